/*
 * task: the pixel lattice. A task names pixels of one frame; the same six numbers serve rows,
 * tiles, runs that wrap at the row's end, and scattered sets.
 *
 *     pixels p = y*FW + x + i*sx + j*sy*FW,  0 <= i < w, 0 <= j < h,  FW the frame's width
 *
 * Pixel n of a task is (i, j) = (n mod w, n div w); p numbers the frame row by row from 0, top
 * left.
 */
#ifndef STORMRING_TASK_H
#define STORMRING_TASK_H

#include "base/base.h"

#define FRAME_SIDE_MAX 65535 /* pixels: p and counts of pixels fit in 32 bits unsigned */

struct lattice {
    uint32_t x, y, w, h, sx, sy;
};

struct task {
    uint32_t frame, id; /* the key; id counts from 0 in each frame */
    struct lattice at;
    int32_t to;          /* preassigned slot, -1 none */
    uint32_t generation; /* of its frame (wire.h) */
};

static inline uint64_t lattice_count(const struct lattice *l) { return (uint64_t)l->w * l->h; }
static inline uint64_t lattice_pixel(const struct lattice *l, uint32_t frame_w, uint64_t n)
{
    return (uint64_t)(l->y + n / l->w * l->sy) * frame_w + l->x + n % l->w * l->sx;
}
/* True if every number is in range and every pixel inside a frame of w x h. */
bool lattice_valid(const struct lattice *l, uint32_t frame_w, uint32_t frame_h);
/*
 * The lattice of the pixels of l from n0 on, in order: at most `most` (> 0), part of one row or
 * whole rows. Cutting from 0 by the returned counts visits every pixel once.
 */
struct lattice lattice_cut(const struct lattice *l, uint32_t frame_w, uint64_t n0, uint64_t most);
/* Returns n if sub is pixels n .. n + count of l as lattice_cut makes them; else -1. */
int64_t lattice_offset(const struct lattice *l, uint32_t frame_w, const struct lattice *sub);

/* Ways to cut a frame into tasks. */
enum cut_unit {
    CUT_ROW,
    CUT_TILE,
    CUT_RUN,
    CUT_SCATTER,
    CUT_FINE,
    CUT_COARSE,
    CUT_GUIDED,
    CUT_FACTORING
};
/* Tasks per slot: enough to balance the load, and few enough that their transfer costs little. */
#define CUT_TASKS_A_SLOT 150
#define CUT_TASKS_MOST 1000000
struct cut {
    enum cut_unit unit;
    uint32_t tasks; /* fine, coarse, tile: this many for each slot; 0: tiles as they are */
    uint32_t w,
        h; /* tile: its sides; run: w pixels; coarse: at least w; scatter: w sets; the last */
           /* two: chunks are of whole rows, or of whole runs of w pixels */
    uint32_t *ends; /* the end of each chunk: n entries, owned */
    uint32_t n;
};
/*
 * Parses "row", "tile:WxH", "run:N", "scatter" (the caller sets w), "tile:WxH:TASKS", "fine",
 * "fine:TASKS", "coarse:N" (the caller calls cut_suit), "guided", "guided:N", "factoring",
 * "factoring:N" (the caller calls cut_chunks). False if s is none of them.
 */
bool cut_parse(const char *s, struct cut *cut);
/* Chooses a size that gives cut->tasks tasks per slot. Fine and coarse become runs: fine ones no
 * longer than a row, coarse ones no shorter than w. The longer side of a tile is halved until there
 * are at least as many. */
void cut_suit(struct cut *cut, uint32_t frame_w, uint32_t frame_h, int slots);
/* Computes the chunks of a frame. power: for factoring, the powers of the slots, or NULL. With
 * powers the first `slots` chunks are one for each slot. cut_free frees them. */
void cut_chunks(
    struct cut *cut, uint32_t frame_w, uint32_t frame_h, const double *power, int slots);
/* The pixels of chunk id. */
struct lattice chunk_at(const struct cut *cut, uint32_t frame_w, uint32_t frame_h, uint32_t id);
void cut_free(struct cut *cut);
uint32_t cut_count(const struct cut *cut, uint32_t frame_w, uint32_t frame_h);
/* Task number id (< cut_count) of frame 0, unassigned. */
struct task cut_task(const struct cut *cut, uint32_t frame_w, uint32_t frame_h, uint32_t id);

/* The set of pixels of a frame that are present. */
struct coverage {
    uint32_t w, h;
    uint64_t done; /* pixels set */
    uint64_t *bits;
};

