/*
 * wire: the records between programs, encoded and decoded in memory. stormring-task(5) and
 * stormring-frag(5) have the grammar; the labels below are theirs. Only wire_read does I/O.
 *
 * A record is one line of text and, if the line says bytes=N, N raw bytes and a newline. The
 * decoder is fed bytes as they come; "need more" is a normal answer. After a bad record it looks
 * for the next good one from each following byte on, so a torn record costs only itself.
 */
#ifndef STORMRING_WIRE_H
#define STORMRING_WIRE_H

#include "base/base.h"
#include "task/task.h"

#define WIRE_FORMAT 4                      /* of fragment streams, as in hello */
#define WIRE_LINE_MAX 1024                 /* bytes, newline included */
#define WIRE_SEAL_BYTES 13                 /* " sum=89abcdef", the last word of a sealed line */
#define WIRE_FRAG_PIXELS_MAX 65536         /* longer tasks come in several frags */
#define WIRE_STATE_MAX INT64_C(0x7fffffff) /* bytes of a record of state */
#define WIRE_STATE_KINDS 5                 /* scene, grid, spec, view, files */
#define WIRE_SLOTS_MAX (1 << 20)           /* slots that one stream may name */
#define WIRE_TAKES_MOST 1000000            /* percent, in an ask */
#define WIRE_WITHIN_LEAST .5               /* seconds of silence that alive may allow, */
#define WIRE_WITHIN_MOST 1e8               /* to this */
#define WIRE_JOB 33                        /* bytes of a job with NUL: 32 hexadecimal digits */
#define WIRE_WHY 160                       /* bytes of a message for people */
#define WIRE_SAID 160                      /* likewise, in a record */
#define WIRE_PIXEL_BYTES 16                /* RGBA float32, linear, premultiplied, little-endian */

enum rec_kind {
    REC_FRAME,
    REC_SCENE,
    REC_GRID,
    REC_SPEC,
    REC_VIEW,
    REC_FILES,
    REC_TASK,
    REC_FLUSH, /* down */
    REC_HELLO,
    REC_FRAG,
    REC_DONE,
    REC_FAIL,
    REC_BEAT,
    REC_BYE,
    REC_UP,
    REC_GONE, /* up (and frame) */
    REC_CODE, /* either way, between a fan and a worker on another machine */
    REC_RING,
    REC_HEIR, /* down, to a node of a ring */
    REC_ASK,
    REC_NONE, /* either way, between a node and the hub */
    REC_GIVE,
    REC_CRASHED, /* up, from a node */
    REC_JOINS,
    REC_LEAVE, /* down, from a policy to its fan */
    REC_DRAIN, /* up, from a fan to its policy */
    REC_ALIVE, /* down, from a fan to a worker on another machine */
    REC_KINDS
};

/* The name of the record on the wire. */
const char *rec_name(enum rec_kind kind);

/* Pointers are into the decoder's buffer, valid until the next wire_next or wire_feed. */
struct record {
    enum rec_kind kind;
    const char *line; /* not terminated, without its newline */
    size_t line_len;
    const unsigned char *body; /* bytes=N of them, without the newline after them; NULL: dropped */
    size_t body_len;
    bool has_body;
    size_t wire_len; /* bytes that the body had on the wire: fewer if it was packed */
    struct task
        task; /* task, frag: all; done, failed, give: the key; frame: .frame; to=K, else -1 */
    uint32_t frame_w, frame_h; /* frame */
};

/* Appends the n bytes with this hash, or returns false. The hash is text of any kind. */
typedef bool wire_kept(const char *sha256, size_t n, struct buf *to);
/* True if such a body of n bytes may be read. False: the record comes out without it. */
typedef bool wire_room(void *ctx, size_t n);

/* All zero, except `upward`, at the beginning of a stream. */
struct decoder {
    struct buf in;
    bool upward;      /* reads from workers, which are not trusted: state records are bad there, */
                      /* so the decoder never waits for more than a frag */
    bool coded;       /* the sender may pack bodies: records come out as they were before */
    wire_kept *kept;  /* finds bodies of state that are not sent: wire_keep; NULL: all are sent */
    wire_room *room;  /* asked before `kept`; NULL: all are read */
    void *room_ctx;   /* its argument */
    bool unsummed;    /* does not check bodies: call wire_crc and wire_light */
    bool ended;       /* no more bytes will be fed */
    bool lost;        /* looking for the next good record */
    uint64_t bad;     /* records lost so far; adjacent losses count as one */
    uint64_t skipped; /* bytes lost so far; records and these are all bytes fed */
    char why[WIRE_WHY]; /* the error in the last bad record, and what was expected */
    size_t consumed;    /* bytes of the last record, dropped at the next call */
    uint64_t checked;   /* bytes whose crc did not match */
    size_t span;        /* bytes of a whole record */
    size_t extent;      /* length of a bad record, if it is certain */
    struct buf plain;   /* a packed record, unpacked */
    bool drops;         /* the body of the record in front is dropped: */
    size_t dropped;     /* bytes so far */
};

