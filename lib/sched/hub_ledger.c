/*
 * The hub: the ledger. Each entry is on the one list that its owner, its state and its pieces name.
 */
#include "sched/hub_int.h"

static struct task_list *list_of(struct hub *h, int32_t i)
{
    const struct hub_task *t = hub_task(h, i);
    if (t->owner < 0 && pieces_exist(&h->ledger, i)) return &h->cut;
    if (t->aside) return &h->aside;
    if (t->owner < 0) return t->piece.parent >= 0 ? &h->rest : &h->pool;
    return t->computed ? &h->nodes[t->owner].computed : &h->nodes[t->owner].held;
}

/* Entry i enters the list `held` of its owner, or leaves it. */
static void count(struct hub *h, int32_t i, int32_t more)
{
    const struct hub_task *t = hub_task(h, i);
    if (t->owner < 0 || t->computed) return;
    struct hub_node *s = &h->nodes[t->owner];
    s->held_px += more * tasks_px(&h->ledger, i);
    if (!pieces_exist(&h->ledger, i)) {
        h->left_px += more * tasks_px(&h->ledger, i);
        return;
    }
    s->cut += more;
    s->cut_px += more * tasks_px(&h->ledger, i);
}

void hub_unlist(struct hub *h, int32_t i)
{
    list_remove(&h->ledger, list_of(h, i), i);
    h->n_computed -= hub_task(h, i)->computed;
    count(h, i, -1);
}

void hub_enlist(struct hub *h, int32_t i, int32_t k, bool computed)
{
    hub_task(h, i)->owner = k;
    hub_task(h, i)->computed = computed;
    hub_task(h, i)->aside = false;
    h->n_computed += computed;
    list_push_back(&h->ledger, list_of(h, i), i);
    count(h, i, 1);
}

void hub_put_aside(struct hub *h, int32_t i)
{
    struct hub_task *t = hub_task(h, i);
    t->owner = t->from = -1;
    t->computed = false;
    t->aside = true;
    list_push_back(&h->ledger, list_of(h, i), i);
}

int32_t hub_enter(struct hub *h, const struct task *t, uint32_t frame_w)
{
    int32_t i = tasks_add(&h->ledger, t, frame_w);
    hub_task(h, i)->piece = PIECE_OF_NONE;
    hub_task(h, i)->owner = hub_task(h, i)->from = -1;
    blame_note(&h->blame, t);
    return i;
}

/* Pieces of entry i come or go: before (-1) and after (1) that. */
static void recount(struct hub *h, int32_t i, int32_t more)
{
    if (i < 0) return;
    bool unowned = hub_task(h, i)->owner < 0;
    if (unowned && more < 0) list_remove(&h->ledger, list_of(h, i), i);
    if (unowned && more > 0) list_push_back(&h->ledger, list_of(h, i), i);
    count(h, i, more);
}

/* Piece i is new: no node has it yet. */
static int32_t enlist_piece(struct hub *h, int32_t i)
{
    const struct hub_task *parent = hub_task(h, pieces_parent(&h->ledger, i));
    hub_task(h, i)->from = parent->owner;
    hub_task(h, i)->tries = parent->tries;
    hub_enlist(h, i, -1, false);
    return i;
}

int32_t hub_open_task(struct hub *h, int32_t i)
{
    const struct lattice at = pieces_missing(&h->ledger.at[i]);
    recount(h, i, -1);
    int32_t piece = pieces_add(&h->ledger, &h->blame.frames, i, &at);
    recount(h, i, 1);
    return enlist_piece(h, piece);
}

int32_t hub_cut_off(struct hub *h, int32_t i, uint64_t n)
{
    return enlist_piece(h, pieces_cut(&h->ledger, &h->blame.frames, i, n));
}

bool hub_bad(const struct hub *h, int32_t i)
{
    return blame_bad(&h->blame, &h->ledger, i, hub_task(h, i)->alone);
}

void hub_remove(struct hub *h, int32_t i)
{
    int32_t parent = pieces_parent(&h->ledger, i);
    uint32_t generation = h->ledger.at[i].task.generation;
    hub_unlist(h, i);
    blame_forget(&h->blame, &h->ledger.at[i].task);
    recount(h, parent, -1);
    pieces_remove(&h->ledger, i);
    recount(h, parent, 1);
    if (!h->blame.refusals.n || tasks_in_generation(&h->ledger, generation)) return;
    for (int32_t k = 0; k < h->n_nodes; k++)
        if (refuse_is(&h->blame.refusals, generation, k)) hub_mark(h, k);
}
