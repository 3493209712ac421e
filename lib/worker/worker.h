/*
 * worker: the one loop that every renderer shares. Records in on stdin, a render callback,
 * fragments out on stdout, as stormring-task(5) and stormring-frag(5) say.
 *
 * The loop says hello; takes state (scene, ...) and frame records; says `frame ... job=` once it
 * can render; renders tasks in order, each with the state that its frame is of, which is the latest
 * or the one before: that one goes when the next begins to come. While a callback is at work, or a
 * part of a long record is there, a timer (SIGALRM) sends a beat every 500 ms, and looks at stdout
 * every 100 ms: when its reader is gone the process ends at once. End of input: what was read is
 * finished, then bye. It blocks only in poll, read and write.
 */
#ifndef STORMRING_WORKER_H
#define STORMRING_WORKER_H

#include "base/base.h"
#include "task/task.h"
#include "wire/wire.h"

#define WORKER_ERR 256

struct worker_ops {
    const char *program; /* for hello */
    /*
     * Take a state record of this generation (wire.h): the latest, or the next one, which begins
     * with all that the latest has. 0, or -1 with text in err. `body` is valid during the call,
     * which may destroy it.
     */
    int (*state)(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body, size_t n,
        char err[WORKER_ERR]);
    /* No more tasks of this generation will come, if it ever was: what only it needs can go. NULL:
     * nothing can. */
    void (*drop)(void *ctx, uint32_t generation);
    /*
     * Is all state of f's generation there and usable? Called before every task, of a
     * generation that was not dropped; builds what is needed.
     */
    int (*ready)(void *ctx, const struct frame_size *f, char err[WORKER_ERR]);
    /* The hash of format, options that change pixels, state and size, of the frame made ready. */
    uint64_t (*job)(void *ctx);
    /*
     * Program and options that give this job, as command line words with commas between
     * ("rtworker,-d3"): who finishes the picture later needs them.
     */
    const char *(*with)(void *ctx);
    /* Pixels n0 .. n0+n of the lattice into rgba[4n]. */
    void (*render)(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba);
    /* A built-in picture, always the same; its bytes are hashed, its time gives the power. */
    void (*selftest)(void *ctx, float *rgba, uint32_t *n); /* n: room for 4*n floats, then pixels */
    /*
     * For who stands in for another worker; NULL for all others: the CPU time that this one would
     * have used so far, in place of this process's own. Frames are then announced as `replayed`.
     */
    int64_t (*cpu_us)(void *ctx);
};

struct worker_options {
    uint32_t frag_pixels; /* at most so many pixels in a frag; 0: whole tasks */
    bool concentrate;     /* keep fragments until flush, other state's tasks, or end of input */
};

/* -c and -f PIXELS, which all workers have, among getopt's: takes opt if it is one of them. */
#define WORKER_OPTIONS "cf:"
bool worker_option(struct worker_options *o, int opt, const char *arg);

/* Runs to the end of input; returns the exit status. */
int worker_run(const struct worker_ops *ops, const struct worker_options *o, void *ctx);

/* Power 1 is a machine that takes so long for the self-test (microseconds). */
#define WORKER_SELFTEST_REFERENCE_US 2000.0

#endif
