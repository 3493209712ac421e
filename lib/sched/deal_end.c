/*
 * deal: the last tasks. Rules 1 to 4 apply once the input has ended, rule 5 at any time. Rules 2 to
 * 5 apply with the pool empty.
 *
 * 1. With an endgame, a task is cut before a slot gets it if the slot would need longer for it than
 *    one and a half pieces. A piece takes PART, or QUEUED_PART, of the time from the end of the
 *    slot's tasks to the expected end of the run (deal_cost.c). This is factoring, down to parts of
 *    rows and weighted by the measured speeds (S. F. Hummel, E. Schonberg, L. E. Flynn, "Factoring:
 *    a method for scheduling parallel loops", Comm. ACM 35(8), 1992; S. F. Hummel, J. Schmidt,
 *    R. N. Uma, J. Wein, "Load-sharing in heterogeneous systems via weighted factoring", SPAA
 *    1996).
 * 2. With SCHED_DEPTH_AUTO or an endgame, an idle slot gets a task that another slot has queued:
 *    the last one of the slot that needs longest for its queue. A task cannot be called back
 *    through a pipe; a second copy has the same effect, because the run does not wait for the
 *    first. Where pixels take longer than computing, the two slots meet in the middle.
 * 3. With an endgame, if rule 2 finds no task, an idle slot gets the task that was given longest
 *    ago, cut by rule 1 if it is long (D. P. da Silva, W. Cirne, F. V. Brasileiro, "Trading cycles
 *    for information: using replication to schedule bag-of-tasks applications on computational
 *    grids", Euro-Par 2003; there tasks are not divided). With a least time, the task must have
 *    been out for that time and the time that the idle slot would need.
 * 4. With an endgame, if rules 3 and 5 find no task, the idle slot gets a computed task whose
 *    pixels have not arrived, although their slot was asked to flush, or while it is busy and
 *    cannot be asked: it may be dead. With a least time, the task must have been out as in rule 3.
 *    A slot that owes pixels itself does not get such a task. After a flush, the rule applies
 *    before the end of the input, too, if the task is late.
 *    By no rule does a slot get a task of which it owes the pixels.
 * 5. With an endgame, an idle slot gets a late task, whether the input has ended or not, and
 *    whatever number of slots have a copy. A task is late if the idle slot could have done it
 *    PATIENCE_TASK_TIMES over since it was last given, and PATIENCE_TASK_US and the least time
 *    have passed.
 *    So neither one hanging slot nor COPIES_MOST of them can hold up a frame that other slots wait
 *    for, or a live input.
 */
#include "sched/deal_int.h"

#define COPIES_MOST 3   /* of a pixel at once, except by rule 5 */
#define PART .5         /* a piece takes this part of the time left */
#define QUEUED_PART .05 /* the same with SCHED_DEPTH_AUTO: queued pieces cost no round trips */
#define PIECE_TRIPS 2.0 /* round trips, added to its least time: less costs more than it saves */
#define QUEUED_TRIPS .1 /* the same with SCHED_DEPTH_AUTO */

/* Is entry i a task or piece that slot k may be given a copy of? */
static bool may_have(const struct deal *d, int32_t k, int32_t i)
{
    const struct account *a = deal_account(d, i);
    return a->place == OUT && !pieces_exist(&d->ledger, i) && !deal_owes(d, k, i) &&
           !deal_refuses(d, k, i);
}

/* The same, and is it being computed by fewer than COPIES_MOST slots, counting copies of the tasks
 * that it is a piece of? */
static bool may_copy(const struct deal *d, int32_t k, int32_t i)
{
    if (!may_have(d, k, i) || deal_account(d, i)->alone) return false;
    int32_t copies = 0;
    for (; i >= 0; i = pieces_parent(&d->ledger, i)) copies += deal_account(d, i)->copies;
    return copies < COPIES_MOST;
}

/* Rule 2, for slot k: the last queued task of the slot with the longest queue. */
static int32_t in_store(const struct deal *d, int32_t k)
{
    int32_t from = deal_pick_store(d);
    if (from < 0) return -1;
    const struct task_table *has = &d->slots[from].has;
    const struct task *t = &has->at[d->slots[from].held.tail].task;
    int32_t i = tasks_find(&d->ledger, t->frame, t->id);
    return i >= 0 && may_copy(d, k, i) ? i : -1;
}

/* The lowest member. */
static int32_t lowest(const struct slot_set *s) { return set_after(s, -1); }

/* The lowest that refuses nothing, if there is one. */
static int32_t lowest_willing(const struct deal *d, const struct slot_set *s)
{
    int32_t k = lowest(s);
    for (int32_t n = d->blame.refusals.n ? s->count : 0; n > 0; n--, k = set_after(s, k))
        if (!refuse_any(&d->blame.refusals, k)) break;
    return k;
}

/* Rule 4: a computed task whose pixels are missing. */
static int32_t withheld(const struct deal *d)
{
    int32_t k = lowest(&d->withheld);
    return k >= 0 ? d->slots[k].computed.head : -1;
}

/* Has entry i been out for the least time, `more_us`, and the time that slot k would need, `times`
 * over? If not, notes when it will have been. */
static bool is_out_for(
    struct deal *d, int32_t i, int32_t k, double times, double more_us, int64_t now)
{
    deal_end_us(d); /* for deal_time_us */
    double us = deal_work(d, i) * deal_time_us(d, k);
    us = d->p.least_us + more_us + times * (us + d->slots[k].pace.round_trip_us);
    int64_t out_us = deal_account(d, i)->progress_us + (int64_t)fmin(us, PATIENCE_TASK_MOST_US);
    if (now >= out_us) return true;
    if (out_us < d->late_us) d->late_us = out_us;
    return false;
}

