/*
 * deal: marks. Each change of a slot is marked. Sets, and tournaments for the slot that needs a
 * task first and the slot with the longest queue, then answer the questions of a step in a time
 * logarithmic in the number of slots.
 */
#include "sched/deal_int.h"

#include <stdlib.h>

/* A slot gets its next task before the end of the last one: earlier by the sum of */
#define SAFETY 1.25 /* this number of round trips, and */
#define SPREAD 1.5  /* of standard deviations of a round trip's tasks, if independent */

#define LATER 2.5    /* a slot of known speed may hold this multiple of its first share */
#define UNMEASURED 4 /* the queue of a slot of unknown round trip counts this number of times */

/*
 * The number of tasks that slot s, which is up, may hold beyond those it computes. With
 * SCHED_DEPTH_AUTO it follows measurements (pace.c). A queue that is too deep costs nothing until
 * the end, and there the queues are run down: once the input has ended, a slot may hold at most
 * SHARES times its share of the pool (share_of). With SCHED_DEPTH_AUTO and an endgame, neither
 * applies: the queue follows expected times (need_of).
 */
static int32_t depth_of(const struct deal *d, const struct slot *s)
{
    return deal_adapts(d) ? pace_depth(&s->pace, s->width) : d->p.depth;
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
    if (s->speed.work <= 0)
        return deal_shares(d)    ? -1 / (1 + s->px / s->power)
               : load > s->width ? (double)INFINITY
                                 : 0;
    double us = s->last_work * deal_time_us(d, k) / s->width, trip_us = s->pace.round_trip_us;
    return s->ends_us - SAFETY * trip_us - SPREAD * sqrt(trip_us * us);
}

/*
 * What the limit of deal_pick.c is set against: the number of tasks in the queue of slot s; with
 * expected times, the pixels that it holds for its power. Those only count until its round trip is
 * measured (pace.c): LATER of them count as one when its speed is known, and costs with it.
 */
static double excess_of(const struct deal *d, const struct slot *s)
{
    int32_t load = slot_load(s);
    bool known = s->pace.measured || !deal_adapts(d);
    if (!deal_timed(d)) return (known ? 1 : UNMEASURED) * (load - s->width);
    if (!deal_shares(d) || s->pace.measured || load < s->width) return 0;
    double px = s->px * (1 + .5 / load) / s->power; /* half a task more, so that it is rounded */
    return s->speed.work > 0 ? px / LATER : px;
}

/* ---- marks ----------------------------------------------------------------------------------- */

/* Notes how much slot k needs another task, if it may have one, and how long its queue is. */
static void rate(struct deal *d, int32_t k)
{
    const struct slot *s = &d->slots[k];
    const double never = (double)INFINITY;
    int32_t load = slot_load(s);
    bool up = s->state == SLOT_UP, stores = up && s->held.count > s->width;
    double need = up && !s->starved ? need_of(d, k) : never,
           task_us = s->pace.task_us > 0 ? s->pace.task_us : 1;
    tournament_set(&d->need, k, need);
    tournament_set(&d->excess, k, need < never ? excess_of(d, s) : never);
    tournament_set(&d->store, k, stores ? -load * task_us : never);
}

void deal_mark(struct deal *d, int32_t k)
{
    struct slot *s = &d->slots[k];
    bool up = s->state == SLOT_UP, drains = s->state == SLOT_DRAINS;
    double power = !up ? 0 : s->stated > 0 ? s->stated : 1;
    d->power += power - s->power;
    s->power = power;
    bool idle = up && !slot_load(s), owes = s->owed.count;
    set_put(&d->idle, k, idle);
    set_put(&d->free, k, idle && !owes);
    bool late = s->computed.count && (s->asked || slot_load(s));
    set_put(&d->withheld, k, (up || drains) && late);
    set_put(&d->unflushed, k, idle && owes && !s->asked);
    set_put(&d->leaving, k, drains && !slot_load(s) && !(owes && s->asked));
    rate(d, k);
}

/* ---- room ------------------------------------------------------------------------------------ */

#define SETS 5
static struct slot_set *nth_set(struct deal *d, int i)
{
    struct slot_set *const sets[SETS] = {
        &d->idle, &d->free, &d->withheld, &d->unflushed, &d->leaving};
    return sets[i];
}

void deal_close_room(struct deal *d)
{
    for (int i = 0; i < SETS; i++) set_free(nth_set(d, i));
    tournament_free(&d->need);
    tournament_free(&d->excess);
    tournament_free(&d->store);
}

void deal_make_room(struct deal *d, int32_t n)
{
    int32_t places = d->need.n ? d->need.n : 1;
    if (n <= d->need.n) return;
    deal_close_room(d);
    while (places < n) places *= 2;
    for (int i = 0; i < SETS; i++) set_init(nth_set(d, i), places);
    tournament_init(&d->need, places);
    tournament_init(&d->excess, places);
    tournament_init(&d->store, places);
    d->slots = xrealloc(d->slots, (size_t)places, sizeof *d->slots);
    for (int32_t k = 0; k < d->n_slots; k++) deal_mark(d, k);
}
