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
    for (int32_t n = s->width; n > 0 && i >= 0; n--, i = h->ledger.at[i].next)
        blame(h, k, i, out);
}

void hub_aside_fail(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    blame(h, k, i, out);
    hub_pass_on(h, i, k, out);
}

void hub_aside_well(struct hub *h, int32_t i, struct sched_actions *out)
{
    const uint32_t frame = task_of(h, i)->frame;
    if (!blame_well(&h->blame, task_of(h, i))) return;
    for (int32_t j = h->aside.head, next; j >= 0; j = next) {
        next = h->ledger.at[j].next;
        if (task_of(h, j)->frame != frame || hub_bad(h, j)) continue;
        hub_unlist(h, j);
        hub_start(h, j, out);
    }
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
    blame_abandon(&h->ledger, i, all, out);
    hub_commit(h, i, out);
}

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
        give(h, half[k], out);
    }
}

static void try_entry(struct hub *h, int32_t i, struct sched_actions *out)
{
    int32_t *alone = &hub_task(h, i)->alone;
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
    if (!blame_due(&h->blame, quiet, h->ended || h->flush, h->now_us)) return;
    for (int32_t n = h->aside.count; n > 0 && h->aside.count; n--) {
        int32_t i = h->aside.head;
        list_remove(&h->ledger, &h->aside, i);
        list_push_back(&h->ledger, &h->aside, i);
        try_entry(h, i, out);
    }
}
