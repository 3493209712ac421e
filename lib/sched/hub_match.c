/*
 * The hub: pairs asks with victims. The victim of an ask is a node that by the ledger has tasks not
 * begun, and does not ask itself. Of the nodes with most work left, by powers of two of its time,
 * the hub takes the next one in the ring. Outstanding asks reduce the work left of a node. The
 * search takes two set queries. The paper searches from node to node, which finds the nearest node,
 * not the one that needs help. If there is no victim the hub remembers the ask, and serves it when
 * a node has work.
 *
 * If an ask has to wait, or to go to another victim, the asking node is told so once: by a NONE
 * with its own number. It must not take the time of such an ask for the time of a normal one.
 *
 * The hub itself gives away tasks that wait for a node not up yet, as many as that node would give.
 */
#include "sched/hub_int.h"

#define REVIEWED 4 /* nodes that a step marks again, because costs have changed */

static void give_late(struct hub *h, struct sched_actions *out)
{
    while (h->hungry.count && h->late.count) {
        int32_t late = set_after(&h->late, set_after(&h->hungry, -1));
        int32_t held = h->nodes[late].held.count;
        hub_give(h, late, set_before(&h->hungry, late), (held + 1) / 2, out);
    }
}

static void tell(int32_t k, enum ring_kind kind, int32_t peer, struct sched_actions *out)
{
    sched_act(out, SCHED_SAY, k, NULL);
    out->at[out->n - 1].ring = (struct ring){.kind = kind, .peer = peer, .next = -1};
}

/* What node thief takes for work, in percent of what node k takes; 0: not both have done a task. */
static int32_t takes(const struct hub *h, int32_t k, int32_t thief)
{
    if (h->nodes[k].speed.work <= 0 || h->nodes[thief].speed.work <= 0) return 0;
    double percent = 100 * hub_time_us(h, thief) / hub_time_us(h, k);
    return (int32_t)rint(fmax(1, fmin(percent, RING_TAKES_MOST)));
}

/* Asks a node with work left on behalf of the nearest hungry node before it. */
static void ask(struct hub *h, struct sched_actions *out)
{
    const struct slot_set *rich = &h->rich[63 - __builtin_clzll(h->loads)];
    int32_t victim = set_after(rich, set_after(&h->hungry, -1));
    int32_t thief = set_before(&h->hungry, victim);
    hub_pair(h, victim, thief);
    tell(victim, RING_ASK, thief, out);
    out->at[out->n - 1].ring.takes = takes(h, victim, thief);
}

/* In the endgame a hungry node gets a part of another node's task: the
 * one that would be done with it first. The others take turns, because a part may pay for one of
 * them if not for that. */
static bool end(struct hub *h, struct sched_actions *out)
{
    if (!hub_is_ending(h)) return false;
    for (int n = 0; n < REVIEWED; n++)
        hub_cost_mark(h, h->reviewed = set_after(&h->up, h->reviewed));
    int32_t first = tournament_least(&h->wanting, NULL);
    if (first >= 0 && hub_end(h, first, out)) return true;
    h->turn = set_after(&h->hungry, h->turn);
    return h->turn != first && hub_end(h, h->turn, out);
}

void hub_match(struct hub *h, struct sched_actions *out)
{
    h->end_us = INT64_MAX;
    give_late(h, out);
    while (h->hungry.count) {
        if (h->loads) ask(h, out);
        else if (!end(h, out)) break;
    }
    while (h->delayed.count) {
        int32_t k = set_after(&h->delayed, -1);
        h->nodes[k].told = true;
        hub_mark(h, k);
        tell(k, RING_NONE, k, out);
    }
}
