/*
 * deal, shared by its files. Each calls only those below it:
 *
 *     deal.c        events, and which tasks a slot gets
 *     deal_aside.c  tasks that cost slots
 *     deal_end.c    the last tasks
 *     deal_leave.c  slots that leave the run
 *     deal_pick.c   the choice of the next slot
 *     deal_ledger.c tasks, and the slots that hold them
 *     deal_mark.c   what slots need and have
 *     deal_cost.c   expected times
 */
#ifndef STORMRING_SCHED_DEAL_INT_H
#define STORMRING_SCHED_DEAL_INT_H

#include "sched/blame.h"
#include "sched/cost.h"
#include "sched/pace.h"
#include "sched/pieces.h"
#include "sched/slot_set.h"
#include "sched/tournament.h"

enum slot_state { SLOT_NEW, SLOT_UP, SLOT_DRAINS, SLOT_GONE };

#define DEAL_SHARES_MOST 512 /* on more slots there are no first shares */

struct slot {
    enum slot_state state;
    int32_t width;                       /* tasks that it computes at once */
    struct pace pace;                    /* its measured times */
    struct speed speed;                  /* likewise: deal_cost.c */
    double stated;                       /* its power by the hosts file; 0: none */
    double power;                        /* that, or 1; 0 if it is not up */
    double px;                           /* pixels of its tasks to compute */
    double work;                         /* of its tasks to compute */
    double last_work;                    /* of the one given last, */
    double given_us;                     /* and when that was */
    double ends_us, due_us;              /* when its last and its first `done` are expected */
    int64_t scaled_us;                   /* when its power changed */
    bool stalled;                        /* it was overdue, and has done no task since */
    bool asked;                          /* asked to flush since it was last given work */
    bool starved;                        /* it refuses all that is in the pool */
    struct task_list promised, computed; /* entries of the ledger */
    struct task_table has;               /* copies given to it, on these lists: */
    struct task_list held;               /* to compute; no other slot has them */
    struct task_list shared;             /* to compute; others have them too, or they were cut */
    struct task_list owed;               /* computed and not committed; some pixels are missing */
    struct task_list outrun;             /* the same, but committed: others sent its pixels first */
};
/* Payload of an entry of `has`. */
enum copy_list { HELD, SHARED, OWED, OUTRUN };
struct copy {
    int64_t given_us;    /* when the slot was given it */
    double work;         /* expected */
    int32_t tries;       /* attempt number, from 1 */
    uint32_t came_as;    /* id of the input task that it is, or is a piece of */
    enum copy_list list; /* the one that it is on */
    int32_t next;        /* OWED: the next slot that owes the same task, -1: none */
};
static inline struct copy *deal_copy(const struct slot *s, int32_t c)
{
    return tasks_extra(&s->has, c);
}
/* Has slot s computed its copy c? */
static inline bool deal_computed(const struct slot *s, int32_t c)
{
    return deal_copy(s, c)->list == OWED || deal_copy(s, c)->list == OUTRUN;
}

/* Payload of an entry of the ledger. */
enum place { IN_POOL, PROMISED, OUT, COMPUTED, ASIDE };
struct account {
    struct piece piece; /* first: pieces.h */
    enum place place;
    int32_t owner;       /* PROMISED, COMPUTED: the slot on whose list it is; else -1 */
    int32_t alone;       /* not 0: it was put aside, only one slot at a time gets it; blame_step */
    int32_t tries;       /* attempts so far */
    int32_t copies;      /* slots that have a copy and have not done it */
    int32_t latest;      /* the slot it was last given to */
    int32_t owing;       /* the first slot that owes its pixels (copy.next: others), -1: none */
    double work;         /* in the pool: pixels of an input task, expected work of a piece */
    int64_t progress_us; /* when it was last given, or computed after that */
};

struct deal {
    struct sched_params p;
    struct task_table ledger; /* uncommitted tasks */
    struct task_list pool, out, aside;
    int32_t pool_of[GENERATIONS]; /* entries of the pool by generation, modulo GENERATIONS */
    struct blame blame;
    bool fed; /* tasks of a generation have come to the pool that had none of it */
    int64_t now_us;
    struct costs costs;
    double power;     /* sum of the powers of the slots that are up */
    double left_px;   /* pixels of the input tasks that no slot has computed */
    double mean_us;   /* mean time of the slots for work 1; 0: not known */
    double pool_px;   /* pixels of the input tasks in the pool */
    double pool_work; /* work of the pieces in the pool */
    double end_us;    /* expected end of the run, */
    double stale_us;  /* and until when that holds; */
    int32_t looks;    /* on many slots, for this number of looks more */
    struct slot *slots;
    int32_t n_slots;    /* entries of `slots` */
    int32_t up;         /* slots that are up, */
    int32_t drains;     /* and those that will leave */
    int32_t known;      /* number of slots, from SCHED_SLOTS; 0 before */
    int32_t n_promised; /* promised tasks */
    /* deal_mark.c, with room for as many slots as `slots`; only slots that are up: */
    struct tournament need;    /* tasks held, or the time at which it needs more */
    struct tournament excess;  /* what deal_pick.c limits; both only if it may get more */
    struct tournament store;   /* minus the time of its queued work, if there is any */
    struct slot_set idle;      /* slots with no task to compute */
    struct slot_set free;      /* idle slots that owe no pixels of computed tasks */
    struct slot_set withheld;  /* slots that owe pixels, and were asked to flush or are busy */
    struct slot_set unflushed; /* idle slots that owe pixels and were not asked to flush */
    struct slot_set leaving;   /* slots that drain, idle, and were not asked for pixels they owe */
    int64_t late_us;           /* when a task is late or a slot needs one; INT64_MAX: never */
    bool ended, flush, closed;
};

