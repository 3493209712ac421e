/* Hosts files, comma lists, and the commands that reach hosts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "hosts/hosts_int.h"

#include <string.h>
#include <unistd.h>

static char path[32], err[HOSTS_ERR];
static struct hosts hosts;

static bool read_bytes(const char *text, size_t n)
{
    memcpy(path, "/tmp/hosts.XXXXXX", 18);
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(write_full(fd, text, n), 0);
    close(fd);
    bool good = hosts_read(&hosts, path, err);
    unlink(path);
    return good;
}

static bool read_text(const char *text) { return read_bytes(text, strlen(text)); }

/* The text is refused at this line, in these words. */
static void refused(const char *text, int line, const char *words)
{
    char place[64];
    assert_false(read_text(text));
    snprintf(place, sizeof place, line ? "%s:%d: " : "%s: ", path, line);
    assert_int_equal(strncmp(err, place, strlen(place)), 0);
    assert_non_null(strstr(err, words));
    assert_non_null(strstr(err, "expected"));
    assert_null(hosts.at);
}

static void a_file_has_a_host_a_line(void **state)
{
    (void)state;
    assert_true(read_text("# name\n\n  :\tslots=2\r\nrender1 power=1.347 slots=4 # big one\n"
                          "me@render2 via=\"ssh -p 2222 %h \\\"%%\\\" # %c\" bin=~/bin"));
    assert_int_equal(hosts.n, 3);
    assert_int_equal(hosts.slots, 7);
    assert_true(host_is_here(&hosts.at[0]));
    assert_int_equal(hosts.at[0].slots, 2);
    assert_true(hosts.at[0].power == 0);
    assert_string_equal(hosts.at[1].name, "render1");
    assert_int_equal(hosts.at[1].slots, 4);
    assert_true(hosts.at[1].power == 1.347);
    assert_null(hosts.at[1].via);
    assert_string_equal(hosts.at[2].name, "me@render2");
    assert_string_equal(hosts.at[2].via, "ssh -p 2222 %h \"%%\" # %c");
    assert_string_equal(hosts.at[2].bin, "~/bin");
    assert_int_equal(hosts.at[2].slots, 1);
    hosts_free(&hosts);
}

static void a_host_may_have_a_queue_and_a_limit(void **state)
{
    (void)state;
    assert_true(read_text("a wait=3600 tries=20\nb wait=.5e1\n: tries=1\n"));
    assert_true(hosts.at[0].wait_s == 3600 && hosts.at[1].wait_s == 5);
    assert_true(hosts.at[0].tries == 20 && hosts.at[1].tries == 0 && hosts.at[2].tries == 1);
    hosts_free(&hosts);
    refused("a wait=0", 1, "wait='0': expected seconds from 1 to 1e6");
    refused("a wait=1h", 1, "wait='1h'");
    refused("a\na tries=0", 2, "tries='0': expected an integer from 1 to 1000");
    refused("a tries=1001", 1, "tries='1001'");
    refused(": wait=9", 1, "expected no via=, bin=, send= or wait=");
}

static void a_lone_name_may_be_meant_for_a_file(void **state)
{
    (void)state;
    assert_false(hosts_read(&hosts, "my.hosts", err));
    assert_non_null(strstr(err, "my.hosts: no such file"));
    assert_true(hosts_read(&hosts, "1/my.hosts", err));
    assert_false(hosts.no_file);
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, "a.txt,b", err));
    assert_false(hosts.no_file);
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, "render1.example.org", err));
    assert_true(hosts.no_file);
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, ":", err));
    assert_false(hosts.no_file);
    hosts_free(&hosts);
}

