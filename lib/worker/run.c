/* A worker from its hello to its exit: worker.h. */
#include "worker/worker_int.h"

#include <inttypes.h>
#include <signal.h>
#include <stdlib.h>

#define SELFTEST_PIXELS 4096 /* room */

static void hello(struct worker *w, int slots)
{
    static float rgba[4 * SELFTEST_PIXELS];
    const double processors = proc_quota("");
    struct worker_power p = {0};
    uint32_t n;
    do {
        const int64_t start_us = now_us(), used_us = cpu_us();
        n = SELFTEST_PIXELS;
        w->ops->selftest(w->ctx, rgba, &n);
        worker_power_add(&p, cpu_us() - used_us, now_us() - start_us);
    } while (!w->ops->power && !worker_power_known(&p));
    char selftest[24];
    snprintf(
        selftest, sizeof selftest, "%016" PRIx64, hash64_u32(HASH64_INIT, rgba, (size_t)n * 4));
    const double best = w->ops->power ? w->ops->power(w->ctx) : worker_power_best(&p, processors),
                 least = w->ops->power ? best : worker_power_least(&p, processors);
    wire_hello(&w->out, w->ops->program, selftest, slots * best, slots * least, slots);
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
        .ops = ops, .options = o, .ctx = ctx, .in = STREAM_INPUT, .generations.keeps = true};
    w.in.room = worker_room;
    w.in.room_ctx = &w;
    int status = ST_OK;
    frames_init(&w.frames, sizeof(struct worker_job));
    signal(SIGPIPE, SIG_IGN); /* so the status is the same whenever the reader goes */
    hello(&w, o->jobs > 1 ? o->jobs : 1);
    if (o->jobs > 1) status = worker_forks(&w);
    else worker_loop(&w);
    free_all(&w);
    return status == ST_OK && w.failed ? ST_PARTIAL : status;
}
