/*
 * The hub: the last tasks, if SCHED endgame is set and the input has ended. If a node wants work
 * and no node can be asked for some, the node gets a part of a task that another node has.
 *
 * 1. The hub takes the node that will need longest for its tasks (hub_cost.c). A task that is late
 *    is expected to take as long again as it is late.
 * 2. The last task of that node is cut, if the idle node's piece would come back before it. Its
 *    pieces cover all pixels that are missing. The first one goes to the idle node, and the rest
 *    waits for the next nodes that want work.
 * 3. A piece keeps its node busy for half of its share of all work that is left, and at least for
 *    PIECE_US and PIECE_TRIPS of its round trip. If its task is late, a pixel costs what the task
 *    has taken so far.
 *
 * The task stays with its node, whose worker cannot be told to stop. What comes first counts: its
 * own pixels, or the last of its pieces. Pieces are entries of the ledger, and can be cut again.
 * They have new ids, above all input ids of the frame. (As deal_end.c does with the tasks of its
 * slots; see there for the sources.)
 */
#include "sched/hub_int.h"

#define PIECE_US 1000.0
#define PIECE_TRIPS .5

/* ---- which task ------------------------------------------------------------------------------ */

/* Node k has the task of entry i, or a task that this is a piece of. */
static bool has_part(const struct hub *h, int32_t k, int32_t i)
{
    while (i >= 0 && hub_task(h, i)->owner != k) i = hub_task(h, i)->parent;
    return i >= 0;
}

/* A piece that no node has, for node k. */
static int32_t rest_for(const struct hub *h, int32_t k)
{
    int32_t i = h->rest.head;
    while (i >= 0 && has_part(h, k, i)) i = h->ledger.at[i].next;
    return i;
}

/* The last task of node k that is not cut, and of which node `to` has no part; -1: none. */
static int32_t last_of(const struct hub *h, int32_t k, int32_t to)
{
    int32_t i = h->nodes[k].held.tail;
    while (i >= 0 && (hub_task(h, i)->piece >= 0 || has_part(h, to, i))) i = h->ledger.at[i].prev;
    return i;
}

struct helper {
    const struct hub *h;
    int32_t k;
};
static bool can_be_helped(const void *context, int32_t at)
{
    const struct helper *by = context;
    return at != by->k && last_of(by->h, at, by->k) >= 0;
}

/* The node that will need longest, and has a task for node k; -1: none. */
static int32_t slowest(const struct hub *h, int32_t k)
{
    const struct helper by = {h, k};
    int32_t last = tournament_least(&h->latest, can_be_helped, &by);
    int32_t late = tournament_least(&h->most_late, can_be_helped, &by);
    bool is_late;
    if (last < 0) return -1;
    return hub_left_us(h, late, &is_late) > hub_left_us(h, last, &is_late) ? late : last;
}

/* ---- pieces ---------------------------------------------------------------------------------- */

/* Makes a piece of all missing pixels of entry i, which a node has. */
static int32_t open_task(struct hub *h, int32_t i)
{
    const struct task_entry *e = &h->ledger.at[i];
    struct lattice at = e->task.at;
    if (at.h == 1) at = lattice_cut(&at, e->frame_w, e->delivered, at.w);
    int32_t k = hub_task(h, i)->owner;
    double us = hub_time_us(h, k);
    if (us > 0)
        cost_set(&h->costs, e->task.frame, hub_came_as(h, i), hub_own_pixel_us(h, k, i) / us);
    h->taken_over = true;
    i = hub_enter(h, i, &at);
    hub_mark(h, hub_task(h, hub_task(h, i)->parent)->owner);
    return i;
}

/* Splits the first n pixels off entry i, a piece that no node has. */
static int32_t cut_off(struct hub *h, int32_t i, uint64_t n)
{
    struct task_entry *e = &h->ledger.at[i];
    struct lattice at = lattice_cut(&e->task.at, e->frame_w, 0, n);
    e->task.at = lattice_cut(&e->task.at, e->frame_w, n, UINT32_MAX);
    return hub_enter(h, hub_task(h, i)->parent, &at);
}

/* The part of a piece of px pixels that node k should get; a pixel takes it us. */
static uint64_t part_px(const struct hub *h, int32_t k, double px, double us)
{
    double share_us = h->left_px * h->pace.us_per_px / h->up.count / 2;
    double least_us = PIECE_US + PIECE_TRIPS * h->nodes[k].pace.round_trip_us;
    return us > 0 ? (uint64_t)fmax(fmin(fmax(share_us, least_us) / us, px), 1) : (uint64_t)px;
}

static void give(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    const struct lattice *at = &h->ledger.at[i].task.at;
    double px = tasks_px(&h->ledger, i);
    uint64_t n = part_px(h, k, px, hub_pixel_us(h, k, i));
    if (at->h > 1) n = n < at->w ? at->w : n - n % at->w;
    if ((double)n < .75 * px && !h->ledger.at[i].delivered) i = cut_off(h, i, n);
    hub_unlist(h, i);
    hub_assign(h, i, k, out);
}

bool hub_end(struct hub *h, int32_t k, struct sched_actions *out)
{
    bool late;
    double mine_us = hub_left_us(h, k, &late), trip_us = h->nodes[k].pace.round_trip_us;
    int32_t i = rest_for(h, k);
    if (i >= 0) {
        give(h, k, i, out);
        return true;
    }
    int32_t from = slowest(h, k);
    if (from < 0) return false;
    i = last_of(h, from, k);
    double us = hub_time_us(h, from), theirs_us = hub_left_us(h, from, &late);
    if (us > 0) us = hub_own_pixel_us(h, from, i) * hub_time_us(h, k) / us;
    double need_us =
        fmax(trip_us, mine_us) + us * (double)part_px(h, k, tasks_px(&h->ledger, i), us);
    if (need_us >= theirs_us) {
        double wait_us = late ? need_us - theirs_us : need_us + theirs_us;
        int64_t then_us = h->now_us + 1 + (int64_t)fmin(wait_us, 1e12);
        if (then_us < h->end_us) h->end_us = then_us;
        return false;
    }
    give(h, k, open_task(h, i), out);
    return true;
}
