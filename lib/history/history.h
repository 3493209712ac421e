/*
 * history: what a log of fragments tells, as tables: its runs and slots, each task that a slot did
 * and what of the picture came of it. One reader for whoever judges a run (fragstat) or repeats it
 * (replay).
 *
 * Call history_read for each file, or history_over for one that lies in memory and whose pixels are
 * wanted; then look at the tables; then history_free. A log is a set of facts that nobody vouches
 * for: damaged records are skipped and counted, and of each pixel the first one counts, as in
 * gather. A pixel belongs to the `done` that its slot said last of that task.
 */
#ifndef STORMRING_HISTORY_H
#define STORMRING_HISTORY_H

#include "base/base.h"
#include "task/task.h"
#include "wire/wire.h"

#define HISTORY_NAME 64
#define HISTORY_JOB 24
#define HISTORY_ERR 256
#define HISTORY_WITH 160
#define HISTORY_SLOTS_MAX (1 << 20) /* what a hello may claim */

/* A task that a slot did, in the order of the log. */
struct history_done {
    uint32_t frame, id;
    int32_t run, slot;       /* places in their tables */
    int64_t cpu_us, wall_us; /* as its worker says: see stormring-frag(5) */
    int64_t recv_us;         /* when fan heard of it, since the run began; -1: no fan did */
    int64_t try;             /* how many times the task had been given: 1, or 2, ... */
    bool stolen;             /* another node of a ring gave it to this one */
    uint64_t sent;           /* pixels that it brought; */
    uint64_t pixels;         /* of them, those that nobody had brought before */
    uint32_t rows;           /* rows of the frame of which it brought the first pixel */
    int32_t before;          /* the one before of this key, or -1 */
};

struct history_frame {
    uint32_t number, w, h;
    char job[HISTORY_JOB], with[HISTORY_WITH]; /* of the first slot that announced it */
    bool replayed;                             /* its times are those of another run */
    bool split;                                /* some row came of several tasks */
    struct coverage have;
    int32_t
        *row_of; /* by row: the done that brought its first pixel, HISTORY_NONE, HISTORY_UNKNOWN */
    struct history_place *places; /* private: by pixel, when somebody asks for one */
};
#define HISTORY_NONE (-1)    /* not there */
#define HISTORY_UNKNOWN (-2) /* there, but the log does not say what it cost */

/* Pixels, in the order of the log; only of history_over. */
struct history_frag {
    uint32_t frame;
    int32_t done; /* that they are of, or HISTORY_UNKNOWN */
    struct lattice at;
    const unsigned char *body; /* for wire_pixels, once it is sound */
    size_t bytes;
    uint32_t crc; /* that the body should have */
    bool summed;  /* and has */
};

/* A pixel: the n-th of a frag. */
struct history_place {
    int32_t frag; /* or HISTORY_NONE */
    uint32_t n;
};

struct history_slot {
    char name[HISTORY_NAME]; /* as fan stamped it: "0", "1.0"; "-" for a worker without one */
};

struct history_run {
    int32_t slots; /* as its hello says, 1 without one */
};

struct history {
    struct history_done *dones;
    size_t n_dones;
    struct history_frame *frames;
    size_t n_frames;
    struct history_slot *slots;
    size_t n_slots;
    struct history_run *runs; /* those in which a task was done */
    size_t n_runs;
    struct history_frag *frags;
    size_t n_frags;        /* of these jobs; 0: a log without pixels, maybe filtered as text */
    uint64_t bad, skipped; /* records and bytes lost to damage */
    char why[160];         /* what was wrong with the last bad one */
    bool refused;          /* it is of another format, as why says: nothing behind that is read */

    /* private */
    bool keep;                       /* frags */
    int32_t *slot_at;                /* slots by the hash of their names; -1: none */
    size_t slots_room;               /* places there, twice those in `slots` */
    size_t *sorted;                  /* numbers of frags by place, when somebody looks for one */
    struct task_table last;          /* by key; since_us is the place of its last done */
    bool running;                    /* the last run goes on */
};

/* Reads fd to its end; whoever opened it closes it. 0, or -1 with errno. */
int history_read(struct history *l, int fd);
/*
 * A whole log of n bytes, which have to stay until history_free. Its bodies are not looked at: ask
 * history_sound before using one. Where records are damaged in other ways, it is all read again,
 * with every body summed, so that no good record is lost with a bad one.
 */
void history_over(struct history *l, unsigned char *p, size_t n);
/* Are these bytes those that were sent, and pixels? */
bool history_sound(struct history_frag *f);
/* The first frag that has just these pixels, or NULL. */
struct history_frag *history_frag_at(
    struct history *l, const struct history_frame *f, const struct lattice *at);
/* Where pixel p came first. */
struct history_place history_place_of(struct history *l, const struct history_frame *f, uint64_t p);
/*
 * Did nothing of it come to use: others had brought its pixels, or nobody ever got them? A log
 * without any pixels is taken at its word: of each key the first one did.
 */
bool history_wasted(const struct history *l, const struct history_done *d);
/* Does some row have pixels of several tasks? */
bool history_split(const struct history *l);
/* Has l the pixels of the jobs of `other`, and as many? Else false, with text in err. */
bool history_same(const struct history *l, const struct history *other, char err[HISTORY_ERR]);
/* NULL when no slot announced it. */
const struct history_frame *history_frame_of(const struct history *l, uint32_t number);
void history_free(struct history *l);

#endif
