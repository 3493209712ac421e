/*
 * worker: the loop that all renderers share. It reads records from stdin, calls a render callback,
 * and writes fragments to stdout: stormring-task(5), stormring-frag(5).
 *
 * The loop says hello; takes state (scene, ...) and frame records; says `frame ... job=` once it
 * can render; and renders tasks in order, each with the state of its frame. That state is the
 * latest one, the one before, or an earlier one that is still alive (wire.h). During a callback, or
 * while a long record arrives, a timer (SIGALRM) sends a beat every 500 ms. It also checks stdout
 * every 100 ms: if the reader is gone the process ends at once. At the end of input the loop
 * finishes its tasks and says bye. It blocks only in poll, read and write.
 */
#ifndef STORMRING_WORKER_H
#define STORMRING_WORKER_H

#include "base/base.h"
#include "task/task.h"
#include "wire/wire.h"

#define WORKER_ERR 256

struct worker_ops {
    const char *program; /* as hello states it */
    /*
     * Takes a state record of this generation (wire.h): the latest one, or the next, which begins
     * with all state of the latest. Returns 0, or -1 with text in err. `body` is valid during the
     * call, which may modify it.
     */
    int (*state)(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body, size_t n,
        char err[WORKER_ERR]);
    /* No more tasks of this generation will come, even if none came: frees state that only it
     * needs. NULL: nothing to free. */
    void (*drop)(void *ctx, uint32_t generation);
    /*
     * Checks that all state of f's generation is present and usable, and builds what rendering
     * needs. Called before every task, for a generation that was not dropped. Returns 0, or else
     * text in err.
     */
    int (*ready)(void *ctx, const struct frame_size *f, char err[WORKER_ERR]);
    /* Hash of format, options that change pixels, state and size, for the frame made ready. */
    uint64_t (*job)(void *ctx);
    /*
     * Program and options that give this job, as command line words separated by commas
     * ("rtworker,-d3"). The command that finishes the picture later needs them.
     */
    const char *(*with)(void *ctx);
    /* Renders pixels n0 .. n0+n of the lattice into rgba[4n]. */
    void (*render)(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba);
    /* Renders a fixed built-in picture. Its bytes are hashed; its time gives the power. */
    void (*selftest)(void *ctx, float *rgba, uint32_t *n); /* n: room for 4*n floats, then pixels */
    /*
     * For a stand-in for another worker, else NULL: the CPU time, in microseconds, that the other
     * worker would have used so far. Frames are then announced as `replayed`.
     */
    int64_t (*cpu_us)(void *ctx);
};

struct worker_options {
    uint32_t frag_pixels; /* most pixels in a frag; 0: whole tasks */
    /* hold fragments until a flush, a task of other state, or the end of input */
    bool concentrate;
};

/* Options of all workers: -c and -f PIXELS. Handles opt, or returns false if it is another one. */
#define WORKER_OPTIONS "cf:"
bool worker_option(struct worker_options *o, int opt, const char *arg);

/* Runs to the end of input. Returns the exit status. */
int worker_run(const struct worker_ops *ops, const struct worker_options *o, void *ctx);

/* A machine of power 1 takes this time for the self-test, in microseconds. */
#define WORKER_SELFTEST_REFERENCE_US 2000.0

#endif
