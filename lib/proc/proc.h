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
    pid_t pid;    /* leader of its own process group; 0: none, or reaped */
    int to, from; /* its standard input (non-blocking) and output, -1 once closed */
    int err;      /* its standard error (non-blocking); -1 if it shares this process's */
};
#define CHILD_NONE ((struct child){0, -1, -1, -1})

/*
 * Starts argv (found on PATH) in its own process group, with shared stderr and default SIGPIPE. It
 * is killed when this process dies in any way. 0, or -1 with errno of the failed call, execvp
 * included. End it with child_ended or child_end.
 */
int child_start(struct child *c, char *const argv[]);
/* The same, with standard error through a pipe of its own, for work on another machine: it is not
 * stopped with this process (signals_catch). */
int child_start_apart(struct child *c, char *const argv[]);
/*
 * The same, but the child is a fork of this process that runs the function, whose result is its
 * exit status. It has no other descriptors than 0, 1 and 2. This process must have one thread only.
 */
int child_fork(struct child *c, int (*function)(void *ctx), void *ctx);
void child_close(int *fd); /* closes *fd unless -1, and makes it -1 */
/*
 * Has the child ended? If so, kills the rest of its group, reaps it, and sets *status to its wait
 * status; -1 if there was no child. Closes `to` and `from` in any case; `err` may still hold its
 * last output. Does not wait.
 */
bool child_ended(struct child *c, int *status);
/* Sends SIGTERM to the child's group, so that it can end its own children. Does not wait. */
void child_stop(struct child *c);
/*
 * Closes all pipes, waits up to grace_ms, then kills the group, and reaps. Returns the wait status,
 * or -1 if there was no child.
 */
int child_end(struct child *c, int grace_ms);
/*
 * Runs argv to its end, as a shell does: in this process's group, with its descriptors, and with
 * standard input and error from these; err -1: that goes where the output goes. Appends what it
 * prints to `said`. Returns the exit status, 127 if it cannot be run, or 128 and the number of the
 * signal that ended it; -1 with errno if there can be no process.
 */
int child_run(char *const argv[], int in, int err, struct buf *said);
/* The exit status of a wait status, by which a shell states a signal as 128 and its number. */
int status_code(int status);
/* "exit-3", "signal-9" for a wait status, into text[24]. 137, the status of a shell whose command
 * was ended by signal 9, is that signal; launchers choose other numbers above 128 themselves. */
const char *status_text(int status, char text[24]);
/* What a message adds to such a text: of signal 9 that the kernel sends it when memory is short;
 * else "". It begins with "; ". */
const char *status_hint(const char *text);
/* Raises the limit of open descriptors to n if the system allows it. Returns it, at most n. */
int want_descriptors(int n);

/* ---- what the system allows this process (limits.c) ---- */

/* The number of processors that this process may use: those of its set, and no more than its quota,
 * rounded up. At least 1. */
int cores_available(void);
/*
 * The functions below read files of /proc and /sys below the directory `root`, "" for those of the
 * system. A file that is missing, or has other text than expected, limits nothing.
 *
 * The processors that this process's control groups allow it, of version 1, 2 or both, and the
 * groups around them: such as .25; INFINITY: no quota.
 */
double proc_quota(const char *root);
/* What this process may still take. INFINITY: no limit. */
struct proc_memory {
    double bytes;     /* of memory: by its control groups, and by what the machine has, with swap */
    double addresses; /* by RLIMIT_AS */
};
struct proc_memory proc_memory(const char *root);

/* ---- signals: delivered only while this process waits in signals_poll ---- */

/*
 * From now on SIGINT, SIGTERM and SIGHUP, unless ignored, only set signals_came. SIGPIPE is
 * ignored. SIGTSTP, unless ignored, stops children too, because they are in other process groups
 * than the terminal's; the SIGCONT that continues this process continues them. The clock forgets
 * the time between. Children start without these changes.
 */
void signals_catch(void);
/* Only that of SIGTSTP, at any time: for a process with one thread that does not call
 * signals_poll. */
void signals_catch_stop(void);
struct pollfd;
/* poll(2). The end of a child, or one of the signals above, ends it with EINTR. */
int signals_poll(struct pollfd *p, size_t n, int timeout_ms);
/* In the place of signals_catch: one of the signals above prints `text` on stderr before it ends
 * this process, if this file exists then. Both must stay. */
void signals_say(const char *text, const char *file);
/* Undoes signals_catch in a child. */
void signals_restore(void);
/* True if one of the signals has come. */
bool signals_came(void);
/* Ends this process by the signal that came, so that its parent sees the usual status. */
_Noreturn void signals_die(void);

#endif
