/* Children, and queues that never block their writer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "os/os.h"
#include "pipe/pipe.h"
#include "scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define ARG(s) ((char[]){s}) /* execvp wants them writable */

static int ends[2];

#ifdef _GNU_SOURCE
/* Replaces libc's, so that it can fail. */
static bool fork_fails;
pid_t fork(void)
{
    if (!fork_fails) return _Fork();
    errno = EAGAIN;
    return -1;
}
#endif

static int open_pipe(void **state)
{
    (void)state;
    if (os_pipe(ends) != 0) return -1;
    return fcntl(ends[0], F_SETFL, O_NONBLOCK) | fcntl(ends[1], F_SETFL, O_NONBLOCK);
}

static int close_pipe(void **state)
{
    (void)state;
    close(ends[0]);
    if (ends[1] >= 0) close(ends[1]);
    return 0;
}

/* What can be read now, as a string. */
static const char *drained(void)
{
    static char text[1 << 17];
    size_t n = 0;
    ssize_t k;
    while ((k = read(ends[0], text + n, sizeof text - 1 - n)) > 0) n += (size_t)k;
    text[n] = '\0';
    return text;
}

static void bulk(struct up_queue *q, char letter, size_t n)
{
    for (size_t i = 0; i < n; i++) buf_append(&q->bulk, &letter, 1);
    up_end_record(q);
}

static void control_overtakes_pixels_between_records(void **state)
{
    (void)state;
    struct up_queue q = {0};
    bulk(&q, 'a', 10);
    bulk(&q, 'b', 10);
    buf_append(&q.control, "X", 1);
    assert_int_equal(up_size(&q), 21);
    assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
    assert_string_equal(drained(), "Xaaaaaaaaaabbbbbbbbbb");
    assert_int_equal(up_size(&q), 0);
    up_free(&q);
}

static void control_does_not_split_a_record(void **state)
{
    (void)state;
    struct up_queue q = {0};
    bulk(&q, 'a', PIPE_BUF + 100);
    bulk(&q, 'b', 50);
    assert_int_equal(
        up_write(&q, ends[1], PIPE_BUF), 0); /* PIPE_BUF bytes: 100 of the record are left */
    buf_append(&q.control, "X", 1);
    assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
    while (up_size(&q)) assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
    const char *text = drained();
    assert_int_equal(strspn(text, "a"), PIPE_BUF + 100);
    assert_int_equal(text[PIPE_BUF + 100], 'X');
    assert_int_equal(strspn(text + PIPE_BUF + 101, "b"), 50);
    up_free(&q);
}

static void no_write_is_longer_than_a_pipe_takes_at_once(void **state)
{
    (void)state;
    struct up_queue q = {0};
    for (int i = 0; i < 3000; i++) buf_append(&q.control, "cc", 2);
    bulk(&q, 'p', 9000);
    size_t before;
    while ((before = up_size(&q)) > 0) {
        assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
        assert_in_range(before - up_size(&q), 1, PIPE_BUF);
    }
    const char *text = drained();
    assert_int_equal(strspn(text, "c"), 6000);
    assert_int_equal(strspn(text + 6000, "p"), 9000);
    up_free(&q);
}

static void an_unfinished_record_waits(void **state)
{
    (void)state;
    struct up_queue q = {0};
    bulk(&q, 'a', 5);
    buf_append(&q.bulk, "half", 4);
    assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
    assert_string_equal(drained(), "aaaaa");
    up_end_record(&q);
    assert_int_equal(up_write(&q, ends[1], PIPE_BUF), 0);
    assert_string_equal(drained(), "half");
    up_free(&q);
}

