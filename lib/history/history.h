/*
 * history: the content of a log of fragments as tables: its runs and slots, and the tasks that
 * slots did with the pixels that each brought. fragstat, which judges a run, and replay, which
 * repeats it, share this reader.
 *
 * Call history_read for each file; or history_read_bytes for one in memory, if its pixels are
 * needed. Then use the tables, then call history_free. A log is not trusted: damaged records are
 * skipped and counted, and of each pixel the first one counts, as in gather. A pixel belongs to
 * the latest `done` of its slot for that task in the run, or else to the next one: workers may send
 * pixels of a long task before it is done.
 */
#ifndef STORMRING_HISTORY_H
#define STORMRING_HISTORY_H

#include "base/base.h"
#include "eta/eta.h"
#include "task/task.h"
#include "wire/wire.h"

#define HISTORY_NAME 64
#define HISTORY_ERR 256
#define HISTORY_WITH 160
#define HISTORY_HOST 64
#define HISTORY_WORD 32
#define HISTORY_SLOTS_MAX (1 << 20) /* limit of slots in a hello */

/* A task that a slot did, in the order of the log. */
struct history_done {
    uint32_t frame, id;
    int32_t run, slot;       /* indices into their tables */
    int64_t cpu_us, wall_us; /* as its worker reports: see stormring-frag(5) */
    int64_t recv_us;         /* time in the run at which fan received it; -1: no fan */
    int64_t try;             /* attempt number: 1, 2, ... */
    bool stolen;             /* given by another node of a ring */
    uint64_t sent;           /* pixels that it brought */
    uint64_t pixels;         /* of them, those that came first */
    int32_t before;          /* previous done of this key, -1: none */
};

struct history_frame {
    uint32_t number, w, h;
    char job[WIRE_JOB], with[HISTORY_WITH]; /* as first announced */
    bool replayed;                          /* its times are those of another run */
    struct coverage have;
    struct history_place *places; /* private: by pixel; built when first needed */
};
#define HISTORY_NONE (-1)    /* not present */
#define HISTORY_UNKNOWN (-2) /* present, but the log does not state its cost */

/* Pixels, in the order of the log; only after history_read_bytes. */
struct history_frag {
    uint32_t frame;
    int32_t done; /* the done they belong to, or HISTORY_UNKNOWN */
    struct lattice at;
    const unsigned char *body; /* for wire_pixels, once history_frag_intact is true */
    size_t bytes;
    uint32_t crc; /* expected crc of the body */
    bool summed;  /* the crc was checked */
};

/* A pixel: the n-th of a frag. */
struct history_place {
    int32_t frag; /* index, or HISTORY_NONE */
    uint32_t n;
};

struct history_slot {
    char name[HISTORY_NAME]; /* as stamped by fan: "0", "1.0"; "-" without a fan */
    char host[HISTORY_HOST]; /* the latest; empty if not stated */
    size_t ready;            /* 1 + the run in which it is ready; 0: it is not */
};

struct history_run {
    int32_t slots; /* from its hello; 1 without one */
};

/* A slot was ready for the first task, or was lost. */
struct history_event {
    int32_t run, slot;
    int64_t recv_us;        /* time in the run; -1: not stated */
    bool lost;              /* or it left the run in good order */
    int64_t tasks;          /* lost with it */
    char why[HISTORY_WORD]; /* fan(1) lists the words; empty: it was ready */
};

struct history {
    struct history_done *dones;
    size_t n_dones;
    struct history_frame *frames;
    size_t n_frames;
    struct history_slot *slots;
    size_t n_slots;
    struct history_run *runs; /* runs in which a task was done */
    size_t n_runs;
    struct history_event *events; /* in the order of the log */
    size_t n_events;
    struct eta *eta;        /* the caller's: gets costs and pixels; or NULL */
    bool ended;             /* the last run has said bye */
    char bye[HISTORY_WORD]; /* why it ended early, or empty */
    struct history_frag *frags;
    size_t n_frags;        /* of these jobs; 0: no pixels, perhaps filtered as text */
    uint64_t bad, skipped; /* records and bytes lost to damage */
    char why[160];         /* the error in the last bad record */
    bool refused;          /* a hello of another format, see why: the rest is not read */

