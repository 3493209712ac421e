/*
 * worker: the loop that all renderers share. It reads records from stdin, calls a render callback,
 * and writes fragments to stdout: stormring-task(5), stormring-frag(5).
 *
 * The loop says hello; takes state (scene, ...) and frame records; says `frame ... job=` once it
 * can render; and renders tasks in order, each with the state of its frame. That state is the
 * latest one, the one before, or an earlier one that is still alive (wire.h). During a callback, or
 * while a long record arrives, a timer (SIGALRM) sends a beat every 500 ms. It also checks stdout
 * every 100 ms: if the reader is gone the process ends at once. At the end of input the loop
 * finishes its tasks and says bye. It blocks only in poll, read and write. With `jobs` above 1, the
 * process forks that number of children after it has built, and they render; see forks.c.
 *
 * A renderer calls worker_states_new, worker_states_load for each part of its state that is a file,
 * worker_render, and worker_states_free. A stand-in for a renderer has no state: it fills a struct
 * worker_ops and calls worker_run.
 */
#ifndef STORMRING_WORKER_H
#define STORMRING_WORKER_H

#include "base/base.h"
#include "task/task.h"
#include "wire/wire.h"

#define WORKER_ERR 256
#define WORKER_REFUSED 1 /* state does not fit in memory: tasks that need it are not done */

struct worker_ops {
    const char *program; /* as hello states it */
    /*
     * Takes a state record of this generation (wire.h): the latest one, or the next, which begins
     * with all state of the latest. Returns 0, or -1 with text in err. `body` is valid during the
     * call, which may modify it. NULL, if n is not 0: it does not fit in memory, as err says, and
     * what needs it is refused.
     */
    int (*state)(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body, size_t n,
        char err[WORKER_ERR]);
    /* The bytes that such a record takes when it is loaded, at least, by the first n of its bytes.
     * NULL: records are not refused. */
    double (*needs)(
        void *ctx, enum rec_kind kind, const unsigned char *start, size_t n, size_t bytes);
    /* No more tasks of this generation will come, even if none came: frees state that only it
     * needs. NULL: nothing to free. */
    void (*drop)(void *ctx, uint32_t generation);
    /*
     * Checks that all state of f's generation is present and usable, and builds what rendering
     * needs. Called before every task, for a generation that was not dropped. Returns 0, or -1 with
     * text in err, or WORKER_REFUSED with that of `state`.
     */
    int (*ready)(void *ctx, const struct frame_size *f, char err[WORKER_ERR]);
    /* Hash of format, options that change pixels, state and size, for the frame made ready. */
    void (*job)(void *ctx, char job[WIRE_JOB]);
    /*
     * Program and options that give this job, as command line words separated by commas
     * ("rtworker,-d3"). The command that finishes the picture later needs them.
     */
    const char *(*with)(void *ctx);
    /* Called before each task, whose lattice this is; render then gets it in one or more pieces.
     * False with text in err: it cannot be rendered, and the worker goes on. NULL: no matter. */
    bool (*task)(void *ctx, const struct frame_size *f, const struct lattice *whole,
        char err[WORKER_ERR]);
    /* Renders pixels n0 .. n0+n of the lattice into rgba[4n]. */
    void (*render)(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba);
    /* Renders a fixed built-in picture, the same each time. Its bytes are hashed; its time gives
     * the power. */
    void (*selftest)(void *ctx, float *rgba, uint32_t *n); /* n: room for 4*n floats, then pixels */
    /* The power that a stand-in states. NULL: it is measured. */
    double (*power)(void *ctx);
    /* The CPU time used so far, in microseconds. NULL: that of this process. */
    int64_t (*cpu_us)(void *ctx);
    /* This is a stand-in for another worker, whose CPU time cpu_us returns. Frames are announced as
     * `replayed`. */
    bool replayed;
};

struct worker_options {
    uint32_t frag_pixels; /* most pixels in a frag; 0: whole tasks */
    /* hold fragments until a flush, a task of other state, or the end of input */
    bool concentrate;
    int jobs; /* slots: processes that render; 0 and 1: this one only */
};

/* Options of all workers: -c and -f PIXELS; of renderers also -j SLOTS. Handles opt, or returns
 * false if it is another one. */
#define WORKER_OPTIONS "cf:"
#define WORKER_JOBS_MOST 4096
bool worker_option(struct worker_options *o, int opt, const char *arg);

/* Runs to the end of input. Returns the exit status. */
int worker_run(const struct worker_ops *ops, const struct worker_options *o, void *ctx);

/* ---- power (power.c) ------------------------------------------------------------------------- */

/* A machine of power 1 takes this CPU time for the self-test, in microseconds. */
#define WORKER_SELFTEST_REFERENCE_US 2000.0