static void a_list_is_taken_as_parallel_takes_it(void **state)
{
    (void)state;
    assert_true(hosts_read(&hosts, ":,4/render1,me@render2,2/:,3/fe80::1%eth0", err));
    assert_int_equal(hosts.n, 5);
    assert_int_equal(hosts.slots, 11);
    assert_true(host_is_here(&hosts.at[0]));
    assert_string_equal(hosts.at[1].name, "render1");
    assert_int_equal(hosts.at[1].slots, 4);
    assert_string_equal(hosts.at[2].name, "me@render2");
    assert_true(host_is_here(&hosts.at[3]));
    assert_int_equal(hosts.at[3].slots, 2);
    assert_false(host_is_here(&hosts.at[4]));
    hosts_free(&hosts);
}

static void a_bad_list_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"", ",", "a,", "0/a", "x/a", "4/", "-oProxyCommand=x", "4/-x",
        "a b", "4097/a", "no/such/file", "99999999999999999999/a", "a\tb", "\xc3\xa4"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_false(hosts_read(&hosts, bad[i], err));
        assert_non_null(strstr(err, "expected"));
        assert_null(hosts.at);
    }
    assert_false(hosts_read(&hosts, "no/such/file", err));
    assert_non_null(strstr(err, "no/such/file: no such file"));
}

static void a_bad_file_is_refused_with_its_line(void **state)
{
    (void)state;
    static const char nul[] = "a\nb\0 via=\"x %c\"\n";
    char name[300];
    refused("", 0, "no host");
    refused("# nobody\n\n", 0, "no host");
    refused("a\nb slots=0\n", 2, "slots='0': expected an integer");
    refused("a slots=4097", 1, "slots='4097'");
    refused("a slots=1 slots=1", 1, "slots comes twice");
    refused("a power=0", 1, "power='0'");
    refused("a send=yes", 1, "send='yes': expected auto");
    refused(": send=auto", 1, "expected no via=, bin=, send=");
    refused("a send=auto bin=/opt", 1, "bin= and send= together");
    refused("a power=nan", 1, "power='nan'");
    refused("a power=", 1, "power=''");
    refused("a latency_ms=-1", 1, "latency_ms='-1': expected a number from 0 to 1e7");
    refused("a bytes_per_s=.5", 1, "bytes_per_s='.5': expected a number from 1 to 1e15");
    assert_true(read_text("a via=\"sh -c 'it; \\\"%h' \\\"'\\\" %c\""));
    hosts_free(&hosts);
    refused("a via=\"ssh %h\"", 1, "%c");
    refused("a via=\"ssh %h %c %x\"", 1, "via=");
    refused("a via=\"sh -c 'cd /; %c'\"", 1, "outside of inner quotes");
    refused("a via=\"sh -c \\\"%c\\\"\"", 1, "outside of inner quotes");
    refused("a via=\"sh -c 'x \\\"%c\\\"'\"", 1, "outside of inner quotes");
    refused("a via=\"%c %\"", 1, "via=");
    refused("a via=\"ssh %h %c\nb", 1, "quote");
    refused("a bin=here", 1, "bin='here'");
    refused("a bin=/a:/b", 1, "bin='/a:/b'");
    refused("a cores=4", 1, "'cores': unknown");
    refused("a slots", 1, "slots without a value, expected slots=VALUE");
    refused("slots=4", 1, "no host name");
    refused("-x", 1, "no host name");
    refused("\"a b\"", 1, "no host name");
    refused(": via=\"sh -c %c\"", 1, "this machine");
    refused(": bin=/usr/bin", 1, "this machine");
    memset(name, 'n', sizeof name);
    name[HOST_NAME_MOST + 1] = '\0';
    refused(name, 1, "no host name");
    name[HOST_NAME_MOST] = '\0';
    assert_true(read_text(name));
    hosts_free(&hosts);
    assert_true(read_text("a slots=4000\nb slots=96"));
    hosts_free(&hosts);
    assert_false(read_bytes(nul, sizeof nul - 1));
    assert_non_null(strstr(err, ":2: a NUL byte, expected text"));
}

