/* What must hold of every policy, checked as it acts. */
#include "sim/world.h"

#include <string.h>

#define AUTO_MOST 1001 /* tasks at a slot, where the depth follows the link */

static bool adapts(const struct world *w) { return w->plan->depth == SCHED_DEPTH_AUTO; }
static bool is_up(const struct world *w, int32_t k) { return w->slots[k].up; }
static bool has(const struct vtask *t, int32_t k) { return t->owners >> k & 1; }
static int32_t count_owners(const struct vtask *t) { return __builtin_popcountll(t->owners); }
static bool is_piece(const struct world *w, const struct vtask *t)
{
    return t->task.id >= (uint32_t)w->plan->tasks;
}
static bool inside(const struct world *w, const struct vtask *piece, const struct vtask *t)
{
    return piece != t && lattice_offset(&t->task.at, w->frame_w, &piece->task.at) >= 0;
}
static bool meet(const struct world *w, const struct lattice *a, const struct lattice *b)
{
    for (uint64_t i = 0, n = lattice_count(a); i < n; i++)
        for (uint64_t j = 0, m = lattice_count(b); j < m; j++)
            if (lattice_pixel(a, w->frame_w, i) == lattice_pixel(b, w->frame_w, j)) return true;
    return false;
}
/* Not committed, and computed by nobody who is up. */
static bool is_open(const struct vtask *t)
{
    return t->known && !t->committed && !t->overtaken && t->computed_by < 0;
}

static bool is_sent(const struct world *w, const struct lattice *at)
{
    uint64_t n = lattice_count(at), i = 0;
    while (i < n && coverage_has(&w->sent, lattice_pixel(at, w->frame_w, i))) i++;
    return i == n;
}

/* Was a piece of t given, that counts still? Do committed ones? */
static bool in_pieces(const struct world *w, const struct vtask *t, bool committed)
{
    for (int32_t i = w->plan->tasks; i < w->n_tasks; i++) {
        const struct vtask *p = &w->tasks[i];
        if (!p->known || p->overtaken || (p->committed && !committed)) continue;
        if (inside(w, p, t)) return true;
    }
    return false;
}

/* For a slot that has not come up yet, or of which it is not known that it does not exist. */
static bool is_promised(const struct world *w, const struct vtask *t)
{
    if (t->to < 0 || t->gives) return false;
    if (t->to >= w->plan->slots) return !w->slots_known;
    return !w->slots[t->to].up && !w->slots[t->to].lost;
}

/* Known tasks that nobody has, and that wait as themselves, for anybody or for their slot. */
static int32_t count_waiting(const struct world *w, bool promised)
{
    int32_t n = 0;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (!is_open(t) || t->owners || in_pieces(w, t, true)) continue;
        n += is_promised(w, t) == promised;
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

/* What was made of t is needed no more, unless it is lost. */
static void overtake(struct world *w, const struct vtask *t)
{
    for (int32_t i = w->plan->tasks; i < w->n_tasks; i++)
        if (w->tasks[i].known && inside(w, &w->tasks[i], t)) w->tasks[i].overtaken = true;
}

static void note_done(struct world *w, struct vtask *t, int32_t k)
{
    if (!has(t, k)) return;
    int32_t nth = w->policy->tries(w->state, k, 0, t->task.id);
    if (!is_piece(w, t) && nth != t->nth[k]) fail(w, "done of another try", nth, t->nth[k]);
    t->owners &= ~(UINT64_C(1) << k);
    w->slots[k].has--;
    if (t->computed_by >= 0 || t->committed || t->overtaken) return;
    t->computed_by = k;
    overtake(w, t);
}

static void note_gone(struct world *w, int32_t k)
{
    w->slots[k].up = false;
    w->slots[k].lost = true;
    w->slots[k].has = 0;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        w->tasks[i].owners &= ~(UINT64_C(1) << k);
        if (w->tasks[i].computed_by == k) w->tasks[i].computed_by = -1;
    }
}

static void note_pixels(struct world *w, struct vtask *t, const struct lattice *at)
{
    int64_t n0 = lattice_offset(&t->task.at, w->frame_w, at);
    if (!t->known || n0 < 0 || (uint64_t)n0 > t->sent) return;
    uint64_t n = lattice_count(at);
    if ((uint64_t)n0 + n > t->sent) t->sent = (uint64_t)n0 + n;
    for (uint64_t i = 0; i < n; i++) coverage_set(&w->sent, lattice_pixel(at, w->frame_w, i));
}

