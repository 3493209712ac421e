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
 *
 *   asks     is remembered (hungry) until the node is given a task, from whichever node
 *   asked    answers with tasks, or with NONE: then it is dry until it is given a task, or has done
 *            one, and the ask is remembered again; it is not dry if it was given a task while the
 *            ask was under way, because perhaps it answered before it saw that task
 *
 * The loss of an unreachable node is known only after seconds. A node that asked waits only
 * for a multiple of the longest recent answer. Then its ask is remembered again, and the
 * victim is silent: it is not asked until it sends something. Its answer may still come: its GIVE
 * counts, whatever the asking node waits for by then.
 * One machine with hub.c and hub_hung.c.
 */
#include "sched/hub_int.h"

#define LATE_TIMES 8       /* of the longest answer: then an answer is late, */
#define LATE_US 100000     /* with this added for a busy machine */
#define FIRST_US 3000000   /* while no answer has come yet */
#define ANSWERS_OF_LATE 16 /* the number of recent answers, about, of which it is the longest */
#define REVIEWED 4         /* nodes that a step marks again, because costs have changed */

static void for_sets(struct hub *h, void (*act)(struct slot_set *s, int32_t n))
{
    struct slot_set *sets[] = {
        &h->up, &h->hungry, &h->idle, &h->freed, &h->late, &h->delayed, &h->leaving};
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) act(sets[i], h->n_places);
    for (int c = 0; c < LOADS; c++) act(&h->rich[c], h->n_places);
}

static void empty(struct slot_set *s, int32_t n)
{
    (void)n;
    set_free(s);
}

void hub_sets_init(struct hub *h)
{
    for_sets(h, set_init);
    tournament_init(&h->wanting, h->n_places);
    tournament_init(&h->latest, h->n_places);
    tournament_init(&h->most_late, h->n_places);
}

void hub_sets_free(struct hub *h)
{
    for_sets(h, empty);
    tournament_free(&h->wanting);
    tournament_free(&h->latest);
    tournament_free(&h->most_late);
}

/* The class of work of px pixels for node s. A node without measurements counts as the mean of the
 * others. */
static int32_t class_of(const struct hub *h, const struct hub_node *s, double px)
{
    double us_per_px = s->pace.us_per_px > 0 ? s->pace.us_per_px : h->pace.us_per_px;
    if (us_per_px <= 0) us_per_px = 1;
    double us = px * us_per_px / s->width;
    if (us < 1) return 0;
    int32_t load = ilogb(us);
    return load < LOADS ? load : LOADS - 1;
}

/* Node k moves from class *from of these sets to class `to`; -1: none. */
static void move(struct slot_set *sets, uint64_t *used, int32_t k, int32_t *from, int32_t to)
{
    if (to == *from) return;
    if (*from >= 0) {
        set_put(&sets[*from], k, false);
        if (!sets[*from].count) *used &= ~(UINT64_C(1) << *from);
    }
    if (to >= 0) {
        set_put(&sets[to], k, true);
        *used |= UINT64_C(1) << to;
    }
    *from = to;
}

static void mark_rich(struct hub *h, int32_t k, bool rich)
{
    struct hub_node *s = &h->nodes[k];
    int32_t load = rich ? class_of(h, s, s->held_px / (1 + s->thieves)) : -1;
    move(h->rich, &h->loads, k, &s->load, load);
}

/* A node is not a victim if there is an outstanding ask for each task that it has not begun. */
void hub_mark(struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    bool up = s->state == NODE_UP, drains = s->state == NODE_DRAINS;
    bool more = s->held.count > s->width + s->thieves;
    set_put(&h->late, k, s->state == NODE_NEW && s->held.count);
    set_put(&h->hungry, k, up && s->asking && s->victim < 0);
    set_put(&h->delayed, k, up && s->asking && !s->told && (s->victim < 0 || s->passed_on));
    set_put(&h->leaving, k, drains && !s->held.count && !s->computed.count);
    mark_rich(h, k, up && more && !s->asking && !s->dry && !s->silent);
    hub_busy(h, k);
    hub_cost_mark(h, k);
}

static void give_late(struct hub *h, struct sched_actions *out)
{
    while (h->hungry.count && h->late.count) {
        int32_t late = set_after(&h->late, set_after(&h->hungry, -1));
        int32_t held = h->nodes[late].held.count;
        hub_give(h, late, set_before(&h->hungry, late), h->p.one ? 1 : (held + 1) / 2, out);
    }
}

