/* Checks of deal after each action. */
#include "deal_note.h"

#include <string.h>

/* Slots were lost over t, or over a task that it is a part of, or over all that they had. Such
 * tasks wait behind others, are tried one by one, and are cut (deal_aside.c); sim checks what is
 * given up. */
static bool is_suspect(const struct world *w, const struct vtask *t)
{
    int32_t all = 0;
    bool well = false;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *other = &w->tasks[i];
        if (other->blamed && (other == t || inside(w, t, other))) return true;
        all += other->blamed;
        well = well || (other->note && of(other)->done);
    }
    return !well && all >= sim_losses(w->plan);
}

/* True if a piece of t was given that still counts; and if committed ones do. */
static bool in_pieces(const struct world *w, const struct vtask *t, bool committed)
{
    for (int32_t i = w->plan->tasks; i < w->n_tasks; i++) {
        const struct vtask *p = &w->tasks[i];
        if (!p->known || of(p)->overtaken || (p->committed && !committed)) continue;
        if (inside(w, p, t)) return true;
    }
    return false;
}

/* True if t waits for a slot that has not come up yet, or does not exist. */
static bool is_promised(const struct world *w, const struct vtask *t)
{
    if (t->to < 0 || of(t)->gives) return false;
    if (t->to >= w->plan->slots - w->plan->joins) return !w->slots_known;
    return !w->slots[t->to].up && !w->slots[t->to].lost;
}

/* Known tasks without an owner that wait as a whole, for any slot or for theirs; all, or only those
 * that are not suspect. */
static int32_t count_waiting(const struct world *w, bool promised, bool all)
{
    int32_t n = 0;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (!is_open(t) || of(t)->owners || in_pieces(w, t, true)) continue;
        n += is_promised(w, t) == promised && (all || !is_suspect(w, t));
    }
    return n;
}

static int32_t count_up(const struct world *w)
{
    int32_t n = 0;
    for (int32_t k = 0; k < w->plan->slots; k++) n += is_up(w, k);
    return n;
}

/* ---- what the policy is told ----------------------------------------------------------------- */

/* The pieces of t are not needed any more, unless t is lost. */
static void overtake(struct world *w, const struct vtask *t)
{
    for (int32_t i = w->plan->tasks; i < w->n_tasks; i++)
        if (w->tasks[i].known && inside(w, &w->tasks[i], t)) of(&w->tasks[i])->overtaken = true;
}

static void note_done(struct world *w, struct vtask *t, int32_t k)
{
    if (!has(t, k)) return;
    int32_t nth = w->policy->tries(w->state, k, 0, t->task.id);
    if (!is_piece(w, t) && nth != of(t)->nth[k])
        sim_fail(w, "the policy numbers an attempt wrongly", nth, of(t)->nth[k]);
    of(t)->owners &= ~(UINT64_C(1) << k);
    of(t)->done = true;
    w->slots[k].has--;
    if (of(t)->got[k] < lattice_count(&t->task.at)) of(t)->owing |= UINT64_C(1) << k;
    if (of(t)->computed_by >= 0 || t->committed || of(t)->overtaken) return;
    of(t)->computed_by = k;
    of(t)->since_us = w->now_us;
    overtake(w, t);
}

/* Slot k cannot compute t. */
static void note_fail(struct world *w, struct vtask *t, int32_t k, bool refused)
{
    const uint64_t bit = UINT64_C(1) << k;
    const uint32_t g = t->task.generation;
    if (!has(t, k) && !owes_it(t, k)) return;
    if (refused && is_up(w, k)) w->slots[k].refused[g / 64] |= UINT64_C(1) << g % 64;
    w->slots[k].has -= has(t, k);
    of(t)->owners &= ~bit;
    of(t)->owing &= ~bit;
    if (of(t)->computed_by == k)
        of(t)->computed_by = of(t)->owing && !of(t)->owners ? __builtin_ctzll(of(t)->owing) : -1;
}

