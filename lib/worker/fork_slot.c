/*
 * forks: the life of a child. It is a fork of the parent, made when a task needs it, and runs
 * worker_loop with the state that the parent had then. It gets frames, tasks and flushes only.
 * For tasks of later state it is replaced: its input ends, it finishes what it has, and the parent
 * forks another. If it dies, its slot is `gone` with all of its tasks, and `up` again: the program
 * that sent the tasks gives them once more, as after the loss of any worker.
 */
#include "worker/worker_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/wait.h>

#define DEATHS_MOST 5 /* in a row, without a computed task: it is no accident */

static size_t tasks_in(const struct buf *b) { return buf_size(b) / sizeof(struct task); }

/* The first task of b, which has one. */
static struct task first(const struct buf *b)
{
    struct task t;
    memcpy(&t, buf_data(b), sizeof t);
    return t;
}

/* The child has ended. */
static void settle(struct fork_slot *s)
{
    child_end(&s->child, 0);
    wire_free(&s->from);
    down_free(&s->to);
    buf_free(&s->sent);
    s->ends = false;
}

void worker_fork_free(struct fork_slot *s)
{
    settle(s);
    buf_free(&s->waiting);
}

/* ---- the loss of a child -------------------------------------------------------------------- */

static void say(struct forks *p, enum rec_kind kind, const char *text)
{
    wire_plain(&p->out.queue.bulk, kind, text);
    up_end_record(&p->out.queue);
}

/* The slot is gone, with all of its tasks, computed ones that it holds back as well. */
static void lose(struct forks *p, struct fork_slot *s, const char *why)
{
    char text[96];
    snprintf(text, sizeof text, "w=%d why=%s lost=%zu", s->number, why,
        tasks_in(&s->sent) + tasks_in(&s->waiting));
    say(p, REC_GONE, text);
    p->lost = true;
    buf_free(&s->waiting);
    settle(s);
}

/* It can have another child. */
static void lose_child(struct forks *p, struct fork_slot *s, const char *why)
{
    char text[64] = "";
    const size_t n = tasks_in(&s->sent);
    const struct task t = n ? first(&s->sent) : (struct task){0};
    if (n) snprintf(text, sizeof text, " in task %" PRIu32 " %" PRIu32, t.frame, t.id);
    warn("slot %d: lost (%s)%s with %zu tasks, forked again", s->number, why, text, n);
    if (++s->deaths >= DEATHS_MOST)
        die(ST_SYSTEM, "slot %d: lost %d times in a row", s->number, s->deaths);
    lose(p, s, why);
    snprintf(text, sizeof text, "w=%d host=: power=%.6g slots=1", s->number, p->w->power);
    say(p, REC_UP, text);
}

/* The system refuses a child. Without a process the slot stays gone. */
static void leave_out(struct forks *p, struct fork_slot *s)
{
    int err = errno, others = 0;
    for (int k = 0; k < p->n_slots; k++) others += p->slots[k].child.pid > 0;
    errno = err;
    if (!others) die(ST_SYSTEM, "fork:");
    warn("slot %d: %s; the run goes on without it", s->number, strerror(err));
    s->out = true;
    lose(p, s, "not-forked");
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
    uint32_t now = p->w->generations.now;
    if (p->forked >= FORKS_MOST) return false;
    p->forked++;
    if (child_fork(&s->child, render, p->w) != 0) {
        leave_out(p, s);
        return false;
    }
    s->from = (struct decoder){.upward = true, .unsummed = true};
    s->generation = worker_forks_built(p, now) ? now : now - 1;
    return true;
}

static bool fits(const struct fork_slot *s, uint32_t generation)
{
    return s->child.pid && !s->ends && (int32_t)(s->generation - generation) >= 0;
}

bool worker_fork_wants(
    const struct forks *p, const struct fork_slot *s, size_t ahead, uint32_t generation)
{
    bool replaced = s->child.pid && !fits(s, generation);
    if (s->out || (!s->child.pid && p->builder.busy)) return false;
    return tasks_in(&s->sent) + tasks_in(&s->waiting) <= (replaced ? 0 : ahead);
}

