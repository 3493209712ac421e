/*
 * pipe: streams of records through pipes, without blocking: queues of bytes towards children, a
 * queue of whole records towards the reader, and what all poll loops share.
 *
 * An inherited descriptor is never set non-blocking, because that affects all processes that share
 * it. If standard output is a pipe it is opened once more; the new description may be non-blocking.
 * If not, the queue towards the reader writes only after POLLOUT, and at most PIPE_BUF bytes, which
 * cannot block.
 */
#ifndef STORMRING_PIPE_H
#define STORMRING_PIPE_H

#include "proc/proc.h"
#include "wire/wire.h"

#include <poll.h>

/* ---- towards children: bytes in order; queues share long bodies ---- */

struct blob {
    struct buf bytes;
    struct buf packed; /* the same record, packed when a queue first wants it so */
    bool tried;        /* to pack it; that may gain nothing */
    struct buf kept;   /* likewise, with a hash for its body */
    bool hashed;       /* its body is, if it is long enough to be kept */
    char hash[SHA256_TEXT];
    int users; /* queues that still need it, and its maker until blob_drop */
};
/* Takes over the bytes, one record, and leaves an empty buffer. The maker is the first user. */
struct blob *blob_new(struct buf *bytes);
void blob_drop(struct blob *b); /* removes a user; the last one frees it */

struct down_queue {
    struct buf bytes; /* between blobs; append to it */
    bool packs;       /* its reader takes packed blobs */
    char *keeps;      /* owned: the bodies that its reader has (keep_list); NULL: none */
    uint64_t written; /* bytes written, without blobs */
    struct down_blob {
        struct blob *blob;
        const struct buf *form; /* which is being written; NULL: none yet */
        uint64_t at;            /* is written when `written` reaches this */
        size_t sent;
    } * blobs;
    size_t n_blobs, first_blob;
    size_t blob_bytes; /* bytes of blobs not yet written */
};
void down_append(struct down_queue *q, const void *p, size_t n);
/* The same at the head of a queue of which nothing was written. */
void down_begin(struct down_queue *q, const void *p, size_t n);
void down_share(struct down_queue *q, struct blob *b); /* adds a user */
static inline size_t down_size(const struct down_queue *q)
{
    return buf_size(&q->bytes) + q->blob_bytes;
}
/* Blobs not yet written. */
static inline size_t down_blobs(const struct down_queue *q) { return q->n_blobs - q->first_blob; }
/* Writes as much as a non-blocking fd takes. 0, or -1 with errno (EPIPE: the reader is gone). */
int down_write(struct down_queue *q, int fd);
void down_free(struct down_queue *q);

/* ---- towards the reader: whole records, control before pixels ---- */

struct up_queue {
    struct buf control, bulk;
    struct buf sizes; /* size_t each: lengths of the records in `bulk` */
    size_t left;      /* unwritten bytes of the bulk record under way */
    size_t marked;    /* bytes of ended records in `bulk` */
    bool packs;       /* the reader takes packed frags */
};
/* Ends a record: call it after appending one to q->bulk. Packs it if the reader takes that. */
void up_end_record(struct up_queue *q);
static inline size_t up_size(const struct up_queue *q)
{
    return buf_size(&q->control) + buf_size(&q->bulk);
}
/* One write of at most `most` bytes. 0, or -1 with errno; a full pipe is no error. */
int up_write(struct up_queue *q, int fd, size_t most);
void up_free(struct up_queue *q);
/*
 * Makes a pipe at standard output non-blocking without changing the description that other
 * processes share. Returns the largest size of a write. If that is more than PIPE_BUF it succeeded,
 * and writes need no poll.
 */
size_t stdout_private(void);

/* ---- silence.c: the program at the other end of standard input may be cut off ---- */

/*
 * Takes a record of standard input if it is an `alive` or a `beat`; else returns false. From an
 * `alive` on, the process ends with ST_SYSTEM, at once and whatever it does, if nothing has come on
 * standard input for the time that the record states. The sender writes beats more often than that.
 * Children that proc started end with the process.
 */
bool silence_take(const struct record *r);
/* Something was read from standard input. */
void silence_heard(void);
/* Standard input has ended, or this is another process: its silence means nothing. */
void silence_forget(void);

/* ---- room.c: whether long state fits in memory ---- */

