/* The list of actions of one step, and the limit on live generations. */
#include "sched/sched.h"

void sched_act(
    struct sched_actions *out, enum sched_action_kind kind, int32_t slot, const struct task *task)
{
    if (out->n == out->cap) {
        out->cap = out->cap ? 2 * out->cap : 64;
        out->at = xrealloc(out->at, out->cap, sizeof *out->at);
    }
    struct sched_action *a = &out->at[out->n++];
    *a = (struct sched_action){
        .kind = kind, .slot = slot, .from = -1, .ring = {.peer = -1, .next = -1}};
    if (task) {
        a->task = *task;
        a->origin_id = task->id;
    }
}

bool sched_admits(const struct policy *p, const void *state, uint32_t from, uint32_t oldest)
{
    for (; from != oldest; from++)
        if (p->uncommitted(state, from) > 0) return false;
    return true;
}
