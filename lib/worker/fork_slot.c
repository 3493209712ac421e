/*
 * forks: the life of a child. It is a fork of the parent, made when a task needs it, and runs
 * worker_loop with the state that the parent had then. It gets frames, tasks and flushes only.
 * For tasks of later state it is replaced: its input ends, it finishes what it has, and the parent
 * forks another. If it dies, or is silent, the parent forks another one for its tasks.
 * A task over which LOSSES_MOST of them are lost fails.
 * One machine with forks.c and worker.c.
 */
#include "patience/patience.h"
#include "worker/worker_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/wait.h>

#define LOSSES_MOST 2 /* children lost over a task: it is no accident */

static struct fork_task *extra(const struct fork_slot *s, int32_t i)
{
    return tasks_extra(&s->tasks, i);
}

static const char *stamp(char w[24], int slot)
{
    snprintf(w, 24, "w=%d", slot);
    return w;
}

void worker_fork_open(struct fork_slot *s, int number)
{
    *s = (struct fork_slot){
        .number = number, .child = CHILD_NONE, .waiting = TASK_LIST_EMPTY, .sent = TASK_LIST_EMPTY};
    tasks_init(&s->tasks, sizeof(struct fork_task));
}

/* The child has ended. */
static void settle(struct fork_slot *s)
{
    child_end(&s->child, 0);
    wire_free(&s->from);
    down_free(&s->to);
    s->ends = s->flushed = false;
    s->undone = 0;
    s->silent_us = 0;
}

void worker_fork_free(struct fork_slot *s)
{
    settle(s);
    tasks_free(&s->tasks);
}

bool worker_fork_add(struct fork_slot *s, const struct task *t, uint32_t frame_w, int of)
{
    if (tasks_find(&s->tasks, t->frame, t->id) >= 0) return false;
    int32_t i = tasks_add(&s->tasks, t, frame_w);
    extra(s, i)->of = of;
    list_push_back(&s->tasks, &s->waiting, i);
    return true;
}

void worker_fork_give(struct forks *p, const struct task *t, uint32_t frame_w)
{
    struct fork_slot *s = &p->slots[t->to];
    if (worker_fork_add(s, t, frame_w, s->number)) return;
    /* Another slot, which has no child, may have lent the task to this one, and wait for it. */
    int of = extra(s, tasks_find(&s->tasks, t->frame, t->id))->of;
    if (of != s->number) worker_fork_add(&p->slots[of], t, frame_w, s->number);
}

/* ---- down ----------------------------------------------------------------------------------- */

static int render(void *ctx)
{
    struct worker *w = ctx;
    w->in = (struct decoder){0};
    w->out = w->held = (struct buf){0};
    w->cpu_us = w->ops->cpu_us ? w->ops->cpu_us(w->ctx) : cpu_us();
    worker_loop(w);
    return ST_OK;
}

static bool start(struct forks *p, struct fork_slot *s)
{
    static bool said;
    uint32_t now = p->w->generations.now;
    if (p->forked >= FORKS_MOST) return false;
    p->forked++;
    if (child_fork(&s->child, render, p->w) != 0) {
        int err = errno, others = 0;
        p->forked = FORKS_MOST + 1; /* the next round tries again, after a pause */
        for (int k = 0; k < p->n_slots; k++) others += p->slots[k].child.pid > 0;
        errno = err;
        if (!others) die(ST_SYSTEM, "fork:");
        if (!said) warn("slot %d: %s; other slots take its tasks", s->number, strerror(err));
        said = s->refused = true;
        return false;
    }
    s->refused = false;
    s->from = (struct decoder){.upward = true, .unsummed = true};
    s->generation = worker_forks_built(p, now) ? now : now - 1;
    return true;
}

static bool fits(const struct fork_slot *s, uint32_t generation)
{
    return s->child.pid && !s->ends && (int32_t)(s->generation - generation) >= 0;
}

bool worker_fork_wants(
    const struct forks *p, const struct fork_slot *s, int ahead, uint32_t generation)
{
    bool replaced = s->child.pid && !fits(s, generation);
    if (!s->child.pid && p->builder.busy) return false;
    return s->undone + s->waiting.count <= (replaced ? 0 : ahead);
}

