/*
 * deal: the choice of the next slot. Each change of a slot is marked. Queries at each step then
 * take time logarithmic in the number of slots: sets, and a tournament (tree selection, D. E.
 * Knuth, "The Art of Computer Programming" vol. 3, 5.2.3) for the slot that needs a task first, and
 * the slot with the longest queue.
 *
 * One machine with deal_cost.c and deal_ledger.c.
 */
#include "sched/deal_int.h"

#include <stdlib.h>

#define SHARES 2 /* of the pool: the most a slot may hold at the end */
/* A slot gets its next task before the end of the last one: earlier by the sum of */
#define SAFETY 1.25 /* this number of round trips, and */
#define SPREAD 1.5  /* of standard deviations of a round trip's tasks, if independent */

static const struct rating nothing = {(double)INFINITY, INT32_MAX, 0};

static bool adapts(const struct deal *d) { return d->p.depth == SCHED_DEPTH_AUTO; }

/*
 * The number of tasks that slot s, which is up, may hold beyond those it computes. With
 * SCHED_DEPTH_AUTO it follows measurements (pace.c). A queue that is too deep costs nothing until
 * the end, and there the queues are run down: once the input has ended, a slot may hold at most
 * SHARES times its share of the pool (share_of). With SCHED_DEPTH_AUTO and an endgame, neither
 * applies: the queue follows expected times (need_of).
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

/* The priority of slot k, lowest first: the number of its tasks; or the time at which it must be
 * given another one, so that this arrives before the last one ends. INFINITY: it gets no more, for
 * example because its first task is overdue. With expected times, a slot that can begin at once is
 * below 0. */
static double need_of(const struct deal *d, int32_t k)
{
    const struct slot *s = &d->slots[k];
    int32_t load = slot_load(s);
    if (!deal_timed(d)) return load - s->width < depth_of(d, s) ? (double)load : (double)INFINITY;
    if (load < s->width) return load - s->width;
    if (s->stalled || load - s->width >= PACE_DEPTH_MOST) return (double)INFINITY;
    if (s->speed.work <= 0) return load > s->width ? (double)INFINITY : 0;
    double us = s->last_work * deal_time_us(d, k) / s->width, trip_us = s->pace.round_trip_us;
    return s->ends_us - SAFETY * trip_us - SPREAD * sqrt(trip_us * us);
}

/* ---- the tournament -------------------------------------------------------------------------- */

static struct rating rating_of(const struct deal *d, int32_t k)
{
    const struct slot *s = &d->slots[k];
    int32_t load = slot_load(s);
    struct rating r = nothing;
    if (s->state != SLOT_UP) return r;
    r.need = need_of(d, k);
    if (r.need < (double)INFINITY) r.excess = load - s->width;
    if (s->held.count > s->width) r.store_us = load * (s->pace.task_us > 0 ? s->pace.task_us : 1);
    return r;
}

static struct rating better(const struct rating *a, const struct rating *b)
{
    return (struct rating){.need = fmin(a->need, b->need),
        .excess = a->excess < b->excess ? a->excess : b->excess,
        .store_us = fmax(a->store_us, b->store_us)};
}

static bool equal(double a, double b) { return !(a < b) && !(a > b); }
static bool same(const struct rating *a, const struct rating *b)
{
    return equal(a->need, b->need) && a->excess == b->excess && equal(a->store_us, b->store_us);
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
 * The slot below tree node i with the least need, the lowest of equals, whose excess is less than
 * `share`; k (or -1) if that slot is no better than k. If all slots have one width, one descent is
 * enough.
 */
static int32_t least(const struct deal *d, int32_t i, int32_t share, int32_t k)
{
    const struct rating *best = d->best;
    int32_t first = i; /* the first leaf below i */
    while (first < d->n_places) first *= 2;
    double most = k < 0 ? (double)INFINITY : best[d->n_places + k].need;
    bool better = best[i].need < most || (equal(best[i].need, most) && first - d->n_places < k);
    if (!better || best[i].excess >= share) return k;
    if (i >= d->n_places) return i - d->n_places;
    int32_t near = 2 * i + (best[2 * i + 1].need < best[2 * i].need);
    return least(d, near ^ 1, share, least(d, near, share, k));
}

int32_t deal_pick_hungriest(struct deal *d)
{
    if (d->best[1].need >= (double)INFINITY) return -1;
    int32_t share = deal_timed(d) ? INT32_MAX : share_of(d), k;
    for (;;) {
        if (deal_timed(d) && d->best[1].need > (double)d->now_us) return -1;
        k = least(d, 1, share, -1);
        if (k < 0 || !deal_timed(d) || slot_load(&d->slots[k]) < d->slots[k].width) return k;
        deal_review(d, k);
        if (d->best[d->n_places + k].need > (double)d->now_us) continue;
        if (!deal_overdue(d, k)) return k;
        d->slots[k].stalled = true;
        deal_mark(d, k);
    }
}

double deal_pick_us(const struct deal *d) { return d->best[1].need; }

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
    rate(d, k, rating_of(d, k));
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
