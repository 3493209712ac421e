/* Checks of every run, after each event, in time that does not grow with the run. */
#include "sim/world.h"

#include <string.h>

bool sim_is_sent(const struct world *w, const struct lattice *at)
{
    uint64_t n = lattice_count(at), i = 0;
    while (i < n && coverage_has(&w->sent, lattice_pixel(at, w->frame_w, i))) i++;
    return i == n;
}

static void note_pixels(struct world *w, struct vtask *t, const struct lattice *at)
{
    int64_t n0 = lattice_offset(&t->task.at, w->frame_w, at);
    if (!t->known || n0 < 0 || (uint64_t)n0 > t->sent) return;
    uint64_t n = lattice_count(at);
    if ((uint64_t)n0 + n > t->sent) t->sent = (uint64_t)n0 + n;
    for (uint64_t i = 0; i < n; i++) coverage_set(&w->sent, lattice_pixel(at, w->frame_w, i));
}

void sim_note_event(struct world *w, const struct sched_event *e)
{
    bool named = e->task.frame == 0 && e->task.id < (uint32_t)w->n_tasks;
    struct vtask *t = named ? &w->tasks[e->task.id] : NULL;
    if (e->kind == SCHED_TASK && t) {
        w->n_open += !t->known;
        w->open_of[t->task.generation % GENERATIONS] += !t->known;
        t->known = true;
    }
    if (e->kind == SCHED_INPUT_END) w->input_ended = true;
    if (e->kind == SCHED_SLOTS) w->slots_known = true;
    if (e->kind == SCHED_UP) w->slots[e->slot].up = true;
    if (e->kind == SCHED_DRAIN && w->slots[e->slot].up && !w->slots[e->slot].drains)
        w->slots[e->slot].drains = w->slots[e->slot].hands_over = true;
    if (e->kind == SCHED_GONE) {
        w->slots[e->slot].up = w->slots[e->slot].drains = w->slots[e->slot].left = false;
        w->slots[e->slot].lost = true;
    }
    if (e->kind == SCHED_PIXELS && t) note_pixels(w, t, &e->task.at);
    if (w->checks && w->checks->event) w->checks->event(w, e);
}

/* A piece is seen for the first time when it is given, given up, or committed as its halves are.
 * The hub may cut one again that came back when no node was up: then it has fewer pixels. */
static void note_piece(struct world *w, const struct sched_action *a)
{
    struct vtask *t = sim_vtask_at(w, a->task.id);
    if (!t || (t->known && memcmp(&t->task.at, &a->task.at, sizeof a->task.at) == 0)) return;
    if (t->known) t->sent = 0;
    t->task = a->task;
    t->known = true;
}

static bool is_piece(const struct world *w, const struct sched_action *a)
{
    return a->task.id >= (uint32_t)w->plan->tasks;
}

static void check_commit(struct world *w, const struct sched_action *a)
{
    struct vtask *t = sim_vtask_at(w, a->task.id);
    w->result->commits++;
    if (t && !t->known && is_piece(w, a)) note_piece(w, a);
    if (!t || !t->known || t->committed) sim_fail(w, "a task was committed twice", a->task.id, 0);
    else if (!sim_is_sent(w, &t->task.at))
        sim_fail(w, "a task was committed before its last pixel came", a->task.id, 0);
    if (!t) return;
    t->committed = true;
    if (a->task.id >= (uint32_t)w->plan->tasks) return;
    w->n_open--;
    w->open_of[t->task.generation % GENERATIONS]--;
}

static bool inside(const struct world *w, const struct lattice *part, const struct task *t)
{
    return lattice_offset(&t->at, w->frame_w, part) >= 0;
}

/* A task is given up only if it is bad, or has cost as many slots as if it were. The parts of a
 * task count for the task, and the task for its parts. */
static void check_abandon(struct world *w, const struct sched_action *a)
{
    const int32_t most = sim_losses(w->plan);
    int32_t blamed = 0;
    for (int32_t k = 0; a->refused && k < w->plan->slots; k++)
        if (w->slots[k].up && !w->slots[k].drains && !sim_refuses(w, k, a->task.generation))
            sim_fail(w, "a task was given up that a slot does not refuse", a->task.id, k);
    for (int32_t i = 0; i < w->n_tasks; i++) {
        const struct vtask *t = &w->tasks[i];
        if (a->all || inside(w, &a->task.at, &t->task) || inside(w, &t->task.at, &a->task))
            blamed += t->blamed;
    }
    if (!a->refused && blamed <= most)
        sim_fail(w, "a task was given up too early", a->task.id, blamed);
    /* A half was tried twice more; not a pixel alone, which other losses may hit by chance. */
    const bool piece = is_piece(w, a), half = piece && lattice_count(&a->task.at) > 1;
    if (!a->all && half && w->n_poison && !sim_poison_in(w, &a->task) && blamed < most + 2)
        sim_fail(w, "a good task was given up", a->task.id, blamed);
    if (piece && !sim_vtask_at(w, a->task.id)->known) note_piece(w, a);
    const uint64_t done = w->sent.done;
    for (uint64_t i = 0, n = lattice_count(&a->task.at); i < n; i++)
        coverage_set(&w->sent, lattice_pixel(&a->task.at, w->frame_w, i));
    w->result->abandoned += w->sent.done - done;
}

static void check_end(struct world *w)
{
    if (w->ended) sim_fail(w, "the run ended twice", 0, 0);
    if (!w->input_ended || w->n_open)
        sim_fail(w, "the run ended with tasks uncommitted", w->n_open, 0);
    if (w->sent.done != w->wanted_px)
        sim_fail(
            w, "the run ended with pixels missing", (int64_t)w->sent.done, (int64_t)w->wanted_px);
    w->ended = true;
}

void sim_note_action(struct world *w, const struct sched_action *a)
{
    bool given = a->kind == SCHED_GIVE, piece = given && is_piece(w, a);
    w->result->gives += given;
    w->result->pieces += piece;
    if (a->kind == SCHED_ASK_FLUSH) w->result->flushes++;
    if (a->kind == SCHED_STOP) w->result->stops++;
    if (a->kind == SCHED_BLAME && !a->refused && sim_vtask_at(w, a->task.id))
        sim_vtask_at(w, a->task.id)->blamed++;
    if (a->kind == SCHED_ABANDON) check_abandon(w, a);
    if (a->kind == SCHED_COMMIT) check_commit(w, a);
    if (a->kind == SCHED_END || a->kind == SCHED_STOP) check_end(w);
    if (w->checks && w->checks->action) w->checks->action(w, a);
    if (a->kind == SCHED_LEAVE) w->slots[a->slot].left = true;
    if (piece) note_piece(w, a);
}