static void note_gone(struct world *w, int32_t k)
{
    w->slots[k].has = 0;
    memset(w->slots[k].refused, 0, sizeof w->slots[k].refused);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct note *t = of(&w->tasks[i]);
        uint64_t bit = UINT64_C(1) << k;
        bool alone = t->owners == bit && t->computed_by < 0 && !in_pieces(w, &w->tasks[i], false);
        t->owners &= ~bit;
        t->owing &= ~bit;
        if (t->computed_by == k || alone)
            t->computed_by = t->owing && !t->owners ? __builtin_ctzll(t->owing) : -1;
    }
}

/* Pixels of t came from slot k: those that continue or repeat the earlier ones count. */
static void note_pixels(struct world *w, struct vtask *t, const struct sched_event *e)
{
    if (!has(t, e->slot) && !owes_it(t, e->slot)) return;
    uint64_t *got = &of(t)->got[e->slot], n = lattice_count(&e->task.at);
    int64_t at = lattice_offset(&t->task.at, w->frame_w, &e->task.at);
    if (at < 0 || (uint64_t)at > *got) return;
    if ((uint64_t)at + n > *got) *got = (uint64_t)at + n;
    if (*got == lattice_count(&t->task.at)) of(t)->owing &= ~(UINT64_C(1) << e->slot);
}

static void deal_task(struct vtask *t)
{
    t->note = xcalloc(1, sizeof(struct note));
    of(t)->computed_by = -1;
}

static void deal_event(struct world *w, const struct sched_event *e)
{
    bool named = e->task.frame == 0 && e->task.id < (uint32_t)w->n_tasks;
    if (e->kind == SCHED_TASK && named) of(&w->tasks[e->task.id])->came = w->n_read;
    if (e->kind == SCHED_PIXELS && named) note_pixels(w, &w->tasks[e->task.id], e);
    if (e->kind == SCHED_DONE && named) note_done(w, &w->tasks[e->task.id], e->slot);
    if (e->kind == SCHED_FAIL && named) note_fail(w, &w->tasks[e->task.id], e->slot, e->refused);
    if (e->kind == SCHED_GONE) note_gone(w, e->slot);
}

/* ---- what it does ---------------------------------------------------------------------------- */

/* True if slot k owes pixels. */
static bool owes(const struct world *w, int32_t k)
{
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (t->known && !t->committed && !of(t)->overtaken && owes_it(t, k)) return true;
    }
    return false;
}

static bool is_late(const struct world *w, const struct vtask *t)
{
    return w->plan->params.endgame && w->now_us - of(t)->since_us >= LATE_US;
}

/* Slot k is given a computed task: only in the endgame, or late, if a slot that computed it is busy
 * or was asked to flush. */
static void check_withheld(struct world *w, struct vtask *t, int32_t k)
{
    bool late = false;
    for (int32_t i = 0; i < w->plan->slots; i++)
        late = late || (owes_it(t, i) && (w->slots[i].asked || w->slots[i].has));
    late = late && w->plan->params.endgame && (w->input_ended || is_late(w, t));
    late = late && (double)(w->now_us - of(t)->since_us) >= w->plan->params.least_us;
    if (!late || owes(w, k)) sim_fail(w, "a computed task was given again", k, t->task.id);
    of(t)->computed_by = -1;
    w->result->withheld++;
}

/* A new piece: of one task, and disjoint from the other pieces. */
static void check_piece(struct world *w, struct vtask *t, const struct sched_action *a)
{
    int32_t wholes = 0;
    t->task = a->task;
    bool searched = is_suspect(w, t);
    if ((!w->plan->params.endgame && !searched) || !w->input_ended)
        sim_fail(w, "a piece was given before the endgame", a->slot, a->task.id);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *other = &w->tasks[i];
        if (other == t || !other->known || of(other)->overtaken) continue;
        if (inside(w, t, other) && of(other)->computed_by >= 0)
            check_withheld(w, &w->tasks[i], a->slot);
        if (inside(w, t, other)) wholes += i < w->plan->tasks;
        else if (inside(w, other, t)) continue;
        else if (i >= w->plan->tasks && meet(w, &t->task.at, &other->task.at))
            sim_fail(w, "pieces overlap", a->task.id, i);
    }
    if (wholes != 1) sim_fail(w, "a piece is not part of exactly one task", wholes, a->task.id);
    t->known = true;
}

