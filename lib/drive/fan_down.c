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

#define KINDS 3 /* of state */

void fan_forget(struct fan_state_of *state)
{
    for (int i = 0; i < KINDS; i++)
        if (state->kind[i]) blob_drop(state->kind[i]);
    buf_free(&state->frame_lines);
    *state = (struct fan_state_of){0};
}

/* Slot s, which has this state already, or none (NULL), is sent that one. */
static void send_state(
    struct fan_slot *s, const struct fan_state_of *has, const struct fan_state_of *state)
{
    for (int i = 0; i < KINDS; i++)
        if (state->kind[i] && !(has && has->kind[i] == state->kind[i]))
            down_share(&s->down, state->kind[i]);
    down_append(&s->down, buf_data(&state->frame_lines), buf_size(&state->frame_lines));
}

/*
 * A task of the state before the latest, for a slot that was not sent that: it is sent both, in
 * their order, so that the worker's latest is the latest again.
 */
void fan_prime(struct fan *f, struct fan_slot *s, uint32_t generation)
{
    uint32_t now = f->input.generations.now;
    const struct fan_state_of *latest = &f->states[now & 1], *before = &f->states[~now & 1];
    const struct fan_state_of *has = s->primed ? latest : NULL;
    if (generation != now) {
        send_state(s, has, before);
        has = before;
    }
    send_state(s, has, latest);
    s->since = generation;
    s->primed = s->loading = true;
}

/* Once the latest state has tasks, those of the one before were all given to somebody: they come
 * only where that one is lost. */
void fan_prime_early(struct fan *f, struct fan_slot *s)
{
    uint32_t now = f->input.generations.now;
    fan_prime(f, s, f->begun ? now : now - 1);
}

/* A generation begins with all that the one before has, and the one before that goes. */
static void begin_generation(struct fan *f)
{
    uint32_t now = f->input.generations.now;
    struct fan_state_of *latest = &f->states[now & 1];
    f->begun = false;
    fan_forget(latest);
    for (int i = 0; i < KINDS; i++) {
        latest->kind[i] = f->states[~now & 1].kind[i];
        if (latest->kind[i]) latest->kind[i]->users++;
    }
}

static void route_state(struct fan *f, const struct record *r)
{
    struct generations *g = &f->input.generations;
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    bool begins = generation_ends(g, r->kind);
    generation_state(g, r->kind);
    if (begins) begin_generation(f);
    struct blob *b = blob_new(&bytes), **kept = &f->states[g->now & 1].kind[r->kind - REC_SCENE];
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
    struct buf *lines = &f->states[f->input.generations.now & 1].frame_lines;
    if (r->kind == REC_FRAME) buf_append(lines, buf_data(&f->line), buf_size(&f->line));
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
    const struct frame_size *frame = stream_frame_of(&f->input, r);
    if (!frame) return ST_USAGE;
    if (t->to >= f->n_slots) {
        warn("task %u %u: to=%d, expected a slot below %d", t->frame, t->id, t->to, f->n_slots);
        return ST_USAGE;
    }
    f->asked = true;
    f->begun |= frame->generation == f->input.generations.now;
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
        stream_frame(&f->input, r);
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
