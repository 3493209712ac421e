/*
 * Checks of the ring (default rules) after each action of hub and nodes, against the checks' own
 * ledger. Steps cost no more than those of the policy, except when a slot comes or goes.
 */
#include "ring_model.h"

#include <stdlib.h>

/* Limits of a late ask, as in the rules. */
#define LATE_TIMES 8
#define LATE_US 100000
#define FIRST_US 3000000
#define ANSWERS 16
#define HUNG_US 200000 /* a node with progress since then is not late */

#define PASSES_MOST 12 /* of a task: twice as many as halving takes for 64 nodes */

/* ---- the ledger ------------------------------------------------------------------------------ */

static void note_task(struct world *w, struct ring_model *m, const struct task *task)
{
    struct rtask *t = sim_ring_task(w, task);
    if (t->place != RING_ABSENT) return;
    m->open++;
    m->most_px = fmax(m->most_px, px_of(task));
    t->from = -1;
    sim_ring_enter(w, m, t, RING_ORPHAN, m->n ? sim_ring_home(m, task) : -1);
}

/* Slots beyond these may join later. */
static void note_slots(struct world *w, struct ring_model *m, int32_t n)
{
    m->n = n;
    for (int32_t k = n; k < w->plan->slots; k++) m->slots[k].state = RING_GONE;
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct rtask *t = w->tasks[i].note;
        if (t && t->place == RING_ORPHAN)
            sim_ring_enter(w, m, t, RING_ORPHAN, sim_ring_home(m, &w->tasks[i].task));
    }
}

static void note_up(struct world *w, struct ring_model *m, int32_t k)
{
    struct rslot *s = &m->slots[k];
    if (sim_ring_works(s)) return; /* it has another power */
    if (k >= m->n) m->n = k + 1;
    m->promised -= s->promised;
    m->up += s->state != RING_UP;
    s->promised = 0;
    s->state = RING_UP;
    s->placed = false;
    sim_ring_mark(w, m, k);
}

/* Slot k has no victim any more. */
static void part(struct world *w, struct ring_model *m, int32_t k)
{
    int32_t victim = m->slots[k].victim;
    if (victim < 0) return;
    m->slots[k].victim = -1;
    m->slots[victim].thieves--;
    sim_ring_mark(w, m, victim);
    sim_ring_mark(w, m, k);
}

/* Slot k is no victim any more; the nodes that asked it ask others. */
static void pass_on(struct world *w, struct ring_model *m, int32_t k)
{
    for (int32_t i = 0; i < w->plan->slots; i++) {
        if (m->slots[i].victim != k) continue;
        m->slots[i].passed = true;
        part(w, m, i);
    }
}

static void retire(struct world *w, struct ring_model *m, int32_t k, enum rstate state)
{
    struct rslot *s = &m->slots[k];
    m->promised -= s->promised;
    m->up -= s->state == RING_UP;
    s->promised = 0;
    s->state = state;
    part(w, m, k);
    pass_on(w, m, k);
    s->asking = s->told = s->passed = s->dry = s->silent = false;
    sim_ring_mark(w, m, k);
}

static void note_gone(struct world *w, struct ring_model *m, int32_t k)
{
    retire(w, m, k, RING_GONE);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        struct rtask *t = w->tasks[i].note;
        if (t && t->base == k && t->place != RING_ABSENT) sim_ring_hand_on(w, m, t, k);
    }
}

static void note_drain(struct world *w, struct ring_model *m, int32_t k)
{
    if (m->slots[k].state == RING_UP) retire(w, m, k, RING_DRAINS);
}

static void note_done(struct world *w, struct ring_model *m, struct rtask *t, int32_t k)
{
    struct rslot *s = &m->slots[k];
    if (t->base != k || !sim_ring_works(s) || t->place == RING_ABSENT) return;
    s->dry = false;
    m->paced = true;
    sim_ring_mark(w, m, k);
    /* the repeated report means that the first was too early */
    if (t->place == RING_COMPUTED) s->flushed = false;
    if (t->place == RING_HELD) s->moved_us = w->now_us, s->timed = true, sim_ring_note_well(w, m);
    if (t->place == RING_HELD) sim_ring_enter(w, m, t, RING_COMPUTED, k);
}

