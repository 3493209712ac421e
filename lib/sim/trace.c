/* Events as text. */
#include "sim/world.h"

#include <inttypes.h>

static const char *const rings[] = {[RING_PLACE] = "place",
    [RING_ASK] = "ask",
    [RING_GIVE] = "give",
    [RING_NONE] = "none",
    [RING_CRASHED] = "crashed",
    [RING_HEIR] = "heir"};
static const char *const faults[] = {[SIM_CRASH] = "crash",
    [SIM_SILENCE] = "silence",
    [SIM_PAUSE] = "pause",
    [SIM_SLOW] = "slow",
    [SIM_HANG] = "hang",
    [SIM_DRAIN] = "drain",
    [SIM_KILL] = "kill"};
static const char *const scheds[] = {[SCHED_TASK] = "task",
    [SCHED_INPUT_END] = "end",
    [SCHED_FLUSH] = "flush",
    [SCHED_SLOTS] = "slots",
    [SCHED_UP] = "up",
    [SCHED_GONE] = "gone",
    [SCHED_DRAIN] = "drain",
    [SCHED_DONE] = "done",
    [SCHED_FAIL] = "fail",
    [SCHED_PIXELS] = "pixels",
    [SCHED_RING] = "ring",
    [SCHED_WAKE] = "wake"};
static const char *const kinds[] = {[SIM_INPUT] = "input",
    [SIM_STATE] = "has its state",
    [SIM_PREPARED] = "is prepared",
    [SIM_COMPUTED] = "computed",
    [SIM_WAKE] = "wake",
    [SIM_RESUME] = "resumes",
    [SIM_GIVE_UP] = "is given up",
    [SIM_RETURN] = "starts",
    [SIM_RESTART] = "restarts"};

/* The arriving event in words. */
static int describe(const struct sched_event *e, char *at, size_t room)
{
    const struct ring *r = &e->ring;
    bool named = e->kind == SCHED_TASK || e->kind == SCHED_DONE || e->kind == SCHED_PIXELS;
    if (e->kind == SCHED_RING) {
        const char *name = rings[r->kind];
        if (r->kind == RING_PLACE) return snprintf(at, room, "%s me=%" PRId32, name, r->me);
        if (r->kind == RING_GIVE)
            return snprintf(at, room, "%s %" PRIu32 " peer=%" PRId32, name, e->task.id, r->peer);
        return snprintf(at, room, "%s peer=%" PRId32 " next=%" PRId32 "%s", name, r->peer, r->next,
            r->idle ? " idle" : "");
    }
    if (!named) return snprintf(at, room, "%s", scheds[e->kind]);
    if (e->kind != SCHED_TASK || e->from < 0)
        return snprintf(at, room, "%s %" PRIu32, scheds[e->kind], e->task.id);
    return snprintf(at, room, "task %" PRIu32 " from=%" PRId32, e->task.id, e->from);
}

void sim_trace_line(const struct sim_event *e, bool lost, char line[SIM_LINE])
{
    char what[64];
    bool to_hub = e->kind == SIM_SCHED || e->kind == SIM_AT_HUB;
    if (to_hub || e->kind == SIM_TO_SLOT) describe(&e->sched, what, sizeof what);
    else if (e->kind == SIM_LOAD) snprintf(what, sizeof what, "share %.3g", e->sched.power);
    else if (e->kind == SIM_FAULT) snprintf(what, sizeof what, "fault %s", faults[e->sched.n]);
    else snprintf(what, sizeof what, "%s", kinds[e->kind]);
    snprintf(line, SIM_LINE, "%" PRId64 " %" PRId32 "%s %s%s", e->at_us, e->slot,
        to_hub                   ? " to hub:"
        : e->kind == SIM_TO_SLOT ? " from hub:"
                                 : ":",
        what, lost ? " (lost)" : "");
}
