/*
 * command: runs one command and reads what it writes. A keeper stands between: it leads the process
 * group, reads the command's standard error, and ends the group, itself included, when the pipe
 * from this process ends.
 */
#include "crop/crop.h"
#include "os/os.h"
#include "proc/proc.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define TAIL_BYTES 4096 /* kept of standard error */
#define TAIL_LINES 8    /* shown */
#define LINE_BYTES 300  /* of each */

struct keeper {
    char *const *words;
    const struct crop_place *place;
    bool piped; /* standard output is the picture */
};

/* In the child: cropworker relays it. */
static void complain(const char *name)
{
    char shown[1024];
    int why = errno;
    text_shown(shown, sizeof shown, name);
    dprintf(STDERR_FILENO, "%s: %s\n", shown, strerror(why));
}

/* Goes to the place of the command. Returns what failed, with errno; or NULL. */
static const char *take_place(const struct crop_place *p)
{
    if (p->directory) {
        if (chdir(p->directory) != 0) return p->directory;
        unsetenv("PWD"); /* it names another directory, and Blender believes it */
    }
    if (!p->own) return NULL;
    const char *const own[] = {p->own, p->directory, NULL};
    if (setenv("TMPDIR", p->own, 1) != 0) return p->own;
    return crop_confine(own, crop_landlock()) == 0 ? NULL : "Landlock";
}

static _Noreturn void run_command(const struct keeper *k, int err)
{
    signals_restore();
    os_die_with_parent(SIGKILL);
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (null >= 0 && dup2(null, STDIN_FILENO) >= 0 && dup2(err, STDERR_FILENO) >= 0 &&
        (k->piped || dup2(null, STDOUT_FILENO) >= 0)) {
        const char *failed = take_place(k->place);
        if (failed) {
            complain(failed);
            _exit(126);
        }
        execvp(k->words[0], k->words);
        complain(k->words[0]);
    }
    _exit(127);
}

/* Reads standard error, and keeps the last bytes. */
static bool read_tail(int fd, struct buf *tail)
{
    ptrdiff_t n = read_some(fd, tail, TAIL_BYTES);
    if (buf_size(tail) > 2 * TAIL_BYTES) buf_consume(tail, buf_size(tail) - TAIL_BYTES);
    return n > 0;
}

/* Prints the last lines that are not empty. */
static void show_tail(const char *name, const struct buf *tail)
{
    const char *end = (const char *)buf_data(tail) + buf_size(tail), *p = end;
    int lines = 0;
    while (p > (const char *)buf_data(tail)) {
        if (p[-1] == '\n' && p < end && *p != '\n' && ++lines == TAIL_LINES) break;
        p--;
    }
    while (p < end) {
        const char *line = p, *nl = memchr(p, '\n', (size_t)(end - p));
        size_t n = (size_t)((nl ? nl : end) - line);
        p = nl ? nl + 1 : end;
        while (n && (line[n - 1] == '\r' || line[n - 1] == ' ')) n--;
        if (n) relay(name, line, n < LINE_BYTES ? n : LINE_BYTES);
    }
}

/* Waits for the command. The end of standard input ends all, and so does a signal. */
static int watch(pid_t pid, int err, const char *name)
{
    struct buf tail = {0};
    struct pollfd p[2] = {{STDIN_FILENO, 0, 0}, {err, POLLIN, 0}};
    int status = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        p[0].revents = p[1].revents = 0;
        if (signals_poll(p, 2, -1) < 0 && errno != EINTR) return 1;
        if (p[0].revents || signals_came()) kill(0, SIGKILL);
        if (p[1].revents && !read_tail(err, &tail)) p[1].fd = -1;
    }
    if (status == 0) return 0;
    fcntl(err, F_SETFL, O_NONBLOCK); /* another process of the group may hold it open */
    while (read_tail(err, &tail)) continue;
    show_tail(name, &tail);
    return status_code(status);
}

static int keep(void *ctx)
{
    const struct keeper *k = ctx;
    const char *slash = strrchr(k->words[0], '/');
    int err[2];
    os_rename("cropkeeper");
    signal(SIGALRM, SIG_DFL);
    signals_catch();
    if (os_pipe(err) != 0) return 126;
    pid_t pid = fork();
    if (pid < 0) return 126;
    if (pid == 0) run_command(k, err[1]);
    close(STDOUT_FILENO);
    close(err[1]);
    return watch(pid, err[0], slash ? slash + 1 : k->words[0]);
}

/* Waits for the keeper without closing its pipe. */
static int wait_for(struct child *c)
{
    siginfo_t info;
    while (waitid(P_PID, (id_t)c->pid, &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) continue;
    return child_end(c, 0);
}

/* Reads standard output until its end, or until the keeper has ended: a process in the background
 * may hold it open. Only the keeper can read its standard input, so that pipe fails then. Returns
 * whether that was possible. */
static bool read_output(const struct child *c, struct buf *to, size_t most)
{
    struct pollfd p[2] = {{c->from, POLLIN, 0}, {c->to, 0, 0}};
    bool ended = false;
    ptrdiff_t n = 1;
    while (n > 0 && buf_size(to) <= most) {
        int ready = poll(p, ended ? 1 : 2, ended ? 0 : -1);
        if (ready < 0 && errno == EINTR) continue;
        if (ready < 0) n = -1;
        else if (ready && p[0].revents) n = read_some(c->from, to, 1 << 18);
        else if (ended) break;
        else ended = true; /* what it wrote is in the pipe by now */
    }
    return n >= 0;
}

int crop_run(char *const words[], const struct crop_place *place, struct buf *out, size_t most,
    char err[CROP_ERR])
{
    struct keeper k = {words, place, out != NULL};
    struct child c;
    struct buf none = {0}, *to = out ? out : &none;
    signals_catch_stop(); /* for the command, too */
    if (child_fork(&c, keep, &k) != 0) return err_set(err, "fork: %s", strerror(errno)) - 1;
    bool good = read_output(&c, to, most);
    if (!good) err_set(err, "standard output of %s: %s", words[0], strerror(errno));
    else if (buf_size(to) > most) {
        err_set(err, "more than %zu bytes of output, expected a picture", most);
        good = false;
    }
    buf_free(&none);
    if (!good) {
        child_end(&c, 0);
        return -1;
    }
    int status = wait_for(&c);
    if (status == 0) return 0;
    char text[24];
    int code = status_code(status);
    if (code > 128 && code <= 128 + SIGRTMAX)
        err_set(err, "%s: ended by signal %d%s", words[0], code - 128,
            status_hint(status_text(status, text)));
    else err_set(err, "%s: exit status %d, expected 0", words[0], code);
    return code == 127 ? CROP_NOT_FOUND : -1;
}
