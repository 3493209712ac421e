/* A worker from its hello to its exit: worker.h. */
#include "worker/worker_int.h"

#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>

#define SELFTEST_PIXELS 4096 /* room */

static void hello(struct worker *w, int slots)
{
    static float rgba[4 * SELFTEST_PIXELS];
    uint32_t n = SELFTEST_PIXELS;
    int64_t start = now_us();
    w->ops->selftest(w->ctx, rgba, &n);
    int64_t took = now_us() - start;
    uint64_t hash = hash64_u32(HASH64_INIT, rgba, (size_t)n * 4);
    char selftest[24];
    snprintf(selftest, sizeof selftest, "%016" PRIx64, hash);
    double power = WORKER_SELFTEST_REFERENCE_US / (double)(took > 0 ? took : 1);
    wire_hello(&w->out, w->ops->program, selftest, slots * power, slots);
    worker_push(w);
}

bool worker_option(struct worker_options *o, int opt, const char *arg)
{
    if (opt == 'c') o->concentrate = true;
    else if (opt == 'f') o->frag_pixels = (uint32_t)opt_int(opt, arg, 1, WIRE_FRAG_PIXELS_MAX);
    else if (opt == 'j') o->jobs = (int)opt_int(opt, arg, 1, WORKER_JOBS_MOST);
    else return false;
    return true;
}

static void free_all(struct worker *w)
{
    wire_free(&w->in);
    buf_free(&w->out);
    buf_free(&w->held);
    frames_free(&w->frames);
    free(w->pixels);
}

int worker_run(const struct worker_ops *ops, const struct worker_options *o, void *ctx)
{
    struct worker w = {
        .ops = ops, .options = o, .ctx = ctx, .in.coded = true, .generations.keeps = true};
    int status = ST_OK;
    frames_init(&w.frames, sizeof(struct worker_job));
    signal(SIGPIPE, SIG_IGN); /* so the status is the same whenever the reader goes */
    hello(&w, o->jobs > 1 ? o->jobs : 1);
    if (o->jobs > 1) status = worker_forks(&w);
    else worker_loop(&w);
    free_all(&w);
    return status;
}
