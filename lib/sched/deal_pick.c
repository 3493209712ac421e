/*
 * deal: which slot is the next. Whatever changes about a slot is marked, and what is asked at every
 * step is then answered in the logarithm of the number of slots: by sets, and by a tournament (the
 * tree selection of D. E. Knuth, "The Art of Computer Programming" vol. 3, 5.2.3), in which the
 * winners stand between slots that may be given more, and between those that have some in store.
 */
#include "sched/deal_int.h"

#include <stdlib.h>

#define SHARES 2   /* of the pool, a slot may have in store at the end, */
#define TRIP .25   /* and with an endgame what it does in this part of a round trip */

static const struct rating nothing = {INT32_MAX, INT32_MAX, 0};

static bool adapts(const struct deal *d) { return d->p.depth == SCHED_DEPTH_AUTO; }

/*
 * So many tasks slot s, which is up, may have beyond those that it is on. With SCHED_DEPTH_AUTO
 * that follows what is measured of it (pace.c). What is too deep costs nothing until the end, and
 * there the queues are run down: when the input has ended, no slot may hold more than SHARES times
 * its share of the pool (share_of), and with an endgame, which can take more back,
 * what keeps it busy for a part of a round trip.
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

/* Tasks that slot s does in that part of a round trip. */
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
 * The slot below i with the least load, of equals the lowest, whose excess is less than `share`, if
 * it is better than slot k, -1. Where all slots have one width, one way down is all.
 */
static int32_t least(const struct deal *d, int32_t i, int32_t share, int32_t k)
{
    const struct rating *best = d->best;
    int32_t first = i; /* of its places */
    while (first < d->n_places) first *= 2;
    int32_t most = k < 0 ? INT32_MAX : best[d->n_places + k].load;
    bool better = best[i].load < most || (best[i].load == most && first - d->n_places < k);
    if (!better || best[i].excess >= share) return k;
    if (i >= d->n_places) return i - d->n_places;
    int32_t near = 2 * i + (best[2 * i + 1].load < best[2 * i].load);
    return least(d, near ^ 1, share, least(d, near, share, k));
}

int32_t pick_hungriest(const struct deal *d)
{
    if (d->best[1].load == INT32_MAX) return -1;
    return least(d, 1, share_of(d), -1);
}

int32_t pick_store(const struct deal *d)
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
    bool up = s->state == SLOT_UP, idle = up && !slot_load(s), owes = s->computed.count;
    set_put(&d->idle, k, idle);
    set_put(&d->free, k, idle && !owes);
    set_put(&d->withheld, k, up && owes && (s->asked || !idle));
    set_put(&d->unflushed, k, idle && owes && !s->asked);
    rate(d, k, rating_of(d, s));
}

void deal_close_room(struct deal *d)
{
    struct slot_set *sets[] = {&d->idle, &d->free, &d->withheld, &d->unflushed};
    for (int i = 0; d->n_places && i < 4; i++) set_free(sets[i]);
    free(d->best);
}

void deal_make_room(struct deal *d, int32_t n)
{
    if (n <= d->n_places) return;
    struct slot_set *sets[] = {&d->idle, &d->free, &d->withheld, &d->unflushed};
    int32_t places = d->n_places ? d->n_places : 1;
    deal_close_room(d);
    while (places < n) places *= 2;
    d->n_places = places;
    for (int i = 0; i < 4; i++) set_init(sets[i], places);
    d->slots = xrealloc(d->slots, (size_t)places, sizeof *d->slots);
    d->best = xmalloc(2 * (size_t)places, sizeof *d->best);
    for (int32_t i = 0; i < 2 * places; i++) d->best[i] = nothing;
    for (int32_t k = 0; k < d->n_slots; k++) deal_mark(d, k);
}
