/*
 * fan: records from the input. State goes to all slots, a task to one; a bad input ends the run.
 * The live states and their frames are kept for slots that come later.
 */
#include "fan/fan_int.h"

#include <inttypes.h>
#include <unistd.h>

/* Limits on the queue of one slot; beyond them the input waits. State is kept once for all
 * slots, so a queue may hold many records, or long ones, but not both. A slot that lags gets no
 * more state before its next task (leave_behind), so that the others do not wait. */
#define STATES_MOST (4 * GENERATIONS)
#define LAG_MOST (2 * GENERATIONS)
#define LONG_STATES_MOST 16 /* likewise, if they have more than LONG_BYTES */
#define LONG_LAG_MOST 8     /* likewise */
#define LONG_BYTES STATE_BYTES
#define LATE_QUEUE_MOST (64 << 20) /* bytes of tasks for a slot that was not up yet */

static bool too_many(const struct down_queue *q, size_t most, size_t long_most)
{
    size_t n = down_blobs(q);
    return n >= most || (n >= long_most && q->blob_bytes > LONG_BYTES);
}

bool fan_room_down(const struct fan *f)
{
    for (int k = 0; k < f->n_slots; k++) {
        const struct fan_slot *s = &f->slots[k];
        size_t most = fan_slot_fed(s) ? DOWN_QUEUE_MOST : LATE_QUEUE_MOST;
        if (buf_size(&s->feed.queue.bytes) > most) return false;
        if (too_many(&s->feed.queue, STATES_MOST, LONG_STATES_MOST)) return false;
    }
    return true;
}

/* A new generation inherits all state of the previous one. */
static void begin_generation(struct fan *f)
{
    uint32_t now = f->input.generations.now;
    struct fan_state_of *latest = &f->states[now % GENERATIONS];
    const struct fan_state_of *before = &f->states[(now - 1) % GENERATIONS];
    f->begun = false;
    fan_forget(latest);
    for (int i = 0; i < WIRE_STATE_KINDS; i++) {
        latest->kind[i] = before->kind[i];
        latest->number[i] = before->number[i];
        if (latest->kind[i]) latest->kind[i]->users++;
    }
}

/* A slot that lags reads nothing, or has a slow link, while others have gone on. It gets no more
 * state until it has a task again, so that no slot waits for it. */
static void leave_behind(struct fan *f)
{
    for (int k = 0; k < f->n_slots; k++)
        f->slots[k].feed.behind |= too_many(&f->slots[k].feed.queue, LAG_MOST, LONG_LAG_MOST);
}

static void route_state(struct fan *f, const struct record *r)
{
    struct generations *g = &f->input.generations;
    struct buf bytes = {0};
    wire_forward(&bytes, r, NULL, NULL);
    bool begins = generation_ends(g, r->kind);
    uint32_t forgotten = g->oldest;
    generation_state(g, r->kind, r->body_len);
    for (; forgotten != g->oldest; forgotten++) fan_forget(&f->states[forgotten % GENERATIONS]);
    if (begins) {
        begin_generation(f);
        leave_behind(f);
    }
    unsigned kind = r->kind - REC_SCENE;
    struct fan_state_of *latest = &f->states[g->now % GENERATIONS];
    struct blob *b = blob_new(&bytes), **kept = &latest->kind[kind];
    latest->number[kind] = ++f->n_states;
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        if (!fan_takes(s) || s->feed.behind) continue;
        down_share(&s->feed.queue, b);
        s->feed.sent[kind] = latest->number[kind];
        s->feed.loading = true;
    }
    if (*kept) blob_drop(*kept);
    *kept = b;
}

/* Routes a frame or a flush. */
static void route_small(struct fan *f, const struct record *r)
{
    struct buf *lines = &f->states[f->input.generations.now % GENERATIONS].frame_lines;
    if (r->kind == REC_FRAME) fan_pass_down(lines, r, f->slots, -1);
    for (int k = 0; k < f->n_slots; k++) {
        struct fan_slot *s = &f->slots[k];
        int32_t to = r->task.to - s->number;
        if (!fan_takes(s) || (r->task.to >= 0 && (to < 0 || to >= s->width))) continue;
        if (r->kind == REC_FRAME && s->feed.behind) continue;
        fan_pass_down(&s->feed.queue.bytes, r, s, r->task.to);
        if (r->kind == REC_FLUSH) s->feed.flushed = true;
    }
}