void coverage_init(struct coverage *c, uint32_t w, uint32_t h);
void coverage_free(struct coverage *c);
static inline bool coverage_has(const struct coverage *c, uint64_t p)
{
    return c->bits[p >> 6] >> (p & 63) & 1;
}
/* True if p was not present before. */
static inline bool coverage_set(struct coverage *c, uint64_t p)
{
    uint64_t bit = UINT64_C(1) << (p & 63), *word = &c->bits[p >> 6];
    if (*word & bit) return false;
    *word |= bit;
    c->done++;
    return true;
}
static inline bool coverage_full(const struct coverage *c)
{
    return c->done == (uint64_t)c->w * c->h;
}
/*
 * Finds the next lattice of missing pixels at or after *p, and advances *p; false if there are
 * none. Whole and partial rows come as one lattice each, the gaps of a scattered worker as one
 * strided lattice. Calling it until false names each missing pixel once. It marks them in `taken`,
 * which the caller must have made as a copy of c.
 */
bool coverage_missing(struct coverage *taken, uint64_t *p, struct lattice *out);
void coverage_copy(struct coverage *to, const struct coverage *from);
/*
 * Cuts off leading pixels of *at that are present: by pixel if it has one row, else by whole rows.
 * *at must be inside the frame. False if all are present; *at is unchanged then.
 */
bool coverage_trim(const struct coverage *c, struct lattice *at);

/* ---- the tasks of a frame ------------------------------------------------------------ */

/* When a slot gets its next task. */
struct cut_turn {
    double due; /* in the order of these the slots get tasks */
    int32_t slot;
    uint32_t had; /* tasks so far */
};

/*
 * The tasks of a frame, one after the other, each with its slot. Call cut_tasks_begin; set fields
 * and call the functions that are needed; cut_tasks_next until it returns false; cut_tasks_end.
 *
 * Without powers slots take turns. With powers tasks are assigned by weighted interleave: in the
 * order of slots, each slot with a credit of at least 1 gets a task and pays 1; when no slot has
 * that, each credit grows by the slot's power. Of chunks only the first ones get slots, one each in
 * order, and only with powers. A task that is left out takes no turn.
 *
 * Fine tasks are parts of rows. If those of a slot were at equal distances, they could all be in
 * few columns, which may be dear. So with unequal powers the k-th task of a slot is at a random
 * place of the k-th stretch of tasks of which it should have one.
 */
struct cut_tasks {
    struct cut cut; /* of this frame; owned */
    uint32_t frame_w, frame_h;
    uint32_t n;                  /* tasks, with those that `have` leaves out */
    const struct coverage *have; /* pixels that need no task; NULL: none. The caller's */
    uint32_t assigned;           /* the first tasks in the order, which get a slot; at first all */

    /* private */
    int slots;
    const double *power;    /* the caller's */
    double *credit;         /* by slot */
    struct cut_turn *turns; /* a heap: the first is due first. NULL: weighted interleave */
    int turn;               /* the slot to look at next */
    uint32_t *order;        /* ids; NULL: ascending */
    uint32_t at, given;     /* tasks looked at; tasks that took a turn */
};
/* What depends on the number of slots: fine, coarse, tile:WxH:TASKS; guided and factoring. */
bool cut_follows_slots(const struct cut *cut);
bool cut_in_chunks(const struct cut *cut);
/*
 * Cuts the frame. power: of the slots, above 0, or NULL; it must stay valid. slots 0, not with
 * those: no task gets a slot.
 */
void cut_tasks_begin(struct cut_tasks *c, const struct cut *cut, uint32_t frame_w, uint32_t frame_h,
    int slots, const double *power);
/* The first tasks of a frame: `count` of them, or `count` of every `of`. */
struct cut_share {
    int64_t count, of; /* 0 .. UINT32_MAX; of 0: count is a number of tasks */
};
/* Parses "COUNT" or "COUNT/OF" with COUNT <= OF. False if s is neither. */
bool cut_share_parse(const char *s, struct cut_share *share);
/* The number of tasks out of n; more than n if count is. */
uint32_t cut_share_of(const struct cut_share *share, uint32_t n);
/*
 * Puts a sample from all over the picture first: 32 tasks, evenly spread, but at most an eighth of
 * all; then 64 and 128 tasks between those, while the sample is at most a quarter of all.
 */
void cut_tasks_sample(struct cut_tasks *c);
/* Puts the tasks with the highest cost first; equals stay in the order of ids. cost: by id. */
void cut_tasks_sort(struct cut_tasks *c, const double *cost);
/* The next task, of frame 0. False: there are no more. */
bool cut_tasks_next(struct cut_tasks *c, struct task *t);
void cut_tasks_end(struct cut_tasks *c);

/* ---- tables ------------------------------------------------------------------------- */

