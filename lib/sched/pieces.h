/*
 * Pieces of tasks, as deal and the hub of the ring cut them at the end of a run. A slot cannot be
 * told to stop. So a task that is cut stays in the ledger, and its pieces, which cover its missing
 * pixels, are entries too. What comes first counts: its own pixels, or the last of its pieces.
 * Pieces have new ids, above all input ids of their frame, and can be cut again.
 *
 * The payload of each entry of such a ledger begins with a struct piece. An entry of the input gets
 * PIECE_OF_NONE.
 */
#ifndef STORMRING_SCHED_PIECES_H
#define STORMRING_SCHED_PIECES_H

#include "task/task.h"

#include <math.h>

struct piece {
    int32_t parent;        /* the entry that it is a piece of; -1: none */
    int32_t first;         /* the first of its own uncommitted pieces; -1: none */
    int32_t before, after; /* its neighbours among the pieces of its parent; -1: none */
};
#define PIECE_OF_NONE ((struct piece){-1, -1, -1, -1})

static inline struct piece *pieces_at(const struct task_table *ledger, int32_t i)
{
    return tasks_extra(ledger, i);
}
static inline int32_t pieces_parent(const struct task_table *ledger, int32_t i)
{
    return pieces_at(ledger, i)->parent;
}
/* Is entry i cut? */
static inline bool pieces_exist(const struct task_table *ledger, int32_t i)
{
    return pieces_at(ledger, i)->first >= 0;
}
/* The id of the input task that entry i is, or is a piece of. */
uint32_t pieces_came_as(const struct task_table *ledger, int32_t i);

/* ---- new numbers ----------------------------------------------------------------------------- */

/* The highest id of each frame so far: a table of frames with a payload of PIECES_ID bytes. */
#define PIECES_ID sizeof(uint32_t)
/* Notes the id of a task of the input. */
void pieces_note_id(struct frames *ids, const struct task *t);
/* Is there another id for a piece of t? */
bool pieces_id_left(const struct frames *ids, const struct task *t);
/* Adds a piece of entry `parent` with these pixels, under a new id. The other fields of its payload
 * are zero. Pointers to entries and payloads become void. */
int32_t pieces_add(
    struct task_table *ledger, struct frames *ids, int32_t parent, const struct lattice *at);
/* Removes entry i, which has no pieces, from the pieces of its parent and from the ledger. */
void pieces_remove(struct task_table *ledger, int32_t i);
/* A piece of entry i, or of one of its pieces, that is not cut itself; -1: entry i is not cut. */
int32_t pieces_leaf(const struct task_table *ledger, int32_t i);

/* ---- cutting --------------------------------------------------------------------------------- */

#define PIECES_LEAST_US 1000.0 /* a piece is to take this time, and more: see the callers */

/* The missing pixels of an entry; of several rows, all. */
struct lattice pieces_missing(const struct task_entry *e);
/*
 * The number of pixels of a piece that keeps a slot busy for share_us, at least for least_us: from
 * 1 to most. pixel_us: what the slot needs for a pixel; 0: not known, which gives `most`.
 */
uint64_t pieces_px(double share_us, double least_us, double pixel_us, double most);
/* The same as whole rows if `at` has several: at least one row. */
uint64_t pieces_rows(const struct lattice *at, uint64_t px);
/* Cuts the first px pixels off entry i, a piece that no slot has had, as another piece. */
int32_t pieces_cut(struct task_table *ledger, struct frames *ids, int32_t i, uint64_t px);

#endif