static int route_task(struct fan *f, const struct record *r)
{
    const struct task *t = &r->task;
    const struct frame_size *frame = stream_frame_of(&f->input, r);
    if (!frame) return ST_USAGE;
    int n = f->n_numbers;
    if (t->to >= n) {
        warn("task %u %u: to=%d, expected a slot below %d", t->frame, t->id, t->to, n);
        return ST_USAGE;
    }
    f->asked = true;
    f->begun |= frame->generation == f->input.generations.now;
    return fan_slot_send(f, t->to >= 0 ? t->to : (int)(t->id % (uint32_t)n), r, frame);
}

/* The input states the frame's job, or leaves it to the first slot. Workers announce a frame that
 * comes again, of the same size and state, only once: it keeps its job. */
static void route_frame(struct fan *f, const struct record *r)
{
    const struct frame_size *known = frames_find(&f->input.frames, r->task.frame);
    bool again = known && known->w == r->frame_w && known->h == r->frame_h &&
                 known->generation == f->input.generations.now;
    const struct fan_job before = again ? *fan_job(f, known) : (struct fan_job){.by = -1};
    struct fan_job *job = fan_job(f, stream_frame(&f->input, r));
    if (rec_str(r, "job", job->hash, sizeof job->hash)) {
        job->stated = true;
        job->by = -1;
    } else *job = before;
    f->n_frames++;
    route_small(f, r);
}

/* Routes a message of the hub to one node. A slot that is not up does not get it: it is told its
 * place when it comes up. */
static int route_ring(struct fan *f, const struct record *r)
{
    int k = r->task.to;
    if (k < 0 || k >= f->n_numbers) {
        warn("record `%s`: expected to=K, a slot below %d", rec_name(r->kind), f->n_numbers);
        return ST_USAGE;
    }
    struct fan_slot *s = fan_slot_of(f, k);
    if (s->width > 1) {
        warn("record `%s`: expected a worker for each slot, without -1", rec_name(r->kind));
        return ST_USAGE;
    }
    if (s->state != FAN_UP || !fan_takes(s)) return 0;
    f->ring = true;
    s->conn.placed |= r->kind == REC_RING;
    s->conn.ahead--;
    fan_pass_down(&s->feed.queue.bytes, r, s, k);
    return 0;
}

static int route_leave(struct fan *f, const struct record *r)
{
    if (r->task.to < f->n_numbers) {
        fan_dismiss(f, r->task.to);
        return 0;
    }
    warn("leave: to=%" PRId32 ", expected a slot below %d", r->task.to, f->n_numbers);
    return ST_USAGE;
}

static int route(void *ctx, const struct record *r)
{
    struct fan *f = ctx;
    switch (r->kind) {
    case REC_SCENE:
    case REC_GRID:
    case REC_SPEC:
    case REC_VIEW:
    case REC_FILES: route_state(f, r); return 0;
    case REC_FRAME: route_frame(f, r); return 0;
    case REC_FLUSH:
        route_small(f, r);
        if (r->task.to < 0) outlet_answer(&f->out);
        return 0;
    case REC_TASK: return route_task(f, r);
    case REC_CODE: outlet_code(&f->out, r); return 0;
    case REC_RING:
    case REC_HEIR:
    case REC_ASK:
    case REC_NONE: return route_ring(f, r);
    case REC_JOINS: f->joins = true; return 0;
    case REC_LEAVE: return route_leave(f, r);
    case REC_BYE: f->dismissed = true; return 0;
    default:
        warn(
            "standard input: record `%s`, expected state, frame, task or flush", rec_name(r->kind));
        return ST_USAGE;
    }
}

void fan_take_input(struct fan *f)
{
    f->refused = stream_input(&f->in, &f->in_open, route, f);
    outlet_beat_within(&f->out, &f->in);
}
