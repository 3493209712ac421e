/*
 * The hub: the last tasks, if SCHED endgame is set and the input has ended. If a node wants work
 * and no node can be asked for some, the node gets a part of a task that another node has.
 *
 * 1. The hub takes the node that will need longest for its tasks: one of those with most work left,
 *    by powers of two, or the one whose latest progress is oldest. A task that is late, by the mean
 *    time of its pixels, is expected to take as long again as it is late.
 * 2. The last task of that node is cut, if the idle node's piece would come back before it. Its
 *    pieces cover all pixels that are missing. The first one goes to the idle node, and the rest
 *    waits for the next nodes that want work.
 * 3. A piece keeps its node busy for half of its share of all work that is left, and at least for
 *    PIECE_US and PIECE_TRIPS of its round trip. The cost of a pixel is the time that its task has
 *    taken so far, if that is late, or that of the latest piece that is done; nodes are compared by
 *    the mean times of their pixels.
 *
 * The task stays with its node, whose worker cannot be told to stop. What comes first counts: its
 * own pixels, or the last of its pieces. Pieces are entries of the ledger, and can be cut again.
 * They have new ids, above all input ids of the frame. (As deal_end.c does with the tasks of its
 * slots; see there for the sources.)
 * One machine with hub.c.
 */
#include "sched/hub_int.h"

#define PIECE_US 1000.0
#define PIECE_TRIPS .5
#define LOOKS 8 /* nodes that are compared */

/* ---- times ----------------------------------------------------------------------------------- */

static double us_per_px(const struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    double us = s->pace.us_per_px > 0 ? s->pace.us_per_px : h->pace.us_per_px;
    return us / s->width;
}

/* The mean time of a pixel of node k, of all that it has done. Nodes are compared by this, because
 * the latest pixels may be dear on one and cheap on another. */
static double mean_us(const struct hub *h, int32_t k)
{
    const struct hub_node *s = &h->nodes[k];
    return s->all_px > 0 ? s->all_us / s->all_px / s->width : us_per_px(h, k);
}

/* The time that node k needs for a pixel of entry i, which has a known cost if it is a piece. */
static double cost_us(const struct hub *h, int32_t k, int32_t i)
{
    int32_t parent = hub_task(h, i)->parent;
    return parent >= 0 ? hub_task(h, parent)->cost * mean_us(h, k) : us_per_px(h, k);
}

/* The time that node k needs for all of its tasks. *late: its current task should be done. */
static double left_us(const struct hub *h, int32_t k, bool *late)
{
    const struct hub_node *s = &h->nodes[k];
    int32_t first = s->held.head;
    *late = false;
    if (first < 0) return 0;
    double us = tasks_px(&h->ledger, first) * cost_us(h, k, first);
    double rest_us = (s->held_px - tasks_px(&h->ledger, first)) * us_per_px(h, k);
    double since_us = (double)(h->now_us - s->progress_us);
    *late = since_us > us;
    return rest_us + fabs(us - since_us);
}

/* The cost of a pixel of entry i of node k; if it is the current task, of the time so far. */
static double cost_of(const struct hub *h, int32_t k, int32_t i)
{
    double us = cost_us(h, k, i), mean = mean_us(h, k);
    double since_us = (double)(h->now_us - h->nodes[k].progress_us);
    if (i == h->nodes[k].held.head) us = fmax(us, since_us / tasks_px(&h->ledger, i));
    return mean > 0 ? us / mean : 1;
}

void hub_end_note(struct hub *h, int32_t i, const struct pace_task *done)
{
    int32_t k = hub_task(h, i)->owner, parent = hub_task(h, i)->parent;
    struct hub_node *s = &h->nodes[k];
    int64_t since = s->pace.done_us > done->sent_us ? s->pace.done_us : done->sent_us;
    bool told = done->wall_us >= 0 && done->wall_us <= done->done_us - done->sent_us;
    double us = (double)(told ? done->wall_us : done->done_us - since), px = (double)done->px;
    if (parent >= 0 && mean_us(h, k) > 0)
        hub_task(h, parent)->cost = us / s->width / px / mean_us(h, k);
    s->all_us += us;
    s->all_px += px;
}

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

/* The node that will need longest, and has a task for node k; -1: none. */
static int32_t slowest(const struct hub *h, int32_t k)
{
    double most_us = 0;
    bool late;
    int32_t found = -1, at = k;
    if (!h->worths) return -1;
    const struct slot_set *worth = &h->worth[63 - __builtin_clzll(h->worths)];
    for (int32_t n = worth->count < LOOKS ? worth->count : LOOKS; n >= 0; n--) {
        at = n ? set_after(worth, at) : h->stalest;
        if (at < 0 || at == k || last_of(h, at, k) < 0) continue;
        double us = left_us(h, at, &late);
        if (us <= most_us) continue;
        most_us = us;
        found = at;
    }
    return found;
}

/* ---- pieces ---------------------------------------------------------------------------------- */

/* Makes a piece of all missing pixels of entry i, which a node has. */
static int32_t open_task(struct hub *h, int32_t i)
{
    const struct task_entry *e = &h->ledger.at[i];
    struct lattice at = e->task.at;
    if (at.h == 1) at = lattice_cut(&at, e->frame_w, e->delivered, at.w);
    hub_task(h, i)->cost = cost_of(h, hub_task(h, i)->owner, i);
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
    uint64_t n = part_px(h, k, px, cost_us(h, k, i));
    if (at->h > 1) n = n < at->w ? at->w : n - n % at->w;
    if ((double)n < .75 * px && !h->ledger.at[i].delivered) i = cut_off(h, i, n);
    hub_unlist(h, i);
    hub_assign(h, i, k, out);
}

bool hub_end(struct hub *h, int32_t k, struct sched_actions *out)
{
    bool late;
    double mine_us = left_us(h, k, &late), trip_us = h->nodes[k].pace.round_trip_us;
    int32_t i = rest_for(h, k);
    if (i >= 0) {
        give(h, k, i, out);
        return true;
    }
    int32_t from = slowest(h, k);
    if (from < 0) return false;
    i = last_of(h, from, k);
    double us = cost_of(h, from, i) * mean_us(h, k), theirs_us = left_us(h, from, &late);
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