/* No shell, no other program and no reader of records makes anything else of a name. */
static void names_consist_of_harmless_bytes(void **state)
{
    (void)state;
    static const char *const good[] = {"Render-1.example.org", "me.too+x@10.0.0.1", "a_b%eth0",
        "::1", "me@fe80::1%eth0", "2001:db8::7", "9"};
    static const char *const bad[] = {"a$(touch${IFS}X)", "a;b", "a`b`", "a|b", "a&b", "a'b", "a*b",
        "a~b", "a!b", "a(b", "a{b}", "a>b", "a^b", "a[1]", "me@-oProxyCommand", "-l@a", "@a", "me@",
        "a@b@c", "root:x:0:0:root", "daemon::1:", "a:22", "me:x@a", "::1::2", "a\177", "\303\244"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(read_text(good[i]));
        assert_string_equal(hosts.at[0].name, good[i]);
        hosts_free(&hosts);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) refused(bad[i], 1, "no host name");
    /* In a list a comma and a slash are no part of a name, and a colon is part of an address. */
    for (int c = 1; c < 256; c++) {
        const char name[] = {'1', '/', 'a', (char)c, 'b', '\0'};
        bool harmless = (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z');
        if (strchr(",/", c)) continue;
        assert_int_equal(hosts_read(&hosts, name, err), harmless || strchr("._@%+-", c));
        if (harmless || strchr("._@%+-", c)) hosts_free(&hosts);
        else assert_non_null(strstr(err, ": no host name"));
    }
}

static void hosts_and_slots_have_a_limit(void **state)
{
    (void)state;
    static char text[3 * HOSTS_MOST + 3];
    char *at = text;
    int lines = 0;
    for (int left = HOSTS_SLOTS_MAX; left; left -= left < HOST_SLOTS_MAX ? left : HOST_SLOTS_MAX)
        at += sprintf(at, "a slots=%d\n", left < HOST_SLOTS_MAX ? left : HOST_SLOTS_MAX), lines++;
    assert_true(read_text(text));
    assert_int_equal(hosts.slots, HOSTS_SLOTS_MAX);
    hosts_free(&hosts);
    strcpy(at, "b\n");
    refused(text, lines + 1, "1000001 slots");
    for (at = text; at < text + 2 * HOSTS_MOST; at += 2) memcpy(at, "a\n", 3);
    assert_true(read_text(text));
    assert_int_equal(hosts.n, HOSTS_MOST);
    hosts_free(&hosts);
    strcpy(at, "b\n");
    refused(text, HOSTS_MOST + 1, "100000 hosts");
}

/* A file that was named by mistake is refused soon, and little of it is shown. */
static void what_is_no_hosts_file_is_refused(void **state)
{
    (void)state;
    static char line[5000], text[(16 << 20) + 2];
    memset(line, 'x', sizeof line - 1);
    refused(line, 1, "more than 4096 bytes");
    memcpy(line, "a #", 3);
    line[4097] = '\0';
    refused(line, 1, "more than 4096 bytes");
    line[4096] = '\0';
    assert_true(read_text(line));
    hosts_free(&hosts);
    memset(line, 'x', sizeof line - 1);
    line[200] = '\0';
    memcpy(line, "a secret", 8);
    refused(line, 1, "'secretxxxxxxxxxxxxxxxxxxxxxxxxx...': unknown");
    memset(text, '\n', sizeof text - 1);
    refused(text, 0, "larger than 16777216 bytes");
    text[16 << 20] = '\0';
    refused(text, 0, "no host");
    assert_false(hosts_read(&hosts, "/dev/zero", err));
    assert_non_null(strstr(err, "/dev/zero: no regular file, expected"));
    assert_false(hosts_read(&hosts, "/tmp/", err));
    assert_non_null(strstr(err, "/tmp/: no regular file, expected"));
}

/* What the host's shell is to run, when `via` only prints it. */
static void check_command(const char *name, const char *via, const char *bin, const char *expected)
{
    char word[] = "rtworker", quoted[] = "it's a \"$word\" \\ `x` ! *", empty[] = "",
         option[] = "-d3";
    char *worker[] = {word, quoted, empty, option, NULL};
    struct host h = {.name = xstrdup(name),
        .via = via ? xstrdup(via) : NULL,
        .bin = bin ? xstrdup(bin) : NULL,
        .slots = 1};
    char **argv = host_argv(&h, worker);
    assert_string_equal(argv[0], "sh");
    assert_string_equal(argv[1], "-c");
    assert_string_equal(argv[2], expected);
    assert_null(argv[3]);
    host_argv_free(argv);
    free(h.name);
    free(h.via);
    free(h.bin);
}

static void commands_are_quoted_for_both_shells(void **state)
{
    (void)state;
#define THERE                                                                                      \
    "'\\''it'\\''"                                                                                 \
    "\\"                                                                                           \
    "'\\''"                                                                                        \
    "'\\''s a \"$word\" '\\''"                                                                     \
    "\\\\"                                                                                         \
    "'\\'' `x` '\\''"                                                                              \
    "\\!"                                                                                          \
    "'\\'' *'\\''"                                                                                 \
    " '\\'''\\'' -d3'"
    check_command("a", "%h %c", NULL, "exec a 'exec rtworker " THERE);
    check_command("a;b", "x %h %% %c", NULL, "exec x 'a;b' % 'exec rtworker " THERE);
    check_command(
        "a", "%c", "/opt/x y", "exec 'exec env PATH='\\''/opt/x y'\\'':\"$PATH\" rtworker " THERE);
    check_command("a", "%c", "~/b", "exec 'exec env PATH=\"$HOME\"/b:\"$PATH\" rtworker " THERE);
    check_command("me@a", NULL, NULL,
        "exec ssh -T -x -a -e none -oBatchMode=yes -oClearAllForwardings=yes -oRemoteCommand=none"
        " -oPermitLocalCommand=no -oControlMaster=no -oConnectTimeout=10 -oServerAliveInterval=5"
        " -oServerAliveCountMax=3 me@a 'exec rtworker " THERE);
}

static void control_characters_travel_as_numbers(void **state)
{
    (void)state;
    char word[] = "a", lines[] = "x\ny\\z\t!\177", empty[] = "";
    char *plain[] = {word, empty, NULL}, *odd[] = {word, lines, empty, NULL};
    assert_null(hosts_plain_words(plain));
    char **words = hosts_plain_words(odd);
    assert_non_null(words);
    assert_string_equal(words[0], "sh");
    assert_string_equal(words[1], "-c");
    assert_null(strpbrk(words[2], "!\\'\n"));
    assert_string_equal(words[4], "a");
    assert_string_equal(words[5], "x\\0012y\\0134z\\0011!\\0177");
    assert_string_equal(words[6], "");
    assert_null(words[7]);
    host_argv_free(words);
}

/* What other programs take for a host, as a list or in a file. */
static void a_message_says_what_to_write(void **state)
{
    (void)state;
    static const char *const rows[][3] = {
        {"a:2222", "via=\"ssh -p 2222 %h %c\"; slots are written 4/host", "slots=4"},
        {"root@a:22", "expected 'root@a' without a colon: a port goes into ~/.ssh/config",
            "ssh -p 22 "},
        {"[::1]", "an IPv6 address without brackets", "without brackets"},
        {"me@[fe80::1%eth0]:22", "without brackets and port", "without brackets and port"},
        {"ssh://a:22", "without `ssh://`", "without `ssh://`"},
        {"a,", "a name before and after each comma", "one host a line"},
        {",a", "a name before and after each comma", "one host a line"},
        {"2/", "and after `4/`", "four slots are written"},
        {"..", "or an IPv6 address", "or an IPv6 address"},
        {":2", "or an IPv6 address", "or an IPv6 address"},
        {"4*a", "`4/host` for four slots", "a line `host slots=4`"},
        {"a*4", "four slots are written `4/host`", "a line `host slots=4`"},
        {"n[1-4]", "each host by its name", "each host by its name"},
        {"a b", "commas between names, and no blanks", NULL},
        {"a;b", "commas between names, and no blanks", "of letters, digits and ._@%+-"},
        {"a:/tmp", "no such file", "four slots are written"},
        {"a:b", "or an IPv6 address", "or an IPv6 address"},
        {"a,slurm:", "`slurm:` alone", "one host a line"},
        {"slurm", "expected `slurm:` for the nodes of a job, or 1/slurm", NULL},
        {"pbs", "expected `pbs:`", NULL},
        {"4/a", NULL, "expected a line `host slots=4` for four slots"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i][2]) refused(rows[i][0], 1, rows[i][2]);
        if (!rows[i][1]) continue;
        assert_false(hosts_read(&hosts, rows[i][0], err));
        if (!strstr(err, rows[i][1])) fail_msg("%s", err);
    }
}

