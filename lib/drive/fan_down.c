/* fan: what comes down. State goes to all slots, a task to one; a bad input ends the run. */
#include "drive/fan_int.h"

#include <unistd.h>

static void route_state(struct fan *f, const struct record *r)
{
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    struct blob *b = blob_new(&bytes);
    for (int k = 0; k < f->o->slots; k++)
        if (f->slots[k].child.to >= 0) down_share(&f->slots[k].down, b);
    blob_drop(b);
}

static void route_small(struct fan *f, const struct record *r)
{
    static const char *const drop[] = {"to", NULL};
    buf_consume(&f->line, buf_size(&f->line));
    wire_forward(&f->line, r, drop, NULL);
    for (int k = 0; k < f->o->slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (s->child.to < 0 || (r->task.to >= 0 && r->task.to != k)) continue;
        down_append(&s->down, buf_data(&f->line), buf_size(&f->line));
        if (r->kind == REC_FLUSH) s->flushed = true;
    }
}

static int route_task(struct fan *f, const struct record *r)
{
    const struct task *t = &r->task;
    const struct frame_size *frame = stream_frame_of(&f->frames, r);
    if (!frame) return ST_USAGE;
    if (t->to >= f->o->slots) {
        warn("task %u %u: to=%d, expected a slot below %d", t->frame, t->id, t->to, f->o->slots);
        return ST_USAGE;
    }
    return slot_send(f, t->to >= 0 ? t->to : (int)(t->id % (uint32_t)f->o->slots), r, frame);
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
    default:
        warn(
            "standard input: record `%s`, expected state, frame, task or flush", rec_name(r->kind));
        return ST_USAGE;
    }
}

void fan_take_input(struct fan *f) { f->refused = stream_input(&f->in, &f->in_open, route, f); }
