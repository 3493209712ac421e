/*
 * deal: the choice of the next slot.
 */
#include "sched/deal_int.h"

#define SHARES 2 /* of the pool: the most a slot may hold at the end */

/* The limit of the tasks that a slot may hold beyond its width. */
static double share_of(const struct deal *d)
{
    bool revoked = d->up && d->ended && (deal_adapts(d) || d->p.endgame) && !deal_timed(d);
    return revoked ? SHARES * d->pool.count / d->up : (double)INFINITY;
}

int32_t deal_pick_hungriest(struct deal *d)
{
    const struct tournament_filter few = {.under = &d->excess, .limit = share_of(d)};
    for (;;) {
        int32_t k = tournament_least(&d->need, &few);
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

double deal_pick_us(const struct deal *d) { return tournament_top(&d->need); }

int32_t deal_pick_store(const struct deal *d) { return tournament_least(&d->store, NULL); }
