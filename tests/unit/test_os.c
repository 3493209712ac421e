/* What the system does: the same in Linux's way and in that of POSIX, except where os.h says so. */
#include "os/os.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE_MS 60000

static int pipe_of[2];

static int open_pipe(void **state)
{
    (void)state;
    return os_pipe(pipe_of);
}

static int close_pipe(void **state)
{
    (void)state;
    close(pipe_of[0]);
    return close(pipe_of[1]);
}

static bool kept_from_exec(int fd) { return fcntl(fd, F_GETFD) == FD_CLOEXEC; }

static void descriptors_are_kept_from_exec(void **state)
{
    (void)state;
    char name[] = "/tmp/stormring-os-XXXXXX";
    int fd = os_temporary(name);
    assert_true(fd >= 0);
    unlink(name);
    assert_true(kept_from_exec(fd) && kept_from_exec(pipe_of[0]) && kept_from_exec(pipe_of[1]));
    close(fd);
    char nowhere[] = "/no/such/XXXXXX";
    assert_int_equal(os_temporary(nowhere), -1);
    assert_int_equal(errno, ENOENT);
}

/* The exit status of a child that runs this. */
static int of_child(int (*run)(void))
{
    int status;
    pid_t pid = fork();
    if (pid == 0) _exit(run());
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static int is_open(int fd) { return fcntl(fd, F_GETFD) >= 0; }

static int close_others(void)
{
    os_close_others();
    return is_open(pipe_of[0]) + is_open(pipe_of[1]) + 2 * is_open(STDERR_FILENO);
}

static void others_are_closed(void **state)
{
    (void)state;
    assert_int_equal(of_child(close_others), 2);
}

static void some_processor_is_there(void **state)
{
    (void)state;
    assert_in_range(os_processors(), 1, 1 << 20);
}

/* ---- signals --------------------------------------------------------------------------------- */

static volatile sig_atomic_t signals;

static void count(int sig)
{
    (void)sig;
    signals++;
    os_poll_end();
}

static int poll_with(const sigset_t *mask, int timeout_ms)
{
    struct pollfd p = {pipe_of[0], POLLIN, 0};
    return os_poll(&p, 1, timeout_ms, mask);
}

/* A blocked signal that came before ends the wait, and is delivered only then. */
static void a_signal_ends_the_wait(void **state)
{
    (void)state;
    struct sigaction act = {.sa_handler = count}, was;
    sigset_t blocked, before;
    sigfillset(&act.sa_mask);
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGCHLD);
    sigaction(SIGCHLD, &act, &was);
    sigprocmask(SIG_BLOCK, &blocked, &before);
    for (int round = 1; round <= 3; round++) {
        pid_t pid = fork();
        if (pid == 0) {
            if (round == 3) poll(NULL, 0, 20); /* it ends while this process waits */
            _exit(0);
        }
        siginfo_t info;
        if (round < 3) waitid(P_PID, (id_t)pid, &info, WEXITED | WNOWAIT);
        assert_int_equal(signals, round - 1);
        assert_int_equal(poll_with(&before, PATIENCE_MS), -1);
        assert_int_equal(errno, EINTR);
        assert_int_equal(signals, round);
        assert_int_equal(waitpid(pid, NULL, 0), pid);
        sigset_t now;
        sigprocmask(SIG_SETMASK, NULL, &now);
        assert_true(sigismember(&now, SIGCHLD));
    }
    assert_int_equal(poll_with(&before, 0), 0);
    assert_int_equal(write(pipe_of[1], "x", 1), 1);
    assert_int_equal(poll_with(&before, PATIENCE_MS), 1);
    assert_int_equal(poll_with(NULL, PATIENCE_MS), 1);
    raise(SIGCHLD); /* it waits for the next time */
    assert_int_equal(signals, 3);
    assert_int_equal(poll_with(NULL, PATIENCE_MS), 1);
    assert_int_equal(signals, 3);
    sigprocmask(SIG_SETMASK, &before, NULL);
    assert_int_equal(signals, 4);
    sigaction(SIGCHLD, &was, NULL);
}

/* ---- files ----------------------------------------------------------------------------------- */

static char file[] = "/tmp/stormring-os-XXXXXX";

static int other_sees(void)
{
    int fd = open(file, O_RDWR | O_CLOEXEC), reads = open(file, O_RDONLY | O_CLOEXEC);
    const bool seen = os_locked(reads), refused = os_lock(fd) != 0;
    return seen + 2 * (refused && errno == EWOULDBLOCK);
}

static void a_lock_is_seen_by_others(void **state)
{
    (void)state;
    int fd = os_temporary(file);
    assert_true(fd >= 0);
    assert_int_equal(of_child(other_sees), 0);
    assert_int_equal(os_lock(fd), 0);
    assert_int_equal(of_child(other_sees), 3);
    close(fd);
    assert_int_equal(of_child(other_sees), 0);
    unlink(file);
}

static void unread_bytes_are_counted(void **state)
{
    (void)state;
    assert_int_equal(write(pipe_of[1], "12345", 5), 5);
#ifdef _GNU_SOURCE
    assert_int_equal(os_unread(pipe_of[0]), 5);
#else
    assert_int_equal(os_unread(pipe_of[0]), -1);
#endif
}

static void a_pipe_is_no_terminal(void **state)
{
    (void)state;
    int columns, rows;
    assert_false(os_terminal(pipe_of[0], &columns, &rows));
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* Only whole pages are given back, so both ends stay. */
static void pages_are_given_back(void **state)
{
    (void)state;
    const size_t n = 1 << 20;
    char *p = malloc(n);
    assert_non_null(p);
    os_populate(p, 0);
    os_populate(p, n);
    memset(p, 'x', n);
    os_discard(p + 1, 100);
    assert_int_equal(p[1], 'x');
    os_discard(p + 1, n - 2);
    assert_true(p[0] == 'x' && p[n - 1] == 'x');
#ifdef _GNU_SOURCE
    assert_int_equal(p[n / 2], 0);
#else
    assert_int_equal(p[n / 2], 'x');
#endif
    free(p);
}

/* ---- options --------------------------------------------------------------------------------- */

static void options_have_two_words(void **state)
{
    (void)state;
    char *argv[] = {(char[]){"a"}, (char[]){"-xy"}, (char[]){"2"}, (char[]){"--version"},
        (char[]){"--help"}, (char[]){"--"}, (char[]){"--help"}, NULL};
    const int argc = 7;
    assert_int_equal(os_getopt(argc, argv, "+hxy:"), 'x');
    assert_int_equal(os_getopt(argc, argv, "+hxy:"), 'y');
    assert_string_equal(optarg, "2");
    assert_int_equal(os_getopt(argc, argv, "+hxy:"), OS_VERSION);
    assert_int_equal(os_getopt(argc, argv, "+hxy:"), 'h');
    assert_int_equal(os_getopt(argc, argv, "+hxy:"), -1);
    assert_int_equal(optind, 6);
}

int main(void)
{
#define PIPED(t) cmocka_unit_test_setup_teardown(t, open_pipe, close_pipe)
    const struct CMUnitTest tests[] = {
        PIPED(descriptors_are_kept_from_exec),
        PIPED(others_are_closed),
        cmocka_unit_test(some_processor_is_there),
        PIPED(a_signal_ends_the_wait),
        cmocka_unit_test(a_lock_is_seen_by_others),
        PIPED(unread_bytes_are_counted),
        PIPED(a_pipe_is_no_terminal),
        cmocka_unit_test(pages_are_given_back),
        cmocka_unit_test(options_have_two_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