enum wire_result {
    WIRE_MORE,   /* feed more bytes; after wire_end: the end */
    WIRE_RECORD, /* *r is valid; its sum, crc and pixels were checked */
    WIRE_BAD     /* a loss; see why. The next call resynchronises */
};

void wire_feed(struct decoder *d, const void *p, size_t n);
/*
 * A decoder of a whole stream in memory. It copies nothing: records point into p, which must stay
 * valid. Do not feed or free it.
 */
struct decoder wire_over(unsigned char *p, size_t n);
void wire_end(struct decoder *d);
enum wire_result wire_next(struct decoder *d, struct record *r);
void wire_free(struct decoder *d);
/*
 * Reads fd, a stream that goes down and must have no bad record, to its end; `take` gets each
 * record. Blocks as fd does. Returns 0; 1 at the first bad record, with the error in why; or -1
 * with errno.
 */
typedef void wire_taker(void *ctx, const struct record *r);
int wire_read(int fd, wire_taker *take, void *ctx, char why[WIRE_WHY]);
/* The body of r, which d has returned last, for modification. */
unsigned char *wire_body(struct decoder *d, const struct record *r);
/* After WIRE_MORE: kind and length of the state record whose body is arriving; REC_KINDS: none. */
enum rec_kind wire_awaited(struct decoder *d, size_t *bytes);
/* After wire_awaited has returned a kind: the body is dropped as it comes, unchecked, so that it
 * takes no memory. The record comes out in its place, without it. */
static inline void wire_drop(struct decoder *d) { d->drops = true; }

/*
 * A stream may change its state. A frame belongs to the state before it in the stream; a frame
 * before all state belongs to the first. Generations number these states. A state record begins the
 * next generation if a frame came since the last one began; it replaces the record of its kind.
 * Each reader in a chain of programs counts like this, although not from the same number. All zero
 * at first.
 *
 * Tasks may come, or come again, for the latest two generations, and for up to GENERATIONS while
 * all of their state is at most STATE_BYTES. So small frames do not wait for each other's round
 * trips. A task given again may follow later state in the stream than the policy has seen. So
 * programs that only keep state keep twice as much.
 */
#define STATE_BYTES (4 << 20) /* limit of all state of more than two generations */
struct generations {
    uint32_t now, oldest; /* the latest; the first that may have tasks */
    bool keeps;           /* this program only keeps state, and keeps twice as much */
    bool framed;          /* a frame came */
    bool has[WIRE_STATE_KINDS];
    struct {
        uint32_t since[WIRE_STATE_KINDS]; /* the generation that the record came in */
        size_t bytes[WIRE_STATE_KINDS];
    } at[GENERATIONS]; /* by generation, modulo GENERATIONS */
};
/* True if a state record of this kind would begin a new generation. */
bool generation_ends(const struct generations *g, enum rec_kind kind);
/* Counts a state record of this length; or a frame, which gets generation g->now. */
void generation_state(struct generations *g, enum rec_kind kind, size_t bytes);
void generation_frame(struct generations *g, struct frame_size *f);
/* The value that g->oldest would have after such a record. */
uint32_t generation_oldest(const struct generations *g, enum rec_kind kind, size_t bytes);
/* True if tasks of f may come. */
static inline bool generation_lives(const struct generations *g, const struct frame_size *f)
{
    return g->now - f->generation <= g->now - g->oldest;
}

/* The value of KEY=VALUE in r's line (not terminated), or NULL. */
const char *rec_key(const struct record *r, const char *key, size_t *len);
bool rec_int(const struct record *r, const char *key, int64_t min, int64_t max, int64_t *out);
bool rec_real(const struct record *r, const char *key, double min, double max, double *out);
/* Copies the value into out[size]; false if it is absent or too long. */
bool rec_str(const struct record *r, const char *key, char *out, size_t size);
/* The words of `said=`, with NUL; "" if there are none. They are from another machine. */
void rec_said(const struct record *r, char said[WIRE_SAID]);
/* The slot of the outermost fan that stamped r: 2 if w is "2.1". -1: none. */
int32_t rec_slot(const struct record *r);
/* The keys of a ring record; -1 or false if absent. */
struct rec_ring {
    int32_t peer, next, me, n;
    int32_t takes; /* 0: absent */
    bool idle, published;
};
/* False if r is no ring record, or lacks a key, or has one out of range. A decoder returns no
 * such record. */
