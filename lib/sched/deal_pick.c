/*
 * deal: the choice of the next slot. Each change of a slot is marked. Queries at each step then
 * take time logarithmic in the number of slots: sets, and a tournament (tree selection, D. E.
 * Knuth, "The Art of Computer Programming" vol. 3, 5.2.3) for the slot with the least load and the
 * slot with the longest queue.
 */
#include "sched/deal_int.h"

#include <stdlib.h>

#define SHARES 2   /* of the pool: the most a slot may hold at the end */
#define TRIP .25   /* of a round trip: the work a slot may hold beyond its share, with an endgame */

static const struct rating nothing = {INT32_MAX, INT32_MAX, 0};

static bool adapts(const struct deal *d) { return d->p.depth == SCHED_DEPTH_AUTO; }

/*
 * The number of tasks that slot s, which is up, may hold beyond those it computes. With
 * SCHED_DEPTH_AUTO it follows measurements (pace.c). A queue that is too deep costs nothing until
 * the end, and there the queues are run down: once the input has ended, a slot may hold at most
 * SHARES times its share of the pool (share_of). With an endgame, which can take more back, it may
 * also hold work for TRIP of a round trip.
 */
static int32_t depth_of(const struct deal *d, const struct slot *s)
{
    return adapts(d) ? pace_depth(&s->pace, s->width) : d->p.depth;
}

static int32_t share_of(const struct deal *d)
{
    bool revoked = d->ended && (adapts(d) || d->p.endgame);
    return revoked ? SHARES * d->pool.count / d->up : INT32_MAX;
}

/* The number of tasks that slot s computes in TRIP of a round trip. */
static int32_t trip_of(const struct deal *d, const struct slot *s)
{
    double tasks = s->pace.task_us > 0 ? s->width * s->pace.round_trip_us / s->pace.task_us : 0;
    return adapts(d) && d->p.endgame ? (int32_t)fmin(TRIP * tasks, INT16_MAX) : 0;
}

/* ---- the tournament -------------------------------------------------------------------------- */

static struct rating rating_of(const struct deal *d, const struct slot *s)
{
    int32_t load = slot_load(s);
    struct rating r = nothing;
    if (s->state != SLOT_UP) return r;
    if (load - s->width < depth_of(d, s)) {
        r.load = load;
        r.excess = load - s->width - trip_of(d, s);
    }
    if (s->held.count > s->width) r.store_us = load * (s->pace.task_us > 0 ? s->pace.task_us : 1);
    return r;
}

static struct rating better(const struct rating *a, const struct rating *b)
{
    return (struct rating){.load = a->load < b->load ? a->load : b->load,
        .excess = a->excess < b->excess ? a->excess : b->excess,
        .store_us = a->store_us > b->store_us ? a->store_us : b->store_us};
}

static bool same(const struct rating *a, const struct rating *b)
{
    return a->load == b->load && a->excess == b->excess && !(a->store_us < b->store_us) &&
           !(a->store_us > b->store_us);
}

static void rate(struct deal *d, int32_t k, struct rating r)
{
    struct rating *best = d->best;
    for (int32_t i = d->n_places + k; i && !same(&best[i], &r);) {
        best[i] = r;
        if ((i /= 2) != 0) r = better(&best[2 * i], &best[2 * i + 1]);
    }
}

/*
 * The slot below tree node i with the least load, the lowest of equals, whose excess is less than
 * `share`; k (or -1) if that slot is no better than k. If all slots have one width, one descent is
 * enough.
 */
static int32_t least(const struct deal *d, int32_t i, int32_t share, int32_t k)
{
    const struct rating *best = d->best;
    int32_t first = i; /* the first leaf below i */
    while (first < d->n_places) first *= 2;
    int32_t most = k < 0 ? INT32_MAX : best[d->n_places + k].load;
    bool better = best[i].load < most || (best[i].load == most && first - d->n_places < k);
    if (!better || best[i].excess >= share) return k;
    if (i >= d->n_places) return i - d->n_places;
    int32_t near = 2 * i + (best[2 * i + 1].load < best[2 * i].load);
    return least(d, near ^ 1, share, least(d, near, share, k));
}

int32_t deal_pick_hungriest(const struct deal *d)
{
    if (d->best[1].load == INT32_MAX) return -1;
    return least(d, 1, share_of(d), -1);
}

int32_t deal_pick_store(const struct deal *d)
{
    if (d->best[1].store_us <= 0) return -1;
    int32_t i = 1;
    while (i < d->n_places) i = 2 * i + (d->best[2 * i + 1].store_us > d->best[2 * i].store_us);
    return i - d->n_places;
}

/* ---- marks ----------------------------------------------------------------------------------- */

void deal_mark(struct deal *d, int32_t k)
{
    const struct slot *s = &d->slots[k];
    bool up = s->state == SLOT_UP, drains = s->state == SLOT_DRAINS;
    bool idle = up && !slot_load(s), owes = s->owed.count;
    set_put(&d->idle, k, idle);
    set_put(&d->free, k, idle && !owes);
    bool late = s->computed.count && (s->asked || slot_load(s));
    set_put(&d->withheld, k, (up || drains) && late);
    set_put(&d->unflushed, k, idle && owes && !s->asked);
    set_put(&d->leaving, k, drains && !slot_load(s) && !(owes && s->asked));
    rate(d, k, rating_of(d, s));
}

#define SETS 5
static struct slot_set *nth_set(struct deal *d, int i)
{
    struct slot_set *const sets[SETS] = {
        &d->idle, &d->free, &d->withheld, &d->unflushed, &d->leaving};
    return sets[i];
}

void deal_close_room(struct deal *d)
{
    for (int i = 0; d->n_places && i < SETS; i++) set_free(nth_set(d, i));
    free(d->best);
}

void deal_make_room(struct deal *d, int32_t n)
{
    if (n <= d->n_places) return;
    int32_t places = d->n_places ? d->n_places : 1;
    deal_close_room(d);
    while (places < n) places *= 2;
    d->n_places = places;
    for (int i = 0; i < SETS; i++) set_init(nth_set(d, i), places);
    d->slots = xrealloc(d->slots, (size_t)places, sizeof *d->slots);
    d->best = xmalloc(2 * (size_t)places, sizeof *d->best);
    for (int32_t i = 0; i < 2 * places; i++) d->best[i] = nothing;
    for (int32_t k = 0; k < d->n_slots; k++) deal_mark(d, k);
}
