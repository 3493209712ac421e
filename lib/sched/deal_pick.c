/*
 * deal: the choice of the next slot, and of the tasks of a first share.
 *
 * The first tasks of a slot have to last until more can come, which takes a round trip. Neither
 * this nor what tasks cost is known then. So with expected times a slot gets FIRST of its share of
 * the work left, by the stated powers, before it has done a task. The rest is given on demand, and
 * what a slot was given too much is copied and cut at the end. Weighted factoring gives the half
 * (S. F. Hummel, J. Schmidt, R. N. Uma, J. Wein, "Load-sharing in heterogeneous systems via
 * weighted factoring", SPAA 1996); here stated powers are trusted less.
 */
#include "sched/deal_int.h"

#define SHARES 2      /* of the pool: the most a slot may hold at the end */
#define FIRST .35     /* of its share of the work: what a slot may hold before it has done a task */
#define APART_MOST 64 /* tasks from one of a first share to the next in the pool */

/* The limit of what deal_mark.c says a slot holds. */
static double limit_of(const struct deal *d)
{
    if (!d->up) return 0;
    if (deal_timed(d) && !deal_shares(d)) return (double)INFINITY;
    if (deal_timed(d)) return FIRST * d->left_px / (d->power / d->up * deal_slots(d));
    bool revoked = d->ended && (deal_adapts(d) || d->p.endgame);
    return revoked ? SHARES * d->pool.count / d->up : (double)INFINITY;
}

/* The slot that needs a task first of those below the limit. */
static int32_t first_needy(const struct deal *d)
{
    const struct tournament_filter few = {.under = &d->excess, .limit = limit_of(d)};
    return tournament_least(&d->need, &few);
}

int32_t deal_pick_hungriest(struct deal *d)
{
    for (;;) {
        int32_t k = first_needy(d);
        if (k < 0 || !deal_timed(d)) return k;
        if (tournament_key(&d->need, k) > (double)d->now_us) return -1;
        if (slot_load(&d->slots[k]) < d->slots[k].width) return k;
        if (deal_review(d, k)) deal_mark(d, k);
        if (tournament_key(&d->need, k) > (double)d->now_us) continue;
        if (!deal_overdue(d, k)) return k;
        d->slots[k].stalled = true;
        deal_mark(d, k);
    }
}

double deal_pick_us(const struct deal *d)
{
    int32_t k = first_needy(d);
    return k < 0 ? (double)INFINITY : tournament_key(&d->need, k);
}

/* Neighbours cost about the same. So a slot that gets several tasks before its times are known gets
 * every n-th one, where n slots will get as many. */
int32_t deal_pick_apart(const struct deal *d, int32_t k, int32_t i)
{
    if (!deal_shares(d) || d->slots[k].pace.measured) return -1;
    int32_t n = d->costs.mean > 0 ? d->up : deal_slots(d) - d->up + 1;
    for (n = n < APART_MOST ? n : APART_MOST; n > 0 && i >= 0; n--) i = d->ledger.at[i].next;
    return i;
}

int32_t deal_pick_store(const struct deal *d) { return tournament_least(&d->store, NULL); }