/* pair: node k is asked on behalf of node thief. part: ends that. */
static void pair(struct hub *h, int32_t k, int32_t thief)
{
    struct hub_node *s = &h->nodes[k], *t = &h->nodes[thief];
    t->victim = k;
    t->given_before = s->given;
    t->since_us = h->now_us;
    t->older = h->newest;
    t->newer = -1;
    *(h->newest >= 0 ? &h->nodes[h->newest].newer : &h->oldest) = thief;
    h->newest = thief;
    t->before = -1;
    t->after = s->thief;
    if (s->thief >= 0) h->nodes[s->thief].before = thief;
    s->thief = thief;
    s->thieves++;
    hub_mark(h, k);
    hub_mark(h, thief);
}

static void part(struct hub *h, int32_t thief)
{
    struct hub_node *t = &h->nodes[thief];
    int32_t k = t->victim;
    if (k < 0) return;
    if (t->before >= 0) h->nodes[t->before].after = t->after;
    else h->nodes[k].thief = t->after;
    if (t->after >= 0) h->nodes[t->after].before = t->before;
    *(t->older >= 0 ? &h->nodes[t->older].newer : &h->oldest) = t->newer;
    *(t->newer >= 0 ? &h->nodes[t->newer].older : &h->newest) = t->older;
    t->victim = -1;
    h->nodes[k].thieves--;
    hub_mark(h, k);
    hub_mark(h, thief);
}

static void tell(int32_t k, enum ring_kind kind, int32_t peer, struct sched_actions *out)
{
    sched_act(out, SCHED_SAY, k, NULL);
    out->at[out->n - 1].ring = (struct ring){.kind = kind, .peer = peer, .next = -1};
}

/* Asks a node with work left on behalf of the nearest hungry node before it. */
static void ask(struct hub *h, struct sched_actions *out)
{
    const struct slot_set *rich = &h->rich[63 - __builtin_clzll(h->loads)];
    int32_t victim = set_after(rich, set_after(&h->hungry, -1));
    int32_t thief = set_before(&h->hungry, victim);
    pair(h, victim, thief);
    tell(victim, RING_ASK, thief, out);
}

/* In the endgame a hungry node gets a part of another node's task: the
 * one that would be done with it first. The others take turns, because a part may pay for one of
 * them if not for that. */
static bool end(struct hub *h, struct sched_actions *out)
{
    if (!hub_is_ending(h)) return false;
    for (int n = 0; n < REVIEWED; n++)
        hub_cost_mark(h, h->reviewed = set_after(&h->up, h->reviewed));
    int32_t first = tournament_least(&h->wanting, NULL, NULL);
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

void hub_served(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = s->told = s->passed_on = s->dry = false;
    s->given++;
    part(h, k);
    hub_mark(h, k);
}

void hub_asks(struct hub *h, int32_t k)
{
    h->nodes[k].asking = true;
    hub_mark(h, k);
}

void hub_answers(struct hub *h, int32_t k, int32_t peer)
{
    if (peer < 0 || peer >= h->n_nodes || h->nodes[peer].victim != k) return;
    int64_t us = h->now_us - h->nodes[peer].since_us;
    h->answer_us -= h->answer_us / ANSWERS_OF_LATE;
    if (us > h->answer_us) h->answer_us = us;
}

void hub_has_none(struct hub *h, int32_t k, int32_t peer)
{
    if (peer < 0 || peer >= h->n_nodes || h->nodes[peer].victim != k) return;
    hub_answers(h, k, peer);
    h->nodes[k].dry = h->nodes[k].given == h->nodes[peer].given_before;
    h->nodes[peer].passed_on = true;
    part(h, peer);
    hub_mark(h, k);
}

/* The asks that wait for node k go to other victims. */
static void pass_on(struct hub *h, int32_t k)
{
    while (h->nodes[k].thief >= 0) {
        h->nodes[h->nodes[k].thief].passed_on = true;
        part(h, h->nodes[k].thief);
    }
    hub_mark(h, k);
}

void hub_lost(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = s->told = s->passed_on = s->dry = s->silent = false;
    part(h, k);
    pass_on(h, k);
}

int64_t hub_late_us(const struct hub *h)
{
    if (h->oldest < 0) return INT64_MAX;
    int64_t late_us = h->answer_us ? LATE_TIMES * h->answer_us + LATE_US : FIRST_US;
    return h->nodes[h->oldest].since_us + late_us;
}

void hub_late(struct hub *h)
{
    while (h->now_us >= hub_late_us(h)) {
        int32_t k = h->nodes[h->oldest].victim;
        h->nodes[k].silent = true;
        pass_on(h, k);
    }
}
