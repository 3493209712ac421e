/* A way of POSIX.1-2008: see os.h. */
#include "os/os.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <string.h>
#include <unistd.h>

/* ---- processes ---- */

void os_die_with_parent(int sig) { (void)sig; }
int os_dies_with_parent(void) { return 0; }

void os_close_others(void)
{
    for (int fd = (int)sysconf(_SC_OPEN_MAX); fd-- > STDERR_FILENO + 1;) close(fd);
}

/* Every system has this name, which POSIX has since 2024. */
int os_processors(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n > 0 ? (int)n : 1;
}

void os_rename(const char *name) { (void)name; }
void os_sleep_exactly(void) {}

/* ---- signals ---- */

static sigjmp_buf before_waiting;
static volatile sig_atomic_t waiting;

/*
 * A signal that comes between the change of the mask and poll would not end that, so each handler
 * goes back to before both. What poll has found by then, it finds again.
 */
int os_poll(struct pollfd *p, size_t n, int timeout_ms, const sigset_t *mask)
{
    sigset_t was;
    if (!mask) return poll(p, (nfds_t)n, timeout_ms);
    sigprocmask(SIG_SETMASK, NULL, &was);
    if (sigsetjmp(before_waiting, 1) != 0) {
        waiting = 0;
        errno = EINTR;
        return -1;
    }
    waiting = 1;
    sigprocmask(SIG_SETMASK, mask, NULL);
    int ready = poll(p, (nfds_t)n, timeout_ms), err = errno;
    sigprocmask(SIG_SETMASK, &was, NULL);
    waiting = 0;
    errno = err;
    return ready;
}

void os_poll_end(void)
{
    if (waiting) siglongjmp(before_waiting, 1);
}

int os_signal_stack(void *stack, size_t bytes)
{
    (void)stack, (void)bytes;
    return 0;
}

/* ---- files ---- */

int os_lock(int fd)
{
    struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(fd, F_SETLK, &all) == 0) return 0;
    if (errno == EACCES || errno == EAGAIN) errno = EWOULDBLOCK;
    return -1;
}

bool os_locked(int fd)
{
    struct flock all = {.l_type = F_RDLCK, .l_whence = SEEK_SET};
    return fcntl(fd, F_GETLK, &all) == 0 && all.l_type != F_UNLCK;
}

int os_unread(int fd)
{
    (void)fd;
    return -1;
}

bool os_terminal(int fd, int *columns, int *rows)
{
    (void)fd;
    *columns = *rows = 0;
    return false;
}

/* ---- memory ---- */

void os_populate(void *p, size_t bytes) { (void)p, (void)bytes; }
void os_large_pages(void *p, size_t bytes) { (void)p, (void)bytes; }
void os_discard(void *p, size_t bytes) { (void)p, (void)bytes; }
void os_allocate_afresh(size_t bytes) { (void)bytes; }

/* ---- options ---- */

int os_getopt(int argc, char **argv, const char *letters)
{
    const char *word = optind < argc ? argv[optind] : "";
    const bool help = strcmp(word, "--help") == 0, version = strcmp(word, "--version") == 0;
    if (!help && !version) return getopt(argc, argv, letters + (*letters == '+'));
    optind++;
    return help ? 'h' : OS_VERSION;
}
