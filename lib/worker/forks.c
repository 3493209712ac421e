/*
 * forks: a worker with several slots, for -j. This process reads the input, loads and builds each
 * state once, and forks a child for each slot, which shares its memory until it is written. The
 * children render (fork_slot.c). A thread loads and builds (builder.c), so that meanwhile children
 * get tasks of earlier state and beats go on; but no child is forked meanwhile.
 *
 * A task with to=K is for slot K; any other one for the slot that is idle first. If the system
 * refuses to fork a slot's child, other slots have its tasks, and the records still name it. A
 * state record holds the input until it is loaded. It waits until no task needs the state that it
 * replaces.
 * One machine with fork_slot.c and worker.c.
 */
#include "patience/patience.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <unistd.h>

#define AHEAD 3          /* tasks of a slot, without those that have to= */
#define TASKS_MOST 65536 /* waiting; beyond that the input waits */
#define ROUND_MS 200     /* longest round while there is work */
#define POLL_FIXED 3     /* entries of poll before those of the children */

/* ---- state ---------------------------------------------------------------------------------- */

/* Tasks that no child has computed and delivered, of generations before `oldest`, or all. */
static int tasks_before(const struct forks *p, const uint32_t *oldest)
{
    int n = oldest ? 0 : p->tasks.count;
    for (int k = -1; k < p->n_slots; k++) {
        const struct task_table *t = k < 0 ? &p->tasks : &p->slots[k].tasks;
        if (!oldest) n += k < 0 ? 0 : t->count;
        for (uint32_t g = p->w->generations.oldest; oldest && (int32_t)(g - *oldest) < 0; g++)
            n += tasks_in_generation(t, g);
    }
    return n;
}

static int tasks_waiting(const struct forks *p)
{
    int n = p->any.count;
    for (int k = 0; k < p->n_slots; k++) n += p->slots[k].waiting.count;
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
        if (worker_announce(w, f, err)) die(ST_USAGE, "%s", err);
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
    else if (!p->unfit[now % GENERATIONS]) want(p, f);
}

/* True if no task needs what the held record replaces. Children that hold back pixels are to
 * flush. */
static bool is_free(struct forks *p)
{
    const struct record *r = &p->held;
    bool frame = r->kind == REC_FRAME;
    uint32_t oldest = frame ? 0 : generation_oldest(&p->w->generations, r->kind, r->body_len);
    if (!tasks_before(p, frame ? NULL : &oldest)) return true;
    for (int k = 0; k < p->n_slots; k++) p->slots[k].flush |= !p->flushed;
    p->flushed = true;
    return false;
}

static int take(void *ctx, const struct record *r);

/* Goes on with the input after the held record. */
static void resume(struct forks *p)
{
    p->holds = false;
    p->refused = stream_take(&p->w->in, take, p);
}

/* Notes why tasks of the generation cannot be done; NULL: nothing is known. */
static void set_unfit(struct forks *p, uint32_t generation, const char *why)
{
    char **at = &p->unfit[generation % GENERATIONS];
    free(*at);
    *at = why ? xstrdup(why) : NULL;
}

/* Starts to load the held record, if it fits in memory. */
static void load(struct forks *p)
{
    struct worker *w = p->w;
    const struct record *r = &p->held;
    worker_drop_older(w, r->kind, r->body_len);
    generation_state(&w->generations, r->kind, r->body_len);
    const uint32_t now = w->generations.now;
    p->built[now % GENERATIONS] = false;
    set_unfit(p, now, NULL);
    if (worker_loads(w, r)) {
        worker_builder_load(&p->builder, r, wire_body(&w->in, r));
        return;
    }
    if (w->ops->state(w->ctx, now, r->kind, NULL, r->body_len, w->refusal) != 0)
        die(ST_USAGE, "%s", w->refusal);
    resume(p);
}

/* Says of all waiting tasks of the generation why they cannot be done. */
static void fail_all(struct forks *p, uint32_t generation, const char *why)
{
    set_unfit(p, generation, why);
    for (int32_t i = p->any.head, next; i >= 0; i = next) {
        const struct task t = p->tasks.at[i].task;
        next = p->tasks.at[i].next;
        if (t.generation != generation) continue;
        worker_fail(p->w, &p->out.queue.control, &t, "w=0", why);
        list_remove(&p->tasks, &p->any, i);
        tasks_remove(&p->tasks, i);
    }
    for (int k = 0; k < p->n_slots; k++) worker_fork_fail(p, &p->slots[k], generation, why);
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
    bool asked = tasks_before(p, &next) > 0;
    if (b->failed == WORKER_REFUSED) {
        fail_all(p, b->generation, b->err);
        return;
    }
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
    t.generation = f->generation;
    const char *unfit = p->unfit[t.generation % GENERATIONS];
    if (unfit) {
        char w[24];
        snprintf(w, sizeof w, "w=%d", t.to >= 0 && t.to < p->n_slots ? t.to : 0);
        worker_fail(p->w, &p->out.queue.control, &t, w, unfit);
        return;
    }
    if (!worker_forks_built(p, t.generation)) want(p, f);
    if (t.to >= 0 && t.to < p->n_slots) worker_fork_give(p, &t, f->w);
    else if (tasks_find(&p->tasks, t.frame, t.id) < 0)
        list_push_back(&p->tasks, &p->any, tasks_add(&p->tasks, &t, f->w));
}