bool rec_ring(const struct record *r, struct rec_ring *m);
/* Bytes of the whole record in a stream, with all its newlines. */
size_t rec_size(const struct record *r);
/* True if r has KEY=VALUE. */
bool rec_is(const struct record *r, const char *key, const char *value);
/* True if the line ends in its sum. A decoder has checked that sum. */
bool rec_sealed(const struct record *r);
/* True unless r is the hello of a stream of another format; then why names the format. */
bool rec_ours(const struct record *r, char why[WIRE_WHY]);
/* The pixels of a frag, host byte order, 4 floats each, lattice order. */
void rec_pixels(const struct record *r, float *rgba);
/* n pixels of a frag's body. */
void wire_pixels(const unsigned char *body, size_t n, float *rgba);

/* CRC-32 of a body or a line. */
uint32_t wire_crc(const void *p, size_t n);
/* True if all values of a frag's body are finite and >= 0, and alpha is at most 1. */
bool wire_light(const unsigned char *body, size_t n);

/*
 * Packed records (pack.c): only a decoder with `coded` takes them. wire_pack appends the packed
 * form of r; false, and nothing is appended, if it would not be shorter. wire_pack_last packs
 * in place the last record of b, which begins at unread byte `at`, if it is a frag.
 */
bool wire_pack(struct buf *to, const struct record *r);
void wire_pack_last(struct buf *b, size_t at);
/* Appends a code record with n bytes that cannot be packed: the answer to a probe. */
#define WIRE_PROBE_MAX (1 << 20)
void wire_probe(struct buf *b, size_t n, const char *extra);
/* Appends r, a record of state, with this hash in the place of its body: only for a decoder that
 * finds that (`kept`). */
void wire_keep(struct buf *to, const struct record *r, const char *sha256);
/* True if the body of r was found by its hash. */
bool rec_kept(const struct record *r);

/*
 * Encoders append one record to b. `extra` is NULL or "key=value ...". Records that go up, or from
 * one program to another, are sealed: the line ends in its own sum. Records that people may write
 * or edit as text are not: frames and tasks as partition writes them.
 */
void wire_frame(struct buf *b, uint32_t frame, uint32_t w, uint32_t h, const char *extra);
void wire_task(struct buf *b, const struct task *t);
void wire_state(struct buf *b, enum rec_kind kind, const void *body, size_t n);
/* Sealed: a task as a policy gives it; */
void wire_give(struct buf *b, const struct task *t, const char *extra);
/* a frame as a worker announces it; */
void wire_job(struct buf *b, const struct frame_size *f, const char *job, const char *extra);
void wire_frag(struct buf *b, const struct task *t, const struct lattice *at, const char *job,
    const float *rgba);
void wire_done(struct buf *b, const struct task *t, int64_t cpu_us, int64_t wall_us);
#define WIRE_REFUSED "out-of-memory" /* why: the state does not fit the host's memory */
/* The task cannot be computed: why is one word; said: words of a command or a process, or "". */
void wire_failed(
    struct buf *b, const struct task *t, const char *why, const char *said, const char *extra);
/* Appends " said=" and the words, of which WIRE_SAID bytes fit; nothing if they are empty. */
void wire_said(struct buf *b, const char *said);
/* least: of the power, by the self-test; 0: not known */
void wire_hello(struct buf *b, const char *program, const char *selftest, double power,
    double least, int slots);
/* a record without numbers and body: "kind extra"; */
void wire_plain(struct buf *b, enum rec_kind kind, const char *extra);
/* a ring record; for a give, of task t; with to=K if t->to >= 0; */
void wire_ring(struct buf *b, enum rec_kind kind, const struct task *t, const struct rec_ring *m);
/* why: "", or the reason for an early end of the stream; */
void wire_bye(struct buf *b, const char *why);
/* r as it came. */
void wire_copy(struct buf *b, const struct record *r);
/*
 * r itself, with `extra` appended and without the keys in `drop` (NULL-ended, or NULL). All other
 * keys, known or not, are kept.
 */
void wire_forward(
    struct buf *b, const struct record *r, const char *const *drop, const char *extra);
/* Ends the line that begins at unread byte `at` of b: with its sum, unless the line is one word,
 * and a newline. */
void wire_seal(struct buf *b, size_t at);

#endif