    /* private */
    bool keep;                   /* fills frags */
    int32_t *slot_at;            /* slots by hash of the name; -1: none */
    size_t slots_room;           /* size of slot_at, twice that of `slots` */
    size_t *sorted;              /* indices of frags by place; built when first needed */
    struct task_table tasks;     /* those of the log, with history.c's payload */
    struct history_early *early; /* pixels of the last run that came before their done */
    int32_t n_early;
    bool running;   /* the last run goes on */
    double lone_us; /* wall time of the last run, without a fan */
};

/*
 * Reads a log that grows: handles the complete records in d, whose `upward` is true and which was
 * fed by the caller.
 */
void history_feed(struct history *l, struct decoder *d);
/* Reads fd to its end; the caller closes it. 0, or -1 with errno. */
int history_read(struct history *l, int fd);
/*
 * Reads a whole log of n bytes in memory, which must stay until history_free. Bodies are not
 * checked: call history_frag_intact before using one. If records are damaged in other ways, reads
 * all again with every body checked, so that a bad record costs no good one.
 */
void history_read_bytes(struct history *l, unsigned char *p, size_t n);
/* True if these bytes are those that were sent, and valid pixels. */
bool history_frag_intact(struct history_frag *f);
/* The first frag with exactly these pixels, or NULL. */
struct history_frag *history_frag_at(
    struct history *l, const struct history_frame *f, const struct lattice *at);
/* The first occurrence of pixel p. */
struct history_place history_place_of(struct history *l, const struct history_frame *f, uint64_t p);
/*
 * True if the done was useless: its pixels had come before, or never came. In a log without any
 * pixels the first done of each key counts as useful.
 */
bool history_wasted(const struct history *l, const struct history_done *d);
/* True if l has the jobs of `other`, and the same pixels; else text in err. */
bool history_same(const struct history *l, const struct history *other, char err[HISTORY_ERR]);
/* NULL if no slot announced it. */
const struct history_frame *history_frame_of(const struct history *l, uint32_t number);
void history_free(struct history *l);

/* ---- costs ----------------------------------------------------------------------------------- */

/*
 * The longest time from the begin of a run to the end of its first task, or of a later task, in
 * microseconds; 0: the log has none. Ignores times above most_us.
 */
int64_t history_longest_us(const struct history *l, int64_t most_us);

/* The cost of each pixel of a picture, from the CPU times of the tasks in a log. */
struct history_costs {
    uint32_t w, h; /* 0: no task was both done and delivered */
    double *us;    /* row by row; microseconds */
};
/* Reads the first frame of the log at `path`. Missing pixels get the mean. False with text in
 * err: it cannot be read, or is of another format. */
bool history_costs_read(const char *path, struct history_costs *c, char err[HISTORY_ERR]);
void history_costs_free(struct history_costs *c);
/* The cost of each pixel of a task, put at its place in us, which has frame_w x frame_h pixels.
 * The picture is of the same scene, and may have another size. */
void history_costs_put(const struct history_costs *c, const struct lattice *at, uint32_t frame_w,
    uint32_t frame_h, double *us);
/* The sum over the pixels of a task. */
double history_cost_of(
    const struct history_costs *c, const struct lattice *at, uint32_t frame_w, uint32_t frame_h);

/* ---- replaying ------------------------------------------------------------------------------- */

/* A log in memory. A regular file is mapped, so that all its readers share it. */
struct history_file {
    unsigned char *bytes;
    size_t n;
    bool mapped;
};
/* Returns 0; or with errno -1: it cannot be opened, -2: it cannot be read. history_close frees it,
 * after history_free. */
int history_open(struct history_file *file, const char *path);
void history_close(struct history_file *file);
/* True if the log has tasks with pixels; else text in err. */
bool history_replayable(const struct history *l, char err[HISTORY_ERR]);

/* The pixels of a task, in a log read by history_read_bytes. */
struct history_found {
    struct lattice at;
    const struct history_frag *whole; /* has exactly these pixels; NULL: they are spread */
    double cpu_us;                    /* each pixel costs its share of the task that it came with */
};
/* False with text in err: a pixel is missing, damaged, or of unknown cost. */
bool history_find(struct history *l, const struct history_frame *f, const struct lattice *at,
    struct history_found *found, char err[HISTORY_ERR]);
/* Pixels n0 .. n0 + n of these, four floats each. */
void history_pixels(struct history *l, const struct history_frame *f,
    const struct history_found *found, uint64_t n0, uint32_t n, float *rgba);

#endif
