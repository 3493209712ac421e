/*
 * Workers of every simulated run, for sim_run and sim_tree_run: the tasks that a worker has, the
 * cost of a task, and the split of the worker's time. And the note of a failure.
 */
#ifndef STORMRING_SIM_WORKER_H
#define STORMRING_SIM_WORKER_H

#include "sim/sim.h"

struct sim_tasks {
    struct task *at;      /* the caller frees it */
    size_t first, n, cap; /* tasks first .. n-1 */
};
void sim_append_task(struct sim_tasks *list, const struct task *t);

/* The time of the task on a worker of power 1; others take that divided by their power. */
double sim_work_us(const struct sim_work *work, const struct task *t);

/* A worker's time. It computes one task at a time. */
struct sim_clock {
    bool busy;        /* it computes a task */
    int64_t first_us; /* begin of its first task; -1: it has begun none */
    int64_t began_us; /* begin of its current task, or of the one before */
    int64_t last_us;  /* end of its last task */
    double busy_us;   /* time of the tasks that have ended */
    double rest_us;   /* rounded off so far */
};
#define SIM_CLOCK_INIT ((struct sim_clock){.first_us = -1})
void sim_clock_begin(struct sim_clock *c, int64_t now_us);
/* The time of a task that takes us, rounded so that those of many short tasks add up. */
int64_t sim_clock_round(struct sim_clock *c, double us);
/* The current task has ended in one way or another; if there is none, nothing happens. */
void sim_clock_end(struct sim_clock *c, int64_t now_us);
/*
 * Adds the time from 0 to end_us, in four parts: before its first task, in tasks, between them, and
 * after its last one. The current task counts up to end_us. A worker that had none waited for its
 * first task all the time.
 */
void sim_clock_split(const struct sim_clock *c, int64_t end_us, struct sim_result *r);

/* Notes the first failure of a run: what, with two numbers that say where, at now_us. */
void sim_note_failure(struct sim_result *r, int64_t now_us, const char *what, int64_t a, int64_t b);

#endif