static void note_ring(struct world *w, struct ring_model *m, const struct sched_event *e)
{
    struct rslot *s = &m->slots[e->slot];
    struct rtask *t = e->ring.kind == RING_GIVE ? sim_ring_task(w, &e->task) : NULL;
    int32_t peer = e->ring.peer;
    if (!sim_ring_works(s)) return;
    if (e->ring.kind == RING_ASK) {
        s->asking = true;
        sim_ring_mark(w, m, e->slot);
        return;
    }
    if (e->ring.kind != RING_GIVE && e->ring.kind != RING_NONE) return;
    bool exists = peer >= 0 && peer < m->n;
    bool given = t && t->base == e->slot && (t->place == RING_HELD || t->place == RING_COMPUTED);
    if (given && t->cut) {
        sim_ring_enter(w, m, t, RING_CUT, -1);
        given = false;
    }
    if (given) {
        t->from = e->slot;
        if (++t->passes > PASSES_MOST && w->plan->p_false <= 0)
            sim_fail(w, "a task is passed round", e->slot, (int32_t)e->task.id);
        sim_ring_enter(w, m, t, RING_ORPHAN, exists ? peer : e->slot);
    }
    if (!exists || m->slots[peer].victim != e->slot) return;
    m->answer_us -= m->answer_us / ANSWERS;
    if (w->now_us - m->slots[peer].since_us > m->answer_us)
        m->answer_us = w->now_us - m->slots[peer].since_us;
    /* A GIVE of a task that the node does not own is still an answer. */
    if (given) return;
    s->dry = s->given == m->slots[peer].given_before;
    m->slots[peer].passed = true;
    part(w, m, peer);
    sim_ring_mark(w, m, e->slot);
}

/* Ends asks that were not answered in time, and all others to the same victim. */
static void note_late(struct world *w, struct ring_model *m)
{
    int64_t late_us = m->answer_us ? LATE_TIMES * m->answer_us + LATE_US : FIRST_US;
    int64_t since_us = w->now_us - late_us;
    for (int32_t i = 0; i < w->plan->slots; i++) {
        int32_t k = m->slots[i].victim;
        if (k < 0 || m->slots[i].since_us > since_us) continue;
        m->slots[k].silent = true;
        pass_on(w, m, k);
    }
}

static void ring_event(struct world *w, const struct sched_event *e)
{
    struct ring_model *m = sim_ring_model(w);
    struct rtask *t;
    note_late(w, m);
    m->n_events++;
    if (e->kind == SCHED_DONE || e->kind == SCHED_FAIL || e->kind == SCHED_RING) {
        m->slots[e->slot].silent = false;
        sim_ring_mark(w, m, e->slot);
    }
    m->touched = e->kind == SCHED_TASK ? -1 : e->slot;
    switch (e->kind) {
    case SCHED_TASK: note_task(w, m, &e->task); break;
    case SCHED_INPUT_END: m->input_ended = true; break;
    case SCHED_FLUSH: m->flush = true; break;
    case SCHED_SLOTS: note_slots(w, m, e->n); break;
    case SCHED_UP: note_up(w, m, e->slot); break;
    case SCHED_GONE: note_gone(w, m, e->slot); break;
    case SCHED_DONE:
        if ((t = sim_ring_task(w, &e->task)) != NULL) note_done(w, m, t, e->slot);
        break;
    case SCHED_FAIL:
        if ((t = sim_ring_task(w, &e->task)) != NULL) sim_ring_note_fail(w, m, t, e->slot);
        break;
    case SCHED_RING: note_ring(w, m, e); break;
    case SCHED_DRAIN: note_drain(w, m, e->slot); break;
    case SCHED_PIXELS:
    case SCHED_WAKE: break;
    }
}

/* Tasks that wait for a slot not up yet go to nodes that ask, about half of them at a time. */
static bool is_late(struct ring_model *m, struct rtask *t, int32_t k)
{
    int32_t late = t->base;
    if (late < 0 || m->slots[late].state != RING_NEW) return false;
    if (m->slots[k].hungry) {
        m->late = late;
        m->late_left = (m->slots[late].promised + 1) / 2;
    }
    if (m->late != late || m->late_left-- <= 0) return false;
    t->from = late;
    return true;
}

/* ---- what the hub does ----------------------------------------------------------------------- */

/* An idle node is given a late task of another node, if no node can be asked. */
static void check_taken_over(
    struct world *w, struct ring_model *m, struct rtask *t, const struct sched_action *a)
{
    const struct rslot *s = &m->slots[a->slot], *before = &m->slots[t->base];
    bool owed = t->place == RING_HELD || (t->place == RING_COMPUTED && before->flushed);
    if (!owed || w->now_us - before->moved_us < HUNG_US)
        sim_fail(w, "a task is taken from a node that is in time", t->base, (int32_t)a->task.id);
    if (!s->asking || s->held || s->victim >= 0)
        sim_fail(w, "a node that is not idle takes a task over", a->slot, (int32_t)a->task.id);
    if (m->rich)
        sim_fail(w, "a task is taken over while a node has tasks to give", m->rich, a->slot);
    t->from = t->base;
    m->taken_over = true;
    w->result->taken_over++;
    sim_ring_enter(w, m, t, RING_ORPHAN, a->slot);
}

