/*
 * What tasks cost, and how fast slots are, measured against each other. A slot needs for a task
 *
 *     pixels * cost of a pixel * time of the slot for work 1
 *
 * Pixels times cost are the work of a task. The time of a slot is that of its latest tasks / their
 * expected work. The cost of a pixel is then the time of its task / (pixels * time of the slot).
 */
#ifndef STORMRING_SCHED_COST_H
#define STORMRING_SCHED_COST_H

#include "sched/sched.h"

struct observed_cost {
    uint32_t frame, id;
    double cost; /* of a pixel; 0: none */
};
struct costs {
    struct observed_cost *at; /* of the latest tasks, by number modulo n */
    uint32_t n;
    double mean; /* recent; 0: not known */
};
struct speed {
    double us, work; /* of the latest tasks of a slot; 0: none */
};

/* The time that the slot needs for work 1; mean_us if none of its tasks is known. */
static inline double cost_time_us(const struct speed *s, double mean_us)
{
    return s->work > 0 ? s->us / s->work : mean_us;
}

void cost_init(struct costs *c, uint32_t n); /* allocates, cost_free frees */
void cost_free(struct costs *c);
/* The expected cost of a pixel of task `id` of the input, and of its pieces: the observed one, else
 * the mean of the nearest known tasks below and above by number, else the recent mean of all, else
 * 1. */
double cost_expected(const struct costs *c, uint32_t frame, uint32_t id);
void cost_set(struct costs *c, uint32_t frame, uint32_t id, double cost);
/* A slot has computed px pixels of task `id` in `us` microseconds. keep: the weight of its tasks
 * before this one, from 0 to 1. */
void cost_note(struct costs *c, struct speed *s, uint32_t frame, uint32_t id, double px, double us,
    double keep);

#endif