/* True if the child can take tasks of the generation. */
static bool prepare(struct forks *p, struct fork_slot *s, uint32_t generation)
{
    if (!s->child.pid) return !p->builder.busy && start(p, s);
    s->ends |= !fits(s, generation);
    return !s->ends;
}

static void send(struct fork_slot *s)
{
    struct task t = first(&s->waiting);
    buf_consume(&s->waiting, sizeof t);
    buf_append(&s->sent, &t, sizeof t);
    t.to = -1;
    wire_task(&s->to.bytes, &t);
}

/* Ends the child if it is idle and no task can come for it: later state is built, or the input
 * has ended. */
static void end_idle(const struct forks *p, struct fork_slot *s)
{
    uint32_t now = p->w->generations.now;
    bool over = !p->in_open && !p->holds && !buf_size(&p->any);
    bool old = s->generation != now && worker_forks_built(p, now);
    if (s->child.pid && !buf_size(&s->sent) && !buf_size(&s->waiting)) s->ends |= over || old;
}

void worker_fork_feed(struct forks *p, struct fork_slot *s)
{
    for (; buf_size(&s->waiting); send(s)) {
        uint32_t generation = first(&s->waiting).generation;
        if (!worker_forks_built(p, generation) || !prepare(p, s, generation)) break;
    }
    if (s->flush && !buf_size(&s->waiting) && !buf_size(&p->any)) {
        if (s->child.pid && !s->ends) wire_plain(&s->to.bytes, REC_FLUSH, NULL);
        s->flush = false;
    }
    end_idle(p, s);
    if (s->child.to < 0) return;
    /* If it reads no more, the end of its output will explain why. */
    if (down_write(&s->to, s->child.to) != 0) down_free(&s->to);
    if (s->ends && !down_size(&s->to)) child_close(&s->child.to);
}

/* ---- up ------------------------------------------------------------------------------------- */

static const char *stamp(const struct fork_slot *s, char w[24])
{
    snprintf(w, 24, "w=%d", s->number);
    return w;
}

/* It renders its tasks in order. */
static const char *take_done(struct forks *p, struct fork_slot *s, const struct record *r)
{
    char w[24];
    const struct task t = buf_size(&s->sent) ? first(&s->sent) : (struct task){0};
    if (!buf_size(&s->sent) || t.frame != r->task.frame || t.id != r->task.id) return "wrong-task";
    buf_consume(&s->sent, sizeof t);
    s->deaths = 0;
    wire_forward(&p->out.queue.control, r, NULL, stamp(s, w));
    return NULL;
}

/* While the parent waits for children and reads nothing, the beat of one is that of all slots,
 * because their tasks may be unread. */
static void take_beat(struct forks *p, const struct fork_slot *s, const struct record *r)
{
    char w[24];
    wire_forward(&p->out.queue.control, r, NULL, p->holds ? NULL : stamp(s, w));
}

static const char *take(struct forks *p, struct fork_slot *s, const struct record *r)
{
    char w[24];
    switch (r->kind) {
    case REC_FRAME: /* the parent has said it */
    case REC_BYE: return NULL;
    case REC_BEAT: take_beat(p, s, r); return NULL;
    case REC_DONE: return take_done(p, s, r);
    case REC_FRAG: up_forward(&p->out.queue, r, NULL, stamp(s, w)); return NULL;
    default: return "wrong-record";
    }
}

void worker_fork_listen(struct forks *p, struct fork_slot *s)
{
    int more = stream_read(&s->from, s->child.from);
    struct record r;
    enum wire_result result;
    const char *why = NULL;
    while (!why && (result = wire_next(&s->from, &r)) != WIRE_MORE) {
        if (result == WIRE_RECORD) why = take(p, s, &r);
        else if (!s->from.ended) why = "garbage";
    }
    if (why) lose_child(p, s, why);
    else if (more <= 0) child_close(&s->child.from);
}

void worker_fork_check(struct forks *p, struct fork_slot *s)
{
    char why[24];
    int status;
    if (!s->child.pid || s->child.from >= 0) return;
    bool told = s->ends && s->child.to < 0;
    if (!child_ended(&s->child, &status)) return;
    if (!told || buf_size(&s->sent) || status != 0) lose_child(p, s, status_text(status, why));
    else settle(s);
}
