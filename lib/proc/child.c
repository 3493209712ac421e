/*
 * Starting and ending children.
 *
 * All pipes are close-on-exec. The child dup2s its ends onto 0, 1 and, if it has a pipe for it, 2,
 * which clears the flag there; then it execs. A failure before or in exec goes back as errno over
 * the REPORT pipe. A successful exec closes that pipe's write end. The parent closes the child's
 * ends at once.
 */
#include "os/os.h"
#include "proc/proc_int.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { TO, FROM, REPORT, ERR, PIPES }; /* ERR comes last: it may be missing */

void child_close(int *fd)
{
    if (*fd >= 0) close(*fd);
    *fd = -1;
}

/* What a child runs. */
struct to_run {
    int (*function)(void *ctx);
    void *ctx;
    bool forks; /* the result is the exit status; else, a return is a failure with errno */
};

static _Noreturn void run_child(pid_t parent, int p[PIPES][2], const struct to_run *run)
{
    setpgid(0, 0);
    groups_forget(); /* they are those of the parent */
    signals_restore();
    /* A killed parent cannot kill its children: this also ends a stopped child, or one that
     * ignores signals. */
    os_die_with_parent(SIGKILL);
    if (getppid() != parent) _exit(127);
    /* Without exec, the child would keep the pipes of others open, which would never end. */
    if (dup2(p[TO][0], STDIN_FILENO) >= 0 && dup2(p[FROM][1], STDOUT_FILENO) >= 0 &&
        (p[ERR][1] < 0 || dup2(p[ERR][1], STDERR_FILENO) >= 0)) {
        if (run->forks) os_close_others();
        const int status = run->function(run->ctx);
        if (run->forks) _exit(status);
    }
    int err = errno;
    (void)!write(p[REPORT][1], &err, sizeof err);
    _exit(127);
}

static int open_pipes(int p[PIPES][2], int n)
{
    p[ERR][0] = p[ERR][1] = -1;
    for (int i = 0; i < n; i++) {
        if (os_pipe(p[i]) == 0) continue;
        int err = errno;
        while (i-- > 0) close(p[i][0]), close(p[i][1]);
        errno = err;
        return -1;
    }
    return 0;
}

/* The errno of a failure before or in exec, or 0. */
static int read_report(int fd)
{
    int err = 0;
    ssize_t n;
    do n = read(fd, &err, sizeof err);
    while (n < 0 && errno == EINTR);
    return n == sizeof err ? err : 0;
}

static int set_nonblocking(int fd) { return fd < 0 ? 0 : fcntl(fd, F_SETFL, O_NONBLOCK); }

static int start(struct child *c, const struct to_run *run, int n_pipes)
{
    int p[PIPES][2], err = 0;
    sigset_t stop, before;
    *c = CHILD_NONE;
    if (open_pipes(p, n_pipes) != 0) return -1;
    /* A stop reaches the groups that are known, so it waits until this one is. */
    sigemptyset(&stop);
    sigaddset(&stop, SIGTSTP);
    sigprocmask(SIG_BLOCK, &stop, &before);
    pid_t parent = getpid();
    c->pid = fork();
    if (c->pid == 0) {
        sigprocmask(SIG_SETMASK, &before, NULL);
        run_child(parent, p, run);
    }
    if (c->pid < 0) err = errno, c->pid = 0;
    if (c->pid > 0 && n_pipes == ERR) groups_add(c->pid);
    sigprocmask(SIG_SETMASK, &before, NULL);
    close(p[TO][0]), close(p[FROM][1]), close(p[REPORT][1]), child_close(&p[ERR][1]);
    c->to = p[TO][1];
    c->from = p[FROM][0];
    c->err = p[ERR][0];
    if (!err) err = read_report(p[REPORT][0]);
    close(p[REPORT][0]);
    if (!err && (set_nonblocking(c->to) < 0 || set_nonblocking(c->err) < 0)) err = errno;
    if (!err) return 0;
    child_end(c, 0);
    errno = err;
    return -1;
}

static int exec(void *argv)
{
    char *const *words = *(char *const **)argv;
    return execvp(words[0], words);
}

int child_start(struct child *c, char *const argv[])
{
    return start(c, &(struct to_run){exec, &argv, false}, ERR);
}

int child_start_apart(struct child *c, char *const argv[])
{
    return start(c, &(struct to_run){exec, &argv, false}, PIPES);
}

int child_fork(struct child *c, int (*function)(void *ctx), void *ctx)
{
    return start(c, &(struct to_run){function, ctx, true}, ERR);
}

static int kill_group(struct child *c)
{
    int status = -1;
    kill(-c->pid, SIGKILL);
    while (waitpid(c->pid, &status, 0) < 0 && errno == EINTR)
        ;
    groups_remove(c->pid);
    c->pid = 0;
    return status;
}

bool child_ended(struct child *c, int *status)
{
    siginfo_t info = {0};
    child_close(&c->to);
    child_close(&c->from);
    *status = -1;
    if (c->pid <= 0) return true;
    /* Do not reap yet: until then no other process can get its number, which is its group's. */
    if (waitid(P_PID, (id_t)c->pid, &info, WEXITED | WNOWAIT | WNOHANG) == 0 && !info.si_pid)
        return false;
    *status = kill_group(c);
    return true;
}

void child_stop(struct child *c)
{
    child_close(&c->to);
    child_close(&c->from);
    if (c->pid > 0) kill(-c->pid, SIGTERM);
}

int child_end(struct child *c, int grace_ms)
{
    int status;
    child_close(&c->err);
    for (int64_t end = now_us() + grace_ms * INT64_C(1000); !child_ended(c, &status);) {
        if (now_us() >= end) return kill_group(c);
        nanosleep(&(struct timespec){0, 500000}, NULL);
    }
    return status;
}

int child_run(char *const argv[], int in, int err, struct buf *said)
{
    int out[2], status = 0;
    if (os_pipe(out) != 0) return -1;
    pid_t pid = fork();
    if (pid == 0) {
        os_die_with_parent(SIGTERM);
        if (dup2(in, STDIN_FILENO) >= 0 && dup2(out[1], STDOUT_FILENO) >= 0 &&
            dup2(err < 0 ? out[1] : err, STDERR_FILENO) >= 0)
            execvp(argv[0], argv);
        _exit(127);
    }
    close(out[1]);
    while (pid > 0 && read_some(out[0], said, 1 << 16) > 0) continue;
    close(out[0]);
    if (pid < 0) return -1;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
    return status_code(status);
}

int status_code(int status)
{
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

const char *status_text(int status, char text[24])
{
    const bool killed = WIFEXITED(status) && WEXITSTATUS(status) == 128 + SIGKILL;
    if (killed) snprintf(text, 24, "signal-%d", SIGKILL);
    else if (WIFSIGNALED(status)) snprintf(text, 24, "signal-%d", WTERMSIG(status));
    else snprintf(text, 24, "exit-%d", WEXITSTATUS(status));
    return text;
}

const char *status_hint(const char *text)
{
    const bool killed = strcmp(text, "signal-9") == 0;
    return killed ? "; killed (signal 9), as the kernel does when memory is short" : "";
}

int want_descriptors(int n)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= (rlim_t)n) return n;
    limit.rlim_cur = limit.rlim_max < (rlim_t)n ? limit.rlim_max : (rlim_t)n;
    setrlimit(RLIMIT_NOFILE, &limit);
    return (int)limit.rlim_cur;
}