static void a_byte_order_mark_is_skipped(void **state)
{
    (void)state;
    assert_true(read_text("\357\273\277render1 slots=2\n"));
    assert_string_equal(hosts.at[0].name, "render1");
    hosts_free(&hosts);
    assert_false(read_bytes("\377\376a\0\n\0", 6));
    assert_non_null(strstr(err, "text of UTF-16, expected UTF-8"));
}

static void ssh_is_asked_for_its_way(void **state)
{
    (void)state;
    static const char *const settings[][2] = {{"user me\nproxyjump bastion\nport 22\n", "bastion"},
        {"proxycommand ssh -W %h:%p gate", "ssh -W %h:%p gate"},
        {"proxycommand none\nproxyjump none\n", NULL}, {"xproxyjump a\n", NULL}, {"", NULL}};
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        char *jump = host_jump(settings[i][0], strlen(settings[i][0]));
        if (settings[i][1]) assert_string_equal(jump, settings[i][1]);
        else assert_null(jump);
        free(jump);
    }
    assert_true(read_text("a\n:\nb via=\"/usr/bin/ssh -J gate %h %c\"\nc via=\"sh -c %c\"\n"
                          "d via=\"ssh $OPTIONS %h %c\"\ne via=\"podman exec -i %h sh -c %c\"\n"));
    static const bool by_ssh[] = {true, false, true, false, true, false};
    for (size_t i = 0; i < hosts.n; i++) {
        char **argv = host_settings_argv(&hosts.at[i]);
        assert_int_equal(host_by_ssh(&hosts.at[i]), by_ssh[i]);
        assert_int_equal(argv != NULL, by_ssh[i] && i != 4); /* a shell changes the words of d */
        if (i == 2)
            assert_string_equal(argv[2], "exec timeout 1 /usr/bin/ssh -v -G -J gate b true");
        host_argv_free(argv);
    }
    hosts_free(&hosts);
}

