/*
 * The hub: the table of nodes, and nodes that join the ring and leave it.
 *
 * A slot with a number above all others joins when it comes up. It is then a node without tasks,
 * and asks for some; tasks that come later are dealt out to it as well.
 *
 * A node that drains gets no more tasks, and is asked for none. It keeps the tasks that it computes
 * at once, the first ones that it was given. The others go to the nearest node before it that is
 * up, as if it were lost. If it sends one of them first, that counts. It leaves
 * when the hub waits for nothing from it. Its queue cannot be called back, so it is stopped then.
 */
#include "sched/hub_int.h"

#define SLOTS_MAX (1 << 20)

/* ---- the table ---- */

/* Makes sets for n nodes, and marks all nodes again. */
static void make_room(struct hub *h, int32_t n)
{
    hub_sets_free(h);
    h->n_places = n;
    hub_sets_init(h);
    h->loads = 0;
    for (int32_t k = 0; k < h->n_nodes; k++) {
        h->nodes[k].load = -1;
        set_put(&h->up, k, h->nodes[k].state == NODE_UP);
        hub_mark(h, k);
    }
}

static void add_nodes(struct hub *h, int32_t n, enum node_state state)
{
    h->nodes = xrealloc(h->nodes, (size_t)n, sizeof *h->nodes);
    for (; h->n_nodes < n; h->n_nodes++)
        h->nodes[h->n_nodes] = (struct hub_node){.state = state,
            .held = TASK_LIST_EMPTY,
            .computed = TASK_LIST_EMPTY,
            .load = -1,
            .thief = -1,
            .victim = -1};
    if (n > h->n_places) make_room(h, n > 2 * h->n_places ? n : 2 * h->n_places);
}

void hub_note_early(struct hub *h, int32_t k)
{
    if (h->n_nodes || k < 0) return;
    h->early = xgrown(h->early, h->n_early, sizeof *h->early);
    h->early[h->n_early++] = k;
}

bool hub_set_nodes(struct hub *h, int32_t n)
{
    if (h->n_nodes || n < 1 || n > SLOTS_MAX) return false;
    add_nodes(h, n, NODE_NEW);
    for (size_t i = 0; i < h->n_early; i++)
        if (h->early[i] < n) h->nodes[h->early[i]].state = NODE_GONE;
    return true;
}

/* No task waits for nodes between, which may never come up. */
bool hub_join(struct hub *h, int32_t k)
{
    if (!h->n_nodes || k < 0 || k >= SLOTS_MAX) return false;
    if (k >= h->n_nodes) add_nodes(h, k + 1, NODE_GONE);
    return true;
}

/* ---- nodes that leave ---- */

void hub_drain(struct hub *h, int32_t k, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    int32_t i = s->held.head;
    if (s->state != NODE_UP) return;
    s->state = NODE_DRAINS;
    set_put(&h->up, k, false);
    refuse_end(&h->blame.refusals, k);
    hub_aside_settle(h, out);
    hub_lost(h, k);
    for (int32_t kept = 0; i >= 0 && kept < s->width; kept++) i = h->ledger.at[i].next;
    while (i >= 0) {
        int32_t next = h->ledger.at[i].next;
        hub_task(h, i)->tries++;
        hub_hand_on(h, i, k, out);
        i = next;
    }
    hub_mark(h, k);
    hub_ask_flush(h, k, out);
}

void hub_let_go(struct hub *h, struct sched_actions *out)
{
    while (h->leaving.count) {
        int32_t k = set_after(&h->leaving, -1);
        h->nodes[k].state = NODE_GONE;
        h->nodes[k].width = 0; /* it will not come back */
        hub_mark(h, k);
        sched_act(out, SCHED_LEAVE, k, NULL);
    }
}
