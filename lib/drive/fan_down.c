/*
 * fan: what comes down. State goes to all slots, a task to one; a bad input ends the run. The
 * latest state and its frames are kept for slots that come later.
 */
#include "drive/fan_int.h"

#include <unistd.h>

/* What may wait in the queue of one slot, then the input has to wait. State is kept once for all
 * slots, so it is the number of its records that counts. */
#define STATES_MOST 16
#define LATE_QUEUE_MOST (64 << 20) /* bytes of tasks for a slot that was not up yet */

bool fan_room_down(const struct fan *f)
{
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        size_t most = slot_fed(s) ? DOWN_QUEUE_MOST : LATE_QUEUE_MOST;
        if (buf_size(&s->down.bytes) > most || down_blobs(&s->down) > STATES_MOST) return false;
    }
    return true;
}

bool fan_takes(const struct fan_slot *s) { return s->primed && (!slot_fed(s) || s->child.to >= 0); }

void fan_prime(struct fan *f, struct fan_slot *s)
{
    for (size_t i = 0; i < sizeof f->state / sizeof *f->state; i++)
        if (f->state[i]) down_share(&s->down, f->state[i]);
    down_append(&s->down, buf_data(&f->frame_lines), buf_size(&f->frame_lines));
    s->primed = s->loading = true;
}

static void route_state(struct fan *f, const struct record *r)
{
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    struct blob *b = blob_new(&bytes), **kept = &f->state[r->kind - REC_SCENE];
    /* What is announced from now on belongs to other state, and no slot is told of it that comes
     * too late for the old one. */
    for (size_t i = 0; i < f->frames.n; i++) f->frames.at[i].said = false;
    if (*kept) buf_consume(&f->frame_lines, buf_size(&f->frame_lines));
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (!fan_takes(s)) continue;
        down_share(&s->down, b);
        s->loading = true;
    }
    if (*kept) blob_drop(*kept);
    *kept = b;
}

/* A frame or a flush. */
static void route_small(struct fan *f, const struct record *r)
{
    static const char *const drop[] = {"to", NULL};
    buf_consume(&f->line, buf_size(&f->line));
    wire_forward(&f->line, r, drop, NULL);
    if (r->kind == REC_FRAME) buf_append(&f->frame_lines, buf_data(&f->line), buf_size(&f->line));
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (!fan_takes(s) || (r->task.to >= 0 && r->task.to != k)) continue;
        down_append(&s->down, buf_data(&f->line), buf_size(&f->line));
        if (r->kind == REC_FLUSH) s->flushed = true;
    }
}

static int route_task(struct fan *f, const struct record *r)
{
    const struct task *t = &r->task;
    const struct frame_size *frame = stream_frame_of(&f->frames, r);
    if (!frame) return ST_USAGE;
    if (t->to >= f->n_slots) {
        warn("task %u %u: to=%d, expected a slot below %d", t->frame, t->id, t->to, f->n_slots);
        return ST_USAGE;
    }
    return slot_send(f, t->to >= 0 ? t->to : (int)(t->id % (uint32_t)f->n_slots), r, frame);
}

/* What the hub of a ring says to one node. Who is not up hears nothing: it is told its place when
 * it is. */
static int route_ring(struct fan *f, const struct record *r)
{
    static const char *const drop[] = {"to", NULL};
    int k = r->task.to;
    if (k < 0 || k >= f->n_slots) {
        warn("record `%s`: expected to=K, a slot below %d", rec_name(r->kind), f->n_slots);
        return ST_USAGE;
    }
    struct fan_slot *s = &f->slots[k];
    if (s->state != FAN_UP || !fan_takes(s)) return 0;
    s->placed |= r->kind == REC_RING;
    s->ahead--;
    wire_forward(&s->down.bytes, r, drop, NULL);
    return 0;
}

static int route(void *ctx, const struct record *r)
{
    struct fan *f = ctx;
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC: route_state(f, r); return 0;
    case REC_FRAME:
        frames_set(&f->frames, r->task.frame, r->frame_w, r->frame_h);
        route_small(f, r);
        return 0;
    case REC_FLUSH: route_small(f, r); return 0;
    case REC_TASK: return route_task(f, r);
    case REC_RING:
    case REC_HEIR:
    case REC_ASK:
    case REC_NONE: return route_ring(f, r);
    default:
        warn(
            "standard input: record `%s`, expected state, frame, task or flush", rec_name(r->kind));
        return ST_USAGE;
    }
}

void fan_take_input(struct fan *f)
{
    f->refused = stream_input(&f->in, &f->in_open, route, f);
    outlet_beat(&f->out, &f->in);
}