static void here_nothing_is_between(void **state)
{
    (void)state;
    char word[] = "rtworker", option[] = "a b";
    char *worker[] = {word, option, NULL};
    hosts_here(&hosts, 3);
    assert_int_equal(hosts.slots, 3);
    char **argv = host_argv(&hosts.at[0], worker);
    assert_string_equal(argv[0], "rtworker");
    assert_string_equal(argv[1], "a b");
    assert_null(argv[2]);
    host_argv_free(argv);
    hosts_free(&hosts);
}

static void slots_are_numbered_through_the_hosts(void **state)
{
    (void)state;
    static const double powers[] = {.5, .5, 2, 1, 1, 1};
    const char *without = NULL;
    assert_true(read_text("a slots=2 power=.5\nb power=2\nc slots=3 power=1\n"));
    double *power = hosts_powers(&hosts, &without);
    assert_non_null(power);
    for (int k = 0; k < 6; k++) assert_true(power[k] == powers[k]);
    free(power);
    hosts_free(&hosts);
    assert_true(read_text("a slots=2 power=.5\nb\nc\n"));
    assert_null(hosts_powers(&hosts, &without));
    assert_string_equal(without, "b");
    hosts_free(&hosts);
}

/* The lines of a rack, read as its head reads them, are the hosts. */
static void racks_have_the_lines_of_their_hosts(void **state)
{
    (void)state;
    struct hosts all, one;
    assert_true(read_text("a slots=2 power=.5 via=\"v 'x y' \\\"q\\\\\\\\\\\" %c\" tries=3\n"
                          "b power=2 bin=~/x\n"
                          ": slots=4\nc slots=3\nd send=auto wait=9\n"));
    all = hosts;
    assert_true(hosts_racks(&all, 2, err));
    assert_int_equal(all.n, 3);
    assert_int_equal(all.slots, 3);
    assert_string_equal(all.at[0].rack, ": slots=\"2\" power=\".5\" tries=\"3\"\n"
                                        "b bin=\"~/x\" power=\"2\"\n");
    assert_true(all.at[0].power > 2.9 && all.at[0].power < 3.1);
    assert_non_null(all.at[0].via);
    assert_string_equal(all.at[1].rack, ": slots=\"4\"\n");
    assert_true(host_is_here(&all.at[1]));
    assert_string_equal(all.at[2].rack, ": slots=\"3\"\nd send=\"auto\" wait=\"9\" slots=1\n");
    assert_true(hosts_read(&one, all.at[2].rack, err));
    assert_int_equal(one.slots, 4);
    assert_true(one.at[1].send && one.at[1].wait_s > 8);
    hosts_free(&one);
    hosts_free(&all);
    assert_true(read_text("a\nb via=\"v 'x y' \\\"q\\\\\\\\\\\" %c\"\n"));
    char *via = xstrdup(hosts.at[1].via);
    assert_true(hosts_racks(&hosts, 2, err));
    assert_true(hosts_read(&one, hosts.at[0].rack, err));
    assert_string_equal(one.at[1].via, via);
    free(via);
    hosts_free(&one);
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, "x,:,y,z", err));
    assert_true(hosts_racks(&hosts, 9, err));
    assert_int_equal(hosts.n, 3);
    assert_null(host_heir(&hosts.at[1]));
    assert_string_equal(hosts.at[2].rack, ": slots=1\nz slots=1\n");
    hosts_free(&hosts);
    assert_true(read_text("a slots=2 power=1\nb bin=/b power=3\nc send=auto power=3\n"));
    assert_true(hosts_racks(&hosts, 9, err));
    struct host *rack = hosts.at;
    rack->members[1].unusable = true;
    assert_string_equal(host_heir(rack)->name, "c");
    host_succeed(rack, host_heir(rack));
    assert_string_equal(rack->name, "c");
    assert_true(rack->send && rack->slots == 1 && rack->power > 7);
    assert_string_equal(rack->rack, "a slots=\"2\" power=\"1\"\nb bin=\"/b\" power=\"3\"\n"
                                    ": power=\"3\"\n");
    host_succeed(rack, host_heir(rack));
    assert_string_equal(rack->name, "a");
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, "3/x,2/y", err));
    assert_true(hosts_racks(&hosts, 9, err));
    assert_string_equal(hosts.at[0].rack, ": slots=3\ny slots=2\n");
    hosts_free(&hosts);
    assert_false(hosts_read(&hosts, "a\nb slots=0\n", err));
    assert_int_equal(strncmp(err, "-S:2: ", 6), 0);
}

