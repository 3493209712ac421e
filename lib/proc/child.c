/*
 * Starting and ending children.
 *
 * Who closes what: three pipes are made, all close-on-exec. The child dup2s its ends onto 0 and 1
 * (which clears the flag there) and execs; a failure before or in exec goes back as errno over the
 * third pipe, whose write end a successful exec closes. The parent closes the child's ends at once.
 */
#include "proc/proc.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void child_close(int *fd)
{
    if (*fd >= 0) close(*fd);
    *fd = -1;
}

static _Noreturn void run_child(int in, int out, int report, char *const argv[])
{
    setpgid(0, 0);
    signal(SIGPIPE, SIG_DFL);
    if (dup2(in, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0) execvp(argv[0], argv);
    int err = errno;
    (void)!write(report, &err, sizeof err);
    _exit(127);
}

static int open_pipes(int p[3][2])
{
    for (int i = 0; i < 3; i++) {
        if (pipe2(p[i], O_CLOEXEC) == 0) continue;
        int err = errno;
        while (i-- > 0) close(p[i][0]), close(p[i][1]);
        errno = err;
        return -1;
    }
    return 0;
}

int child_start(struct child *c, char *const argv[])
{
    int p[3][2], err = 0;
    *c = (struct child){0, -1, -1};
    if (open_pipes(p) != 0) return -1;
    c->pid = fork();
    if (c->pid == 0) run_child(p[0][0], p[1][1], p[2][1], argv);
    if (c->pid < 0) err = errno;
    close(p[0][0]), close(p[1][1]), close(p[2][1]);
    c->to = p[0][1];
    c->from = p[1][0];
    if (!err && read(p[2][0], &err, sizeof err) == sizeof err) waitpid(c->pid, NULL, 0);
    close(p[2][0]);
    if (!err && fcntl(c->to, F_SETFL, O_NONBLOCK) < 0) err = errno;
    if (!err) return 0;
    child_close(&c->to);
    child_close(&c->from);
    c->pid = 0;
    errno = err;
    return -1;
}

int child_end(struct child *c, int grace_ms)
{
    int status;
    child_close(&c->to);
    child_close(&c->from);
    if (c->pid <= 0) return -1;
    for (int64_t end = now_us() + grace_ms * 1000L; now_us() < end;) {
        if (waitpid(c->pid, &status, WNOHANG) == c->pid) {
            c->pid = 0;
            return status;
        }
        nanosleep(&(struct timespec){0, 500000}, NULL);
    }
    kill(-c->pid, SIGKILL);
    while (waitpid(c->pid, &status, 0) < 0 && errno == EINTR)
        ;
    c->pid = 0;
    return status;
}

const char *status_text(int status, char text[24])
{
    if (WIFSIGNALED(status)) snprintf(text, 24, "signal-%d", WTERMSIG(status));
    else snprintf(text, 24, "exit-%d", WEXITSTATUS(status));
    return text;
}

int cores_available(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    int n = CPU_COUNT(&set);
    return n > 0 ? n : 1;
}