static void shared_bodies_keep_their_place(void **state)
{
    (void)state;
    struct down_queue q = {0}, other = {0};
    struct buf scene = {0};
    buf_append(&scene, "SCENE", 5);
    struct blob *b = blob_new(&scene);
    down_append(&q, "one", 3);
    down_share(&q, b);
    down_share(&other, b);
    down_append(&q, "two", 3);
    assert_int_equal(down_write(&q, ends[1]), 0);
    assert_int_equal(down_size(&q), 0);
    assert_string_equal(drained(), "oneSCENEtwo");
    assert_int_equal(down_write(&other, ends[1]), 0);
    assert_string_equal(drained(), "SCENE");
    down_append(&q, "three", 5);
    assert_int_equal(down_write(&q, ends[1]), 0);
    assert_string_equal(drained(), "three");
    assert_int_equal(b->users, 1);
    blob_drop(b);
    down_free(&q);
    down_free(&other);
}

static void a_full_pipe_is_no_error_and_loses_nothing(void **state)
{
    (void)state;
    struct down_queue q = {0};
    size_t n = 300000, got = 0;
    struct buf body = {0};
    memset(buf_reserve(&body, n), 'z', n);
    body.len = n;
    struct blob *b = blob_new(&body);
    down_share(&q, b);
    blob_drop(b);
    down_append(&q, "end", 3);
    for (int i = 0; i < 100 && down_size(&q); i++) {
        assert_int_equal(down_write(&q, ends[1]), 0);
        got += strlen(drained());
    }
    assert_int_equal(got, n + 3);
    down_free(&q);
}

static void a_reader_that_has_gone_is_seen(void **state)
{
    (void)state;
    struct up_queue up = {0};
    struct down_queue down = {0};
    close(ends[0]);
    ends[0] = dup(ends[1]);
    bulk(&up, 'a', 3);
    down_append(&down, "abc", 3);
    assert_int_equal(up_write(&up, ends[1], PIPE_BUF), -1);
    assert_int_equal(errno, EPIPE);
    assert_int_equal(down_write(&down, ends[1]), -1);
    up_free(&up);
    down_free(&down);
}

static void a_child_talks_and_ends(void **state)
{
    (void)state;
    struct child c;
    char *argv[] = {ARG("/bin/sh"), ARG("-c"), ARG("read x; echo got $x; exit 7"), NULL};
    char text[32], why[24];
    assert_int_equal(child_start(&c, argv), 0);
    assert_int_equal(write(c.to, "word\n", 5), 5);
    assert_int_equal(read(c.from, text, sizeof text), 9);
    assert_memory_equal(text, "got word\n", 9);
    assert_string_equal(status_text(child_end(&c, 1000), why), "exit-7");
    assert_int_equal(child_end(&c, 0), -1);
}

static void what_exec_says_comes_back(void **state)
{
    (void)state;
    struct child c;
    char *argv[] = {ARG("/no/such/program"), NULL};
    assert_int_equal(child_start(&c, argv), -1);
    assert_int_equal(errno, ENOENT);
}

static void a_child_that_stays_is_killed_with_its_group(void **state)
{
    (void)state;
    struct child c;
    static char script[] = "trap '' TERM HUP; sleep 100 & echo $!; sleep 100";
    char *argv[] = {ARG("/bin/sh"), ARG("-c"), script, NULL};
    char text[32] = "", why[24];
    assert_int_equal(child_start(&c, argv), 0);
    assert_true(read(c.from, text, sizeof text - 1) > 0);
    pid_t inner = (pid_t)strtol(text, NULL, 10);
    assert_string_equal(status_text(child_end(&c, 20), why), "signal-9");
    for (int i = 0; i < 100 && kill(inner, 0) == 0; i++) poll(NULL, 0, 10); /* till it is reaped */
    char path[40], stat[80] = "";
    snprintf(path, sizeof path, "/proc/%d/stat", (int)inner);
    FILE *f = fopen(path, "r");
    if (f && fgets(stat, sizeof stat, f)) assert_non_null(strstr(stat, ") Z"));
    if (f) fclose(f);
}

