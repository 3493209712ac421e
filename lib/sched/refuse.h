/*
 * refuse: slots that have not the memory for a state. Such a slot refuses each task of the state's
 * generation at once. That is no loss (blame.h): the task is as good as others, and the slot gets
 * no more of the generation. If all slots that are up refuse it, its tasks are put aside until
 * another slot comes up. They are given up when nothing else is to be done and none will come.
 */
#ifndef STORMRING_SCHED_REFUSE_H
#define STORMRING_SCHED_REFUSE_H

#include "task/task.h"

#define REFUSE_RETURN_US 30000000 /* a lost slot may come back for this time, as fan's -t says */

struct refusals {
    struct refuser {
        uint64_t of[GENERATIONS / 64]; /* bit g: it refuses the generation that is g modulo */
    } * slots;                         /* GENERATIONS; of each slot, */
    int32_t n_slots;                   /* of this number */
    int32_t n;                         /* refusals that hold, */
    int32_t n_all;                     /* and generations that all refuse */
    struct refused {
        uint32_t generation; /* the latest that is this one modulo GENERATIONS: */
        int32_t n;           /* slots that are up and refuse it; */
        bool all;            /* none is up that does not, by refuse_settle, */
        int64_t since_us;    /* since that time */
    } at[GENERATIONS];
};

void refuse_free(struct refusals *r);
/* A task of this generation comes from the input. */
void refuse_begin(struct refusals *r, uint32_t generation);
/* Slot k, which is up, refuses the generation. */
void refuse_add(struct refusals *r, uint32_t generation, int32_t k);
/* Slot k is not up any more: it refuses nothing. */
void refuse_end(struct refusals *r, int32_t k);
/* Does slot k refuse the generation, */
static inline bool refuse_is(const struct refusals *r, uint32_t generation, int32_t k)
{
    const uint32_t g = generation % GENERATIONS;
    return k < r->n_slots && (r->slots[k].of[g / 64] >> g % 64 & 1);
}
/* or any? */
bool refuse_any(const struct refusals *r, int32_t k);
/* Do all slots refuse it that are up? By refuse_settle. */
static inline bool refuse_all(const struct refusals *r, uint32_t generation)
{
    return r->at[generation % GENERATIONS].all;
}
/* Then: the time until which a lost slot may come back. */
static inline int64_t refuse_until_us(const struct refusals *r, uint32_t generation)
{
    return r->at[generation % GENERATIONS].since_us + REFUSE_RETURN_US;
}
/* Of slots, `up` are up. True if a generation is refused by all of them since now, or no longer:
 * *generation. Its tasks are to be put aside, or back. To be called until it is false. */
bool refuse_settle(struct refusals *r, int32_t up, int64_t now, uint32_t *generation);

#endif
