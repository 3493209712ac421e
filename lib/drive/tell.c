/*
 * The live driver: an event for the policy, and its actions, which become records for the command
 * or, from a node of a ring, for its hub.
 */
#include "drive/driver.h"
#include "drive/ring_record.h"

#include <inttypes.h>

void drive_flush(struct driver *d, int32_t to)
{
    char text[24] = "";
    if (to >= 0) snprintf(text, sizeof text, "to=%" PRId32, to);
    wire_plain(&d->down.bytes, REC_FLUSH, text);
}

/* Slot k of the fan may leave. */
static void dismiss(struct driver *d, int32_t k)
{
    char text[24];
    snprintf(text, sizeof text, "to=%" PRId32, k);
    wire_plain(&d->down.bytes, REC_LEAVE, text);
}

/* Sends the task of an action, with the unknown keys of the input task. */
static void give(struct driver *d, const struct sched_action *a, int32_t to)
{
    const char *keys = tags_find(&d->tags, a->task.frame, a->origin_id);
    char text[WIRE_LINE_MAX] = "";
    struct task t = a->task;
    t.to = to;
    int n = 0;
    if (a->from >= 0) n = snprintf(text, sizeof text, "peer=%" PRId32, a->from);
    if (keys) snprintf(text + n, sizeof text - (size_t)n, "%s%s", n ? " " : "", keys);
    wire_give(&d->down.bytes, &t, text);
}

static void perform(struct driver *d)
{
    for (size_t i = 0; i < d->acts.n; i++) {
        const struct sched_action *a = &d->acts.at[i];
        int32_t to = d->lone ? -1 : a->slot;
        switch (a->kind) {
        case SCHED_GIVE:
            if (drive_lacks(d, a->task.generation)) drive_refuse(d, &a->task);
            else give(d, a, to);
            break;
        case SCHED_ASK_FLUSH: drive_flush(d, to); break;
        case SCHED_COMMIT:
            tags_drop(&d->tags, &a->task);
            drive_forgive(d, &a->task);
            break;
        case SCHED_BLAME: drive_blame(d, a); break;
        case SCHED_ABANDON: drive_abandon(d, a); break;
        case SCHED_SAY:
            if (d->node) drive_ring_say(&d->out.queue.control, a, -1);
            else drive_ring_say(&d->down.bytes, a, to);
            break;
        case SCHED_LEAVE: dismiss(d, to); break;
        case SCHED_END: d->closing = true; break;
        case SCHED_STOP: d->stopping = true; break;
        }
    }
    d->acts.n = 0;
}

void drive_tell(struct driver *d, struct sched_event e)
{
    do {
        d->policy->step(d->state, &e, now_us(), &d->acts);
        perform(d);
    } while (drive_refused(d, &e));
}
