/*
 * wire: the records that flow between programs, encoded and decoded in memory; no I/O here.
 * The grammar is in stormring-task(5) and stormring-frag(5); the labels below are theirs.
 *
 * A record is one line of text and, when the line says bytes=N, N raw bytes. The decoder is fed
 * bytes as they come; "need more" is a normal answer. After a bad record it looks for the next good
 * one at every following byte, so a torn record costs itself and nothing else.
 */
#ifndef STORMRING_WIRE_H
#define STORMRING_WIRE_H

#include "base/base.h"
#include "task/task.h"

#define WIRE_FORMAT 2                      /* of streams of fragments, as hello says it */
#define WIRE_LINE_MAX 1024                 /* bytes, newline included */
#define WIRE_SEAL_BYTES 13                 /* " sum=89abcdef", the last word of a sealed line */
#define WIRE_FRAG_PIXELS_MAX 65536         /* a longer task comes in several frags */
#define WIRE_STATE_MAX INT64_C(0x7fffffff) /* bytes of a scene, grid or spec */
#define WIRE_SLOTS_MAX (1 << 20)           /* slots that one stream may name */
#define WIRE_PIXEL_BYTES 16                /* RGBA float32, linear, premultiplied, little-endian */

enum rec_kind {
    REC_FRAME,
    REC_SCENE,
    REC_GRID,
    REC_SPEC,
    REC_TASK,
    REC_FLUSH, /* down */
    REC_HELLO,
    REC_FRAG,
    REC_DONE,
    REC_BEAT,
    REC_BYE,
    REC_UP,
    REC_GONE, /* up (and frame) */
    REC_RING,
    REC_HEIR, /* down, to a node of a ring */
    REC_ASK,
    REC_NONE, /* either way, between a node and the hub */
    REC_GIVE,
    REC_CRASHED, /* up, from a node */
    REC_KINDS
};

/* The record's name on the wire. */
const char *rec_name(enum rec_kind kind);

/* Pointers are into the decoder's buffer: good until the next wire_next or wire_feed. */
struct record {
    enum rec_kind kind;
    const char *line; /* not terminated, without its newline */
    size_t line_len;
    const unsigned char *body; /* bytes=N of them */
    size_t body_len;
    struct task task; /* task, frag: all; done, give: the key; frame: .frame; to=K, else -1 */
    uint32_t frame_w, frame_h; /* frame */
};

/* All zero, but for `upward`, is a decoder at the beginning of a stream. */
struct decoder {
    struct buf in;
    bool upward;   /* reads what workers say, who are not trusted: state records are bad there, */
                   /* so that no more than a frag is ever waited for */
    bool unsummed; /* a body is taken without looking at it: wire_crc and wire_light tell more */
    bool ended;    /* no more will be fed */
    bool lost;     /* looking for the next good record */
    uint64_t bad;  /* records lost so far; what is lost in one piece counts as one */
    uint64_t skipped; /* bytes lost so far; they and the records' bytes are all that was fed */
    char why[160];    /* what was wrong with the last bad one, and what was expected */
    size_t consumed;  /* bytes of the record handed out, dropped at the next call */
    uint64_t checked; /* bytes whose crc was computed in vain */
    size_t extent;    /* of a bad record, where that is certain */
};

enum wire_result {
    WIRE_MORE,   /* feed me (or, once ended: that was all) */
    WIRE_RECORD, /* *r is a valid record; its sum, its body's crc and its pixels were checked */
    WIRE_BAD     /* something was lost; why says what. Calling again resynchronises */
};

void wire_feed(struct decoder *d, const void *p, size_t n);
/*
 * A decoder of a whole stream that lies in memory: nothing is copied, records point into it for as
 * long as it is there. Such a decoder is neither fed nor freed.
 */
struct decoder wire_over(unsigned char *p, size_t n);
void wire_end(struct decoder *d);
enum wire_result wire_next(struct decoder *d, struct record *r);
void wire_free(struct decoder *d);
/* After WIRE_MORE: of what kind is the record whose body is on its way, and how long? REC_KINDS: of
 * none. */
enum rec_kind wire_awaited(struct decoder *d, size_t *bytes);

