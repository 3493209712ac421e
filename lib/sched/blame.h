/*
 * blame: tasks over which slots were lost. A slot computes its tasks in the order in which it was
 * given them. So when it is lost, or says that it cannot compute one, the first tasks that it had
 * not done are suspect, as many as it computes at once. A task may be the reason, for example
 * because it needs too much memory, or its slot may, for example because its host was switched
 * off. So a suspect is tried by other slots, and is put aside when `most` attempts were lost. Then
 * everything else is done first.
 *
 * If all of a frame is bad, each of its tasks would cost `most` slots. So a frame is put aside as a
 * whole when as many attempts were lost, whichever tasks they were, and no task of it was done.
 */
#ifndef STORMRING_SCHED_BLAME_H
#define STORMRING_SCHED_BLAME_H

#include "sched/pieces.h"
#include "sched/refuse.h"
#include "sched/sched.h"
#include "sched/slot_set.h"

#define BLAME_SLOTS 4         /* slots that are remembered for each task */
#define BLAME_CALM_US 100000  /* from the loss of a slot to that of the last one of its worker */
#define BLAME_PAUSE_US 300000 /* without work, after which an open input counts as waiting for us */

/* Payload of a frame. */
struct blame_frame {
    uint32_t top;  /* first: the highest id, for pieces.h */
    int32_t lost;  /* attempts lost before a task was done */
    bool well;     /* a task was done */
    bool aside;    /* it is put aside, */
    int32_t tried; /* one of its tasks was tried since: the `lost` that shows that it was lost */
};

struct blame {
    int32_t most;
    struct refusals refusals;
    struct frames frames;    /* all frames of the input */
    struct task_table tasks; /* that were lost, and are not committed */
    int32_t *lost;           /* of each slot: how often it was, while it computed a task */
    int32_t n_lost;          /* entries */
    int64_t calm_us;         /* when all that was lost with the latest slot is known to be lost */
    int64_t due_us;          /* when what is aside is due, if no work comes; 0: it is not known */
};
void blame_init(struct blame *b, int32_t most);
void blame_free(struct blame *b);
/* Notes a task of the input. */
void blame_note(struct blame *b, const struct task *t);
struct blame_frame *blame_frame(const struct blame *b, const struct task *t);
/* Slot k was lost over the task. True if its frame is to be put aside now. */
bool blame_add(struct blame *b, const struct task *t, int32_t k);
/* A slot was lost now, perhaps with others. */
static inline void blame_gone(struct blame *b, int64_t now) { b->calm_us = now + BLAME_CALM_US; }
/* A task of the frame was done. True if the frame was put aside, and is no longer. */
bool blame_well(struct blame *b, const struct task *t);
/* Lost attempts of the task. */
int32_t blame_count(const struct blame *b, const struct task *t);
/* Was slot k lost over the task? Of many such slots, the latest are known. */
bool blame_is(const struct blame *b, const struct task *t, int32_t k);
/* The same of entry i of a ledger, and of the tasks that it is a piece of: each may have been lost
 * for this piece. */
int32_t blame_sum(const struct blame *b, const struct task_table *ledger, int32_t i);
/* Is the entry, or its frame, to be aside, or do all slots refuse it? alone: it was aside before,
 * see below. */
bool blame_bad(const struct blame *b, const struct task_table *ledger, int32_t i, int32_t alone);
/*
 * What to do with entry i of a ledger, which is on the list `aside`, when nothing else is to be
 * done. ended: pieces may be made. alone: 0; or it was given since, or is a half, and this is the
 * number of lost attempts, by blame_count, that show that it was lost again.
 *
 * Of a frame that is aside, one task is tried. If that is lost too, the whole frame is given up. If
 * any task of the frame is done, all are as good as others. A frame whose other tasks are done is
 * treated as its last task.
 *
 * A task is cut into halves. Before the end of the input the sender of the tasks may know no
 * pieces: then it is tried as it is. One half is tried after the other: slots may die together, as
 * those of one worker do. If one half is lost, it is cut in its turn; so all of the task is
 * computed but the smallest part that is bad. If both are lost, the task is given up: to search in
 * both would cost a slot for each bad pixel.
 */
enum blame_step {
    BLAME_GIVE_FRAME,    /* give it to a slot, for its frame: then call blame_tried */
    BLAME_ABANDON_FRAME, /* give it up with all of its frame */
    BLAME_GIVE,          /* give it to a slot */
    BLAME_GIVE_ALONE,    /* the same, for the last time */
    BLAME_HALVE,         /* cut it */
    BLAME_WAIT,          /* its other half comes first */
    BLAME_ABANDON,       /* give it up */
    BLAME_ABANDON_PARENT /* give up the task that it is a half of */
};
enum blame_step blame_step(const struct blame *b, const struct task_table *ledger,
    const struct task_list *aside, int32_t i, int32_t alone, bool ended);
void blame_tried(struct blame *b, const struct task *t);
/* Is it time for what is aside? quiet: nothing else is to be done. ended: nothing more comes before
 * that. Otherwise the sender may wait for these tasks, as a policy around this one does. */
bool blame_due(struct blame *b, bool quiet, bool ended, int64_t now);
/* When to ask again; INT64_MAX: after the next event. */
int64_t blame_wake_us(const struct blame *b, int64_t now);
/* The slot to try the task: of these, one that does not refuse it; of those, one that was not lost
 * over it, and then the one lost least.
 * may: NULL, or those that it is true of. -1: none. */
int32_t blame_pick(const struct blame *b, const struct task *t, const struct slot_set *of,
    bool (*may)(const void *context, int32_t k), const void *context);
/* Says that the missing pixels of entry i are given up; all: and those of its frame. */
void blame_abandon(const struct blame *b, const struct task_table *ledger, int32_t i, bool all,
    struct sched_actions *out);
/* The task has left the ledger. */
void blame_forget(struct blame *b, const struct task *t);

#endif
