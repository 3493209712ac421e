/* Observed costs, in a table by the numbers of tasks. */
#include "sched/cost.h"

#include <stdlib.h>

#define RECENT .0625 /* weight of the latest task in the mean cost */
#define NEAR 8       /* tasks on each side that count as near */

void cost_init(struct costs *c, uint32_t n)
{
    *c = (struct costs){.at = xcalloc(n, sizeof *c->at), .n = n};
}

void cost_free(struct costs *c) { free(c->at); }

static struct observed_cost *place_of(const struct costs *c, uint32_t frame, uint32_t id)
{
    return &c->at[(id + frame * 61) % c->n];
}

static double known_cost(const struct costs *c, uint32_t frame, uint32_t id)
{
    const struct observed_cost *o = place_of(c, frame, id);
    return o->frame == frame && o->id == id ? o->cost : 0;
}

/* The known cost of this task; else the mean of the nearest ones below and above; 0: none. */
static double near_cost(const struct costs *c, uint32_t frame, uint32_t id)
{
    double below = known_cost(c, frame, id), above = 0;
    if (below > 0) return below;
    for (uint32_t n = 1; n <= NEAR; n++) {
        if (below <= 0 && n <= id) below = known_cost(c, frame, id - n);
        if (above <= 0) above = known_cost(c, frame, id + n);
    }
    return below > 0 && above > 0 ? (below + above) / 2 : below + above;
}

double cost_expected(const struct costs *c, uint32_t frame, uint32_t id)
{
    double near = near_cost(c, frame, id);
    return near > 0 ? near : c->mean > 0 ? c->mean : 1;
}

void cost_set(struct costs *c, uint32_t frame, uint32_t id, double cost)
{
    *place_of(c, frame, id) = (struct observed_cost){frame, id, cost};
}

void cost_note(struct costs *c, struct speed *s, uint32_t frame, uint32_t id, double px, double us,
    double keep)
{
    double work = px * cost_expected(c, frame, id);
    s->us = keep * s->us + us;
    s->work = keep * s->work + work;
    double cost = us / px * s->work / s->us;
    cost_set(c, frame, id, cost);
    c->mean += c->mean > 0 ? RECENT * (cost - c->mean) : cost;
}
