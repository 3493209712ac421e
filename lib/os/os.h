/*
 * os: what systems have beyond POSIX.1-2008. linux.c has Linux's way, and posix.c has a way of
 * POSIX, which `make POSIX=1` takes instead. Both may do less on an older system; then each
 * function says what its caller gets. os.c has short forms of POSIX.
 *
 * Functions that can fail return -1 with errno, unless stated otherwise.
 */
#ifndef STORMRING_OS_H
#define STORMRING_OS_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

/* ---- processes ---- */

/* From now on this signal comes when the parent of this process ends; 0: none. posix.c: none ever
 * comes. Then the end of its standard input tells a process that its parent has ended. */
void os_die_with_parent(int sig);
/* That signal; 0: none. */
int os_dies_with_parent(void);
/* Closes all descriptors above standard error. */
void os_close_others(void);
/* The number of processors that this process may run on. posix.c: of all that are online. */
int os_processors(void);
/* Shows this process under another name of at most 10 bytes. posix.c: the name stays. */
void os_rename(const char *name);
/* Sleeps end on time. posix.c: as late as usual. */
void os_sleep_exactly(void);

/* ---- signals ---- */

struct pollfd;
/* poll(2), with this mask of signals while it waits; NULL: with the usual one. A signal that only
 * this mask lets through ends it with EINTR, also if that came before. The handlers of such signals
 * must block all others, and end with os_poll_end. */
int os_poll(struct pollfd *p, size_t n, int timeout_ms, const sigset_t *mask);
void os_poll_end(void);
/* Gives the handlers of signals this stack, NULL: the usual one again. Returns the flags that these
 * need in their struct sigaction. posix.c: they have the usual one, and it returns 0. */
int os_signal_stack(void *stack, size_t bytes);

/* ---- files ---- */

/* pipe(2) and mkstemp(3), close-on-exec. */
int os_pipe(int ends[2]);
int os_temporary(char *name);
/* Locks a file that is open for writing, until it is closed; EWOULDBLOCK: another process has the
 * lock. posix.c: the lock ends when this process closes any descriptor of the file. */
int os_lock(int fd);
/* True if another process has the lock. */
bool os_locked(int fd);
/* The bytes that can be read from a pipe. posix.c: always -1. */
int os_unread(int fd);
/* The size of a terminal. False: unknown, as always in posix.c. */
bool os_terminal(int fd, int *columns, int *rows);

/* ---- memory ---- */

/* Asks the system for all pages of these bytes at once, which costs less than a fault for each. For
 * memory that will be written soon. posix.c: the faults come. */
void os_populate(void *p, size_t bytes);
/* Asks for large pages: fewer misses of the TLB, and less to copy in a fork. posix.c: they stay
 * small. */
void os_large_pages(void *p, size_t bytes);
/* Returns the whole pages within these bytes to the system. Their contents are lost. posix.c: the
 * pages stay. */
void os_discard(void *p, size_t bytes);
/* Memory of this many bytes, and more, is new from the system each time that it is allocated. Other
 * C libraries than GNU's do as they do. */
void os_allocate_afresh(size_t bytes);

/* ---- options ---- */

/* getopt(3), with --help for -h, and OS_VERSION for --version. A `+` in front of the letters: no
 * option follows an operand. posix.c: always so. */
#define OS_VERSION 256
int os_getopt(int argc, char **argv, const char *letters);

#endif
