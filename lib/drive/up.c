/*
 * The live driver: records from the command. Those about its slots (hello, up, gone, drain) become
 * events and end here; those with results are passed on.
 */
#include "drive/driver.h"
#include "drive/ring_record.h"

#include <inttypes.h>
#include <string.h>

#define POWER_LEAST 1e-6
#define POWER_MOST 1e9

/*
 * A fan reports its slots one by one. Any other command, a policy or a lone worker, is one slot
 * that computes as many tasks at once as its hello states, and handles the loss of its own slots
 * itself. A node is around one worker, whatever that is.
 */
static void take_hello(struct driver *d, const struct record *r)
{
    static const char fan[] = "hello fan ";
    char selftest[24] = "", why[160];
    double power = 1;
    int64_t n = 1;
    if (!rec_ours(r, why)) die(ST_SYSTEM, "the stream of the command %s", why);
    rec_int(r, "slots", 1, WIRE_SLOTS_MAX, &n);
    rec_real(r, "power", POWER_LEAST, POWER_MOST, &power);
    rec_str(r, "selftest", selftest, sizeof selftest);
    wire_hello(&d->out.queue.control, d->policy->name, selftest, power, 0, (int)n);
    d->out.greeted = true;
    d->lone = d->node || strncmp(r->line, fan, sizeof fan - 1) != 0;
    if (d->policy->joins && !d->lone) wire_plain(&d->down.bytes, REC_JOINS, NULL);
    drive_tell(d, (struct sched_event){.kind = SCHED_SLOTS, .n = d->lone ? 1 : (int32_t)n});
    if (d->lone)
        drive_tell(d, (struct sched_event){.kind = SCHED_UP, .n = (int32_t)n, .power = power});
}

/* A task given before, to this or another slot: its `done` gets the attempt number. */
static void forward_done(struct driver *d, const struct record *r, const struct sched_event *e)
{
    static const char *const drop[] = {"try", NULL};
    char text[24];
    int32_t n = d->policy->tries(d->state, e->slot, e->task.frame, e->task.id);
    snprintf(text, sizeof text, "try=%" PRId32, n);
    if (n > 1) wire_forward(&d->out.queue.control, r, drop, text);
    else wire_forward(&d->out.queue.control, r, NULL, NULL);
}

/* Passes a loss on, for the log. False if another policy has kept the slot's tasks. */
static bool forward_gone(struct driver *d, const struct record *r)
{
    bool kept = rec_is(r, "kept", "1");
    up_forward(&d->out.queue, r, NULL, kept ? NULL : "kept=1");
    return !kept;
}

/*
 * A slot came up or was lost. A node passes on the reports of a bare fan within it: the node would
 * not give the fan's tasks to another slot.
 */
static bool take_slot(struct driver *d, const struct record *r, struct sched_event *e)
{
    int64_t n;
    if (d->node) {
        up_forward(&d->out.queue, r, NULL, NULL);
        return false;
    }
    e->kind = r->kind == REC_UP ? SCHED_UP : SCHED_GONE;
    if (r->kind == REC_GONE) drive_reason(d, r);
    if (r->kind == REC_GONE && !forward_gone(d, r)) return false;
    if (rec_int(r, "slots", 1, WIRE_SLOTS_MAX, &n)) e->n = (int32_t)n;
    if (!rec_real(r, "power", POWER_LEAST, POWER_MOST, &e->power)) e->power = 0;
    e->stated = rec_is(r, "stated", "1");
    return true;
}

/* A record that no worker, policy or fan sends. */
static _Noreturn void refuse(const struct record *r, const char *expected)
{
    die(ST_SYSTEM, "from the command: record `%s`, expected %s", rec_name(r->kind), expected);
}

static void check_up(const struct driver *d, const struct record *r)
{
    char job[WIRE_JOB];
    /* A fan may lose its slots before one has said hello. */
    if (!d->out.greeted && r->kind != REC_HELLO && r->kind != REC_GONE && r->kind != REC_BYE)
        refuse(r, "`hello` first");
    if (r->kind == REC_FRAME && !rec_str(r, "job", job, sizeof job)) refuse(r, "`job=` in it");
}

static void take_up(struct driver *d, const struct record *r)
{
    check_up(d, r);
    struct sched_event e = {.slot = d->lone ? 0 : rec_slot(r), .task = r->task, .from = -1};
    switch (r->kind) {
    case REC_HELLO: take_hello(d, r); return;
    case REC_BEAT: wire_forward(&d->out.queue.control, r, NULL, NULL); return;
    case REC_FRAME: up_forward(&d->out.queue, r, NULL, NULL); return;
    case REC_DONE:
        forward_done(d, r, &e);
        e.kind = SCHED_DONE;
        if (!rec_int(r, "wall_us", 0, INT64_MAX, &e.wall_us)) e.wall_us = -1;
        break;
    case REC_FAIL:
        e.kind = SCHED_FAIL;
        e.refused = rec_is(r, "why", WIRE_REFUSED);
        drive_reason(d, r);
        if (d->node) wire_forward(&d->out.queue.control, r, NULL, NULL);
        break;
    case REC_FRAG:
        up_forward(&d->out.queue, r, NULL, NULL);
        e.kind = SCHED_PIXELS;
        break;
    case REC_BYE: rec_str(r, "why", d->why, sizeof d->why); return;
    case REC_DRAIN:
        if (d->lone || !d->policy->joins) return; /* only a fan's slots can leave */
        e.kind = SCHED_DRAIN;
        break;
    case REC_UP:
    case REC_GONE:
        if (!take_slot(d, r, &e)) return;
        break;
    default:
        e.kind = SCHED_RING;
        if (!drive_ring_of(r, &e.ring)) refuse(r, "one that workers send");
        if (d->node) return;
    }
    if (e.slot >= 0) drive_tell(d, e);
}

bool drive_listen(struct driver *d)
{
    struct record r;
    enum wire_result result;
    bool more = stream_read(&d->from, d->child.from) > 0;
    d->heard_us = now_us();
    while ((result = wire_next(&d->from, &r)) != WIRE_MORE) {
        if (result == WIRE_RECORD) take_up(d, &r);
        else if (!d->from.ended) die(ST_SYSTEM, "from the command: %s", d->from.why);
    }
    return more;
}
