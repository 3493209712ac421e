/*
 * forks: a worker with several slots, for -j. This process reads the input, loads and builds each
 * state once, and forks a child for each slot, which shares its memory until it is written. The
 * children render (fork_slot.c). A thread loads and builds (builder.c), so that meanwhile children
 * get tasks of earlier state and beats go on; but no child is forked meanwhile.
 *
 * A task with to=K is for slot K; any other one for the slot that is idle first. A state record
 * holds the input until it is loaded. It waits until no task needs the state that it replaces.
 *
 * What the children owe, and for how long they are silent, is for the reader to watch (fan): here
 * is no table of tasks.
 */
#include "patience/patience.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define AHEAD 3          /* tasks of a slot, without those that have to= */
#define TASKS_MOST 65536 /* waiting; beyond that the input waits */
#define ROUND_MS 200     /* longest round while a child may end */
#define POLL_FIXED 3     /* entries of poll before those of the children */

/* ---- state ---------------------------------------------------------------------------------- */

/* The number of waiting tasks in b; with `before`, only those of earlier generations. */
static int count(const struct buf *b, const uint32_t *before)
{
    int n = 0;
    struct task t;
    for (size_t at = 0; at < buf_size(b); at += sizeof t) {
        memcpy(&t, buf_data(b) + at, sizeof t);
        n += !before || (int32_t)(t.generation - *before) < 0;
    }
    return n;
}

/* The same of all tasks that no child was sent. */
static int tasks_waiting(const struct forks *p, const uint32_t *before)
{
    int n = count(&p->any, before);
    for (int k = 0; k < p->n_slots; k++) n += count(&p->slots[k].waiting, before);
    return n;
}

/* Announces the frames of a generation that is built. */
static void announce(struct forks *p, uint32_t generation)
{
    struct worker *w = p->w;
    char err[WORKER_ERR];
    for (size_t i = 0; i < w->frames.n; i++) {
        const struct frame_size *f = &w->frames.at[i];
        if (f->generation != generation) continue;
        if (!worker_announce(w, f, err)) die(ST_USAGE, "%s", err);
        buf_append(&p->out.queue.bulk, buf_data(&w->out), buf_size(&w->out));
        buf_consume(&w->out, buf_size(&w->out));
        up_end_record(&p->out.queue);
    }
    if (!*w->other_job) return;
    outlet_drain(&p->out);
    die(ST_USAGE, "%s", w->other_job);
}

/* Builds for the frame as soon as the builder is idle. */
static void want(struct forks *p, const struct frame_size *f)
{
    if (p->builder.busy && !p->builder.body && p->builder.generation == f->generation) return;
    p->wanted = *f;
    p->wants = true;
}

/* Does the record change the size or the state of a known frame? Tasks of the old frame have the
 * same keys, so they are finished first. */
static bool changes(const struct forks *p, const struct record *r)
{
    const struct frame_size *f = frames_find(&p->w->frames, r->task.frame);
    return f &&
           (f->w != r->frame_w || f->h != r->frame_h || f->generation != p->w->generations.now);
}

static void take_frame(struct forks *p, const struct record *r)
{
    uint32_t now = p->w->generations.now;
    const struct frame_size *f = worker_frame(p->w, r);
    if (!f) return;
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *s = &p->slots[k];
        if (s->child.pid && !s->ends && s->generation == now)
            wire_forward(&s->to.bytes, r, NULL, NULL);
    }
    if (worker_forks_built(p, now) && !p->builder.busy) announce(p, now);
    else want(p, f);
}

/* True if no task needs what the held record replaces: none waits, and no child that may have one
 * runs. A frame replaces one whose tasks have the same keys. */
static bool is_free(struct forks *p)
{
    const struct record *r = &p->held;
    bool frame = r->kind == REC_FRAME, free = true;
    uint32_t oldest = frame ? 0 : generation_oldest(&p->w->generations, r->kind, r->body_len);
    if (tasks_waiting(p, frame ? NULL : &oldest)) return false;
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *s = &p->slots[k];
        /* Files of a state are the parent's: a later child uses them for tasks of that state. */
        if (!frame && count(&s->sent, &oldest)) free = false;
        if (!s->child.pid || (!frame && (int32_t)(s->generation - oldest) >= 0)) continue;
        s->ends = true; /* it sends what it holds back */
        free = false;
    }
    return free;
}

