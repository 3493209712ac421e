/*
 * deal: expected times. With an endgame, cuts and copies follow them; with SCHED_DEPTH_AUTO as
 * well, queues do, too. cost.h says how they are measured.
 */
#include "sched/deal_int.h"

#define LATEST 8.         /* tasks: a slot's time is the mean over them, or those of a round trip */
#define OVERDUE 1         /* a task is overdue if late by this multiple of its expected time */
#define LATER 2           /* it will then be late by this multiple of its delay so far */
#define REVIEWED 16       /* longer queues are not estimated again */
#define LOOKED_SLOTS 512  /* on n times as many, the expected end holds for n looks */
#define FRESH (1 / 64.)   /* the expected end holds for this part of the time left, */
#define FRESH_MOST_US 1e5 /* and at most for this time */

double deal_cost(const struct deal *d, int32_t i)
{
    return cost_expected(&d->costs, d->ledger.at[i].task.frame, pieces_came_as(&d->ledger, i));
}

double deal_work(const struct deal *d, int32_t i)
{
    return tasks_px(&d->ledger, i) * deal_cost(d, i);
}

double deal_time_us(const struct deal *d, int32_t k)
{
    return cost_time_us(&d->slots[k].speed, d->mean_us);
}

void deal_cost_note(struct deal *d, int32_t k, int32_t c, double us)
{
    struct slot *s = &d->slots[k];
    if (deal_copy(s, c)->given_us < s->scaled_us) return; /* it was begun at another speed */
    const struct task *t = &s->has.at[c].task;
    double keep = 1 - 1 / fmax(LATEST, s->pace.round_trip_us / s->pace.task_us);
    cost_note(&d->costs, &s->speed, t->frame, deal_copy(s, c)->came_as,
        (double)lattice_count(&t->at), us, keep);
}

/* The work of the task that slot s is on: of those to compute, the one that was given first. */
static double first_work(const struct slot *s)
{
    int32_t c = s->held.head, other = s->shared.head;
    if (c < 0 || (other >= 0 && deal_copy(s, other)->given_us < deal_copy(s, c)->given_us))
        c = other;
    return c < 0 ? 0 : deal_copy(s, c)->work;
}

/* The expected time of that task. */
static double first_us(const struct deal *d, int32_t k)
{
    return first_work(&d->slots[k]) * deal_time_us(d, k);
}

bool deal_overdue(const struct deal *d, int32_t k)
{
    const struct slot *s = &d->slots[k];
    double late_us = (double)d->now_us - s->due_us;
    return slot_load(s) && s->speed.work > 0 && late_us > OVERDUE * first_us(d, k);
}

static void set_due(struct deal *d, int32_t k)
{
    struct slot *s = &d->slots[k];
    s->due_us = s->ends_us - (s->work - first_work(s)) * deal_time_us(d, k) / s->width;
}

void deal_foresee(struct deal *d, int32_t k, int32_t c)
{
    struct slot *s = &d->slots[k];
    double arrives_us = (double)d->now_us + s->pace.round_trip_us;
    bool first = !slot_load(s);
    if (first || s->ends_us < arrives_us) s->ends_us = arrives_us;
    s->last_work = deal_copy(s, c)->work;
    s->given_us = (double)d->now_us;
    s->work += s->last_work;
    s->px += (double)lattice_count(&s->has.at[c].task.at);
    s->ends_us += s->last_work * deal_time_us(d, k) / s->width;
    if (first) s->due_us = s->ends_us;
}

void deal_forget(struct deal *d, int32_t k, int32_t c)
{
    struct slot *s = &d->slots[k];
    s->work -= deal_copy(s, c)->work;
    s->px -= (double)lattice_count(&s->has.at[c].task.at);
    double us = deal_time_us(d, k) / s->width;
    s->ends_us = fmax(
        (double)d->now_us + s->work * us, s->given_us + s->pace.round_trip_us + s->last_work * us);
    set_due(d, k);
}

void deal_scale(struct deal *d, int32_t k, double ratio)
{
    struct slot *s = &d->slots[k];
    double left_us = fmax(s->ends_us - (double)d->now_us, 0);
    if (ratio < 1 || ratio > 1) s->scaled_us = d->now_us;
    s->speed.us *= ratio;
    s->ends_us = (double)d->now_us + left_us * ratio;
    set_due(d, k);
    d->stale_us = 0;
}

void deal_cost_late(struct deal *d, int32_t i)
{
    int32_t k = deal_account(d, i)->latest;
    double us = k < 0 ? 0 : deal_time_us(d, k);
    if (us <= 0 || !deal_overdue(d, k)) return;
    double late_us = (double)d->now_us - d->slots[k].due_us;
    cost_set(&d->costs, d->ledger.at[i].task.frame, pieces_came_as(&d->ledger, i),
        deal_cost(d, i) + LATER * late_us / us / tasks_px(&d->ledger, i));
}

/* The costs of the tasks of list l are known better now. */
static void review(struct deal *d, int32_t k, const struct task_list *l)
{
    struct slot *s = &d->slots[k];
    for (int32_t c = l->head; c >= 0; c = s->has.at[c].next) {
        int32_t i = tasks_find(&d->ledger, s->has.at[c].task.frame, s->has.at[c].task.id);
        if (i < 0) continue;
        double work = deal_work(d, i), more = work - deal_copy(s, c)->work;
        deal_copy(s, c)->work = work;
        s->work += more;
        s->ends_us += more * deal_time_us(d, k) / s->width;
    }
}

bool deal_review(struct deal *d, int32_t k)
{
    struct slot *s = &d->slots[k];
    if (slot_load(s) > REVIEWED) return false;
    review(d, k, &s->held);
    review(d, k, &s->shared);
    set_due(d, k);
    return true;
}

double deal_end_us(struct deal *d)
{
    double now = (double)d->now_us;
    if (now < d->stale_us || d->looks-- > 0) return d->end_us;
    d->looks = d->n_slots / LOOKED_SLOTS - 1; /* a look takes time by their number */
    double speed = 0, known = 0, up = 0, work = d->pool_px * d->costs.mean + d->pool_work;
    for (int32_t k = 0; k < d->n_slots; k++) {
        const struct slot *s = &d->slots[k];
        if (s->state != SLOT_UP) continue;
        if (s->held.count) work += s->work;
        if (deal_overdue(d, k)) continue;
        up += s->width;
        if (s->speed.work <= 0) continue;
        known += s->width;
        speed += s->width * s->speed.work / s->speed.us;
    }
    d->mean_us = known > 0 ? known / speed : 0;
    d->end_us = known > 0 ? now + work / (speed * up / known) : (double)INFINITY;
    d->stale_us = now + fmin(FRESH * (d->end_us - now), FRESH_MOST_US);
    return d->end_us;
}
