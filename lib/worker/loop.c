/* The worker's loop: see worker.h. */
#include "worker/worker_int.h"

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

#define READ_BYTES 65536

/* Another job is announced too, so that the reader can say which slot has it. */
static void announce(struct worker *w)
{
    worker_push(w);
    if (*w->other_job) die(ST_USAGE, "%s", w->other_job);
}

static void take_frame(struct worker *w, const struct record *r)
{
    char err[WORKER_ERR];
    const struct frame_size *f = worker_frame(w, r);
    if (f) worker_announce(w, f, err); /* state may be missing: then the first task tries again */
    announce(w);
}

static void release_held(struct worker *w)
{
    worker_push(w);
    if (write_full(STDOUT_FILENO, buf_data(&w->held), buf_size(&w->held)) != 0)
        worker_reader_gone(errno);
    buf_consume(&w->held, buf_size(&w->held));
}

static void emit_frag(
    struct worker *w, const struct task *t, const struct lattice *at, const char *job)
{
    struct buf *to = w->options->concentrate ? &w->held : &w->out;
    size_t begin = buf_size(to);
    wire_frag(to, t, at, job, w->pixels);
    if (w->packs) wire_pack_last(to, begin);
}

/* Absurd but valid scenes, such as mirrors of Ks 1e6, exceed the range of float. Values beyond
 * it become its limit, and NaN becomes 0: the same on all machines, and valid light for all
 * readers. */
static inline float limited(float a, float most) { return a >= 0 ? a < most ? a : most : 0; }

static void limit(float *rgba, uint64_t n)
{
    for (float *end = rgba + 4 * n; rgba < end; rgba += 4) {
        for (int c = 0; c < 3; c++) rgba[c] = limited(rgba[c], FLT_MAX);
        rgba[3] = limited(rgba[3], 1);
    }
}

static int64_t used_us(const struct worker *w)
{
    return w->ops->cpu_us ? w->ops->cpu_us(w->ctx) : cpu_us();
}

/* The CPU time of a task includes all since the previous one: reading and writing are work too. */
static void say_done(struct worker *w, const struct task *t, int64_t wall_us)
{
    int64_t cpu = used_us(w);
    wire_done(&w->out, t, cpu - w->cpu_us, wall_us);
    w->cpu_us = cpu;
}

static void fail(struct worker *w, const struct task *t, const char *err)
{
    warn("%s", err);
    wire_failed(&w->out, t, "failed", err, NULL);
    worker_push(w);
    w->failed = true;
}

static void take_task(struct worker *w, const struct task *t)
{
    char err[WORKER_ERR];
    const struct frame_size *f = worker_frame_of(w, t);
    const int failed = worker_announce(w, f, err);
    if (failed == WORKER_REFUSED) {
        worker_fail(w, &w->out, t, NULL, err);
        worker_push(w);
        return;
    }
    if (failed) die(ST_USAGE, "%s", err);
    announce(w);
    if (w->ops->ready(w->ctx, f, err) != 0) die(ST_USAGE, "%s", err);
    const struct worker_job *known = frames_extra(&w->frames, f);
    if (w->held_of != f->generation) release_held(w);
    w->held_of = f->generation;
    int64_t wall = now_us();
    worker_pulse_begin();
    bool good = !w->ops->task || w->ops->task(w->ctx, f, &t->at, err);
    worker_pulse_end();
    if (!good) {
        fail(w, t, err);
        return;
    }
    uint64_t total = lattice_count(&t->at), most = w->options->frag_pixels;
    if (!most || most > WIRE_FRAG_PIXELS_MAX) most = WIRE_FRAG_PIXELS_MAX;
    for (uint64_t n0 = 0; n0 < total;) {
        struct lattice piece = lattice_cut(&t->at, f->w, n0, most);
        uint32_t count = (uint32_t)lattice_count(&piece);
        worker_pulse_begin();
        w->ops->render(w->ctx, &piece, 0, count, w->pixels);
        limit(w->pixels, count);
        worker_pulse_end();
        n0 += count;
        /* `done` is the scheduling event: it is sent before the last pixels. */
        if (n0 == total) say_done(w, t, now_us() - wall);
        emit_frag(w, t, &piece, known->hash);
        worker_push(w);
    }
}

static void take_state(struct worker *w, const struct record *r)
{
    char err[WORKER_ERR];
    worker_drop_older(w, r->kind, r->body_len);
    generation_state(&w->generations, r->kind, r->body_len);
    unsigned char *body = worker_loads(w, r) ? wire_body(&w->in, r) : NULL;
    memcpy(err, w->refusal, sizeof err);
    worker_pulse_begin();
    stream_keep(r);
    if (w->ops->state(w->ctx, w->generations.now, r->kind, body, r->body_len, err) != 0)
        die(ST_USAGE, "%s", err);
    worker_pulse_end();
}

static void take_record(struct worker *w, const struct record *r)
{
    if (r->kind == REC_TASK) {
        take_task(w, &r->task);
        return;
    }
    switch (r->kind) {
    case REC_FRAME: take_frame(w, r); break;
    case REC_CODE:
        stream_code(r, &w->out, &w->packs);
        worker_push(w);
        break;
    case REC_FLUSH:
        release_held(w);
        wire_plain(&w->out, REC_BEAT, NULL); /* an answer even if nothing was held */
        worker_push(w);
        break;
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_VIEW:
    case REC_FILES: take_state(w, r); break;
    case REC_BYE: worker_dismissed();
    default:
        if (!silence_take(r)) worker_refuse(r);
    }
    w->cpu_us = used_us(w);
}

/* Waits for input while watching the reader, then reads once. False at the end of input. */
static bool fill(struct worker *w)
{
    struct pollfd p[2] = {{STDIN_FILENO, POLLIN, 0}, {STDOUT_FILENO, 0, 0}};
    if (worker_pulse_last(&w->in.in)) return true;
    while (poll(p, 2, -1) < 0)
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
    if (p[1].revents & POLL_GONE) worker_reader_gone(0);
    ptrdiff_t n = read_some(STDIN_FILENO, &w->in.in, READ_BYTES);
    if (n < 0) die(ST_SYSTEM, "standard input:");
    if (n > 0) silence_heard();
    else silence_forget();
    worker_pulse_heard(&w->in.in);
    return n > 0;
}

void worker_loop(struct worker *w)
{
    w->pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *w->pixels);
    worker_pulse_open();
    for (bool more = true; more;) {
        /* While a long state record arrives, beats go on: a program that waits for this worker
         * does not see how much of the record has arrived. */
        size_t bytes;
        enum rec_kind kind = wire_awaited(&w->in, &bytes);
        if (kind != REC_KINDS) worker_drop_older(w, kind, bytes);
        worker_consider(w);
        if (buf_size(&w->in.in) > WIRE_LINE_MAX) worker_pulse_begin();
        more = fill(w);
        worker_pulse_end();
        if (!more) wire_end(&w->in);
        struct record r;
        enum wire_result result;
        while ((result = wire_next(&w->in, &r)) == WIRE_RECORD) take_record(w, &r);
        if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", w->in.why);
    }
    release_held(w);
    wire_plain(&w->out, REC_BYE, NULL);
    worker_push(w);
}
