/*
 * How a command reaches a host: by a template, which is ssh unless the hosts file states another.
 * The words of the command are quoted once for the remote shell. The whole command is quoted again,
 * as one word of the template, for the local shell.
 */
#include "hosts/hosts_int.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/*
 * No terminal, X11, agent, escape character or prompt. What the user's configuration has for a
 * person's sessions does not apply: forwarded ports and tunnels, a remote or local command, and
 * becoming the connection that others share, which would end with this one. A host that does not
 * answer is given up after 10 s; a connection without any data is given up after 15 s. The user's
 * own configuration of hosts and keys still applies.
 */
static const char default_via[] =
    "ssh -T -x -a -e none -oBatchMode=yes -oClearAllForwardings=yes -oRemoteCommand=none"
    " -oPermitLocalCommand=no -oControlMaster=no -oConnectTimeout=10 -oServerAliveInterval=5"
    " -oServerAliveCountMax=3 %h %c";

/* ~ is the remote home directory. */
static void add_path(struct buf *b, const char *bin)
{
    buf_printf(b, "env PATH=");
    if (*bin == '~') buf_printf(b, "\"$HOME\"");
    hosts_add_word(b, *bin == '~' ? bin + 1 : bin);
    buf_printf(b, ":\"$PATH\" ");
}

/* Text for the remote shell, which is replaced by the worker. */
static void add_remote(struct buf *b, const struct host *h, char *const worker[])
{
    if (h->sent) {
        hosts_add_bootstrap(b, h->sent, worker);
        buf_append(b, "", 1);
        return;
    }
    buf_printf(b, "exec ");
    if (h->bin) add_path(b, h->bin);
    for (size_t i = 0; worker[i]; i++) {
        if (i) buf_append(b, " ", 1);
        hosts_add_word(b, worker[i]);
    }
    buf_append(b, "", 1);
}

const char *hosts_via(const struct host *h) { return h->via ? h->via : default_via; }

static void add_template(struct buf *b, const char *via, const char *name, const char *remote)
{
    for (const char *p = via; *p; p++) {
        if (*p != '%') buf_append(b, p, 1);
        else if (*++p == 'h') buf_word(b, name);
        else if (*p == 'c') buf_word(b, remote);
        else buf_append(b, "%", 1);
    }
    buf_append(b, "", 1);
}

static char **copy_of(char *const *words, size_t n)
{
    char **argv = xcalloc(n + 1, sizeof *argv);
    for (size_t i = 0; i < n; i++) argv[i] = xstrdup(words[i]);
    return argv;
}

char **hosts_by_sh(const char *by, const char *via, const char *name, const char *remote)
{
    char sh[] = "sh", option[] = "-c";
    struct buf line = {0};
    buf_printf(&line, "exec %s", by);
    add_template(&line, via, name, remote);
    char **argv = copy_of((char *const[]){sh, option, (char *)line.data}, 3);
    buf_free(&line);
    return argv;
}

/* The worker's command within the limits of the host, by programs that every host has. */
static char **limited(const struct host *h, char *const worker[])
{
    static const char bounded[] = "ulimit -v \"$1\" && shift && exec \"$@\"";
    char kib[24], nice[8];
    const char *before[9];
    size_t n = 0, all = 0;
    snprintf(kib, sizeof kib, "%lld", (long long)(h->memory / 1024));
    snprintf(nice, sizeof nice, "%d", h->nice);
    if (h->nice) before[n++] = "nice", before[n++] = "-n", before[n++] = nice;
    if (h->memory) {
        before[n++] = "sh", before[n++] = "-c", before[n++] = bounded;
        before[n++] = "sh", before[n++] = kib;
    }
    while (worker[all]) all++;
    char **words = xcalloc(n + all + 1, sizeof *words);
    for (size_t i = 0; i < n + all; i++) words[i] = xstrdup(i < n ? before[i] : worker[i - n]);
    return words;
}

char **host_argv(const struct host *h, char *const worker[])
{
    struct buf remote = {0};
    char **words = limited(h, worker);
    if (host_is_here(h)) return words;
    char **plain = hosts_plain_words(words);
    add_remote(&remote, h, plain ? plain : words);
    char **argv = hosts_by_sh("", hosts_via(h), h->name, (const char *)buf_data(&remote));
    host_argv_free(plain);
    host_argv_free(words);
    buf_free(&remote);
    return argv;
}

void host_argv_free(char **argv)
{
    for (size_t i = 0; argv && argv[i]; i++) free(argv[i]);
    free(argv);
}

static bool is_program(const char *dir, size_t n, const char *word)
{
    char path[4096];
    int len = snprintf(path, sizeof path, "%.*s%s%s", (int)n, dir, n ? "/" : "", word);
    return len < 0 || (size_t)len >= sizeof path || access(path, X_OK) == 0;
}

/* The first word of the template if no shell changes it, or "". */
static void first_word(const char *via, char word[HOST_LAUNCHER_MOST])
{
    size_t n = strspn(via, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/+-");
    bool plain = n && n < HOST_LAUNCHER_MOST && via[n] && strchr(" \t", via[n]);
    snprintf(word, HOST_LAUNCHER_MOST, "%.*s", plain ? (int)n : 0, via);
}

bool host_launcher(const struct host *h, char word[HOST_LAUNCHER_MOST])
{
    const char *dir = getenv("PATH");
    first_word(hosts_via(h), word);
    if (!*word || !dir) return true; /* a shell may know what it is */
    if (strchr(word, '/')) return is_program("", 0, word);
    for (size_t k; k = strcspn(dir, ":"), !is_program(dir, k, word); dir += k + 1)
        if (!dir[k]) return false;
    return true;
}

bool host_by_ssh(const struct host *h)
{
    char word[HOST_LAUNCHER_MOST];
    if (host_is_here(h)) return false;
    first_word(hosts_via(h), word);
    const char *slash = strrchr(word, '/');
    return strcmp(slash ? slash + 1 : word, "ssh") == 0;
}
