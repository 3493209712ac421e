/*
 * The hub: tasks that cost nodes, by the rules of deal_aside.c. Here all tasks are at nodes from
 * the beginning, and a suspect goes to the end of the queue of another node. When a frame is put
 * aside, so are those of its tasks that come back from lost nodes.
 */
#include "sched/hub_int.h"

static const struct task *task_of(const struct hub *h, int32_t i) { return &h->ledger.at[i].task; }

/* ---- blame ------------------------------------------------------------------------- */

static void blame(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    sched_act(out, SCHED_BLAME, k, task_of(h, i));
    blame_add(&h->blame, task_of(h, i), k);
}

void hub_aside_blame(struct hub *h, int32_t k, struct sched_actions *out)
{
    const struct hub_node *s = &h->nodes[k];
    int32_t i = s->held.head;
    blame_gone(&h->blame, h->now_us);
    for (int32_t n = s->width; n > 0 && i >= 0; n--, i = h->ledger.at[i].next) blame(h, k, i, out);
}

void hub_aside_fail(struct hub *h, int32_t k, int32_t i, bool refused, struct sched_actions *out)
{
    if (!refused) blame(h, k, i, out);
    else if (hub_is_up(h, k)) {
        sched_act(out, SCHED_BLAME, k, task_of(h, i));
        out->at[out->n - 1].refused = true;
        refuse_add(&h->blame.refusals, task_of(h, i)->generation, k);
        hub_aside_settle(h, out);
    }
    hub_pass_on(h, i, k, out);
}

/* Tasks aside of a frame or a generation that are not bad go to nodes. */
static void start_all(
    struct hub *h, const uint32_t *frame, uint32_t generation, struct sched_actions *out)
{
    for (int32_t i = h->aside.head, next; i >= 0; i = next) {
        next = h->ledger.at[i].next;
        bool is = frame ? task_of(h, i)->frame == *frame : task_of(h, i)->generation == generation;
        if (!is || hub_bad(h, i)) continue;
        hub_unlist(h, i);
        hub_start(h, i, out);
    }
}

/* Tasks that nodes have come back when these refuse them. */
void hub_aside_settle(struct hub *h, struct sched_actions *out)
{
    uint32_t generation;
    while (refuse_settle(&h->blame.refusals, h->up.count, h->now_us, &generation)) {
        if (!refuse_all(&h->blame.refusals, generation)) start_all(h, NULL, generation, out);
        else
            for (int32_t i = h->rest.head, next; i >= 0; i = next) {
                next = h->ledger.at[i].next;
                if (task_of(h, i)->generation != generation) continue;
                hub_unlist(h, i);
                hub_put_aside(h, i);
            }
    }
}

void hub_aside_well(struct hub *h, int32_t i, struct sched_actions *out)
{
    const uint32_t frame = task_of(h, i)->frame;
    if (blame_well(&h->blame, task_of(h, i))) start_all(h, &frame, 0, out);
}

/* ---- trying again ---------------------------------------------------------------------------- */

/* No node has a task to compute that is needed, and none waits for a node. */
static bool is_quiet(const struct hub *h)
{
    for (int32_t k = 0; k < h->n_nodes; k++)
        if (h->nodes[k].held.count > h->nodes[k].cut) return false;
    return !h->pool.count && !h->rest.count;
}

static bool has_nothing(const void *context, int32_t k)
{
    const struct hub *h = context;
    return !h->nodes[k].held.count;
}

/* The node to try entry i; -1: none. */
static int32_t node_for(const struct hub *h, int32_t i)
{
    return blame_pick(&h->blame, task_of(h, i), &h->up, has_nothing, h);
}

/* False: no node is there. */
static bool give(struct hub *h, int32_t i, struct sched_actions *out)
{
    int32_t k = node_for(h, i);
    if (k < 0) return false;
    hub_unlist(h, i);
    hub_assign(h, i, k, out);
    return true;
}

static void abandon(struct hub *h, int32_t i, bool all, struct sched_actions *out)
{
    blame_abandon(&h->blame, &h->ledger, i, all, out);
    hub_commit(h, i, out);
}

/* The time until which a node may come that is not up. */
static int64_t returns_us(const struct hub *h, uint32_t generation)
{
    int64_t until_us = 0;
    for (int32_t k = 0; k < h->n_nodes && until_us < INT64_MAX; k++) {
        const struct hub_node *s = &h->nodes[k];
        if (s->state == NODE_NEW) until_us = INT64_MAX;
        if (s->state == NODE_GONE && s->width)
            until_us = refuse_until_us(&h->blame.refusals, generation);
    }
    return until_us;
}

/* All nodes that are up refuse entry i: gives its frame up, if no other may come. */
static void try_refused(struct hub *h, int32_t i, struct sched_actions *out)
{
    int64_t until_us = returns_us(h, task_of(h, i)->generation);
    if (h->now_us >= until_us) abandon(h, i, true, out);
    else if (until_us < h->return_us) h->return_us = until_us;
}

static void try_entry(struct hub *h, int32_t i, struct sched_actions *out);

/* Cuts entry i into halves. */
static void halve(struct hub *h, int32_t i, struct sched_actions *out)
{
    int32_t half[2];
    half[0] = hub_open_task(h, i);
    const struct lattice at = task_of(h, half[0])->at;
    half[1] = hub_cut_off(h, half[0], pieces_rows(&at, lattice_count(&at) / 2));
    for (int k = 1; k >= 0; k--) { /* the one that was cut off is the first */
        hub_unlist(h, half[k]);
        hub_task(h, half[k])->alone = 1;
        hub_put_aside(h, half[k]);
    }
    for (int k = 1; k >= 0; k--) try_entry(h, half[k], out);
}

static void try_entry(struct hub *h, int32_t i, struct sched_actions *out)
{
    int32_t *alone = &hub_task(h, i)->alone;
    if (refuse_all(&h->blame.refusals, task_of(h, i)->generation)) {
        try_refused(h, i, out);
        return;
    }
    switch (blame_step(&h->blame, &h->ledger, &h->aside, i, *alone, h->ended)) {
    case BLAME_GIVE_FRAME:
        if (is_quiet(h) && give(h, i, out)) blame_tried(&h->blame, task_of(h, i));
        break;
    case BLAME_ABANDON_FRAME: abandon(h, i, true, out); break;
    case BLAME_WAIT: break;
    case BLAME_ABANDON_PARENT: i = pieces_parent(&h->ledger, i); /* fallthrough */
    case BLAME_ABANDON: abandon(h, i, false, out); break;
    case BLAME_HALVE:
        if (node_for(h, i) >= 0) halve(h, i, out);
        break;
    case BLAME_GIVE_ALONE:
        if (give(h, i, out)) *alone = 1 + blame_count(&h->blame, task_of(h, i));
        break;
    case BLAME_GIVE: give(h, i, out); break;
    }
}

void hub_aside_try(struct hub *h, struct sched_actions *out)
{
    bool quiet = h->aside.count && is_quiet(h);
    h->return_us = INT64_MAX;
    if (!blame_due(&h->blame, quiet, h->ended || h->flush, h->now_us)) return;
    for (int32_t n = h->aside.count; n > 0 && h->aside.count; n--) {
        int32_t i = h->aside.head;
        list_remove(&h->ledger, &h->aside, i);
        list_push_back(&h->ledger, &h->aside, i);
        try_entry(h, i, out);
    }
}