/*
 * A stream may go on with other state. A frame is of the state that stands before it in the stream,
 * and one that comes before all state is of the first. Generations number these states: a record of
 * state begins the next one where a frame came since the last one began, and it replaces what the
 * stream has of its kind. Who reads the stream counts so, everywhere in a chain of programs, though
 * not from the same number on. All zero at first.
 *
 * Tasks may come, or come again, of the latest two generations, and of up to GENERATIONS while all
 * of their state together is small: so small frames do not wait for each other's round trips. What
 * is given again may go through more of a stream than those see that decide it, so who only keeps
 * state keeps more.
 */
#define STATE_BYTES (4 << 20) /* all state of more than two generations is at most so long */
struct generations {
    uint32_t now, oldest; /* the latest; the first of which tasks may come */
    bool keeps;           /* it decides nothing, and keeps twice as much */
    bool framed;          /* a frame came */
    bool has[3];          /* a scene, a grid, a spec */
    struct {
        uint32_t since[3]; /* the generation that the record came in */
        size_t bytes[3];
    } at[GENERATIONS]; /* by the generation, modulo that */
};
/* Would a record of state of this kind begin a new one? */
bool generation_ends(const struct generations *g, enum rec_kind kind);
/* It came, with so many bytes; or a frame, which is of g->now. */
void generation_state(struct generations *g, enum rec_kind kind, size_t bytes);
void generation_frame(struct generations *g, struct frame_size *f);
/* What g->oldest will be when it comes. */
uint32_t generation_oldest(const struct generations *g, enum rec_kind kind, size_t bytes);
/* May there be tasks of f? */
static inline bool generation_lives(const struct generations *g, const struct frame_size *f)
{
    return g->now - f->generation <= g->now - g->oldest;
}

/* The value of KEY=VALUE in r's line (not terminated), or NULL. */
const char *rec_key(const struct record *r, const char *key, size_t *len);
bool rec_int(const struct record *r, const char *key, int64_t min, int64_t max, int64_t *out);
bool rec_real(const struct record *r, const char *key, double min, double max, double *out);
/* As a string into out[size]; false when absent or too long. */
bool rec_str(const struct record *r, const char *key, char *out, size_t size);
/* The slot that r is stamped with, of the outermost fan: 2 where w is "2.1". -1: none. */
int32_t rec_slot(const struct record *r);
/* What the keys of a record of a ring say; -1 and false where they do not. */
struct rec_ring {
    int32_t peer, next, me, n;
    bool idle, published, one;
};
/* False where r is no record of a ring, lacks a key or has one out of range: none that a decoder
 * hands out. */
bool rec_ring(const struct record *r, struct rec_ring *m);
/* Is r's KEY=VALUE just this? */
bool rec_is(const struct record *r, const char *key, const char *value);
/* Does its line end in its sum? What a decoder hands out was checked then. */
bool rec_sealed(const struct record *r);
/* Is r no hello, or does a stream of our format begin with it? Else why says of which it is. */
bool rec_ours(const struct record *r, char why[160]);
/* The pixels of a frag, host byte order, 4 floats each, lattice order. */
void rec_pixels(const struct record *r, float *rgba);
/* n pixels of its body, from the byte on. */
void wire_pixels(const unsigned char *body, size_t n, float *rgba);

/* CRC-32, of a body or a line. */
uint32_t wire_crc(const void *p, size_t n);
/* Can a frag's body be pixels: finite numbers >= 0, and alpha of at most 1? */
bool wire_light(const unsigned char *body, size_t n);

/*
 * Encoders append one record to b. `extra` is NULL or "key=value ...". What goes up, or from one
 * program to another, is sealed: its line ends in its own sum. What people may write or change as
 * text is not: frames and tasks as partition cuts them.
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
void wire_hello(struct buf *b, const char *program, const char *selftest, double power, int slots);
/* a record of no numbers and no body: "kind extra"; */
void wire_plain(struct buf *b, enum rec_kind kind, const char *extra);
/* one of a ring, of task t where it is a give; to=K where t->to says so; */
void wire_ring(struct buf *b, enum rec_kind kind, const struct task *t, const struct rec_ring *m);
/* why: "", or why the stream ends before its time; */
void wire_bye(struct buf *b, const char *why);
/*
 * and r again, with `extra` appended and the keys named in drop (NULL-ended, may be NULL) left out.
 * All other keys, known or not, are passed on.
 */
void wire_forward(
    struct buf *b, const struct record *r, const char *const *drop, const char *extra);
/* Ends the line that begins at byte `at` of b's unread ones: with its sum, unless it is one word,
 * and a newline. */
void wire_seal(struct buf *b, size_t at);

#endif