static void a_shell_says_which_signal_it_was(void **state)
{
    (void)state;
    struct child c;
    char *argv[] = {ARG("/bin/sh"), ARG("-c"), ARG("exit 137"), NULL};
    char why[24];
    assert_int_equal(child_start(&c, argv), 0);
    assert_string_equal(status_text(child_end(&c, 60000), why), "signal-9");
    assert_non_null(
        strstr(status_hint(why), "; killed (signal 9), as the kernel does when memory"));
    argv[2] = ARG("kill -9 $$");
    assert_int_equal(child_start(&c, argv), 0);
    assert_string_equal(status_text(child_end(&c, 60000), why), "signal-9");
    argv[2] = ARG("exit 255");
    assert_int_equal(child_start(&c, argv), 0);
    assert_string_equal(status_text(child_end(&c, 60000), why), "exit-255");
    assert_string_equal(status_hint(why), "");
    assert_string_equal(status_hint("signal-15"), "");
}

/* The state of a process: R, S, T, ...; 0: there is none. */
static char state_of(pid_t pid)
{
    char path[40], text[400] = "";
    snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    FILE *f = fopen(path, "r");
    if (f) (void)!fread(text, 1, sizeof text - 1, f), fclose(f);
    const char *name_end = strrchr(text, ')');
    return name_end && name_end[1] == ' ' ? name_end[2] : 0;
}

static void await_state(pid_t pid, bool stopped)
{
    for (int i = 0; i < 60000 && (state_of(pid) == 'T') != stopped; i++)
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    assert_int_equal(state_of(pid) == 'T', stopped);
}

static int64_t clock_all_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000 + t.tv_nsec / 1000;
}

/* Has two children, and says which. Ends at SIGTERM: with 7 if its clock forgot the stop. */
static int stoppable(void *ctx)
{
    struct child here, elsewhere;
    char *argv[] = {ARG("/bin/sleep"), ARG("600"), NULL};
    (void)ctx;
    const int64_t before_us = now_us() - clock_all_us();
    signals_catch();
    if (child_start(&here, argv) != 0 || child_start_apart(&elsewhere, argv) != 0) return 1;
    const pid_t pids[] = {here.pid, elsewhere.pid};
    if (write(1, pids, sizeof pids) != sizeof pids) return 1;
    while (!signals_came()) signals_poll(NULL, 0, -1);
    return before_us - (now_us() - clock_all_us()) >= 100000 ? 7 : 2;
}

static void a_stop_is_passed_on(void **state)
{
    (void)state;
    struct child c;
    pid_t pids[2];
    char why[24];
    assert_int_equal(child_fork(&c, stoppable, NULL), 0);
    assert_int_equal(read(c.from, pids, sizeof pids), sizeof pids);
    kill(c.pid, SIGTSTP);
    await_state(c.pid, true);
    assert_int_equal(state_of(pids[0]), 'T');
    assert_int_not_equal(state_of(pids[1]), 'T');
    nanosleep(&(struct timespec){0, 150000000}, NULL);
    kill(c.pid, SIGCONT);
    await_state(pids[0], false);
    kill(c.pid, SIGTERM);
    assert_string_equal(status_text(child_end(&c, 60000), why), "exit-7");
}

#ifdef _GNU_SOURCE
static int zero(void *ctx)
{
    (void)ctx;
    return 0;
}

static void a_fork_that_fails_leaves_no_child(void **state)
{
    (void)state;
    struct child c;
    fork_fails = true;
    int result = child_fork(&c, zero, NULL), err = errno;
    fork_fails = false;
    assert_int_equal(result, -1);
    assert_int_equal(err, EAGAIN);
    assert_int_equal(c.pid, 0);
    assert_int_equal(c.to, -1);
    assert_int_equal(c.from, -1);
}
#endif