/* Gives task i of slot s to the slot with the fewest that can take it. */
static bool lend(struct forks *p, struct fork_slot *s, int32_t i)
{
    const struct task_entry e = s->tasks.at[i];
    struct fork_slot *to = NULL;
    for (int k = 0; k < p->n_slots; k++) {
        struct fork_slot *o = &p->slots[k];
        if (!fits(o, e.task.generation)) continue;
        int32_t same = tasks_find(&o->tasks, e.task.frame, e.task.id);
        if (same >= 0) { /* it can take the task when the pixels of its own copy are here */
            o->flush |= extra(o, same)->again && !o->flushed;
            continue;
        }
        if (!to || o->undone + o->waiting.count < to->undone + to->waiting.count) to = o;
    }
    return to && worker_fork_add(to, &e.task, e.frame_w, extra(s, i)->of);
}

void worker_fork_fail(struct forks *p, struct fork_slot *s, uint32_t generation, const char *why)
{
    char w[24];
    for (int32_t i = s->waiting.head, next; i >= 0; i = next) {
        next = s->tasks.at[i].next;
        const struct task t = s->tasks.at[i].task;
        if (t.generation != generation) continue;
        worker_fail(p->w, &p->out.queue.control, &t, stamp(w, extra(s, i)->of), why);
        list_remove(&s->tasks, &s->waiting, i);
        tasks_remove(&s->tasks, i);
    }
}

void worker_fork_lend(struct forks *p, struct fork_slot *s)
{
    if (!s->refused || s->child.pid) return;
    for (int32_t i = s->waiting.head, next; i >= 0; i = next) {
        next = s->tasks.at[i].next;
        if (!lend(p, s, i)) continue;
        p->slots[extra(s, i)->of].lent = true;
        list_remove(&s->tasks, &s->waiting, i);
        tasks_remove(&s->tasks, i);
    }
}

/* True if the child can take tasks of the generation. */
static bool prepare(struct forks *p, struct fork_slot *s, uint32_t generation)
{
    if (!s->child.pid) return !p->builder.busy && start(p, s);
    s->ends |= !fits(s, generation);
    return !s->ends;
}

static void send(struct fork_slot *s, int32_t i)
{
    struct task t = s->tasks.at[i].task;
    list_remove(&s->tasks, &s->waiting, i);
    list_push_back(&s->tasks, &s->sent, i);
    extra(s, i)->again = false;
    s->undone++;
    s->flushed = false;
    t.to = -1;
    wire_task(&s->to.bytes, &t);
}

/* Ends the child if it is idle and no task can come for it: later state is built, or the input
 * has ended. */
static void end_idle(const struct forks *p, struct fork_slot *s)
{
    uint32_t now = p->w->generations.now;
    bool over = !p->in_open && !p->holds && !p->any.count;
    bool old = s->generation != now && worker_forks_built(p, now);
    if (s->child.pid && !s->undone && !s->waiting.count) s->ends |= over || old;
}

void worker_fork_feed(struct forks *p, struct fork_slot *s)
{
    for (int32_t i; (i = s->waiting.head) >= 0; send(s, i)) {
        uint32_t generation = s->tasks.at[i].task.generation;
        if (!worker_forks_built(p, generation) || !prepare(p, s, generation)) break;
    }
    if (s->flush && !s->waiting.count && !p->any.count) {
        if (s->child.pid && !s->ends) {
            wire_plain(&s->to.bytes, REC_FLUSH, NULL);
            s->flushed = true;
        }
        s->flush = false;
    }
    end_idle(p, s);
    if (s->child.to < 0) return;
    /* If it reads no more, the end of its output will explain why. */
    if (down_write(&s->to, s->child.to) != 0) down_free(&s->to);
    if (s->ends && !down_size(&s->to)) child_close(&s->child.to);
}

/* ---- the loss of a child -------------------------------------------------------------------- */

/* Task i, which was sent, leaves the table. */
static void drop(struct fork_slot *s, int32_t i)
{
    list_remove(&s->tasks, &s->sent, i);
    tasks_remove(&s->tasks, i);
}

/* Task i cannot be computed: says so, in the words of the child's own record, if it sent one. */
static void fail(
    struct forks *p, struct fork_slot *s, int32_t i, const char *why, const struct record *r)
{
    char w[24];
    if (extra(s, i)->computed)
        die(ST_SYSTEM, "slot %d: lost (%s) with pixels that it had computed", s->number, why);
    stamp(w, extra(s, i)->of);
    if (r) wire_forward(&p->out.queue.control, r, NULL, w);
    else wire_failed(&p->out.queue.control, &s->tasks.at[i].task, why, "", w);
    p->w->failed = true;
    drop(s, i);
}