static void write_version(const char *text)
{
    char other[sizeof path + 4];
    snprintf(other, sizeof other, "%s.new", path);
    FILE *to = fopen(other, "we");
    assert_non_null(to);
    assert_true(fputs(text, to) >= 0);
    assert_int_equal(fclose(to), 0);
    assert_int_equal(rename(other, path), 0);
}

/* What a look finds at this second. */
static enum hosts_news look(struct hosts_watch *w, int second, struct hosts *new)
{
    return hosts_watch(w, second * INT64_C(1000000), new, err);
}

static void a_version_that_stays_is_new_once(void **state)
{
    (void)state;
    struct hosts new;
    struct hosts_watch w;
    memcpy(path, "/tmp/hosts.XXXXXX", 18);
    close(mkstemp(path));
    write_version("a\n");
    assert_true(hosts_read(&hosts, path, err));
    hosts_watch_open(&w, &hosts);
    for (int i = 0; i < 3; i++) assert_int_equal(look(&w, i, &new), HOSTS_SAME);
    write_version("a\nb\n");
    assert_int_equal(look(&w, 3, &new), HOSTS_SAME); /* it may be half written */
    write_version("a\nb\nc\n");
    assert_int_equal(look(&w, 4, &new), HOSTS_SAME);
    assert_int_equal(look(&w, 4, &new), HOSTS_SAME); /* too early */
    assert_int_equal(look(&w, 5, &new), HOSTS_NEW);
    assert_int_equal(new.n, 3);
    hosts_free(&new);
    assert_int_equal(look(&w, 6, &new), HOSTS_SAME);
    write_version("a\n-b\n");
    assert_int_equal(look(&w, 7, &new), HOSTS_SAME);
    assert_int_equal(look(&w, 8, &new), HOSTS_BAD);
    assert_non_null(strstr(err, ":2: "));
    assert_non_null(strstr(err, "no host name"));
    assert_int_equal(look(&w, 9, &new), HOSTS_SAME);
    unlink(path);
    assert_int_equal(look(&w, 10, &new), HOSTS_SAME);
    assert_int_equal(look(&w, 11, &new), HOSTS_BAD);
    assert_non_null(strstr(err, "expected a file"));
    write_version("a\n");
    assert_int_equal(look(&w, 12, &new), HOSTS_SAME);
    assert_int_equal(look(&w, 13, &new), HOSTS_NEW);
    unlink(path);
    hosts_free(&new);
    hosts_free(&hosts);
    assert_true(hosts_read(&hosts, "a,b", err));
    hosts_watch_open(&w, &hosts);
    assert_int_equal(look(&w, 14, &new), HOSTS_SAME); /* a list does not change */
    hosts_free(&hosts);
}