/* Gives tasks without a slot to those that have the fewest. */
static void assign(struct forks *p)
{
    for (int ahead = 0; ahead < AHEAD; ahead++)
        for (int k = 0; k < p->n_slots && p->any.count; k++) {
            struct fork_slot *s = &p->slots[k];
            int32_t i = p->any.head;
            struct task_entry e = p->tasks.at[i];
            if (!worker_forks_built(p, e.task.generation)) return;
            if (!worker_fork_wants(p, s, ahead, e.task.generation)) continue;
            list_remove(&p->tasks, &p->any, i);
            tasks_remove(&p->tasks, i);
            worker_fork_add(s, &e.task, e.frame_w, s->number);
        }
}

static void take_flush(struct forks *p, const struct record *r)
{
    const int32_t to = r->task.to;
    bool all = to < 0 || (to < p->n_slots && p->slots[to].lent);
    for (int k = 0; k < p->n_slots; k++) p->slots[k].flush |= all || to == k;
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
    case REC_VIEW:
    case REC_FILES: break;
    case REC_BYE: worker_dismissed(); /* its children end with it */
    default: worker_refuse(r);
    }
    p->held = *r;
    p->holds = true;
    p->flushed = false;
    return STREAM_HOLD;
}

/* ---- the loop ------------------------------------------------------------------------------- */

static bool has_child(const struct forks *p)
{
    for (int k = 0; k < p->n_slots; k++)
        if (p->slots[k].child.pid) return true;
    return false;
}

static bool has_work(const struct forks *p)
{
    return p->builder.busy || p->holds || tasks_before(p, NULL);
}

static size_t fill_poll(struct forks *p, struct pollfd *at)
{
    bool reading = p->in_open && !p->holds && tasks_waiting(p) < TASKS_MOST;
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
    if (!listening) p->looked_us = 0; /* their silence does not count */
    return n;
}

/* As long as there is work, the reader knows that this process lives; it watches its children
 * itself. */
static void beat(struct forks *p, int64_t now)
{
    outlet_beat_within(&p->out, &p->w->in);
    if (now - p->beat_us < PATIENCE_BEAT_US || !has_work(p)) return;
    p->beat_us = now;
    wire_plain(&p->out.queue.control, REC_BEAT, NULL);
}

static void go_round(struct forks *p, struct pollfd *at)
{
    p->forked = 0;
    assign(p);
    for (int k = 0; k < p->n_slots; k++) worker_fork_feed(p, &p->slots[k]);
    for (int k = 0; k < p->n_slots; k++) worker_fork_lend(p, &p->slots[k]);
    size_t n = fill_poll(p, at);
    int wait_ms = has_work(p) || (!p->in_open && has_child(p)) ? ROUND_MS : -1;
    if (signals_poll(at, n, p->forked == FORKS_MOST ? 0 : wait_ms) < 0) {
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
        for (size_t i = 0; i < n; i++) at[i].revents = 0;
    }
    int64_t now = now_us(), elapsed_us = p->looked_us ? now - p->looked_us : 0;
    p->looked_us = now;
    outlet_polled(&p->out, &at[1]);
    if (p->out.gone) return;
    if (at[0].revents) {
        p->refused = stream_input(&p->w->in, &p->in_open, take, p);
        if (!p->holds) worker_consider(p->w);
    }
    if (at[2].revents) joined(p);
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *s = &p->slots[k];
        if (s->poll && at[s->poll + 1].revents) worker_fork_listen(p, s);
        worker_fork_check(p, s, elapsed_us);
    }
    proceed(p);
    beat(p, now);
    outlet_push(&p->out);
}

static bool goes_on(const struct forks *p)
{
    if (p->out.gone || p->refused || signals_came()) return false;
    return p->in_open || has_work(p) || p->wants || has_child(p);
}

int worker_forks(struct worker *w)
{
    struct forks p = {.w = w, .n_slots = w->options->jobs, .any = TASK_LIST_EMPTY, .in_open = true};
    signals_catch();
    want_descriptors(2 * p.n_slots + 16);
    p.slots = xcalloc((size_t)p.n_slots, sizeof *p.slots);
    for (int k = 0; k < p.n_slots; k++) worker_fork_open(&p.slots[k], k);
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
    for (int g = 0; g < GENERATIONS; g++) free(p.unfit[g]);
    worker_builder_close(&p.builder);
    tasks_free(&p.tasks);
    up_free(&p.out.queue);
    free(p.slots);
    free(at);
    return p.out.gone ? ST_SYSTEM : p.refused;
}