/* The task that the child was computing, or the first one whose pixels are missing; -1: none. */
static int32_t current(const struct fork_slot *s)
{
    int32_t i = s->sent.head;
    while (i >= 0 && extra(s, i)->again) i = s->tasks.at[i].next;
    return i >= 0 ? i : s->sent.head;
}

/* Its tasks wait again, for another child. */
static void lose(struct forks *p, struct fork_slot *s, const char *why)
{
    int32_t suspect = current(s);
    if (suspect >= 0) {
        s->flush = true; /* it may have been asked before it was lost */
        warn("slot %d: lost (%s) with %d tasks, forked again%s", s->number, why, s->sent.count,
            status_hint(why));
        if (++extra(s, suspect)->losses >= LOSSES_MOST) fail(p, s, suspect, why, NULL);
    }
    settle(s);
    for (int32_t i; (i = s->sent.tail) >= 0;) {
        list_remove(&s->tasks, &s->sent, i);
        list_push_front(&s->tasks, &s->waiting, i);
    }
}

/* ---- up ------------------------------------------------------------------------------------- */

static void complete(struct fork_slot *s, int32_t i)
{
    if (!extra(s, i)->again || !tasks_whole(&s->tasks, i)) return;
    drop(s, i);
}

/* A task that is computed again says `done` once only. */
static void take_done(struct forks *p, struct fork_slot *s, const struct record *r)
{
    char w[24];
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i < 0 || extra(s, i)->again) return;
    extra(s, i)->again = true;
    s->undone--;
    if (!extra(s, i)->computed)
        wire_forward(&p->out.queue.control, r, NULL, stamp(w, extra(s, i)->of));
    extra(s, i)->computed = true;
    complete(s, i);
}

/* The child cannot compute the task, and goes on. */
static void take_fail(struct forks *p, struct fork_slot *s, const struct record *r)
{
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i < 0 || extra(s, i)->again || extra(s, i)->computed) return;
    s->undone--;
    fail(p, s, i, "", r);
}

/* Pixels that a child before had sent are dropped. */
static const char *take_frag(struct forks *p, struct fork_slot *s, const struct record *r)
{
    char w[24];
    int32_t i = tasks_find(&s->tasks, r->task.frame, r->task.id);
    if (i < 0) return NULL;
    uint64_t before = s->tasks.at[i].delivered;
    if (!tasks_deliver(&s->tasks, i, &r->task.at)) return "wrong-pixels";
    if (s->tasks.at[i].delivered > before)
        up_forward(&p->out.queue, r, NULL, stamp(w, extra(s, i)->of));
    complete(s, i);
    return NULL;
}

static const char *take(struct forks *p, struct fork_slot *s, const struct record *r)
{
    char w[24];
    switch (r->kind) {
    case REC_FRAME: /* the parent has said it */
    case REC_BYE: return NULL;
    case REC_BEAT: wire_forward(&p->out.queue.control, r, NULL, stamp(w, s->number)); return NULL;
    case REC_DONE: take_done(p, s, r); return NULL;
    case REC_FAIL: take_fail(p, s, r); return NULL;
    case REC_FRAG: return take_frag(p, s, r);
    default: return "wrong-record";
    }
}

void worker_fork_listen(struct forks *p, struct fork_slot *s)
{
    int more = stream_read(&s->from, s->child.from);
    struct record r;
    enum wire_result result;
    const char *why = NULL;
    s->silent_us = 0;
    while (!why && (result = wire_next(&s->from, &r)) != WIRE_MORE) {
        if (result == WIRE_RECORD) why = take(p, s, &r);
        else if (!s->from.ended) why = "garbage";
    }
    if (why) lose(p, s, why);
    else if (more <= 0) child_close(&s->child.from);
}

/* True if the child is to say something, or to end. */
static bool owes(const struct fork_slot *s)
{
    return s->undone || (s->flushed && s->sent.count) || s->ends || s->child.from < 0;
}

void worker_fork_check(struct forks *p, struct fork_slot *s, int64_t elapsed_us)
{
    char why[24];
    int status;
    if (!s->child.pid) return;
    if (owes(s)) s->silent_us += elapsed_us < PATIENCE_PARENT_US ? elapsed_us : PATIENCE_PARENT_US;
    if (s->silent_us > PATIENCE_SILENCE_US) {
        lose(p, s, "silent");
        return;
    }
    if (s->child.from >= 0) return;
    bool told = s->ends && s->child.to < 0;
    if (!child_ended(&s->child, &status)) return;
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (told && !s->sent.count && code == 0) settle(s);
    else lose(p, s, status_text(status, why));
}
