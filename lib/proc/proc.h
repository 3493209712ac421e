/*
 * proc: hosts and the commands that reach them, child processes connected by pipes, and queues of
 * bytes that never block their writer.
 *
 * Descriptors made here are close-on-exec. An inherited descriptor is never set non-blocking (that
 * would leak to whoever shares it). Where the standard output is a pipe it is opened once more,
 * which gives a description of its own that may be non-blocking; else the queue towards the reader
 * writes only after poll has said POLLOUT, and at most PIPE_BUF bytes, which are then taken. The
 * writing end of a pipe made here is nobody else's, and is non-blocking.
 */
#ifndef STORMRING_PROC_H
#define STORMRING_PROC_H

#include "base/base.h"

#include <sys/types.h>

/* ---- hosts: see stormring-hosts(5) ---- */

#define HOSTS_SLOTS_MAX 4096 /* of all hosts together */
#define HOST_NAME_MOST 255   /* bytes of a host's name */
#define HOSTS_ERR 512

struct host {
    char *name, *via, *bin; /* via, bin: NULL where nothing is said */
    int slots;
    double power; /* of a slot; 0: nobody said */
};
struct hosts {
    struct host *at;
    size_t n;
    int slots;    /* of all */
    bool no_file; /* of one name, which could have been meant for a file's */
};
/*
 * Where `arg` is an existing file, its hosts, a line each; else those of a comma list. Slots are
 * numbered from 0 in this order. A lone name with a suffix that files have, and networks have not,
 * is not taken for a host. False with text in err, which begins with the place.
 */
bool hosts_read(struct hosts *h, const char *arg, char err[HOSTS_ERR]);
/* This machine alone. */
void hosts_here(struct hosts *h, int slots);
void hosts_free(struct hosts *h);
/* This machine: its commands are run as they are. */
bool host_is_here(const struct host *h);
/*
 * What to run here so that `worker` (NULL-ended) runs on the host: `worker` itself, or the host's
 * via with the worker as a command for the shell there. NULL-ended, freed by host_argv_free.
 */
char **host_argv(const struct host *h, char *const worker[]);
void host_argv_free(char **argv);

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

/* ---- towards children: bytes in order, with long bodies shared between many queues ---- */

struct blob {
    struct buf bytes;
    int users; /* queues that still need it, and its maker */
};
/* Takes the bytes over and leaves an empty buffer; its maker is its first user. */
struct blob *blob_new(struct buf *bytes);
void blob_drop(struct blob *b); /* one user less; the last one frees it */

struct down_queue {
    struct buf bytes; /* append to it, between blobs */
    uint64_t written; /* of the bytes, not counting blobs */
    struct down_blob {
        struct blob *blob;
        uint64_t at; /* goes out when `written` reaches this */
        size_t sent;
    } * blobs;
    size_t n_blobs, first_blob;
    size_t blob_bytes; /* that are still to be written */
};
void down_append(struct down_queue *q, const void *p, size_t n);
void down_share(struct down_queue *q, struct blob *b); /* adds a user */
static inline size_t down_size(const struct down_queue *q)
{
    return buf_size(&q->bytes) + q->blob_bytes;
}
/* Blobs that are not written yet. */
static inline size_t down_blobs(const struct down_queue *q) { return q->n_blobs - q->first_blob; }
/* Writes what a non-blocking fd takes now. 0, or -1 with errno (EPIPE: the reader has gone). */
int down_write(struct down_queue *q, int fd);
void down_free(struct down_queue *q);

/* ---- towards the reader: whole records, control before pixels ---- */

struct up_queue {
    struct buf control, bulk;
    struct buf sizes; /* size_t each: lengths of the records in bulk */
    size_t left;      /* bytes of the bulk record that is being written */
    size_t marked;    /* bulk bytes that belong to ended records */
};
/* Append to q->bulk, then say that a record has ended there. */
void up_end_record(struct up_queue *q);
static inline size_t up_size(const struct up_queue *q)
{
    return buf_size(&q->control) + buf_size(&q->bulk);
}
/* One write of at most `most` bytes. 0, or -1 with errno; a full pipe is no error. */
int up_write(struct up_queue *q, int fd, size_t most);
void up_free(struct up_queue *q);
/*
 * Makes a pipe at standard output non-blocking without touching the description that others share.
 * Returns how many bytes may be written at a time: more than PIPE_BUF where it succeeded, and then
 * without asking poll first.
 */
size_t stdout_private(void);

#endif
