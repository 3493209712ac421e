/*
 * proc: child processes connected by pipes, and signals.
 *
 * Descriptors made here are close-on-exec. The writing end of a pipe made here is not shared, and
 * is non-blocking.
 */
#ifndef STORMRING_PROC_H
#define STORMRING_PROC_H

#include "base/base.h"

#include <sys/types.h>

/* ---- children ---- */

struct child {
    pid_t pid;    /* its own process group's leader; 0: none, or reaped */
    int to, from; /* its standard input (non-blocking) and output, -1 once closed */
    int err;      /* its standard error (non-blocking), -1 where it shares this process's */
};
#define CHILD_NONE ((struct child){0, -1, -1, -1})

/*
 * Starts argv (found on PATH) in a process group of its own, stderr shared, SIGPIPE at its default;
 * it is killed when this process dies, however that comes about. 0, or -1 with errno of what
 * failed, execvp included.
 */
int child_start(struct child *c, char *const argv[]);
/* The same, with standard error through a pipe of its own. */
int child_start_apart(struct child *c, char *const argv[]);
void child_close(int *fd); /* closes *fd unless -1, and makes it -1 */
/*
 * Has the child ended? Then what is left of its group is killed, it is reaped, and *status is its
 * wait status, or -1 when there was no child. `to` and `from` are closed in any case; what it wrote
 * last may still be in `err`. Does not wait.
 */
bool child_ended(struct child *c, int *status);
/* Asks the child's group to end, so that it can end what it has started itself; does not wait. */
void child_stop(struct child *c);
/*
 * Closes all pipes, waits up to grace_ms, then kills the group, and reaps. Returns the wait
 * status, or -1 when there was no child.
 */
int child_end(struct child *c, int grace_ms);
/* "exit-3", "signal-9" for a wait status, into text[24]. */
const char *status_text(int status, char text[24]);
/* The number of processors this process may run on. */
int cores_available(void);
/* Asks the system for room for so many descriptors. */
void want_descriptors(int n);

/* ---- signals: they come only while this process waits in poll_signals ---- */

/*
 * From now on SIGINT, SIGTERM and SIGHUP, where they are not ignored, end nothing by themselves;
 * SIGPIPE is ignored. Children are started without any of this.
 */
void signals_catch(void);
struct pollfd;
/* poll(2); the end of a child, and the signals above, cut it short as EINTR. */
int poll_signals(struct pollfd *p, size_t n, int timeout_ms);
/* What a child undoes before exec. */
void signals_restore(void);
/* One of the above has come. */
bool signals_came(void);
/* Ends this process by the signal that came: what started it sees what it expects. */
_Noreturn void signals_die(void);

#endif
