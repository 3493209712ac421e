/*
 * The hub: who is asked for whom. An ask goes to the next node of the ring that by the ledger has
 * tasks which are not begun, does not ask itself, and has no other ask to answer: one look at a set
 * instead of the paper's search from node to node. Where there is none the hub remembers who asked,
 * who is served when somebody has work again.
 *
 * What waits for a node that is not up yet nobody can be asked for: the hub gives it, as much as
 * that node would.
 *
 *   asks     is remembered (hungry) until a task is given to it, whoever's that was
 *   asked    answers with tasks, or with NONE: then it is dry until it is given a task, and whoever
 *            asked is remembered again; what it was given while the ask was under way it may have
 *            not seen when it answered
 */
#include "sched/ring_int.h"

void hub_mark(struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    bool up = s->state == NODE_UP;
    set_put(&h->late, k, s->state == NODE_NEW && s->held.count);
    set_put(&h->hungry, k, up && s->asking && s->victim < 0);
    set_put(&h->rich, k,
        up && (!s->asking || BUG(40)) && !s->dry && s->thief < 0 && s->held.count > s->width);
}

static void give_late(struct hub *h, struct sched_actions *out)
{
    while (h->hungry.count && h->late.count) {
        int32_t late = set_after(&h->late, set_after(&h->hungry, -1));
        int32_t held = h->nodes[late].held.count;
        hub_give(h, late, set_before(&h->hungry, late), h->p.one ? 1 : (held + 1) / 2, out);
    }
}

void ring_match(struct hub *h, struct sched_actions *out)
{
    give_late(h, out);
    while (h->hungry.count && h->rich.count) {
        int32_t victim = set_after(&h->rich, set_after(&h->hungry, -1));
        int32_t thief = set_before(&h->hungry, victim);
        h->nodes[thief].victim = victim;
        h->nodes[victim].thief = thief;
        h->nodes[victim].given_before = h->nodes[victim].given;
        hub_mark(h, thief);
        hub_mark(h, victim);
        sched_act(out, SCHED_SAY, victim, NULL);
        out->at[out->n - 1].ring = (struct ring){.kind = RING_ASK, .peer = thief, .next = -1};
    }
}

void ring_served(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = false;
    s->dry = BUG(32) && s->dry;
    s->victim = -1;
    s->given++;
    hub_mark(h, k);
}

void ring_asks(struct hub *h, int32_t k)
{
    h->nodes[k].asking = true;
    hub_mark(h, k);
}

/* Node k owes node peer no answer any more. */
static void answered(struct hub *h, int32_t k, int32_t peer)
{
    h->nodes[k].thief = -1;
    if (h->nodes[peer].victim == k && !BUG(33)) h->nodes[peer].victim = -1;
    hub_mark(h, k);
    hub_mark(h, peer);
}

void ring_has_none(struct hub *h, int32_t k, int32_t peer)
{
    struct hub_node *s = &h->nodes[k];
    if (peer < 0 || s->thief != peer) return;
    s->dry = s->given == s->given_before || BUG(39);
    answered(h, k, peer);
}

void ring_has_given(struct hub *h, int32_t k, int32_t peer)
{
    if (h->nodes[k].thief == peer) answered(h, k, peer);
}

void ring_lost(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = s->dry = false;
    s->victim = -1;
    if (s->thief >= 0 && !BUG(34)) answered(h, k, s->thief);
    hub_mark(h, k);
}