static inline int32_t slot_load(const struct slot *s) { return s->held.count + s->shared.count; }
static inline struct account *deal_account(const struct deal *d, int32_t i)
{
    return tasks_extra(&d->ledger, i);
}
static inline bool deal_adapts(const struct deal *d) { return d->p.depth == SCHED_DEPTH_AUTO; }
/* Do queues follow expected times? */
static inline bool deal_timed(const struct deal *d) { return deal_adapts(d) && d->p.endgame; }

/* Does slot k refuse entry i? */
static inline bool deal_refuses(const struct deal *d, int32_t k, int32_t i)
{
    return d->blame.refusals.n && refuse_is(&d->blame.refusals, d->ledger.at[i].task.generation, k);
}

/* Slot k is not up any more, and refuses nothing. */
static inline void deal_accepts(struct deal *d, int32_t k)
{
    refuse_end(&d->blame.refusals, k);
    d->slots[k].starved = false;
}

/* ---- deal_ledger.c --------------------------------------------------------------------------- */

/* Adds a task of the input to the ledger, on no list. */
int32_t deal_enter(struct deal *d, const struct task *t, uint32_t frame_w);
/* Entry i is new, and on no list: notes that no slot has it, after this number of attempts. */
void deal_open_account(struct deal *d, int32_t i, int32_t tries);
/* Removes entry i from its list. */
void deal_take(struct deal *d, int32_t i);
/* Appends entry i, on no list, to a list. owner: for PROMISED and COMPUTED, else -1. */
void deal_put(struct deal *d, int32_t i, enum place place, int32_t owner);
/* Puts entry i, on no list, at the head of the pool. */
void deal_put_first(struct deal *d, int32_t i);
/* Is entry i, or its frame, to be aside? */
bool deal_bad(const struct deal *d, int32_t i);
/* Puts entry i, on no list, at the end of the pool; or aside, if it is bad. */
void deal_put_last(struct deal *d, int32_t i);
/* The last pixels of entry i were passed on: removes it. The last piece also commits the whole. */
void deal_commit(struct deal *d, int32_t i, struct sched_actions *out);
/* Removes the pieces of entry i. */
void deal_forget_pieces(struct deal *d, int32_t i);
/* Moves the latest slot's copy of entry i from `held` to `shared`. */
void deal_share(struct deal *d, int32_t i);
/* Gives entry i, on no list, to slot k. */
void deal_give(struct deal *d, int32_t k, int32_t i, int64_t now, struct sched_actions *out);
/* Removes copy c of slot k. */
void deal_drop_copy(struct deal *d, int32_t k, int32_t c);
/* Slot k has computed copy c of a committed entry. Some of its pixels are missing. */
void deal_outrun(struct deal *d, int32_t k, int32_t c);
/* Slot k has computed copy c of entry i, and owes its pixels from now on. */
void deal_owe(struct deal *d, int32_t k, int32_t c, int32_t i);
/* Does slot k owe pixels of entry i? */
bool deal_owes(const struct deal *d, int32_t k, int32_t i);
/* Slot k is gone: tasks of its list l stay with other slots that have a copy or have computed one,
 * or go back to the front of the pool; or to its end, if slots were lost over them. */
void deal_lose(struct deal *d, int32_t k, struct task_list *l);
/* The same for one copy; */
void deal_lose_copy(struct deal *d, int32_t k, int32_t c);
/* for all but the first `keep` tasks of the list. */
void deal_lose_after(struct deal *d, int32_t k, struct task_list *l, int32_t keep);
/* The same for ledger entries on list l: tasks that the slot had computed or was promised. */
void deal_reclaim(struct deal *d, struct task_list *l);

/* ---- deal_pick.c ----------------------------------------------------------------------------- */

/* The number of slots: those of the fan, of which some may be lost for good. */
static inline int32_t deal_slots(const struct deal *d)
{
    return d->known > d->up ? d->known : d->up;
}
/* Does a slot get a first share? It takes time by the number of slots to find one that may have
 * more: a tenth of a millisecond a task on 10,000. */