/* Starts to load the held record. */
static void load(struct forks *p)
{
    struct worker *w = p->w;
    const struct record *r = &p->held;
    worker_drop_older(w, r->kind, r->body_len);
    generation_state(&w->generations, r->kind, r->body_len);
    p->built[w->generations.now % GENERATIONS] = false;
    worker_builder_load(&p->builder, r, wire_body(&w->in, r));
}

static int take(void *ctx, const struct record *r);

/* Goes on with the input after the held record. */
static void resume(struct forks *p)
{
    p->holds = false;
    p->refused = stream_take(&p->w->in, take, p);
}

static void joined(struct forks *p)
{
    struct worker_builder *b = &p->builder;
    worker_builder_join(b);
    if (b->body) {
        if (b->failed) die(ST_USAGE, "%s", b->err);
        resume(p);
        return;
    }
    const uint32_t next = b->generation + 1;
    bool asked = tasks_waiting(p, &next) > 0;
    /* State may be missing: then the first task tries again. */
    if (b->failed && asked) die(ST_USAGE, "%s", b->err);
    if (b->failed) return;
    p->built[b->generation % GENERATIONS] = true;
    announce(p, b->generation);
}

/* Gives the builder, if it is idle, its next work. */
static void proceed(struct forks *p)
{
    while (!p->builder.busy && !p->refused && (p->wants || p->holds)) {
        if (p->wants) {
            p->wants = false;
            worker_builder_build(&p->builder, &p->wanted);
            continue;
        }
        if (!is_free(p)) return;
        if (p->held.kind == REC_FRAME) {
            take_frame(p, &p->held);
            resume(p);
        } else {
            load(p);
        }
    }
}

/* ---- tasks ---------------------------------------------------------------------------------- */

static void take_task(struct forks *p, const struct record *r)
{
    struct task t = r->task;
    const struct frame_size *f = worker_frame_of(p->w, &t);
    struct fork_slot *s = t.to >= 0 && t.to < p->n_slots ? &p->slots[t.to] : NULL;
    if (s && s->out) return; /* the sender has been told */
    t.generation = f->generation;
    if (!worker_forks_built(p, t.generation)) want(p, f);
    buf_append(s ? &s->waiting : &p->any, &t, sizeof t);
}

/* Gives tasks without a slot to those that have the fewest. */
static void assign(struct forks *p)
{
    struct task t;
    for (size_t ahead = 0; ahead < AHEAD; ahead++)
        for (int k = 0; k < p->n_slots && buf_size(&p->any); k++) {
            struct fork_slot *s = &p->slots[k];
            memcpy(&t, buf_data(&p->any), sizeof t);
            if (!worker_forks_built(p, t.generation)) return;
            if (!worker_fork_wants(p, s, ahead, t.generation)) continue;
            buf_append(&s->waiting, &t, sizeof t);
            buf_consume(&p->any, sizeof t);
        }
}

static void take_flush(struct forks *p, const struct record *r)
{
    for (int k = 0; k < p->n_slots; k++) p->slots[k].flush |= r->task.to < 0 || r->task.to == k;
    if (r->task.to < 0) outlet_answer(&p->out);
}

static int take(void *ctx, const struct record *r)
{
    struct forks *p = ctx;
    switch (r->kind) {
    case REC_TASK: take_task(p, r); return 0;
    case REC_FLUSH: take_flush(p, r); return 0;
    case REC_CODE: outlet_code(&p->out, r); return 0;
    case REC_FRAME:
        if (!changes(p, r)) {
            take_frame(p, r);
            return 0;
        }
        break;
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_FILES: break;
    default: worker_refuse(r);
    }
    p->held = *r;
    p->holds = true;
    return STREAM_HOLD;
}

/* ---- the loop ------------------------------------------------------------------------------- */

static bool has_child(const struct forks *p)
{
    for (int k = 0; k < p->n_slots; k++)
        if (p->slots[k].child.pid) return true;
    return false;
}

