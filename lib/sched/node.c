/*
 * A node of the ring: a queue of tasks around one worker. The worker is fed few tasks at once, so
 * that the node can give the others away while they wait.
 *
 * The default rules:
 *
 * 1. A node asks ahead. It asks when the time until it runs dry has shrunk to the time that an ask
 *    takes, by its measurements of its worker and of its asks; at the latest when it has no tasks.
 *    Before an ask was answered, an ask is taken to last twice as long as PLACE took to come after
 *    hello. At most one ask is outstanding; any task that comes ends it.
 * 2. The victim gives tasks until both nodes would finish at the same time, if the thief begins one
 *    ask's time from now. The hub says how fast it is; else it counts as fast as the victim. Then
 *    that is about half, and never so much that the victim would have to ask at once. (Steal-half:
 *    D. Hendler, N. Shavit, "Non-blocking steal-half work
 *    queues", PODC 2002. Differs in the end of the queue: the victim gives the tasks that it would
 *    begin first. So all tasks are begun in the order of partition, such as the dearest first.)
 * 3. A node that asks gives nothing. So a given task is begun where it arrives, and the last task
 *    is not passed round.
 *
 * A node that has no PLACE from a hub only feeds its worker.
 */
#include "sched/node_int.h"

#include <stdlib.h>

#define STORE_US 5000
#define LEAST_US 1        /* less counts as no time, both for asks and for gifts */
#define WAIT_MOST_US 1e12 /* no wait is longer */

static void *node_create(const struct sched_params *p)
{
    (void)p;
    struct node *n = xcalloc(1, sizeof *n);
    tasks_init(&n->has, sizeof(struct node_task));
    n->queue = n->fed = n->computed = TASK_LIST_EMPTY;
    n->asked_us = -1;
    n->ask_us = INT64_MAX;
    return n;
}

static void node_destroy(void *state)
{
    struct node *n = state;
    if (!n) return;
    gdc_node_free(n);
    tasks_free(&n->has);
    free(n);
}

/* ---- the worker ------------------------------------------------------------------------------ */

/*
 * The number of tasks that the worker holds beyond its current ones, which cannot be given away any
 * more. They hide the delay of its link, but last for at most STORE_US. A worker that shares its
 * processor seems to have a long delay; a task would wait behind another one for nothing.
 */
static int32_t store_of(const struct node *n)
{
    if (n->place.published || n->pace.task_us <= 0) return 0;
    int32_t depth = pace_depth(&n->pace, n->width);
    double most = STORE_US * n->width / n->pace.task_us;
    return depth < most ? depth : (int32_t)most;
}

static void feed(struct node *n, int64_t now, struct sched_actions *out)
{
    int32_t most = n->width ? n->width + store_of(n) : 0;
    while (n->queue.count && n->fed.count < most) {
        int32_t i = n->queue.head;
        node_queue_take(n, i);
        list_push_back(&n->has, &n->fed, i);
        n->fed_px += tasks_px(&n->has, i);
        *node_task(n, i) = (struct node_task){.place = FED, .fed_us = now};
        sched_act(out, SCHED_GIVE, 0, &n->has.at[i].task);
    }
}

/* ---- events ---------------------------------------------------------------------------------- */

/* A computed task that comes again was lost on its way. */
static void take_task(struct node *n, const struct sched_event *e, int64_t now)
{
    int32_t i = tasks_find(&n->has, e->task.frame, e->task.id);
    if (n->asked_us >= 0 && e->from >= 0 && !n->delayed) {
        double trip_us = (double)(now - n->asked_us);
        if (n->trip_us <= 0 || trip_us < n->trip_us) n->trip_us = trip_us;
        else pace_mix(&n->trip_us, fmin(trip_us, 2 * n->trip_us));
    }
    n->asked_us = -1;
    if (i >= 0 && node_task(n, i)->place != COMPUTED) return;
    if (i >= 0) node_unlist(n, i);
    else i = tasks_add(&n->has, &e->task, e->frame_w);
    node_enqueue(n, i);
}

