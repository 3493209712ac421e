/* Linux's way: see os.h. */
#include "os/os.h"

#include <errno.h>
#include <getopt.h>
#include <malloc.h>
#include <poll.h>
#include <sched.h>
#include <stdint.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Newer than the oldest headers. */
#ifndef SYS_close_range
#define SYS_close_range 436
#endif
#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23
#endif

/* ---- processes ---- */

void os_die_with_parent(int sig) { prctl(PR_SET_PDEATHSIG, sig); }

int os_dies_with_parent(void)
{
    int sig = 0;
    return prctl(PR_GET_PDEATHSIG, &sig) == 0 ? sig : 0;
}

/* Before 5.9 they are closed one by one. */
void os_close_others(void)
{
    if (syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, 0) == 0) return;
    for (int fd = (int)sysconf(_SC_OPEN_MAX); fd-- > STDERR_FILENO + 1;) close(fd);
}

/* A set is too small for a machine of more processors: EINVAL. */
int os_processors(void)
{
    for (int most = CPU_SETSIZE; most <= 1 << 20; most *= 4) {
        cpu_set_t *set = CPU_ALLOC((size_t)most);
        const size_t size = CPU_ALLOC_SIZE((size_t)most);
        int n = -1;
        if (set && sched_getaffinity(0, size, set) == 0) n = CPU_COUNT_S(size, set);
        const bool small = set && n < 0 && errno == EINVAL;
        CPU_FREE(set);
        if (!small) return n > 0 ? n : 1;
    }
    return 1;
}

void os_rename(const char *name)
{
    prctl(PR_SET_NAME, name);
    /* The first word of the command line, which cannot become longer. */
    char *word = program_invocation_name;
    const size_t room = word ? strlen(word) : 0, n = strlen(name);
    for (size_t i = 0; i < room; i++) word[i] = i < n ? name[i] : '\0';
}

/* In nanoseconds. */
void os_sleep_exactly(void) { prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); }

/* ---- signals ---- */

int os_poll(struct pollfd *p, size_t n, int timeout_ms, const sigset_t *mask)
{
    struct timespec t = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
    return ppoll(p, (nfds_t)n, timeout_ms < 0 ? NULL : &t, mask);
}

void os_poll_end(void) {}

int os_signal_stack(void *stack, size_t bytes)
{
    const stack_t to = {.ss_sp = stack, .ss_size = bytes, .ss_flags = stack ? 0 : SS_DISABLE};
    return sigaltstack(&to, NULL) == 0 && stack ? SA_ONSTACK : 0;
}

/* ---- files ---- */

int os_lock(int fd) { return flock(fd, LOCK_EX | LOCK_NB); }

bool os_locked(int fd)
{
    if (flock(fd, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
    flock(fd, LOCK_UN);
    return false;
}

int os_unread(int fd)
{
    int bytes;
    return ioctl(fd, FIONREAD, &bytes) == 0 ? bytes : -1;
}

bool os_terminal(int fd, int *columns, int *rows)
{
    struct winsize size;
    if (ioctl(fd, TIOCGWINSZ, &size) != 0) return false;
    *columns = size.ws_col;
    *rows = size.ws_row;
    return true;
}

/* ---- memory ---- */

void os_populate(void *p, size_t bytes)
{
    size_t before = (uintptr_t)p % (uintptr_t)sysconf(_SC_PAGESIZE);
    if (bytes) madvise((char *)p - before, before + bytes, MADV_POPULATE_WRITE);
}

void os_large_pages(void *p, size_t bytes)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE), before = -(uintptr_t)p % page;
    if (bytes > before) madvise((char *)p + before, bytes - before, MADV_HUGEPAGE);
}

void os_discard(void *p, size_t bytes)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE), before = -(uintptr_t)p % page;
    if (bytes < before + page) return;
    madvise((char *)p + before, (bytes - before) & ~(page - 1), MADV_DONTNEED);
}

void os_allocate_afresh(size_t bytes)
{
#ifdef M_MMAP_THRESHOLD
    mallopt(M_MMAP_THRESHOLD, (int)bytes);
#else
    (void)bytes;
#endif
}

/* ---- options ---- */

int os_getopt(int argc, char **argv, const char *letters)
{
    static const struct option words[] = {
        {"help", no_argument, NULL, 'h'}, {"version", no_argument, NULL, OS_VERSION}, {0}};
    return getopt_long(argc, argv, letters, words, NULL);
}