void note_event(struct world *w, const struct sched_event *e)
{
    struct vtask *t =
        e->task.frame == 0 && e->task.id < (uint32_t)w->n_tasks ? &w->tasks[e->task.id] : NULL;
    if (e->kind == SCHED_TASK && t) t->known = true;
    if (e->kind == SCHED_INPUT_END) w->input_ended = true;
    if (e->kind == SCHED_SLOTS) w->slots_known = true;
    if (e->kind == SCHED_UP) w->slots[e->slot].up = true;
    if (e->kind == SCHED_DONE && t) note_done(w, t, e->slot);
    if (e->kind == SCHED_GONE) note_gone(w, e->slot);
    if (e->kind == SCHED_PIXELS && t) note_pixels(w, t, &e->task.at);
}

/* ---- what it does ---------------------------------------------------------------------------- */

/* Does slot k owe pixels? */
static bool owes(const struct world *w, int32_t k)
{
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (t->known && !t->committed && !t->overtaken && t->computed_by == k) return true;
    }
    return false;
}

/* Slot k is given what is computed: only in the endgame, when who computed it is busy or was
 * asked for it. */
static void check_withheld(struct world *w, struct vtask *t, int32_t k)
{
    const struct vslot *s = &w->slots[t->computed_by];
    bool late = w->plan->endgame && w->input_ended && (s->asked || s->has);
    if (!late || owes(w, k)) fail(w, "work given that is computed", k, t->task.id);
    t->computed_by = -1;
    w->result->withheld++;
}

/* A piece that is seen for the first time: of one task, and beside the other pieces. */
static void check_piece(struct world *w, struct vtask *t, const struct sched_action *a)
{
    int32_t wholes = 0;
    t->task = a->task;
    w->result->pieces++;
    if (!w->plan->endgame || !w->input_ended)
        fail(w, "a piece before the end", a->slot, a->task.id);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *other = &w->tasks[i];
        if (other == t || !other->known || other->overtaken) continue;
        if (inside(w, t, other) && other->computed_by >= 0)
            check_withheld(w, &w->tasks[i], a->slot);
        if (inside(w, t, other)) wholes += i < w->plan->tasks;
        else if (inside(w, other, t)) continue;
        else if (i >= w->plan->tasks && meet(w, &t->task.at, &other->task.at))
            fail(w, "pieces overlap", a->task.id, i);
    }
    if (wholes != 1) fail(w, "a piece of no task", wholes, a->task.id);
    t->known = true;
}

/* Is t, or anything that it is a piece of, committed? */
static bool is_committed(const struct world *w, const struct vtask *t)
{
    if (t->committed) return true;
    for (int32_t i = 0; i < w->n_tasks && is_piece(w, t); i++)
        if (w->tasks[i].committed && !w->tasks[i].overtaken && inside(w, t, &w->tasks[i]))
            return true;
    return false;
}

/* So many slots have t, as itself or as a part of something longer. */
static int32_t copies_of(const struct world *w, const struct vtask *t)
{
    int32_t n = count_owners(t);
    for (int32_t i = 0; i < w->n_tasks && is_piece(w, t); i++)
        if (is_open(&w->tasks[i]) && inside(w, t, &w->tasks[i])) n += count_owners(&w->tasks[i]);
    return n;
}

/* Is the slot that has t, and nobody else, still on something else? */
static bool in_store(const struct world *w, const struct vtask *t)
{
    for (int32_t i = 0; i < w->n_tasks; i++)
        if (w->tasks[i].owners & t->owners && w->tasks[i].order < t->order) return true;
    return false;
}

/* Slot k is given what others have. */
static void check_copy(struct world *w, const struct vtask *t, int32_t k)
{
    w->result->copies++;
    if (!w->input_ended || !(w->plan->endgame || adapts(w)))
        fail(w, "work given twice", k, t->task.id);
    if (w->slots[k].has) fail(w, "a copy to a slot that is busy", k, t->task.id);
    if (count_waiting(w, false)) fail(w, "a copy, while other work waits", k, t->task.id);
    if (in_pieces(w, t, false)) fail(w, "a copy of what is in pieces", k, t->task.id);
    if (!w->plan->endgame && !in_store(w, t)) fail(w, "a copy of what is begun", k, t->task.id);
    if (copies_of(w, t) >= SIM_COPIES_MOST) fail(w, "too many copies", k, t->task.id);
}

