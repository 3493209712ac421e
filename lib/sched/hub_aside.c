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
    h->nodes[k].lost++;
    sched_act(out, SCHED_BLAME, k, task_of(h, i));
    blame_add(&h->blame, task_of(h, i), k);
}

void hub_aside_blame(struct hub *h, int32_t k, struct sched_actions *out)
{
    const struct hub_node *s = &h->nodes[k];
    int32_t i = s->held.head;
    for (int32_t n = s->width; n > 0 && i >= 0; n--, i = h->ledger.at[i].next)
        if (!pieces_exist(&h->ledger, i)) blame(h, k, i, out);
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
        bool bad = blame_bad(&h->blame, &h->ledger, j, hub_task(h, j)->alone);
        if (task_of(h, j)->frame != frame || bad) continue;
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

/* The node for entry i: one that was not lost over it, and of these, the one lost least. */
static int32_t node_for(const struct hub *h, int32_t i)
{
    int32_t best = -1;
    bool best_was = true;
    for (int32_t k = -1, n = h->up.count; n > 0; n--) {
        k = set_after(&h->up, k);
        if (h->nodes[k].held.count) continue;
        bool was = blame_is(&h->blame, task_of(h, i), k);
        bool better =
            best < 0 || (was != best_was ? best_was : h->nodes[k].lost < h->nodes[best].lost);
        if (better) best = k, best_was = was;
    }
    return best;
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
    struct task t = *task_of(h, i);
    t.at = pieces_missing(&h->ledger.at[i]);
    sched_act(out, SCHED_ABANDON, -1, &t);
    out->at[out->n - 1].origin_id = pieces_came_as(&h->ledger, i);
    out->at[out->n - 1].all = all;
    hub_commit(h, i, out);
}

static void try_frame(struct hub *h, int32_t i, struct blame_frame *f, struct sched_actions *out)
{
    if (f->tried && f->lost >= f->tried) abandon(h, i, true, out);
    else if (is_quiet(h) && give(h, i, out)) f->tried = f->lost + 1;
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

static void try_task(struct hub *h, int32_t i, struct sched_actions *out)
{
    int32_t *alone = &hub_task(h, i)->alone;
    switch (blame_step(&h->blame, &h->ledger, i, *alone, h->ended)) {
    case BLAME_WAIT: break;
    case BLAME_ABANDON_PARENT: i = pieces_parent(&h->ledger, i); /* fallthrough */
    case BLAME_ABANDON: abandon(h, i, false, out); break;
    case BLAME_HALVE:
        if (node_for(h, i) >= 0) halve(h, i, out);
        break;
    case BLAME_GIVE_ALONE:
        if (node_for(h, i) >= 0)
            *alone = 1 + blame_count(&h->blame, task_of(h, i)); /* fallthrough */
    case BLAME_GIVE: give(h, i, out); break;
    }
}

/* Is another task of the frame of entry i aside? */
static bool has_others(const struct hub *h, int32_t i)
{
    int32_t j = h->aside.head;
    while (j >= 0 && (j == i || task_of(h, j)->frame != task_of(h, i)->frame))
        j = h->ledger.at[j].next;
    return j >= 0;
}

void hub_aside_try(struct hub *h, struct sched_actions *out)
{
    if ((!h->ended && !h->flush) || !is_quiet(h)) return;
    for (int32_t n = h->aside.count; n > 0 && h->aside.count; n--) {
        int32_t i = h->aside.head;
        list_remove(&h->ledger, &h->aside, i);
        list_push_back(&h->ledger, &h->aside, i);
        struct blame_frame *f = blame_frame(&h->blame, task_of(h, i));
        if (f->aside && (f->tried || has_others(h, i))) try_frame(h, i, f, out);
        else try_task(h, i, out);
    }
}
