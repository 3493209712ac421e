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
 *    PIECES_LEAST_US and PIECE_TRIPS of its round trip. If its task is late, a pixel costs what the
 *    task has taken so far.
 *
 * See deal_end.c for the sources.
 */
#include "sched/hub_int.h"

#define PIECE_TRIPS .5

/* ---- which task ------------------------------------------------------------------------------ */

/* Node k has the task of entry i, or a task that this is a piece of. */
static bool has_part(const struct hub *h, int32_t k, int32_t i)
{
    while (i >= 0 && hub_task(h, i)->owner != k) i = pieces_parent(&h->ledger, i);
    return i >= 0;
}

/* A piece that no node has, for node k. */
static int32_t rest_for(const struct hub *h, int32_t k)
{
    int32_t i = h->rest.head;
    while (i >= 0 && has_part(h, k, i)) i = h->ledger.at[i].next;
    return i;
}

/* The last task of node k that is not cut, and of which node `to` has no part; -1: none. A piece of
 * a bad one would cost that node, too. */
static int32_t last_of(const struct hub *h, int32_t k, int32_t to)
{
    int32_t i = h->nodes[k].held.tail;
    while (i >= 0 && (pieces_exist(&h->ledger, i) || hub_bad(h, i) || has_part(h, to, i)))
        i = h->ledger.at[i].prev;
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
    const struct tournament_filter others = {.may = can_be_helped, .context = &by};
    int32_t last = tournament_least(&h->latest, &others);
    int32_t late = tournament_least(&h->most_late, &others);
    bool is_late;
    if (last < 0) return -1;
    return hub_left_us(h, late, &is_late) > hub_left_us(h, last, &is_late) ? late : last;
}

/* ---- pieces ---------------------------------------------------------------------------------- */

/* Makes a piece of all missing pixels of entry i, which a node has. */
static int32_t open_task(struct hub *h, int32_t i)
{
    const struct task *t = &h->ledger.at[i].task;
    int32_t k = hub_task(h, i)->owner;
    double us = hub_time_us(h, k), pixel_us = hub_own_pixel_us(h, k, i);
    if (us > 0) cost_set(&h->costs, t->frame, pieces_came_as(&h->ledger, i), pixel_us / us);
    h->taken_over = true;
    i = hub_open_task(h, i);
    hub_mark(h, k);
    return i;
}

/* The part of a piece of px pixels that node k should get; a pixel takes it us. */
static uint64_t part_px(const struct hub *h, int32_t k, double px, double us)
{
    double share_us = h->left_px * h->pace.us_per_px / h->up.count / 2;
    double least_us = PIECES_LEAST_US + PIECE_TRIPS * h->nodes[k].pace.round_trip_us;
    return pieces_px(share_us, least_us, us, px);
}

static void give(struct hub *h, int32_t k, int32_t i, struct sched_actions *out)
{
    const struct lattice *at = &h->ledger.at[i].task.at;
    double px = tasks_px(&h->ledger, i);
    uint64_t n = pieces_rows(at, part_px(h, k, px, hub_pixel_us(h, k, i)));
    bool may =
        !h->ledger.at[i].delivered && pieces_id_left(&h->blame.frames, &h->ledger.at[i].task);
    if ((double)n < .75 * px && may) i = hub_cut_off(h, i, n);
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
    if (!pieces_id_left(&h->blame.frames, &h->ledger.at[i].task)) return false;
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
