/*
 * The hub: expected times, by which it chooses at the end (hub_end.c). cost.h says how they are
 * measured.
 */
#include "sched/hub_int.h"

#define LATEST 8.    /* tasks: a node's time is the mean over them */
#define LOOKED_AT 8  /* tasks of a node whose costs are looked up; the others count as the mean */
#define BUSY_US 1e15 /* more than any time */

double hub_time_us(const struct hub *h, int32_t k)
{
    return cost_time_us(&h->nodes[k].speed, h->mean_us) / h->nodes[k].width;
}

static double cost_of(const struct hub *h, int32_t i)
{
    return cost_expected(&h->costs, h->ledger.at[i].task.frame, pieces_came_as(&h->ledger, i));
}

double hub_pixel_us(const struct hub *h, int32_t k, int32_t i)
{
    return cost_of(h, i) * hub_time_us(h, k);
}

double hub_own_pixel_us(const struct hub *h, int32_t k, int32_t i)
{
    double us = hub_pixel_us(h, k, i), since_us = (double)(h->now_us - h->nodes[k].progress_us);
    return i == h->nodes[k].held.head ? fmax(us, since_us / tasks_px(&h->ledger, i)) : us;
}

/* When node k ends its current task, and those that have no pieces. */
static double ends_of(const struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    double work = 0, px = s->held_px;
    int32_t i = s->held.head;
    for (int n = 0; i >= 0 && n < LOOKED_AT; n++, i = h->ledger.at[i].next) {
        px -= tasks_px(&h->ledger, i);
        if (!n || !pieces_exist(&h->ledger, i)) work += tasks_px(&h->ledger, i) * cost_of(h, i);
    }
    if (i >= 0) work += px * h->costs.mean;
    return (double)s->progress_us + work * hub_time_us(h, k);
}

double hub_left_us(const struct hub *h, int32_t k, bool *late)
{
    const struct hub_node *s = &h->nodes[k];
    int32_t i = s->held.head;
    *late = false;
    if (i < 0) return 0;
    double now = (double)h->now_us, ends_us = ends_of(h, k);
    double first_us = (double)s->progress_us + tasks_px(&h->ledger, i) * hub_pixel_us(h, k, i);
    *late = now > first_us;
    return ends_us - now + (*late ? 2 * (now - first_us) : 0);
}

void hub_cost_note(struct hub *h, int32_t i, double px, double us)
{
    struct hub_node *s = &h->nodes[hub_task(h, i)->owner];
    pace_mix(&h->task_work, px * cost_of(h, i));
    cost_note(&h->costs, &s->speed, h->ledger.at[i].task.frame, pieces_came_as(&h->ledger, i), px,
        us, 1 - 1 / LATEST);
    pace_mix(&h->mean_us, s->speed.us / s->speed.work);
}

/* When node k would be done with one more task: from now if it is idle. Else the time only serves
 * to compare such nodes, and is above all times of idle nodes. */
static double done_us(const struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    double us = h->task_work * hub_time_us(h, k);
    return us + (s->held.count ? BUSY_US + ends_of(h, k) : s->pace.round_trip_us);
}

bool hub_is_ending(const struct hub *h) { return h->p.endgame && h->ended; }

void hub_cost_mark(struct hub *h, int32_t k)
{
    if (!hub_is_ending(h)) return;
    const struct hub_node *s = &h->nodes[k];
    bool can_be_cut = hub_works(h, k) && s->held.count > s->cut;
    double never = (double)INFINITY, ends_us = can_be_cut ? ends_of(h, k) : never;
    tournament_set(&h->wanting, k, set_has(&h->hungry, k) ? done_us(h, k) : never);
    tournament_set(&h->latest, k, can_be_cut ? -ends_us : never);
    tournament_set(&h->most_late, k, ends_us);
}
