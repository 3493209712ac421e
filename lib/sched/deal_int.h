/*
 * deal, shared by its files: deal.c (events, and what each slot gets), deal_ledger.c (tasks, and
 * the slots that hold them), deal_pick.c (which slot is next), deal_end.c (the last tasks).
 */
#ifndef STORMRING_SCHED_DEAL_INT_H
#define STORMRING_SCHED_DEAL_INT_H

#include "sched/pace.h"
#include "sched/slot_set.h"

enum slot_state { SLOT_NEW, SLOT_UP, SLOT_GONE };

struct slot {
    enum slot_state state;
    int32_t width;                       /* tasks that it is on at once, when it has enough */
    bool asked;                          /* for a flush, since it was last given work */
    struct task_list promised, computed; /* entries of the ledger */
    struct task_table has;               /* what it was given and has not done; on these lists: */
    struct task_list held, shared; /* given to it alone; `done`: and to others, or in pieces */
    struct pace pace;
};

/* What the ledger says beyond its entries, by their index. */
enum place { IN_POOL, PROMISED, OUT, COMPUTED };
struct account {
    enum place place;
    int32_t copies; /* slots that have it, and have not done it */
    int32_t latest; /* the slot it was last given to */
    int32_t parent; /* the entry that it is a piece of, -1 */
    int32_t pieces; /* of it, not committed; together they hold what is missing of it */
};

/* Of a slot; in the tournament also the best of those of several. */
struct rating {
    int32_t load;    /* what it has, the least first; INT32_MAX: it has what it may */
    int32_t excess;  /* that without what it may have in any case; likewise */
    double store_us; /* the work that it has in store, by time, the most first; 0: none */
};

struct deal {
    struct sched_params p;
    struct task_table ledger; /* tasks that are not committed */
    struct account *account;
    int32_t n_accounts;
    struct task_list pool, out;
    struct frames frames; /* top_id: the highest id of each frame so far */
    double left_px;       /* pixels of the tasks that came, and are not committed */
    struct slot *slots;
    int32_t n_slots;    /* entries of slots */
    int32_t up;         /* of these */
    int32_t known;      /* what SLOTS said, 0 before */
    int32_t n_promised; /* tasks */
    /* deal_pick.c; of the slots that are up: */
    int32_t n_places;          /* entries of slots that there is room for: a power of two */
    struct rating *best;       /* the tournament: 1 is the root, 2 i and 2 i + 1 are below i */
    struct slot_set idle;      /* they have nothing to do */
    struct slot_set free;      /* nor have they computed what is not committed */
    struct slot_set withheld;  /* they have, and were asked for it, or cannot be asked yet */
    struct slot_set unflushed; /* they have, are idle, and were not asked for it */
    int64_t late_us;           /* when a task that others have will be late; INT64_MAX: none will */
    bool ended, flush, closed;
};

static inline int32_t slot_load(const struct slot *s) { return s->held.count + s->shared.count; }

/* ---- deal_ledger.c --------------------------------------------------------------------------- */

/* A new entry of the ledger, on no list. */
int32_t deal_enter(struct deal *d, const struct task *t, uint32_t frame_w, int32_t parent);
/* Takes entry i off the list that it is on. */
void deal_take(struct deal *d, int32_t i);
/* Puts entry i, on no list, at the end of one; slot: whose, for PROMISED and COMPUTED, else -1. */
void deal_put(struct deal *d, int32_t i, enum place place, int32_t slot);
/* Puts it at the head of the pool. */
void deal_put_first(struct deal *d, int32_t i);
/* The last pixels of entry i have been passed on: forgets it, and the whole with its last piece. */
void deal_commit(struct deal *d, int32_t i, struct sched_actions *out);
/* The pieces of entry i are needed no more. */
void deal_forget_pieces(struct deal *d, int32_t i);
/* The slot that entry i was last given to has it not alone any more. */
void deal_share(struct deal *d, int32_t i);
/* Gives entry i, on no list, to slot k. */
void deal_give(struct deal *d, int32_t k, int32_t i, int64_t now, struct sched_actions *out);
/* Slot k has its entry c no more. */
void deal_drop_copy(struct deal *d, int32_t k, int32_t c);
/* Slot k is gone: what it had, of list l, is the others', or goes back to the front of the pool. */
void deal_lose(struct deal *d, int32_t k, struct task_list *l);
/* The same of the ledger's entries on list l, which it had computed, or was to have. */
void deal_reclaim(struct deal *d, struct task_list *l);

/* ---- deal_pick.c ----------------------------------------------------------------------------- */

/* Something about slot k has changed: notes what it may be picked for. */
void deal_mark(struct deal *d, int32_t k);
/* There are up to n slots: makes room for them, and what is marked of them. */
void deal_make_room(struct deal *d, int32_t n);
void deal_close_room(struct deal *d);
/* The slot that has least, the lowest of equals, or -1 when all have what they may. */
int32_t pick_hungriest(const struct deal *d);
/* The slot that has most in store, by time, the lowest of equals, or -1. */
int32_t pick_store(const struct deal *d);

/* ---- deal_end.c ------------------------------------------------------------------------------ */

/* With the pool empty: a task that others have, for a slot that has nothing to do, *k; or -1. Then
 * late_us says when there may be one. */
int32_t end_other(struct deal *d, int32_t *k, int64_t now);
/* What to give to slot k instead of entry i: a piece of it where it is long, else itself. */
int32_t end_piece(struct deal *d, int32_t k, int32_t i);
/* Is any slot still computing something? */
bool end_busy(const struct deal *d);

#endif