/*
 * Tables of frames and of tasks. A table keeps what all owners need, and a payload for each entry:
 * a struct of the owner's own, whose sizeof the owner states before it adds an entry (0: none, and
 * no memory). It is aligned like that struct, and zeroed when its entry is added. The table owns
 * the payloads, the owner what they point at. Adding an entry may move all others: a pointer to an
 * entry or to a payload is valid until then. All zero is an empty table without payloads. If memory
 * is short, or 2^29 tasks are not enough, the process ends.
 */
struct payloads {
    unsigned char *at; /* `size` bytes for each entry, in the order of the entries */
    size_t size;
};

/* The known frames, in ascending order of number. */
struct frame_size {
    uint32_t frame;
    uint32_t w, h;       /* 0: the owner does not need them */
    uint32_t generation; /* generation of its state (wire.h), 0 at first */
};
struct frames {
    struct frame_size *at;
    size_t n;
    struct payloads extra;
};
/* An empty table whose payloads have this size. */
void frames_init(struct frames *f, size_t payload);
/* NULL if unknown. */
struct frame_size *frames_find(const struct frames *f, uint32_t frame);
/* Adds the frame, or changes its size. Its generation and its payload are 0 after both. */
struct frame_size *frames_set(struct frames *f, uint32_t frame, uint32_t w, uint32_t h);
/* The payload of an entry of f, which has payloads. */
static inline void *frames_extra(const struct frames *f, const struct frame_size *frame)
{
    return f->extra.at + (size_t)(frame - f->at) * f->extra.size;
}
/* Frees all entries: f is as frames_init left it. */
void frames_free(struct frames *f);

/*
 * Tasks by key (frame, id); each is on at most one list. An entry's index is stable until it is
 * removed. Memory is reused, so the steady state of a run allocates nothing.
 */
struct task_entry {
    struct task task;
    uint64_t delivered; /* pixels 0 .. delivered have arrived */
    uint32_t frame_w;
    bool live;          /* in the table */
    int32_t chain;      /* next in its hash chain, or of those not in the table */
    int32_t prev, next; /* in its list; -1: none */
};
#define GENERATIONS 128 /* limit of generations with live tasks (wire.h) */
struct task_table {
    struct task_entry *at;
    int32_t *heads;
    struct payloads extra;
    int32_t n_heads, cap, free_list, count;
    int32_t *by_generation; /* number per generation, modulo GENERATIONS; NULL: not counted */
    bool of_slot;           /* by tasks_init_slot */
};
struct task_list {
    int32_t head, tail, count; /* -1: none */
};
#define TASK_LIST_EMPTY ((struct task_list){-1, -1, 0})

/* An empty table whose payloads have this size. */
void tasks_init(struct task_table *t, size_t payload);
/* The same for the tasks of one slot of many: it begins small, and counts no generations. */
void tasks_init_slot(struct task_table *t, size_t payload);
/* The number of entries of this generation, modulo GENERATIONS. */
static inline int32_t tasks_in_generation(const struct task_table *t, uint32_t generation)
{
    return t->by_generation ? t->by_generation[generation % GENERATIONS] : 0;
}
/* Frees all entries: t is as tasks_init or tasks_init_slot left it. */
void tasks_free(struct task_table *t);
/* The payload of entry i of t, which has payloads. */
static inline void *tasks_extra(const struct task_table *t, int32_t i)
{
    return t->extra.at + (size_t)i * t->extra.size;
}
/* Index of the entry with this key, or -1. */
int32_t tasks_find(const struct task_table *t, uint32_t frame, uint32_t id);
/* Adds an entry. Its key must be new. frame_w: 0 if the owner never calls tasks_deliver. */
int32_t tasks_add(struct task_table *t, const struct task *task, uint32_t frame_w);
/* Removes an entry that is on no list. */
void tasks_remove(struct task_table *t, int32_t i);
/*
 * Records that pixels `at` of entry i have arrived. Only pixels that continue or repeat the
 * delivered ones count: false if `at` is no piece of the task or leaves a gap.
 */
bool tasks_deliver(struct task_table *t, int32_t i, const struct lattice *at);
static inline bool tasks_whole(const struct task_table *t, int32_t i)
{
    return t->at[i].delivered == lattice_count(&t->at[i].task.at);
}
/* The number of pixels of entry i. */
static inline double tasks_px(const struct task_table *t, int32_t i)
{
    return (double)lattice_count(&t->at[i].task.at);
}
void list_push_back(struct task_table *t, struct task_list *l, int32_t i);
void list_push_front(struct task_table *t, struct task_list *l, int32_t i);
void list_remove(struct task_table *t, struct task_list *l, int32_t i);

#endif