static void take_done(struct node *n, const struct sched_event *e, int64_t now)
{
    int32_t i = tasks_find(&n->has, e->task.frame, e->task.id);
    if (i < 0 || node_task(n, i)->place != FED) {
        n->flush = n->flush || n->ended; /* it was not done when a flush was asked for before */
        return;
    }
    const struct pace_task done = {.px = lattice_count(&n->has.at[i].task.at),
        .state = n->has.at[i].task.generation,
        .sent_us = node_task(n, i)->fed_us,
        .done_us = now,
        .wall_us = e->wall_us};
    pace_note(&n->pace, &done);
    node_unlist(n, i);
    node_task(n, i)->place = COMPUTED;
    list_push_back(&n->has, &n->computed, i);
}

/* The hub gives it to another node. */
static void take_fail(struct node *n, const struct sched_event *e)
{
    int32_t i = tasks_find(&n->has, e->task.frame, e->task.id);
    if (i < 0 || node_task(n, i)->place != FED) return;
    node_unlist(n, i);
    tasks_remove(&n->has, i);
}

static void take_pixels(struct node *n, const struct sched_event *e, struct sched_actions *out)
{
    int32_t i = tasks_find(&n->has, e->task.frame, e->task.id);
    if (i < 0 || !tasks_deliver(&n->has, i, &e->task.at) || !tasks_whole(&n->has, i)) return;
    sched_act(out, SCHED_COMMIT, 0, &n->has.at[i].task);
    node_unlist(n, i);
    tasks_remove(&n->has, i);
}

/* The worker is lost with all its tasks. Another one may come. */
static void take_gone(struct node *n)
{
    struct task_list *lost[] = {&n->fed, &n->computed};
    for (int l = 0; l < 2; l++) {
        while (lost[l]->count) {
            int32_t i = lost[l]->head;
            node_unlist(n, i);
            node_enqueue(n, i);
        }
    }
    n->width = 0;
    n->flush = n->flush || n->ended;
}

static void take(
    struct node *n, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    switch (e->kind) {
    case SCHED_TASK: take_task(n, e, now); break;
    case SCHED_INPUT_END: n->ended = true; /* fallthrough */
    case SCHED_FLUSH: n->flush = true; break;
    case SCHED_UP:
        n->width += e->n > 1 ? e->n : 1;
        n->pace = (struct pace){0};
        n->up_us = now;
        break;
    case SCHED_GONE: take_gone(n); break;
    case SCHED_DONE: take_done(n, e, now); break;
    case SCHED_FAIL: take_fail(n, e); break;
    case SCHED_PIXELS: take_pixels(n, e, out); break;
    case SCHED_RING:
        if (e->ring.kind != RING_PLACE) break;
        /* Until an ask is answered: it takes two links, there and back, as this took one. */
        if (!n->placed) n->trip_us = 2 * (double)(now - n->up_us);
        n->place = e->ring;
        n->placed = true;
        break;
    case SCHED_SLOTS:
    case SCHED_DRAIN:
    case SCHED_WAKE: break;
    }
}

/* ---- the default rules ----------------------------------------------------------------------- */

/* Microseconds per pixel, over all tasks that the worker computes at once; 0: not known. */
static double pace_of(const struct node *n) { return n->width ? n->pace.us_per_px / n->width : 0; }

/* The time that the worker needs for its fed tasks. If it is late by some time, it counts as
 * late by that time again. */
static double fed_us(const struct node *n, double us_per_px, int64_t now)
{
    if (!n->fed.count) return 0;
    int64_t since = node_task(n, n->fed.head)->fed_us;
    if (since < n->pace.done_us) since = n->pace.done_us;
    return fabs(n->fed_px * us_per_px - (double)(now - since));
}