/* True if t, or a task that it is a piece of, is committed. */
static bool is_committed(const struct world *w, const struct vtask *t)
{
    if (t->committed) return true;
    for (int32_t i = 0; i < w->n_tasks && is_piece(w, t); i++)
        if (w->tasks[i].committed && !of(&w->tasks[i])->overtaken && inside(w, t, &w->tasks[i]))
            return true;
    return false;
}

/* The number of slots that have t, by itself or as part of a longer task. */
static int32_t copies_of(const struct world *w, const struct vtask *t)
{
    int32_t n = count_owners(t);
    for (int32_t i = 0; i < w->n_tasks && is_piece(w, t); i++)
        if (is_open(&w->tasks[i]) && inside(w, t, &w->tasks[i])) n += count_owners(&w->tasks[i]);
    return n;
}

/* True if the only slot that has t is still computing another task. */
static bool in_store(const struct world *w, const struct vtask *t)
{
    for (int32_t i = 0; i < w->n_tasks; i++)
        if (of(&w->tasks[i])->owners & of(t)->owners && of(&w->tasks[i])->order < of(t)->order)
            return true;
    return false;
}

/* Slot k is given a task that others have. withheld: one has computed it, but no pixels come. */
static void check_copy(struct world *w, const struct vtask *t, int32_t k, bool withheld)
{
    w->result->copies++;
    if (is_suspect(w, t)) return; /* slots that have it may hang */
    bool may = w->input_ended && (w->plan->params.endgame || adapts(w));
    if (!may && !is_late(w, t)) sim_fail(w, "a task was given twice", k, t->task.id);
    w->result->late_copies += !may;
    if (w->slots[k].has) sim_fail(w, "a busy slot was given a copy", k, t->task.id);
    if (w->plan->p_refuse <= 0 && count_waiting(w, false, false)) /* else all may refuse those */
        sim_fail(w, "a copy was given while other tasks wait", k, t->task.id);
    if (in_pieces(w, t, false)) sim_fail(w, "a copy of a task in pieces was given", k, t->task.id);
    bool early = (double)(w->now_us - of(t)->since_us) < w->plan->params.least_us && !withheld;
    if ((!w->plan->params.endgame || early) && !in_store(w, t))
        sim_fail(w, "a copy of a task that a slot has begun was given", k, t->task.id);
    if (copies_of(w, t) >= SIM_COPIES_MOST && !is_late(w, t) && !withheld)
        sim_fail(w, "a task has too many copies", k, t->task.id);
}

/* True if this exceeds the depth, or its reduced value at the end. */
static void check_depth(struct world *w, int32_t k, uint32_t id)
{
    int32_t most = adapts(w) ? AUTO_MOST : w->plan->width + w->plan->params.depth,
            n = w->slots[k].has;
    if (n > most) sim_fail(w, "a slot has more tasks than the queue depth allows", k, id);
    /* With pieces, more tasks may wait than these checks count. */
    if (!adapts(w) || w->plan->params.endgame || !w->input_ended || n < 2) return;
    if ((n - 1) * count_up(w) > 2 * (count_waiting(w, false, true) + 1))
        sim_fail(w, "more tasks are queued at a slot than wait", k, id);
}