static inline bool deal_shares(const struct deal *d)
{
    return deal_timed(d) && deal_slots(d) <= DEAL_SHARES_MOST;
}
/* The slot that needs a task first, the lowest of equals; -1 if no slot may get more now. */
int32_t deal_pick_hungriest(struct deal *d);
/* The entry of the pool to give next, after entry i, to a slot that gets several at once. */
int32_t deal_pick_apart(const struct deal *d, int32_t k, int32_t i);
/* The time when deal_pick_hungriest may find a slot. */
double deal_pick_us(const struct deal *d);
/* The slot with the longest queued work, the lowest of equals; -1 if none. */
int32_t deal_pick_store(const struct deal *d);

/* ---- deal_mark.c ----------------------------------------------------------------------------- */

/* Slot k has changed: updates the sets and the tournaments. */
void deal_mark(struct deal *d, int32_t k);
/* Makes room for n slots, and marks all again. */
void deal_make_room(struct deal *d, int32_t n);
void deal_close_room(struct deal *d);

/* ---- deal_cost.c ----------------------------------------------------------------------------- */

/* Expected cost of a pixel of entry i, and work of all its pixels. */
double deal_cost(const struct deal *d, int32_t i);
double deal_work(const struct deal *d, int32_t i);
/* Entry i is computed by a slot and will be cut: it costs more than expected if it is overdue. */
void deal_cost_late(struct deal *d, int32_t i);
/* Time of slot k for work 1; 0: not known. */
double deal_time_us(const struct deal *d, int32_t k);
/* Slot k has computed its copy c in this time. */
void deal_cost_note(struct deal *d, int32_t k, int32_t c, double us);
/* Slot k is given its copy c, or does not compute it any more: changes its expected times. */
void deal_foresee(struct deal *d, int32_t k, int32_t c);
void deal_forget(struct deal *d, int32_t k, int32_t c);
/* Estimates the tasks of slot k again, by the costs that are known now. False: there are many, and
 * it did not. */
bool deal_review(struct deal *d, int32_t k);
/* The times of slot k change by this ratio. */
void deal_scale(struct deal *d, int32_t k, double ratio);
/* Has the first task of slot k taken twice its expected time? */
bool deal_overdue(const struct deal *d, int32_t k);
/* The expected end of the run; INFINITY: not known. Updates mean_us. */
double deal_end_us(struct deal *d);

/* ---- deal_aside.c ---------------------------------------------------------------------------- */

/* Slot k is lost: blames the tasks that it computed. */
void deal_aside_blame(struct deal *d, int32_t k, struct sched_actions *out);
/* Slot k cannot compute its copy c: blames the task, unless the slot refuses the state, and takes
 * the copy away. */
void deal_aside_fail(struct deal *d, int32_t k, int32_t c, bool refused, struct sched_actions *out);
/* After refusals, or other slots that are up: puts tasks aside that all refuse, or back. */
void deal_aside_settle(struct deal *d);
/* A task of the frame was done: if the frame was put aside, its tasks go back to the pool. */
void deal_aside_well(struct deal *d, const struct task *t);
/* The entry to give to slot k instead of the first one of the pool, which it may refuse, or over
 * which it may have been lost; -1: none. */
int32_t deal_aside_other(struct deal *d, int32_t k);
/* If nothing else is to be done, tries what was put aside, or gives it up. late_us is then the time
 * to try again. */
void deal_aside_try(struct deal *d, int64_t now, struct sched_actions *out);

/* ---- deal_leave.c ---------------------------------------------------------------------------- */

/* Slot k is to leave the run. */
void deal_drain(struct deal *d, int32_t k);
/* Slots that drain and owe nothing leave; those that owe only pixels are asked to flush. */
void deal_let_go(struct deal *d, struct sched_actions *out);

/* ---- deal_end.c ------------------------------------------------------------------------------ */

/* With the pool empty: a dispatched task for the idle slot *k, or -1. After -1, late_us is the
 * time when there may be one. */
int32_t deal_end_other(struct deal *d, int32_t *k, int64_t now);
/* The entry to give to slot k instead of entry i: a piece of it if it is long, else i itself. */
int32_t deal_end_piece(struct deal *d, int32_t k, int32_t i);
/* Puts a piece into the pool that covers all missing pixels of entry i, of which slots may hold
 * copies. */
int32_t deal_end_open(struct deal *d, int32_t i);
/* Cuts n pixels off entry i, a piece in the pool, as another piece. */
int32_t deal_end_cut(struct deal *d, int32_t i, uint64_t n);
/* True if a slot still computes a copy, or has pixels of one, that may no longer be needed. */
bool deal_end_busy(const struct deal *d);

#endif