/* Rule 1. more: other tasks may have come with the one that just did. */
static void ask(struct node *n, bool more, int64_t now, struct sched_actions *out)
{
    double us_per_px = pace_of(n);
    double idle_us = fed_us(n, us_per_px, now) + n->queue_px * us_per_px - n->trip_us;
    bool busy = n->queue.count || n->fed.count;
    n->ask_us = INT64_MAX;
    if (n->asked_us >= 0 || n->ended || !n->width) return;
    if (busy && us_per_px <= 0) return;
    if (more || (busy && idle_us >= LEAST_US)) {
        n->ask_us = idle_us < WAIT_MOST_US ? now + (int64_t)fmax(idle_us, 0) : INT64_MAX;
        return;
    }
    n->asked_us = now;
    n->delayed = false;
    node_say(RING_ASK, -1, out);
}

/* Rules 2 and 3: the number of tasks to give to a node that takes this percentage of the time. */
static int32_t spare(const struct node *n, int32_t takes, int64_t now)
{
    double slower = takes > 0 ? takes / 100. : 1;
    bool known = pace_of(n) > 0; /* if not, pixels stand for microseconds */
    double us_per_px = known ? pace_of(n) : 1;
    double here_us = known ? fed_us(n, us_per_px, now) : n->fed_px;
    double there_us = known ? n->trip_us : 0;
    here_us += n->queue_px * us_per_px;
    int32_t given = 0, most = n->queue.count;
    if (n->asked_us >= 0) return 0;
    for (int32_t i = n->queue.head; given < most && i >= 0; i = n->has.at[i].next) {
        double us = tasks_px(&n->has, i) * us_per_px;
        if (there_us + us * slower + LEAST_US > here_us) break;
        there_us += us * slower;
        here_us -= us;
        given++;
    }
    return given;
}

static void answer(struct node *n, const struct ring *ask, int64_t now, struct sched_actions *out)
{
    int32_t given = spare(n, ask->takes, now);
    if (!given) node_say(RING_NONE, ask->peer, out);
    while (given-- > 0) node_give(n, n->queue.head, ask->peer, out);
}

static void default_rules(
    struct node *n, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    if (e->kind == SCHED_RING && e->ring.kind == RING_NONE) n->delayed = true;
    if (e->kind == SCHED_RING && e->ring.kind == RING_ASK) answer(n, &e->ring, now, out);
    ask(n, e->kind == SCHED_TASK, now, out);
}

/* ---- a step ---------------------------------------------------------------------------------- */

static void node_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct node *n = state;
    take(n, e, now, out);
    feed(n, now, out);
    if (n->placed && n->place.published) gdc_node_step(n, e, now, out);
    else if (n->placed) default_rules(n, e, now, out);
    if (n->flush && !n->queue.count && !n->fed.count) {
        if (n->computed.count) sched_act(out, SCHED_ASK_FLUSH, 0, NULL);
        n->flush = false;
    }
    if (!n->ended || n->has.count || n->closed) return;
    n->closed = true;
    sched_act(out, SCHED_END, -1, NULL);
}

static int32_t node_uncommitted(const void *state, uint32_t generation)
{
    return tasks_in_generation(&((const struct node *)state)->has, generation);
}

static int64_t node_waiting(const void *state) { return ((const struct node *)state)->queue.count; }

/* Only the hub counts attempts. */
static int32_t node_tries(const void *state, int32_t slot, uint32_t frame, uint32_t id)
{
    (void)slot;
    return tasks_find(&((const struct node *)state)->has, frame, id) >= 0;
}

static int64_t node_wake_us(const void *state)
{
    const struct node *n = state;
    return n->placed && n->place.published ? gdc_node_wake_us(n) : n->ask_us;
}

const struct policy policy_node = {"ringctl", node_create, node_step, node_uncommitted,
    node_waiting, node_tries, node_wake_us, node_destroy, false};
