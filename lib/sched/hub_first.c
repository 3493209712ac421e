/*
 * The hub: first shares by power, with an endgame. A task that waits at its node costs no message,
 * but each steal takes round trips. So where the hosts file states powers, a node begins with a
 * share by its power. Powers come one by one, with the nodes:
 *
 * 1. A node that comes up gets FIRST of the tasks that waited for it, and less if its power is
 *    below the mean of those that are up. The rest goes to the pool.
 * 2. Once each node has come up or is lost, the pool is dealt out, so that the pixels of all nodes
 *    are as their powers. Nodes of at least the mean power keep theirs; the others' come from all
 *    over the pool.
 * 3. Until then, a node that asks gets a part of the pool.
 */
#include "sched/hub_int.h"

#define FIRST .35   /* as in deal_pick.c */
#define ALMOST .999 /* of the mean power: sums are not exact */
#define PARTS 2     /* an asking node gets this part of its share of the pool */

void hub_first_weigh(struct hub *h, int32_t k, double stated)
{
    struct hub_node *s = &h->nodes[k];
    double power = s->state != NODE_UP ? 0 : stated > 0 ? stated : 1;
    h->power += power - s->power;
    s->power = power;
}

int32_t hub_first_node(const struct hub *h, int32_t i)
{
    const struct task *t = &h->ledger.at[i].task;
    bool chosen = t->to >= 0 && t->to < h->n_nodes;
    return chosen ? t->to : (int32_t)(t->id % (uint32_t)h->n_nodes);
}

/* Has node k at least the mean power of those that are up? */
static bool has_mean(const struct hub *h, int32_t k)
{
    return h->nodes[k].power * h->up.count >= ALMOST * h->power;
}

/* Entry i, of the pool, goes to node k. */
static void take(struct hub *h, int32_t i, int32_t k, struct sched_actions *out)
{
    hub_unlist(h, i);
    hub_assign(h, i, k, out);
}

/* It keeps its order if it will keep the rest, too (deal_own). Else it keeps every n-th one,
 * because neighbours cost about the same. */
void hub_first_part(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    double most = FIRST * s->held.count, credit = 1;
    double part = has_mean(h, k) ? 1 : FIRST * s->power * h->up.count / h->power;
    for (int32_t i = s->held.head, next; i >= 0; i = next, credit += part) {
        next = h->ledger.at[i].next;
        if (credit >= 1 && most > 0) {
            credit -= 1;
            most -= 1;
            continue;
        }
        hub_unlist(h, i);
        hub_enlist(h, i, -1, false);
    }
}

/* The next task goes to the node that has been dealt the least part of what it lacks. */
static void rank(const struct hub *h, struct tournament *t, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    tournament_set(t, k, s->lacks_px > 0 ? s->dealt_px / s->lacks_px : (double)INFINITY);
}

static int32_t next_up(const struct hub *h, int32_t k)
{
    int32_t next = set_after(&h->up, k);
    return next > k ? next : -1;
}

/* Nodes of at least the mean power keep the tasks that waited for them. */
static void deal_own(struct hub *h, struct sched_actions *out)
{
    for (int32_t i = h->pool.head, next; i >= 0; i = next) {
        int32_t k = hub_first_node(h, i);
        next = h->ledger.at[i].next;
        if (hub_is_up(h, k) && has_mean(h, k)) take(h, i, k, out);
    }
}

void hub_first_deal(struct hub *h, struct sched_actions *out)
{
    if (h->n_new || !h->up.count || !h->pool.count) return;
    deal_own(h, out);
    struct tournament t;
    double px = 0;
    tournament_init(&t, h->n_nodes);
    for (int32_t i = h->pool.head; i >= 0; i = h->ledger.at[i].next) px += tasks_px(&h->ledger, i);
    for (int32_t k = next_up(h, -1); k >= 0; k = next_up(h, k)) px += h->nodes[k].held_px;
    for (int32_t k = next_up(h, -1); k >= 0; k = next_up(h, k)) {
        struct hub_node *s = &h->nodes[k];
        s->lacks_px = px * s->power / h->power - s->held_px;
        s->dealt_px = .5 / h->up.count;
        rank(h, &t, k);
    }
    while (h->pool.count) {
        int32_t i = h->pool.head, k = tournament_least(&t, NULL);
        h->nodes[k].dealt_px += tasks_px(&h->ledger, i);
        rank(h, &t, k);
        take(h, i, k, out);
    }
    tournament_free(&t);
}

void hub_first_ask(struct hub *h, struct sched_actions *out)
{
    while (h->p.endgame && h->hungry.count && h->pool.count) {
        int32_t k = set_after(&h->hungry, -1);
        int32_t n = h->pool.count / (PARTS * h->n_nodes) + 1;
        while (n-- > 0 && h->pool.count) take(h, h->pool.head, k, out);
    }
}