static void check_given(struct world *w, struct ring_model *m, const struct sched_action *a)
{
    struct rslot *s = &m->slots[a->slot];
    struct rtask *t = sim_ring_task(w, &a->task);
    int32_t id = (int32_t)a->task.id;
    bool piece = a->task.frame == 0 && id >= w->plan->tasks;
    if (piece && (!t || t->place == RING_ABSENT || t->place == RING_REST)) {
        if (!sim_ring_piece(w, m, a)) return;
        t = sim_ring_task(w, &a->task);
    }
    if (t && t->place == RING_ASIDE) sim_ring_check_tried(w, m, t, a->slot);
    if (t && (t->place == RING_HELD || t->place == RING_COMPUTED) && t->base != a->slot)
        check_taken_over(w, m, t, a);
    if (!t || t->place != RING_ORPHAN) {
        sim_fail(w, "a task is given that has an owner, or does not exist", a->slot, id);
        return;
    }
    int32_t k = is_late(m, t, a->slot) ? a->slot : sim_ring_receiver(w, m, t->base);
    if (a->slot != k) sim_fail(w, "a task is given to a node that does not own it", a->slot, k);
    if (a->from != t->from) sim_fail(w, "a task names the wrong earlier owner", a->from, t->from);
    if (s->state != RING_UP) return;
    if (!s->held) s->moved_us = w->now_us;
    s->given++;
    s->asking = s->told = s->passed = s->dry = s->flushed = false;
    part(w, m, a->slot);
    t->given = m->n_given++;
    sim_ring_enter(w, m, t, RING_HELD, a->slot);
}

/* The work left of slot k, in powers of two, while no speeds are known. */
static int class_of(const struct world *w, const struct rslot *s)
{
    return ilogb(s->held * (double)w->plan->rows * FRAME_W / w->plan->width / (1 + s->thieves));
}

/* The victim is one of the nodes with most work; the thief is the nearest asking node before it. */
static void check_choice(struct world *w, struct ring_model *m, int32_t victim, int32_t thief)
{
    const int32_t n = w->plan->slots;
    for (int32_t i = 0; i < n && !m->paced && !w->plan->work; i++)
        if (m->slots[i].rich && class_of(w, &m->slots[i]) > class_of(w, &m->slots[victim]))
            sim_fail(w, "another node has more work", i, victim);
    for (int32_t i = (thief + 1) % n; i != victim; i = (i + 1) % n)
        if (m->slots[i].hungry) sim_fail(w, "another hungry node is nearer", i, thief);
}

static void check_asked(struct world *w, struct ring_model *m, int32_t victim, const struct ring *r)
{
    int32_t thief = r->peer;
    struct rslot *v = &m->slots[victim], *s = &m->slots[thief];
    if (r->takes < 0 || r->takes > RING_TAKES_MOST || (r->takes > 0) != (v->timed && s->timed))
        sim_fail(w, "the hub states a speed that it does not know", victim, r->takes);
    if (!v->rich) sim_fail(w, "a node without tasks to give is asked", victim, thief);
    if (!s->hungry) sim_fail(w, "a node is asked for a node that wants no work", victim, thief);
    check_choice(w, m, victim, thief);
    v->thieves++;
    s->victim = victim;
    s->given_before = v->given;
    s->since_us = w->now_us;
    sim_ring_mark(w, m, victim);
    sim_ring_mark(w, m, thief);
}

static void check_said(struct world *w, struct ring_model *m, const struct sched_action *a)
{
    struct rslot *s = &m->slots[a->slot];
    const struct ring *r = &a->ring;
    if (s->state != RING_UP)
        sim_fail(w, "a message goes to a node that is not up", a->slot, r->kind);
    if (r->kind == RING_ASK) check_asked(w, m, a->slot, r);
    else if (r->kind == RING_NONE) {
        if (!s->asking || s->told || r->peer != a->slot || !(s->hungry || s->passed))
            sim_fail(w, "the hub sends NONE to a node that has not asked", a->slot, r->peer);
        s->told = true;
    } else if (r->kind != RING_PLACE)
        sim_fail(w, "the hub sends a message that it must not send", a->slot, r->kind);
    else if (s->placed || r->me != a->slot || r->n != m->n || r->published)
        sim_fail(w, "a node is told the wrong place", a->slot, r->me);
    if (r->kind == RING_PLACE) s->placed = true;
}