/* Rule 5: is entry i late, for slot k? */
static bool is_late(struct deal *d, int32_t i, int32_t k, int64_t now)
{
    return is_out_for(d, i, k, PATIENCE_TASK_TIMES, PATIENCE_TASK_US, now);
}

/* Rules 3 and 4: has entry i been out long enough to be copied for slot k? */
static bool is_ripe(struct deal *d, int32_t i, int32_t k, int64_t now)
{
    return d->p.least_us <= 0 || is_out_for(d, i, k, 1, 0, now);
}

/* Rule 3, for slot k: the task given longest ago. */
static int32_t oldest(struct deal *d, int32_t k, int64_t now)
{
    int32_t i = d->out.head;
    while (i >= 0 && !may_copy(d, k, i)) i = d->ledger.at[i].next;
    return i >= 0 && is_ripe(d, i, k, now) ? i : -1;
}

/* Rule 5, for slot k: the uncut task or piece that was given longest ago, if it is late. */
static int32_t late(struct deal *d, int32_t k, int64_t now)
{
    int32_t i = d->out.head;
    while (i >= 0 && !may_have(d, k, i)) i = d->ledger.at[i].next;
    return i >= 0 && is_late(d, i, k, now) ? i : -1;
}

/* Rules 2, 3 and 5 for slot k: an entry, or -1. */
static int32_t other_for(struct deal *d, int32_t k, int64_t now)
{
    int32_t i = d->ended ? in_store(d, k) : -1;
    if (i < 0 && d->ended && d->p.endgame) i = oldest(d, k, now);
    if (i < 0 && d->p.endgame) i = late(d, k, now);
    return i;
}

int32_t deal_end_other(struct deal *d, int32_t *k, int64_t now)
{
    bool revoke = d->p.depth == SCHED_DEPTH_AUTO || d->p.endgame;
    if (!revoke || (*k = lowest_willing(d, &d->idle)) < 0) return -1;
    int32_t i = other_for(d, *k, now), free = lowest_willing(d, &d->free);
    if (i >= 0 || free < 0) return i;
    if (free != *k) i = other_for(d, *k = free, now);
    if (i >= 0 || !d->p.endgame || !(d->ended || d->flush)) return i;
    i = withheld(d);
    return i >= 0 && !deal_refuses(d, *k, i) &&
                   (d->ended ? is_ripe(d, i, *k, now) : is_late(d, i, *k, now))
               ? i
               : -1;
}

/* Rule 1: the pixels of a piece of entry i for slot k. */
static uint64_t piece_px(struct deal *d, int32_t k, int32_t i)
{
    const struct slot *s = &d->slots[k];
    double now = (double)d->now_us, trip_us = s->pace.round_trip_us;
    double end_us = deal_end_us(d), px_us = deal_time_us(d, k) * deal_cost(d, i);
    double starts_us = slot_load(s) ? fmax(s->ends_us, now + trip_us) : now + trip_us;
    bool queued = deal_timed(d);
    double trips = queued ? QUEUED_TRIPS : PIECE_TRIPS, part = queued ? QUEUED_PART : PART;
    double least_us = fmax(PIECES_LEAST_US, d->p.least_us) + trips * trip_us;
    return pieces_px(part * (end_us - starts_us), least_us, px_us, UINT32_MAX);
}

int32_t deal_end_open(struct deal *d, int32_t i)
{
    const struct lattice at = pieces_missing(&d->ledger.at[i]);
    int32_t tries = deal_account(d, i)->tries;
    deal_take(d, i);
    d->stale_us = 0;
    if (deal_account(d, i)->copies) {
        deal_cost_late(d, i);
        deal_share(d, i);
    }
    deal_put(d, i, OUT, -1);
    i = pieces_add(&d->ledger, &d->blame.frames, i, &at);
    deal_open_account(d, i, tries);
    deal_put_first(d, i);
    return i;
}

int32_t deal_end_cut(struct deal *d, int32_t i, uint64_t n)
{
    deal_take(d, i);
    int32_t piece = pieces_cut(&d->ledger, &d->blame.frames, i, n);
    deal_open_account(d, piece, deal_account(d, i)->tries);
    deal_put_first(d, i);
    deal_put_first(d, piece);
    return piece;
}

int32_t deal_end_piece(struct deal *d, int32_t k, int32_t i)
{
    if (!d->p.endgame || !d->ended || deal_account(d, i)->alone) return i;
    uint64_t px = piece_px(d, k, i);
    for (;;) {
        const struct task_entry *e = &d->ledger.at[i];
        const struct lattice at = pieces_missing(e);
        if (lattice_count(&at) <= px + px / 2) return i;
        if (!pieces_id_left(&d->blame.frames, &e->task)) return i;
        /* An input task, or a piece that was given, keeps its pixels. */
        bool named = pieces_parent(&d->ledger, i) < 0 || deal_account(d, i)->latest >= 0;
        i = named ? deal_end_open(d, i) : deal_end_cut(d, i, pieces_rows(&at, px));
    }
}

bool deal_end_busy(const struct deal *d)
{
    bool copied = d->p.depth == SCHED_DEPTH_AUTO || d->p.endgame;
    int32_t k = 0;
    while (k < d->n_slots && !d->slots[k].has.count) k++;
    return copied && k < d->n_slots;
}
