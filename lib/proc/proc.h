/*
 * proc: child processes connected by pipes, and queues of bytes that never block their writer.
 *
 * Descriptors made here are close-on-exec. An inherited descriptor is never set non-blocking (that
 * would leak to whoever shares it): the queue towards the reader writes only after poll has said
 * POLLOUT, and at most PIPE_BUF bytes, which a pipe then takes. The writing end of a pipe made here
 * is nobody else's, and is non-blocking.
 */
#ifndef STORMRING_PROC_H
#define STORMRING_PROC_H

#include "base/base.h"

#include <sys/types.h>

struct child {
    pid_t pid;    /* its own process group's leader; 0: none, or reaped */
    int to, from; /* its standard input (non-blocking) and output, -1 once closed */
};

/*
 * Starts argv (found on PATH) in a process group of its own, default signal actions, stderr shared.
 * 0, or -1 with errno of what failed, execvp included.
 */
int child_start(struct child *c, char *const argv[]);
void child_close(int *fd); /* closes *fd unless -1, and makes it -1 */
/*
 * Closes both pipes, waits up to grace_ms, then kills the group, and reaps. Returns the wait
 * status, or -1 when there was no child.
 */
int child_end(struct child *c, int grace_ms);
/* "exit-3", "signal-9" for a wait status, into text[24]. */
const char *status_text(int status, char text[24]);
/* The number of processors this process may run on. */
int cores_available(void);

/* ---- towards children: bytes in order, with long bodies shared between many queues ----------- */

struct blob {
    struct buf bytes;
    int users; /* queues that still need it */
};
struct blob *blob_new(const void *p, size_t n);

struct down_queue {
    struct buf bytes;
    uint64_t written; /* of the bytes, not counting blobs */
    uint64_t queued;
    struct down_blob {
        struct blob *blob;
        uint64_t at; /* goes out when `written` reaches this */
        size_t sent;
    } * blobs;
    size_t n_blobs, first_blob;
};
void down_append(struct down_queue *q, const void *p, size_t n);
void down_share(struct down_queue *q, struct blob *b); /* adds a user */
static inline bool down_empty(const struct down_queue *q)
{
    return q->written == q->queued && q->first_blob == q->n_blobs;
}
/* Writes what a non-blocking fd takes now. 0, or -1 with errno (EPIPE: the reader has gone). */
int down_write(struct down_queue *q, int fd);
void down_free(struct down_queue *q);

/* ---- towards the reader: whole records, control before pixels -------------------------------- */

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
int up_write(struct up_queue *q, int fd);
void up_free(struct up_queue *q);

#endif
