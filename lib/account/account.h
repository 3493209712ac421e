/*
 * account: how the slots of a run spent their time, from the history of its log, and the least time
 * that any schedule would need.
 *
 * Call order: account_make; set the powers of slots, if known; account_bound; account_free. Times
 * are in seconds. Nothing here exits or prints.
 */
#ifndef STORMRING_ACCOUNT_H
#define STORMRING_ACCOUNT_H

#include "history/history.h"
#include "stats/stats.h"

/* A slot that did something, or that a hello counts. */
struct account_slot {
    char name[HISTORY_NAME];
    double power; /* 1, until the caller sets it */
    struct times times;
    double cpu_s;
    int64_t tasks, duplicates, retries, steals; /* duplicates: tasks whose pixels were not used */
};

#define ACCOUNT_OUTER UINT32_MAX

struct account {
    const struct history *log;  /* the caller's; it must stay until account_free */
    struct account_slot *slots; /* by name: 0, 1, ..., 10 */
    size_t n_slots;
    uint32_t *slot_of;  /* index in slots of each slot of the log; ACCOUNT_OUTER: it has no tasks */
    struct span *spans; /* of each done of the log; slots and runs are indices */
    double *run_s;      /* makespan of each run */
    double *zero_s;     /* start of each run: runs follow each other */
    double makespan_s;  /* of all runs, one after the other */
    int64_t tasks;      /* different ones */
};

void account_make(struct account *a, const struct history *log);
/* What became of the task of span i. */
enum account_kind {
    ACCOUNT_TASK,   /* done at the first attempt */
    ACCOUNT_AGAIN,  /* done at a later attempt */
    ACCOUNT_WASTED, /* its pixels were not used */
    ACCOUNT_KINDS
};
enum account_kind account_kind(const struct account *a, size_t i);
/* The slot of the outermost fan that a slot belongs to: the number before the first point of its
 * name; -1 if it has none. */
int64_t account_outermost(const char *name);
/*
 * The lower bound of stats.h for these slots. The costs of tasks come from `one`, the log of a run
 * of the same pictures by one worker of power 1 (history_same); NULL: from this log. A piece is a
 * pixel, with an equal share of the cost of its task, so that one bound serves all methods. In a
 * log without pixels a piece is a task.
 */
double account_bound(const struct account *a, const struct history *one);
/* This bound / makespan; 0 if the makespan is 0. */
double account_efficiency(const struct account *a, double bound_s);
/* The sum over all slots; its name is empty and its power 0. */
struct account_slot account_total(const struct account *a);
void account_free(struct account *a);

#endif
