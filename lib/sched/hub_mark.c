/*
 * The hub: what nodes want and have. Each change of a node is marked. Sets, and lists in the order
 * of time, then answer the questions of a step in a few accesses.
 *
 * Progress is a task done, new pixels, or a first task after none. Nodes that have tasks, or were
 * asked for pixels that have not arrived, are in a list in the order of their latest progress.
 */
#include "sched/hub_int.h"

/* ---- sets of nodes --------------------------------------------------------------------------- */

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

/* Does node k refuse a task that others have? Then it does not ask them for any. */
static bool refuses(const struct hub *h, int32_t k)
{
    if (!h->blame.refusals.n || !refuse_any(&h->blame.refusals, k)) return false;
    for (uint32_t g = 0; g < GENERATIONS; g++)
        if (refuse_is(&h->blame.refusals, g, k) && tasks_in_generation(&h->ledger, g)) return true;
    return false;
}

/* ---- busy nodes, by latest progress ---------------------------------------------------------- */

static void unlist(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    if (!s->busy) return;
    *(s->staler >= 0 ? &h->nodes[s->staler].fresher : &h->stalest) = s->fresher;
    *(s->fresher >= 0 ? &h->nodes[s->fresher].staler : &h->freshest) = s->staler;
    s->busy = false;
}

static void enlist(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->busy = true;
    s->progress_us = h->now_us;
    s->staler = h->freshest;
    s->fresher = -1;
    *(h->freshest >= 0 ? &h->nodes[h->freshest].fresher : &h->stalest) = k;
    h->freshest = k;
}

/* Notes whether node k has to make progress, and whether it is idle. */
static void mark_busy(struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    bool owes = s->held.count > s->cut || (s->computed.count && s->flushed);
    bool busy = hub_works(h, k) && owes;
    if (busy && !s->busy) enlist(h, k);
    if (!busy) unlist(h, k);
    set_put(&h->idle, k,
        s->state == NODE_UP && s->asking && s->victim < 0 && !s->held.count && !refuses(h, k));
}

void hub_progress(struct hub *h, int32_t k)
{
    if (!h->nodes[k].busy) return;
    unlist(h, k);
    enlist(h, k);
    hub_cost_mark(h, k);
}

/* ---- marks ----------------------------------------------------------------------------------- */

/* A node is not a victim if there is an outstanding ask for each task that it has not begun. */
void hub_mark(struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    bool up = s->state == NODE_UP, drains = s->state == NODE_DRAINS;
    bool more = s->held.count > s->width + s->thieves;
    set_put(&h->late, k, s->state == NODE_NEW && s->held.count);
    set_put(&h->hungry, k, up && s->asking && s->victim < 0 && !refuses(h, k));
    set_put(&h->delayed, k, up && s->asking && !s->told && (s->victim < 0 || s->passed_on));
    set_put(&h->leaving, k, drains && !s->held.count && !s->computed.count);
    mark_rich(h, k, up && more && !s->asking && !s->dry && !s->silent);
    mark_busy(h, k);
    hub_cost_mark(h, k);
}