#define STREAM_LONG (1 << 20) /* bytes; a shorter state always fits */
/* Call after a read. Kind and length of a long state record whose head is here, and little more:
 * it is time to decide whether to wire_drop it. REC_KINDS: none is. */
enum rec_kind stream_arrives(struct decoder *d, size_t *bytes);
/* The addresses that a record's buffer takes. */
double stream_buffer(size_t bytes);
/* True if this process may take that much more; else err says what is needed. */
bool stream_fits(double memory, double addresses, char err[ERR_BYTES]);

/* ---- loops ---- */

#define UP_QUEUE_MOST (4 << 20)   /* bytes for the reader; then workers wait */
#define DOWN_QUEUE_MOST (1 << 20) /* bytes for one child; then the input waits */

/* An entry for fd and events; or one that poll ignores. */
struct pollfd pipe_poll_entry(int fd, bool wanted, short events);
#define POLL_GONE (POLLERR | POLLHUP | POLLNVAL) /* writing end: no reader left */

/*
 * One read(2) of fd into d. 1; 0 at the end of the stream, or -1 with errno; both end d.
 */
int stream_read(struct decoder *d, int fd);

/* Standard output of a driver. */
struct outlet {
    struct up_queue queue;
    size_t most;     /* the largest size of a write */
    bool full;       /* the pipe is full */
    bool gone;       /* the reader is gone, or writing failed (reported) */
    bool greeted;    /* hello has been queued */
    int64_t beat_us; /* time of the last beat of outlet_beat */
};
void outlet_open(struct outlet *o);
struct pollfd outlet_poll(const struct outlet *o);
/* Takes the result of poll; writes if it can. */
void outlet_polled(struct outlet *o, const struct pollfd *p);
/* Writes queued records at once, if that cannot block. */
void outlet_push(struct outlet *o);
/* Queues a `beat` if the last one was a while ago. */
void outlet_beat(struct outlet *o);
/* The same after a read of the input while a long body arrives, because no process behind this one
 * can know of it yet. */
void outlet_beat_within(struct outlet *o, const struct decoder *input);
/* Answers a flush with a `beat`, so that the sender gets an answer even if nothing was held
 * back. */
void outlet_answer(struct outlet *o);
/* The decoder of standard input: bodies may be packed, or be those that this host has kept. A body
 * that should be here and is not ends the process with ST_SYSTEM, so that it is sent next time. */
bool stream_kept(const char *sha256, size_t n, struct buf *to);
#define STREAM_INPUT ((struct decoder){.coded = true, .kept = stream_kept})
/* Call for each record of the input: keeps state that has come from another machine. */
void stream_keep(const struct record *r);
/* Obeys a code record of the input: appends the answer to a probe to `to`, with the names of what
 * this host has kept, or sets *packs, because the reader wants packed pixels from now on. A probe
 * comes from another machine. */
void stream_code(const struct record *r, struct buf *to, bool *packs);
void outlet_code(struct outlet *o, const struct record *r);
/* Writes the rest, waiting for the reader; a signal ends it. */
void outlet_drain(struct outlet *o);

/*
 * One read(2) of standard input. Calls `take` for each record that silence_take does not take,
 * until it returns non-zero: the status to end with at once, or STREAM_HOLD. After STREAM_HOLD do
 * not read before stream_take has handled the buffered rest. Returns 0, or the status to end with
 * after printing the reason. *open: more may come.
 */
#define STREAM_HOLD (-1)
typedef int stream_taker(void *ctx, const struct record *r);
int stream_input(struct decoder *d, bool *open, stream_taker *take, void *ctx);
/* The same without reading: for the buffered rest. */
int stream_take(struct decoder *d, stream_taker *take, void *ctx);
/* The frames of the input and their generations. Frames have a payload if the owner calls
 * frames_init before the first one. */
struct stream_state {
    struct frames frames;
    struct generations generations;
};
/* Adds a frame record. The result is valid until the next frame. */
struct frame_size *stream_frame(struct stream_state *f, const struct record *r);
/* The frame of a task record if its pixels lie inside and its state is alive; else prints the
 * error and returns NULL. */
const struct frame_size *stream_frame_of(const struct stream_state *f, const struct record *r);
/* Queues r as one bulk record; drop and extra as in wire_forward. */
void up_forward(
    struct up_queue *q, const struct record *r, const char *const *drop, const char *extra);

#endif