static void lines_are_the_same_if_they_reach_the_same_host(void **state)
{
    (void)state;
    assert_true(read_text("a\na slots=3 power=2\nb\na bin=/x\na bin=/y\na via=\"x %c\"\n"
                          "a send=auto\na wait=9\n"));
    for (size_t i = 0; i < hosts.n; i++)
        for (size_t j = 0; j < hosts.n; j++)
            assert_int_equal(host_same(&hosts.at[i], &hosts.at[j]), i == j || i + j == 1);
    hosts_free(&hosts);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_has_a_host_a_line),
        cmocka_unit_test(a_host_may_have_a_queue_and_a_limit),
        cmocka_unit_test(a_lone_name_may_be_meant_for_a_file),
        cmocka_unit_test(a_list_is_taken_as_parallel_takes_it),
        cmocka_unit_test(a_bad_list_is_refused),
        cmocka_unit_test(a_bad_file_is_refused_with_its_line),
        cmocka_unit_test(names_consist_of_harmless_bytes),
        cmocka_unit_test(hosts_and_slots_have_a_limit),
        cmocka_unit_test(what_is_no_hosts_file_is_refused),
        cmocka_unit_test(commands_are_quoted_for_both_shells),
        cmocka_unit_test(control_characters_travel_as_numbers),
        cmocka_unit_test(a_message_says_what_to_write),
        cmocka_unit_test(a_byte_order_mark_is_skipped),
        cmocka_unit_test(ssh_is_asked_for_its_way),
        cmocka_unit_test(here_nothing_is_between),
        cmocka_unit_test(slots_are_numbered_through_the_hosts),
        cmocka_unit_test(racks_have_the_lines_of_their_hosts),
        cmocka_unit_test(a_version_that_stays_is_new_once),
        cmocka_unit_test(lines_are_the_same_if_they_reach_the_same_host),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