static bool owes_flush(const struct ring_model *m, const struct rslot *s)
{
    bool up = s->state == RING_UP, drains = s->state == RING_DRAINS;
    bool wanted = drains || ((m->input_ended || m->flush) && up);
    return wanted && !s->flushed && !s->held && s->computed;
}

/* Slot k may leave if it drains, and owes nothing. */
static void check_leave(struct world *w, struct ring_model *m, int32_t k)
{
    struct rslot *s = &m->slots[k];
    if (s->state != RING_DRAINS || s->held || s->computed)
        sim_fail(w, "a node is let go that has tasks, or does not drain", k, s->held);
    s->state = RING_GONE;
}

static void ring_action(struct world *w, const struct sched_action *a)
{
    struct ring_model *m = sim_ring_model(w);
    struct rtask *t;
    if (m->touched >= 0) sim_ring_hand_over(w, m, m->touched);
    switch (a->kind) {
    case SCHED_GIVE: check_given(w, m, a); break;
    case SCHED_SAY: check_said(w, m, a); break;
    case SCHED_ASK_FLUSH:
        if (!owes_flush(m, &m->slots[a->slot]))
            sim_fail(w, "a node that holds no pixels back is asked to flush", a->slot, 0);
        m->slots[a->slot].flushed = true;
        m->slots[a->slot].moved_us = w->now_us;
        break;
    case SCHED_COMMIT:
        if ((t = sim_ring_task(w, &a->task)) == NULL) break;
        sim_ring_forget(w, m, t);
        break;
    case SCHED_LEAVE: check_leave(w, m, a->slot); break;
    case SCHED_BLAME: sim_ring_note_blame(w, m, a); break;
    case SCHED_ABANDON: break;
    case SCHED_END:
    case SCHED_STOP:
        if ((a->kind == SCHED_STOP) != m->taken_over)
            sim_fail(w, "nodes must be stopped exactly if tasks were taken over", 0, 0);
    }
}

/* All due actions of this step were taken. */
static void ring_after(struct world *w)
{
    struct ring_model *m = sim_ring_model(w);
    int32_t k = m->touched;
    if (k >= 0) sim_ring_hand_over(w, m, k);
    if (m->n && m->up && m->orphans > m->promised)
        sim_fail(w, "a task has no owner", m->orphans, m->promised);
    if (m->hungry && m->rich)
        sim_fail(w, "a node wants work while another has tasks to give", m->hungry, m->rich);
    if (m->hungry && m->promised)
        sim_fail(w, "a node wants work while tasks wait for a late node", m->hungry, m->promised);
    if (k >= 0 && m->slots[k].hungry && !m->slots[k].told)
        sim_fail(w, "a hungry node was not told that it waits", k, 0);
    if (k >= 0 && m->slots[k].state == RING_UP && !m->slots[k].placed)
        sim_fail(w, "a node was not told its place", k, 0);
    if (k >= 0 && owes_flush(m, &m->slots[k]))
        sim_fail(w, "a node was not asked to flush its pixels", k, 0);
    for (int32_t i = 0; i < w->plan->slots && !w->ended; i++)
        if (m->slots[i].state == RING_DRAINS && !m->slots[i].held && !m->slots[i].computed)
            sim_fail(w, "a node that drains owes nothing and is not let go", i, 0);
    int64_t open = sched_uncommitted(w->policy, w->state);
    int64_t waiting = w->policy->waiting(w->state), least = m->open - m->computed;
    if (open < m->open || (open > m->open && !m->cuts)) /* pieces without a node are open, too */
        sim_fail(w, "the hub counts the open tasks wrongly", open, m->open);
    if (waiting < least || (waiting > least && !m->cuts))
        sim_fail(w, "the hub counts the waiting tasks wrongly", waiting, m->open);
    if (m->input_ended && !m->open && !w->ended)
        sim_fail(w, "all tasks are committed, and the run goes on", 0, 0);
    if (!m->open) m->flush = false;
}

/* A new hub, without nodes yet. */
static void ring_restart(struct world *w)
{
    free(w->note);
    w->note = NULL;
}

const struct sim_checks oracle_ring = {.event = ring_event,
    .action = ring_action,
    .after = ring_after,
    .restart = ring_restart,
    .node_event = sim_ring_node_event,
    .node_action = sim_ring_node_action};
