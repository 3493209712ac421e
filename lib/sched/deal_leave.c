/*
 * deal: slots that leave the run. A slot that drains gets nothing more. It finishes what it
 * computes, and hands over the rest: tasks that are queued at it, or were promised to it, go back
 * to the pool, and other slots that have copies keep them. If it sends pixels of such a task first,
 * they count. It leaves when it has computed the tasks that it kept, and all pixels that it owed
 * have been passed on, by itself or by others.
 */
#include "sched/deal_int.h"

void deal_drain(struct deal *d, int32_t k)
{
    struct slot *s = &d->slots[k];
    if (s->state == SLOT_NEW) deal_reclaim(d, &s->promised);
    if (s->state != SLOT_UP) return;
    s->state = SLOT_DRAINS;
    d->up--;
    d->drains++;
    deal_accepts(d, k);
    deal_lose(d, k, &s->shared);
    deal_lose_after(d, k, &s->held, s->width);
    deal_mark(d, k);
}

static void leave(struct deal *d, int32_t k, struct sched_actions *out)
{
    d->slots[k].state = SLOT_GONE;
    d->slots[k].width = 0; /* it will not come back */
    d->drains--;
    deal_mark(d, k);
    sched_act(out, SCHED_LEAVE, k, NULL);
}

void deal_let_go(struct deal *d, struct sched_actions *out)
{
    int32_t k;
    while ((k = set_after(&d->leaving, -1)) >= 0) {
        struct slot *s = &d->slots[k];
        if (!s->owed.count) {
            leave(d, k, out);
            continue;
        }
        s->asked = true;
        deal_mark(d, k);
        sched_act(out, SCHED_ASK_FLUSH, k, NULL);
    }
}