/* Beyond the depth, or what is left of it at the end? */
static void check_depth(struct world *w, int32_t k, uint32_t id)
{
    int32_t most = adapts(w) ? AUTO_MOST : w->plan->width + w->plan->depth, n = w->slots[k].has;
    if (n > most) fail(w, "more given than the depth allows", k, id);
    /* With pieces there may be more that waits than is seen here. */
    if (!adapts(w) || w->plan->endgame || !w->input_ended || n < 2) return;
    if ((n - 1) * count_up(w) > 2 * (count_waiting(w, false) + 1))
        fail(w, "more in store than waits", k, id);
}

void check_give(struct world *w, const struct sched_action *a)
{
    struct vslot *s = &w->slots[a->slot];
    struct vtask *t = vtask_at(w, a->task.id);
    w->result->gives++;
    if (!t) {
        fail(w, "work that does not exist", a->slot, a->task.id);
        return;
    }
    if (!t->known && is_piece(w, t)) check_piece(w, t, a);
    if (memcmp(&t->task.at, &a->task.at, sizeof a->task.at) != 0)
        fail(w, "other pixels under the same id", a->slot, a->task.id);
    if (!s->up) fail(w, "work given to a slot that is not up", a->slot, a->task.id);
    if (!t->known || is_committed(w, t) || t->sent == lattice_count(&t->task.at))
        fail(w, "work given that is not to do", a->slot, a->task.id);
    if (t->computed_by >= 0) check_withheld(w, t, a->slot);
    if (t->owners) check_copy(w, t, a->slot);
    bool chosen = !t->gives && t->to >= 0 && t->to < w->plan->slots && !w->slots[t->to].lost;
    if (chosen && t->to != a->slot) fail(w, "work of one slot given to another", t->to, a->slot);
    t->owners |= UINT64_C(1) << a->slot;
    t->nth[a->slot] = (uint8_t)++t->gives;
    t->order = w->result->gives;
    s->has++;
    s->asked = false;
    if (t->to != a->slot) check_depth(w, a->slot, a->task.id);
}

void check_commit(struct world *w, const struct sched_action *a)
{
    struct vtask *t = vtask_at(w, a->task.id);
    w->result->commits++;
    if (!t || !t->known || t->committed) fail(w, "a second commit", a->task.id, 0);
    else if (!is_sent(w, &t->task.at)) fail(w, "a commit before the last pixel", a->task.id, 0);
    if (!t) return;
    t->committed = true;
    overtake(w, t);
}

void check_end(struct world *w, bool stop)
{
    bool busy = false;
    for (int32_t k = 0; k < w->plan->slots; k++) busy = busy || (is_up(w, k) && w->slots[k].has);
    if (w->ended) fail(w, "a second end", 0, 0);
    if (stop && !(w->plan->endgame || adapts(w))) fail(w, "slots are stopped", 0, 0);
    if ((w->plan->endgame || adapts(w)) && stop != busy) fail(w, "busy at the end", busy, stop);
    w->ended = true;
    w->result->end_us = w->now_us;
    w->result->stops += stop;
    for (int32_t i = 0; i < w->plan->tasks; i++)
        if (!w->tasks[i].committed) fail(w, "the end, with work uncommitted", i, 0);
}

void check_owners(struct world *w)
{
    bool endgame = w->plan->endgame && w->input_ended;
    int32_t idle = -1, free = -1; /* free: it owes nothing either */
    for (int32_t k = 0; endgame && k < w->plan->slots; k++) {
        if (!is_up(w, k) || w->slots[k].has) continue;
        idle = k;
        if (!owes(w, k)) free = k;
    }
    int64_t waiting = w->policy->waiting(w->state) - count_waiting(w, true);
    if (!endgame && waiting > count_waiting(w, false))
        fail(w, "more waiting than there is", waiting, 0);
    if (!endgame || idle < 0 || w->ended) return;
    if (waiting) fail(w, "a slot is idle, and work waits", idle, waiting);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        bool computed = t->known && !t->committed && !t->overtaken && t->computed_by >= 0;
        if (free >= 0 && computed) fail(w, "a slot is free, and pixels are withheld", free, i);
        if (!is_open(t) || !t->owners || in_pieces(w, t, false)) continue;
        if (copies_of(w, t) < SIM_COPIES_MOST) fail(w, "a slot is idle in the endgame", idle, i);
    }
}