/* With equal depths the least loaded slot gets it, of equals the first; a copy, an idle one. */
static void check_least(struct world *w, int32_t k, uint32_t id)
{
    if (is_suspect(w, sim_vtask_at(w, id)) || w->plan->p_refuse > 0) return;
    for (int32_t i = 0; i < w->plan->slots && !adapts(w); i++) {
        int32_t first = i < k && !w->plan->params.endgame, had = w->slots[k].has - 1;
        if (is_up(w, i) && w->slots[i].has - first < had)
            sim_fail(w, "another slot has fewer tasks", i, id);
    }
}

/* Tasks without an owner are given in order of arrival, after all lost ones. */
static void check_turn(struct world *w, const struct vtask *t)
{
    if (w->plan->p_refuse > 0) return; /* a slot takes the next one that it does not refuse */
    int32_t blamed = 0; /* if all tasks were put aside, lost ones came behind others */
    for (int32_t i = 0; i < w->n_tasks; i++) blamed += w->tasks[i].blamed;
    if (is_suspect(w, t) || blamed >= sim_losses(w->plan)) return;
    for (int32_t i = 0; i < w->plan->tasks && !w->plan->params.endgame; i++) {
        const struct vtask *other = &w->tasks[i];
        bool first = of(other)->gives ? !of(other)->owners : of(other)->came < of(t)->came;
        if (other->to < 0 && is_open(other) && first && !is_suspect(w, other))
            sim_fail(w, "a task was given out of order", t->task.id, i);
    }
}

static void check_give(struct world *w, const struct sched_action *a)
{
    struct vslot *s = &w->slots[a->slot];
    struct vtask *t = sim_vtask_at(w, a->task.id);
    if (!t) {
        sim_fail(w, "a task was given that does not exist", a->slot, a->task.id);
        return;
    }
    if (!t->known && is_piece(w, t)) check_piece(w, t, a);
    if (memcmp(&t->task.at, &a->task.at, sizeof a->task.at) != 0)
        sim_fail(w, "two tasks with the same number have different pixels", a->slot, a->task.id);
    if (!is_up(w, a->slot))
        sim_fail(w, "a slot that is not up, or drains, was given a task", a->slot, a->task.id);
    if (!t->known || is_committed(w, t) || t->sent == lattice_count(&t->task.at))
        sim_fail(w, "a task was given that is done or unknown", a->slot, a->task.id);
    if (owes_it(t, a->slot))
        sim_fail(w, "a slot was given a task whose pixels it owes", a->slot, a->task.id);
    if (t->to != a->slot && has_refused(s, t))
        sim_fail(w, "a slot was given a task whose state it refuses", a->slot, a->task.id);
    bool withheld = of(t)->computed_by >= 0;
    if (withheld) check_withheld(w, t, a->slot);
    if (of(t)->owners) check_copy(w, t, a->slot, withheld);
    else if (t->to < 0 && !of(t)->gives) check_turn(w, t);
    bool chosen = !of(t)->gives && t->to >= 0 && t->to < w->plan->slots - w->plan->joins &&
                  !w->slots[t->to].lost && !w->slots[t->to].drains;
    if (chosen && t->to != a->slot)
        sim_fail(w, "a task of one slot was given to another", t->to, a->slot);
    of(t)->owners |= UINT64_C(1) << a->slot;
    of(t)->nth[a->slot] = (uint8_t)++of(t)->gives;
    of(t)->got[a->slot] = 0;
    of(t)->order = w->result->gives;
    of(t)->since_us = w->now_us;
    s->has++;
    s->asked = false;
    if (t->to == a->slot) return;
    check_depth(w, a->slot, a->task.id);
    check_least(w, a->slot, a->task.id);
}

static void check_stop(struct world *w, bool stop)
{
    bool busy = false, may = w->plan->params.endgame || adapts(w);
    for (int32_t k = 0; k < w->plan->slots; k++) busy |= w->slots[k].up && w->slots[k].has;
    for (int32_t i = 0; i < w->n_tasks; i++) busy |= of(&w->tasks[i])->owing != 0;
    if (stop != (may && busy))
        sim_fail(w, "slots were stopped that must not be, or left busy at the end", busy, stop);
}

