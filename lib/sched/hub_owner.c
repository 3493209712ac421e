/*
 * The hub: owners of tasks. A task without owner goes to a node, and a task of one node to another:
 * because its owner gave it, is lost, drains, or makes no progress.
 */
#include "sched/hub_int.h"

void hub_start(struct hub *h, int32_t i, struct sched_actions *out)
{
    const struct task *t = &h->ledger.at[i].task;
    bool chosen = t->to >= 0 && t->to < h->n_nodes;
    hub_assign(h, i, chosen ? t->to : (int32_t)(t->id % (uint32_t)h->n_nodes), out);
}

void hub_send(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    struct hub_task *t = hub_task(h, i);
    s->flushed = false;
    t->tries += !t->tries;
    t->sent_us = h->now_us;
    sched_act(out, SCHED_GIVE, k, &h->ledger.at[i].task);
    out->at[out->n - 1].from = t->from;
    out->at[out->n - 1].origin_id = pieces_came_as(&h->ledger, i);
    hub_served(h, k);
    if (s->held.count == 1) hub_progress(h, k);
}

void hub_assign(struct hub *h, int32_t i, int32_t k, struct sched_actions *out)
{
    enum node_state state = h->nodes[k].state;
    if (state == NODE_GONE || state == NODE_DRAINS) k = set_before(&h->up, k);
    for (int32_t n = h->up.count; n > 0 && k >= 0 && hub_refuses(h, k, i); n--)
        k = set_before(&h->up, k);
    hub_enlist(h, i, k, false);
    if (hub_is_up(h, k)) hub_send(h, k, i, out);
    else if (k >= 0) hub_mark(h, k);
}

void hub_give(struct hub *h, int32_t k, int32_t peer, int32_t n, struct sched_actions *out)
{
    while (n-- > 0) {
        int32_t i = h->nodes[k].held.head;
        hub_unlist(h, i);
        hub_task(h, i)->from = k;
        hub_assign(h, i, peer, out);
    }
    hub_mark(h, k);
}

void hub_hand_on(struct hub *h, int32_t i, int32_t k, struct sched_actions *out)
{
    hub_unlist(h, i);
    hub_task(h, i)->from = -1;
    if (pieces_exist(&h->ledger, i)) hub_enlist(h, i, -1, false);
    else if (hub_bad(h, i)) hub_put_aside(h, i);
    else hub_assign(h, i, k, out);
}

void hub_pass_on(struct hub *h, int32_t i, int32_t k, struct sched_actions *out)
{
    hub_task(h, i)->tries++;
    hub_hand_on(h, i, set_before(&h->up, k), out);
    hub_mark(h, k);
    hub_ask_flush(h, k, out);
}

void hub_ask_flush(struct hub *h, int32_t k, struct sched_actions *out)
{
    struct hub_node *s = &h->nodes[k];
    bool wanted = s->state == NODE_DRAINS || ((h->ended || h->flush) && s->state == NODE_UP);
    if (!wanted || s->flushed || s->held.count || !s->computed.count) return;
    s->flushed = true;
    hub_mark(h, k);
    hub_progress(h, k);
    sched_act(out, SCHED_ASK_FLUSH, k, NULL);
}

void hub_take_over(struct hub *h, int32_t i, int32_t thief, struct sched_actions *out)
{
    struct hub_task *t = hub_task(h, i);
    int32_t k = t->owner;
    hub_unlist(h, i);
    t->from = k;
    t->tries++;
    h->taken_over = true;
    hub_assign(h, i, thief, out);
    hub_mark(h, k);
    hub_ask_flush(h, k, out);
}

/* Entry i, without pieces, leaves the ledger. */
static void leave(struct hub *h, int32_t i)
{
    int32_t k = hub_task(h, i)->owner;
    hub_remove(h, i);
    if (k < 0) return;
    hub_mark(h, k);
    set_put(&h->freed, k, true);
}

void hub_commit(struct hub *h, int32_t i, struct sched_actions *out)
{
    do {
        int32_t parent = pieces_parent(&h->ledger, i), j;
        sched_act(out, SCHED_COMMIT, hub_task(h, i)->owner, &h->ledger.at[i].task);
        while ((j = pieces_leaf(&h->ledger, i)) >= 0) leave(h, j);
        leave(h, i);
        i = parent;
    } while (i >= 0 && !pieces_exist(&h->ledger, i));
    while (h->freed.count) {
        int32_t k = set_after(&h->freed, -1);
        set_put(&h->freed, k, false);
        hub_ask_flush(h, k, out);
    }
}
