/*
 * pipe: reading and writing streams of records through pipes without ever blocking: queues of bytes
 * towards children, a queue of whole records towards the reader, and what every loop around them
 * does.
 *
 * An inherited descriptor is never set non-blocking (that would leak to whoever shares it). Where
 * the standard output is a pipe it is opened once more, which gives a description of its own that
 * may be non-blocking; else the queue towards the reader writes only after poll has said POLLOUT,
 * and at most PIPE_BUF bytes, which are then taken.
 */
#ifndef STORMRING_PIPE_H
#define STORMRING_PIPE_H

#include "proc/proc.h"
#include "wire/wire.h"

#include <poll.h>

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

/* ---- loops ---- */

#define UP_QUEUE_MOST (4 << 20)   /* bytes for the reader, then workers have to wait */
#define DOWN_QUEUE_MOST (1 << 20) /* bytes for one child, then the input has to wait */

/* fd with events, or a place that poll ignores. */
struct pollfd poll_entry(int fd, bool wanted, short events);
#define POLL_GONE (POLLERR | POLLHUP | POLLNVAL) /* of a writing end: nobody reads there any more */

/*
 * One read(2) of fd into d; at the end of the stream d is ended. 1, 0 at the end, or -1 with errno,
 * which ends it as well.
 */
int stream_read(struct decoder *d, int fd);

/* The standard output of a driver. */
struct outlet {
    struct up_queue queue;
    size_t most;     /* bytes a write may have */
    bool full;       /* it took less than it was given */
    bool gone;       /* its reader is, or writing fails, which has been said */
    bool greeted;    /* hello has been said */
    int64_t beat_us; /* when outlet_beat last did */
};
void outlet_open(struct outlet *o);
struct pollfd outlet_poll(const struct outlet *o);
/* What poll said of it. */
void outlet_polled(struct outlet *o, const struct pollfd *p);
/* What has just been queued goes out at once, where that cannot block. */
void outlet_push(struct outlet *o);
/*
 * After a read of the input: a body that is long on its way is life as well. Says `beat` now and
 * then, since nobody behind this process knows of it yet.
 */
void outlet_beat(struct outlet *o, const struct decoder *input);
/* A flush came: says `beat`, so that who asked hears something even where nothing was held back. */
void outlet_answer(struct outlet *o);
/* The rest goes to the reader, who may be slow; or until a signal comes. */
void outlet_drain(struct outlet *o);

/*
 * One read(2) of standard input; every record in it goes to take until that returns other than 0:
 * the status to end with at once, or STREAM_HOLD, after which nothing is to be read before
 * stream_take has gone on with what is there. Returns the status to end with, the reason having
 * been said, or 0. *open: more may come.
 */
#define STREAM_HOLD (-1)
typedef int stream_taker(void *ctx, const struct record *r);
int stream_input(struct decoder *d, bool *open, stream_taker *take, void *ctx);
/* The same without reading. */
int stream_take(struct decoder *d, stream_taker *take, void *ctx);
/* The frames of the input, and which state they are of. */
struct stream_state {
    struct frames frames;
    struct generations generations;
};
/* Takes a frame record. */
void stream_frame(struct stream_state *f, const struct record *r);
/* The frame of a task record whose pixels lie in it, and whose state is there; else says what is
 * wrong: NULL. */
const struct frame_size *stream_frame_of(const struct stream_state *f, const struct record *r);
/* Forwards r as one record of the bulk queue. */
void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra);

#endif
