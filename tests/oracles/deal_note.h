/* What the checks of deal know of a task. */
#ifndef STORMRING_TESTS_DEAL_NOTE_H
#define STORMRING_TESTS_DEAL_NOTE_H

#include "oracles.h"
#include "sim/world.h"

struct note {
    uint64_t owners; /* slots that were given it and have not answered: bit K */
    uint64_t owing;  /* slots that have computed it, are not lost, and owe pixels: bit K */
    uint64_t got[SIM_SLOTS_MOST]; /* pixels that the slot has sent under its number */
    int32_t gives, came;          /* came: the number of tasks read when it was */
    int64_t order;                /* of the latest give, among all gives */
    uint8_t nth[SIM_SLOTS_MOST];  /* attempt number of the slot's copy */
    int32_t computed_by;          /* the first slot that computed it and is not lost, -1: none */
    bool overtaken;               /* it is a piece of a task computed since */
    bool done;                    /* a slot has computed it, ever */
    int64_t since_us;             /* time it was last given or computed */
};
static inline struct note *of(const struct vtask *t) { return t->note; }
#define LATE_US 200000 /* a task given or computed since then is not late */
#define AUTO_MOST 2501 /* most tasks at a slot if the depth follows the link */
static inline bool adapts(const struct world *w)
{
    return w->plan->params.depth == SCHED_DEPTH_AUTO;
}
static inline bool is_up(const struct world *w, int32_t k)
{
    return w->slots[k].up && !w->slots[k].drains;
}
static inline bool has(const struct vtask *t, int32_t k) { return of(t)->owners >> k & 1; }
static inline bool owes_it(const struct vtask *t, int32_t k) { return of(t)->owing >> k & 1; }
static inline int32_t count_owners(const struct vtask *t)
{
    return __builtin_popcountll(of(t)->owners);
}
static inline bool is_piece(const struct world *w, const struct vtask *t)
{
    return t->task.id >= (uint32_t)w->plan->tasks;
}
static inline bool inside(const struct world *w, const struct vtask *piece, const struct vtask *t)
{
    return piece != t && lattice_offset(&t->task.at, w->frame_w, &piece->task.at) >= 0;
}
static inline bool meet(const struct world *w, const struct lattice *a, const struct lattice *b)
{
    for (uint64_t i = 0, n = lattice_count(a); i < n; i++)
        for (uint64_t j = 0, m = lattice_count(b); j < m; j++)
            if (lattice_pixel(a, w->frame_w, i) == lattice_pixel(b, w->frame_w, j)) return true;
    return false;
}
/* Not committed, and not computed by a slot that is up. */
static inline bool is_open(const struct vtask *t)
{
    return t->known && !t->committed && !of(t)->overtaken && of(t)->computed_by < 0;
}

/* Has the slot refused the state of t, since it came up? */
static inline bool has_refused(const struct vslot *s, const struct vtask *t)
{
    const uint32_t g = t->task.generation;
    return s->refused[g / 64] >> g % 64 & 1;
}

#endif