/* The last words come first, then the end by the signal; an ignored signal stays so. */
static void last_words_about(const char *file, const char *expected)
{
    char text[32] = "";
    int words[2], status;
    assert_int_equal(pipe(words), 0);
    pid_t pid = fork();
    if (pid == 0) {
        dup2(words[1], STDERR_FILENO);
        signal(SIGHUP, SIG_IGN);
        signals_say("so far\n", file);
        raise(SIGHUP);
        raise(SIGTERM);
        _exit(0);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
    close(words[1]);
    assert_int_equal(read(words[0], text, sizeof text - 1), strlen(expected));
    assert_string_equal(text, expected);
    close(words[0]);
}

static void last_words_are_said(void **state)
{
    (void)state;
    last_words_about("/", "so far\n");
    last_words_about("/no/such", "");
}

/* ---- quotas ---------------------------------------------------------------------------------- */

/* Writes a file of a tree of control groups. */
static void group(const char *dir, const char *name, const char *text)
{
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s%s", dir, name);
    for (char *slash = path + strlen(dir); (slash = strchr(slash + 1, '/'));) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
}

/* A machine: its mounts, and the groups of this process. */
static void machine(const char *dir, const char *mounts, const char *groups)
{
    group(dir, "/proc/self/mountinfo", mounts);
    group(dir, "/proc/self/cgroup", groups);
}

#define V2 "31 23 0:28 / /sys/fs/cgroup rw,relatime shared:4 - cgroup2 cgroup2 rw,nsdelegate\n"
#define V1_AT(top, at) "32 31 0:29 " top " " at " rw - cgroup cgroup rw,cpu,cpuacct\n"
#define HYBRID                                                                                     \
    "40 31 0:37 / /sys/fs/cgroup/systemd rw - cgroup cgroup rw,xattr,name=systemd\n"               \
    "41 31 0:38 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n" V1_AT(                         \
        "/", "/sys/fs/cgroup/cpu")

static double quota(const char *dir, const char *mounts, const char *groups)
{
    machine(dir, mounts, groups);
    return proc_quota(dir);
}

static void remove_tree(const char *dir)
{
    char command[SCRATCH_BYTES + 16];
    snprintf(command, sizeof command, "rm -rf '%s'", dir);
    assert_int_equal(system(command), 0);
}

static void quotas_of_version_2_are_read(void **state)
{
    (void)state;
    char dir[SCRATCH_BYTES];
    assert_true(scratch_make(dir));
    assert_true(isinf(proc_quota(dir))); /* no file at all */
    assert_true(isinf(quota(dir, V2, "")) && isinf(quota(dir, V2, "junk\n:\n0:\n0::x\n")));
    assert_true(isinf(quota(dir, "junk\n1 2 3 - cgroup2\n - cgroup2 a b\n", "0::/job\n")));
    group(dir, "/sys/fs/cgroup/job/cpu.max", "max 100000\n");
    group(dir, "/sys/fs/cgroup/job/part/cpu.max", "150000 100000\n");
    group(dir, "/sys/fs/cgroup/odd/cpu.max", "many\n");
    group(dir, "/sys/fs/cgroup/zero/cpu.max", "50000 0\n");
    assert_true(isinf(quota(dir, V2, "0::/job\n")) && isinf(quota(dir, V2, "0::/odd\n")));
    assert_true(isinf(quota(dir, V2, "0::/zero\n")) && isinf(quota(dir, "", "0::/job/part\n")));
    assert_true(quota(dir, V2, "0::/job/part\n") == 1.5);
    assert_true(quota(dir, V2, "0::/job/part/gone (deleted)\n") == 1.5);
    group(dir, "/sys/fs/cgroup/job/cpu.max", "25000 100000\n"); /* the group around it counts */
    assert_true(quota(dir, V2, "0::/job/part\n") == .25);
    assert_true(isinf(quota(dir, V2, "0::/jobs\n")) && isinf(quota(dir, V2, "0::/elsewhere\n")));
    remove_tree(dir);
}

/* What a container sees: its group is the top of the mount. */
static void quotas_of_a_part_of_the_hierarchy_are_read(void **state)
{
    (void)state;
    static const char part[] = "31 23 0:28 /pods/a /sys/fs/cgroup rw - cgroup2 cgroup2 rw\n",
                      above[] = "31 23 0:28 /../.. /sys/fs/cgroup rw - cgroup2 cgroup2 rw\n",
                      odd[] = "31 23 0:28 / /mnt/control\\040groups rw - cgroup2 cgroup2 rw\n";
    char dir[SCRATCH_BYTES];
    assert_true(scratch_make(dir));
    group(dir, "/sys/fs/cgroup/cpu.max", "200000 100000\n");
    group(dir, "/sys/fs/cgroup/in/cpu.max", "50000 100000\n");
    group(dir, "/sys/fs/cgroup/pods/a/cpu.max", "1000 100000\n"); /* another group of that name */
    assert_true(quota(dir, part, "0::/pods/a\n") == 2);
    assert_true(quota(dir, part, "0::/pods/a/in\n") == .5);
    assert_true(quota(dir, part, "0::/pods/abc\n") == 2); /* not below it: the top is around it */
    assert_true(quota(dir, part, "0::/../../other\n") == 2); /* another view of the groups */
    assert_true(quota(dir, above, "0::/\n") == 2 && quota(dir, V2, "0::/\n") == 2);
    assert_true(quota(dir, V2, "0::/../in\n") == 2);
    group(dir, "/mnt/control groups/a/cpu.max", "30000 100000\n");
    assert_true(quota(dir, odd, "0::/a\n") == .3);
    remove_tree(dir);
}

static void quotas_of_version_1_are_read(void **state)
{
    (void)state;
    static const char groups[] = "4:memory:/\n2:cpuacct,cpu:/job\n1:name=systemd:/job/part\n0::/\n";
    static const char docker[] = V1_AT("/docker/1f", "/sys/fs/cgroup/cpu,cpuacct");
    char dir[SCRATCH_BYTES];
    assert_true(scratch_make(dir));
    group(dir, "/sys/fs/cgroup/cpu/job/cpu.cfs_quota_us", "50000\n");
    assert_true(isinf(quota(dir, HYBRID, groups))); /* no period */
    group(dir, "/sys/fs/cgroup/cpu/job/cpu.cfs_period_us", "100000\n");
    assert_true(quota(dir, HYBRID, groups) == .5);
    assert_true(isinf(quota(dir, HYBRID, "3:cpuset:/job\n0::/job\n")));
    group(dir, "/sys/fs/cgroup/unified/job/cpu.max", "40000 100000\n");
    assert_true(quota(dir, HYBRID, "2:cpu:/job\n0::/job\n") == .4); /* both hold */
    group(dir, "/sys/fs/cgroup/cpu/job/cpu.cfs_quota_us", "-1\n");
    assert_true(isinf(quota(dir, HYBRID, groups)));
    group(dir, "/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "70000\n");
    group(dir, "/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
    assert_true(quota(dir, docker, "2:cpuacct,cpu:/docker/1f\n") == .7);
    assert_true(quota(dir, docker, "2:cpuacct,cpu:/\n") == .7);
    remove_tree(dir);
}

#define MIB 1048576.0

static void memory_is_read(void **state)
{
    (void)state;
    static const char mounts[] =
        V2 "35 31 0:32 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n";
    char dir[SCRATCH_BYTES];
    assert_true(scratch_make(dir));
    machine(dir, mounts, "4:memory:/a/b\n0::/x/y\n");
    assert_true(isinf(proc_memory(dir).bytes));
    group(dir, "/proc/meminfo", "MemTotal:  2048 kB\nMemFree: 1 kB\n");
    assert_true(proc_memory(dir).bytes == 2 * MIB);
    group(dir, "/proc/meminfo",
        "MemTotal: 9999999 kB\nMemAvailable:    1048576 kB\nSwapTotal: 99999 kB\nSwapFree: 1024 "
        "kB\n");
    assert_true(proc_memory(dir).bytes == 1025 * MIB);
    group(dir, "/sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", "9223372036854771712\n");
    group(dir, "/sys/fs/cgroup/x/memory.max", "max\n");
    assert_true(proc_memory(dir).bytes == 1025 * MIB);
    group(dir, "/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "536870912\n"); /* 512 MiB */
    assert_true(proc_memory(dir).bytes == 512 * MIB);
    group(dir, "/sys/fs/cgroup/memory/a/memory.usage_in_bytes", "209715200\n"); /* 200 MiB */
    assert_true(proc_memory(dir).bytes == 312 * MIB);
    group(dir, "/sys/fs/cgroup/memory/a/memory.stat", /* 50 MiB of files */
        "inactive_file 1\ntotal_cache 5\ntotal_inactive_file 41943040\ntotal_active_file "
        "10485760\n");
    assert_true(proc_memory(dir).bytes == 362 * MIB);
    group(dir, "/sys/fs/cgroup/x/memory.max", "104857600\n"); /* 100 MiB, around the group */
    group(dir, "/sys/fs/cgroup/x/memory.current", "83886080\n");
    group(dir, "/sys/fs/cgroup/x/memory.stat",
        "anon 4\nfile 9\ninactive_file 10485760\nactive_file 0\n");
    assert_true(proc_memory(dir).bytes == 30 * MIB);
    group(dir, "/sys/fs/cgroup/x/y/memory.max", "1048576\n");
    assert_true(proc_memory(dir).bytes == MIB);
    group(dir, "/sys/fs/cgroup/x/y/memory.current", "83886080\n");
    assert_true(proc_memory(dir).bytes == 0);
    remove_tree(dir);
}

#ifndef __has_feature
#define __has_feature(feature) 0
#endif

/* The limit of addresses, less what this process has. */
static void a_limit_of_addresses_is_read(void **state)
{
    (void)state;
    int status;
    if (__has_feature(address_sanitizer)) skip(); /* its shadow is larger than any limit */
    assert_true(isinf(proc_memory("").addresses));
    pid_t pid = fork();
    if (pid == 0) {
        setrlimit(RLIMIT_AS, &(struct rlimit){1 << 30, RLIM_INFINITY});
        const double one = proc_memory("").addresses;
        void *more = mmap(NULL, 64 << 20, PROT_READ, MAP_PRIVATE, open("/dev/zero", O_RDONLY), 0);
        const double other = proc_memory("").addresses;
        _exit(more != MAP_FAILED && one > 0 && one < 1 << 30 && fabs(one - other - 64 * MIB) < MIB
                  ? 7
                  : 1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(WEXITSTATUS(status), 7);
}

int main(void)
{
    signal(SIGPIPE, SIG_IGN);
#define PIPED(t) cmocka_unit_test_setup_teardown(t, open_pipe, close_pipe)
    const struct CMUnitTest tests[] = {
        PIPED(control_overtakes_pixels_between_records),
        PIPED(control_does_not_split_a_record),
        PIPED(no_write_is_longer_than_a_pipe_takes_at_once),
        PIPED(an_unfinished_record_waits),
        PIPED(shared_bodies_keep_their_place),
        PIPED(a_full_pipe_is_no_error_and_loses_nothing),
        PIPED(a_reader_that_has_gone_is_seen),
        cmocka_unit_test(a_child_talks_and_ends),
        cmocka_unit_test(what_exec_says_comes_back),
        cmocka_unit_test(a_child_that_stays_is_killed_with_its_group),
        cmocka_unit_test(a_shell_says_which_signal_it_was),
        cmocka_unit_test(a_stop_is_passed_on),
#ifdef _GNU_SOURCE
        cmocka_unit_test(a_fork_that_fails_leaves_no_child),
#endif
        cmocka_unit_test(last_words_are_said),
        cmocka_unit_test(quotas_of_version_2_are_read),
        cmocka_unit_test(quotas_of_a_part_of_the_hierarchy_are_read),
        cmocka_unit_test(quotas_of_version_1_are_read),
        cmocka_unit_test(memory_is_read),
        cmocka_unit_test(a_limit_of_addresses_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