/* Slot k may leave if it drains, and owes nothing. */
static void check_leave(struct world *w, int32_t k)
{
    const struct vslot *s = &w->slots[k];
    if (!s->drains || s->left) sim_fail(w, "a slot was let go that does not drain", k, s->left);
    if (s->has || owes(w, k)) sim_fail(w, "a slot was let go that has tasks", k, s->has);
}

/* A slot that drains has handed over all tasks but those that it computes at once. */
static void hand_over(struct world *w, int32_t k)
{
    struct vslot *s = &w->slots[k];
    for (int32_t i = 0; s->hands_over && i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (!has(t, k) || w->policy->tries(w->state, k, 0, t->task.id)) continue;
        of(t)->owners &= ~(UINT64_C(1) << k);
        s->has--;
    }
    if (s->hands_over && s->has > w->plan->width)
        sim_fail(w, "a slot that drains keeps tasks that it has not begun", k, s->has);
    s->hands_over = false;
}

static void deal_action(struct world *w, const struct sched_action *a)
{
    for (int32_t k = 0; k < w->plan->slots; k++) hand_over(w, k);
    if (a->kind == SCHED_LEAVE) check_leave(w, a->slot);
    if (a->kind == SCHED_GIVE) check_give(w, a);
    if (a->kind == SCHED_ASK_FLUSH) w->slots[a->slot].asked = true;
    if (a->kind == SCHED_COMMIT) overtake(w, sim_vtask_at(w, a->task.id));
    if (a->kind == SCHED_END || a->kind == SCHED_STOP) check_stop(w, a->kind == SCHED_STOP);
}

/* A slot that drains is let go at once when it owes nothing, and is asked for what it owes. */
static void check_drains(struct world *w)
{
    for (int32_t k = 0; k < w->plan->slots && !w->ended; k++) {
        const struct vslot *s = &w->slots[k];
        if (!s->drains || s->left || s->has || (s->asked && owes(w, k))) continue;
        sim_fail(w, "a slot that drains has nothing to do and is not let go", k, s->asked);
    }
}

static void check_owners(struct world *w)
{
    bool endgame = w->plan->params.endgame && w->input_ended;
    int32_t idle = -1, free = -1; /* the first idle slot; one that owes no pixels either */
    for (int32_t k = w->plan->slots - 1; endgame && k >= 0; k--) {
        if (!is_up(w, k) || w->slots[k].has) continue;
        idle = k;
        if (!owes(w, k)) free = k;
    }
    for (int32_t k = 0; k < w->plan->slots; k++) hand_over(w, k);
    check_drains(w);
    if (w->n_tasks > 1000 && w->result->events % 16) return; /* what follows looks at all tasks */
    int64_t waiting = w->policy->waiting(w->state) - count_waiting(w, true, true);
    if (!endgame && waiting > count_waiting(w, false, true))
        sim_fail(w, "the policy counts more waiting tasks than exist", waiting, 0);
    if (!endgame || idle < 0 || w->ended || w->plan->p_refuse > 0) return;
    if (waiting) sim_fail(w, "a slot is idle while tasks wait", idle, waiting);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (w->plan->params.least_us > 0) continue; /* it may be early */
        bool computed = t->known && !t->committed && !of(t)->overtaken && of(t)->computed_by >= 0;
        if (free >= 0 && computed) sim_fail(w, "a slot is free while pixels are withheld", free, i);
        if (!is_open(t) || !of(t)->owners || in_pieces(w, t, false)) continue;
        if (is_suspect(w, t)) continue;
        if (copies_of(w, t) < SIM_COPIES_MOST && (free >= 0 || !owes_it(t, idle)))
            sim_fail(w, "a slot is idle in the endgame", idle, i);
    }
}

const struct sim_checks oracle_deal = {deal_task, deal_event, deal_action, .after = check_owners};