/*
 * The power of a slot: the speed at which it renders if no other process wants its processor.
 *
 * The best of several runs of the self-test counts, by CPU time: other processes take the processor
 * away for a while, and the first run also loads pages. A quota of the group of processes takes it
 * away for good, but not in a test that is shorter than the quota's period, so the quota counts
 * as it is stated. Others that stay do not count: what comes of them shows in the least power, and
 * in the times of tasks, which policies measure.
 *
 * Zero-initialise; add runs until the power is known: after three to eight, which take 4 ms of CPU
 * time or 20 ms; on a slow machine after one of 20 ms.
 */
struct worker_power {
    int n;            /* runs */
    int64_t best_us;  /* CPU time of the shortest */
    int64_t cpu_us;   /* of all */
    int64_t wall_us;  /* wall-clock time of all */
    int64_t later_us; /* of all but the first */
};
/* A run took these times. A CPU time that is 0 or longer than the run is that of a coarse clock:
 * then the other time counts. */
void worker_power_add(struct worker_power *p, int64_t cpu_us, int64_t wall_us);
bool worker_power_known(const struct worker_power *p);
/* Both need a run. processors: those that a quota allows; INFINITY: there is none. */
double worker_power_best(const struct worker_power *p, double processors);
/* By the mean wall-clock time of all runs but the first: at most the best. */
double worker_power_least(const struct worker_power *p, double processors);

/* ---- renderers (states.c) ------------------------------------------------------------------- */

/*
 * A part of a renderer's state, such as a scene or a grid, from a record or a file. A
 * generation (wire.h) begins with the parts of the previous one and shares each until a record
 * replaces it. So a task that was lost can be rendered again after later state has come.
 */
struct worker_part {
    enum rec_kind kind; /* REC_SCENE, REC_GRID, REC_SPEC, REC_VIEW or REC_FILES */
    bool optional;      /* may be missing: then its value is NULL */
    size_t size;        /* bytes of the value that `read` fills */
    /*
     * Fills the value, which is all zero. `bytes` are memory of this process, which no other one
     * can change; their contents are undefined afterwards. Returns 0, or -1 with text in err: then
     * nothing is to be freed. `name` is for messages.
     */
    int (*read)(const void *options, const char *name, unsigned char *bytes, size_t n, void *value,
        char err[WORKER_ERR]);
    /* Frees what `read` allocated, not the value itself. */
    void (*free)(void *value);
    /* The bytes that it takes when it is loaded, at least, by the first n of its bytes. NULL: 0. */
    double (*needs)(const unsigned char *start, size_t n, size_t bytes);
};

#define WORKER_PARTS 2 /* most parts of a renderer */
struct worker_renderer {
    const char *program; /* as hello states it */
    struct worker_part part[WORKER_PARTS];
    int n_parts;
    /* Says in err what does not go together in the values of all parts, and returns false. NULL:
     * all do. */
    bool (*check)(void *const value[], char err[WORKER_ERR]);
    /* Builds what rendering needs from the values of all parts, which outlive it. Called when the
     * first task of a generation comes. Never NULL. */
    void *(*build)(const void *options, void *const value[]);
    void (*free)(void *built);
    /* Sets the size of the frame for the following calls. Cheap: called before every task. NULL if
     * `task` does that. */
    void (*frame)(void *built, uint32_t w, uint32_t h);
    /* As the functions of the same names in struct worker_ops. */
    bool (*task)(void *built, const struct frame_size *f, const struct lattice *whole,
        char err[WORKER_ERR]);
    void (*render)(void *built, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba);
    void (*selftest)(float *rgba, uint32_t *n);
    int64_t (*cpu_us)(void *states);
};

/* The options that change pixels, in words. */
struct worker_words {
    char job[128]; /* format and options: "rt 4 depth=3 ...", for job hashes */
    char with[80]; /* as struct worker_ops has it */
};

struct worker_states;
/* Keeps all three pointers; `options` are for read and build. Never NULL. The caller frees it with
 * worker_states_free. */
struct worker_states *worker_states_new(
    const struct worker_renderer *r, const void *options, const struct worker_words *words);
void worker_states_free(struct worker_states *s);
/*
 * Reads part k from a file; "-": standard input. It replaces the part that was read before. Records
 * of its kind are then refused. A file that cannot be read ends the program with status 2, one that
 * does not fit in memory with status 3. Not after worker_render.
 */
void worker_states_load(struct worker_states *s, int k, const char *path);
/* The value of part k that was loaded; NULL: none was. */
const void *worker_states_value(const struct worker_states *s, int k);
/* What build made of the loaded parts, with the frame set to this size. */
void *worker_states_built(struct worker_states *s, uint32_t w, uint32_t h);
/* The job of a frame of this size of the loaded parts. */
void worker_states_job(const struct worker_states *s, uint32_t w, uint32_t h, char job[WIRE_JOB]);
/* Renders the tasks of standard input, to its end. Returns the exit status. */
int worker_render(struct worker_states *s, const struct worker_options *o);
/* The operations of that loop. Their ctx is s. */
struct worker_ops worker_states_ops(const struct worker_states *s);

#endif