static size_t fill_poll(struct forks *p, struct pollfd *at)
{
    bool reading = p->in_open && !p->holds && tasks_waiting(p, NULL) < TASKS_MOST;
    bool listening = up_size(&p->out.queue) < UP_QUEUE_MOST;
    size_t n = POLL_FIXED;
    at[0] = pipe_poll_entry(STDIN_FILENO, reading, POLLIN);
    at[1] = outlet_poll(&p->out);
    at[2] = pipe_poll_entry(p->builder.done[0], p->builder.busy, POLLIN);
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *s = &p->slots[k];
        s->poll = s->child.from >= 0 ? n : 0;
        if (!s->poll) continue;
        at[n++] = pipe_poll_entry(s->child.to, down_size(&s->to) > 0, POLLOUT);
        at[n++] = pipe_poll_entry(s->child.from, listening, POLLIN);
    }
    return n;
}

/* While a state is loaded or built, the reader knows that this process lives. Otherwise children
 * send beats, each for its slot, so that the silence of one is noticed. */
static void beat(struct forks *p)
{
    int64_t now = now_us();
    outlet_beat(&p->out, &p->w->in);
    if (now - p->beat_us < PATIENCE_BEAT_US || !p->builder.busy) return;
    p->beat_us = now;
    wire_plain(&p->out.queue.control, REC_BEAT, NULL);
}

static int wait_ms(const struct forks *p)
{
    if (p->forked == FORKS_MOST) return 0; /* others may have to be forked */
    return p->builder.busy || has_child(p) ? ROUND_MS : -1;
}

static void go_round(struct forks *p, struct pollfd *at)
{
    p->forked = 0;
    assign(p);
    for (int k = 0; k < p->n_slots; k++) worker_fork_feed(p, &p->slots[k]);
    size_t n = fill_poll(p, at);
    if (signals_poll(at, n, wait_ms(p)) < 0) {
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
        for (size_t i = 0; i < n; i++) at[i].revents = 0;
    }
    outlet_polled(&p->out, &at[1]);
    if (p->out.gone) return;
    if (at[0].revents) p->refused = stream_input(&p->w->in, &p->in_open, take, p);
    if (at[2].revents) joined(p);
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *s = &p->slots[k];
        if (s->poll && at[s->poll + 1].revents) worker_fork_listen(p, s);
        worker_fork_check(p, s);
    }
    proceed(p);
    beat(p);
    outlet_push(&p->out);
}

static bool goes_on(const struct forks *p)
{
    if (p->out.gone || p->refused || signals_came()) return false;
    return p->in_open || p->builder.busy || p->holds || p->wants || tasks_waiting(p, NULL) ||
           has_child(p);
}

int worker_forks(struct worker *w)
{
    struct forks p = {.w = w, .n_slots = w->options->jobs, .in_open = true};
    signals_catch();
    want_descriptors(2 * p.n_slots + 16);
    p.slots = xcalloc((size_t)p.n_slots, sizeof *p.slots);
    for (int k = 0; k < p.n_slots; k++)
        p.slots[k] = (struct fork_slot){.number = k, .child = CHILD_NONE};
    struct pollfd *at = xcalloc((size_t)p.n_slots * 2 + POLL_FIXED, sizeof *at);
    worker_builder_open(&p.builder, w);
    outlet_open(&p.out);
    p.out.greeted = true;
    while (goes_on(&p)) go_round(&p, at);
    if (signals_came()) signals_die();
    if (p.out.gone) exit(ST_SYSTEM); /* the builder may be at work */
    if (p.builder.busy) worker_builder_join(&p.builder);
    if (!p.refused) wire_plain(&p.out.queue.bulk, REC_BYE, NULL);
    up_end_record(&p.out.queue);
    outlet_drain(&p.out);
    for (int k = 0; k < p.n_slots; k++) worker_fork_free(&p.slots[k]);
    worker_builder_close(&p.builder);
    buf_free(&p.any);
    up_free(&p.out.queue);
    free(p.slots);
    free(at);
    if (p.out.gone) return ST_SYSTEM;
    return p.refused ? p.refused : p.lost ? ST_PARTIAL : ST_OK;
}
