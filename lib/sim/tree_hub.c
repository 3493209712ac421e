/*
 * Hubs of a tree, and the links between them. A record is charged to the hub that passes it: a
 * task when the hub gives it, a record from below when the hub takes it. So a task costs each hub
 * three records: the task, its `done` and its pixels.
 */
#include "sim/tree.h"

void tree_fail(struct tree *t, const char *what, int64_t a, int64_t b)
{
    sim_note_failure(t->result, t->now_us, what, a, b);
}

static void schedule(struct tree *t, int64_t at_us, int32_t i, struct sim_event e)
{
    e.at_us = at_us;
    e.slot = i;
    sim_heap_push(&t->heap, &e);
}

/* ---- links ----------------------------------------------------------------------------------- */

static struct sim_link link_of(const struct tree *t, int32_t i)
{
    if (tree_is_worker(t, i)) return net_link_of(t->plan, i - t->n_hubs);
    return t->plan->link;
}

/* One direction of the link of node i. */
static struct net_queue *queue_of(struct tree *t, int32_t i, bool up)
{
    int32_t k = i - t->n_hubs;
    if (k < 0) return up ? &t->hubs[i].up : &t->hubs[i].down;
    return &(up ? t->up : t->down)[net_number_of(t->plan, k)];
}

void tree_say(struct tree *t, int32_t i, struct sched_event e)
{
    struct sim_link link = link_of(t, i);
    net_count(t->result, net_bytes(&e));
    int64_t left_us = net_send(
        queue_of(t, i, true), net_bytes(&e), link.bytes_per_s, t->now_us, e.kind == SCHED_PIXELS);
    e.slot = t->nodes[i].number;
    e.frame_w = t->plan->work->frame_w;
    schedule(t, left_us + link.latency_us, i, (struct sim_event){.kind = SIM_AT_HUB, .sched = e});
}

/* Sends to node i, when its parent has passed the record. */
static void send_down(struct tree *t, int32_t i, struct sched_event e, int64_t at_us)
{
    struct sim_link link = link_of(t, i);
    net_count(t->result, net_bytes(&e));
    at_us = net_send(queue_of(t, i, false), net_bytes(&e), link.bytes_per_s, at_us, true);
    schedule(t, at_us + link.latency_us, i, (struct sim_event){.kind = SIM_TO_SLOT, .sched = e});
}

/* ---- hubs ------------------------------------------------------------------------------------ */

/* Returns the time at which the hub has passed this record: the time of its processor for any
 * record, then the bandwidth of all pixels. */
static int64_t passes(struct tree *t, int32_t hub, const struct sched_event *e)
{
    struct tree_hub *h = &t->hubs[hub];
    double bytes = net_bytes(e);
    if (hub == 0) {
        t->result->hub_records++;
        t->result->hub_bytes += bytes;
    }
    h->busy_us = fmax(h->busy_us, (double)t->now_us) + t->plan->message_us;
    if (e->kind != SCHED_PIXELS) return (int64_t)h->busy_us;
    h->pixels_us = fmax(h->pixels_us, h->busy_us) + net_us(bytes, t->plan->hub_bytes_per_s);
    return (int64_t)h->pixels_us;
}

void tree_sleep(struct tree *t, int32_t hub)
{
    struct tree_hub *h = &t->hubs[hub];
    int64_t at_us = t->policy->wake_us ? t->policy->wake_us(h->state) : INT64_MAX;
    if (at_us >= h->wake_us) return;
    h->wake_us = at_us < t->now_us ? t->now_us : at_us;
    schedule(t, h->wake_us, hub, (struct sim_event){.kind = SIM_WAKE});
}

/* The root has all pixels of this task. */
static void commit(struct tree *t, const struct task *task)
{
    if ((int64_t)task->id >= t->plan->tasks) return; /* a piece */
    for (uint64_t i = 0, n = lattice_count(&task->at); i < n; i++)
        if (!coverage_has(&t->sent, lattice_pixel(&task->at, t->sent.w, i)))
            tree_fail(t, "a task was committed without its pixels", task->id, (int64_t)i);
    if (t->committed[task->id]) tree_fail(t, "a task was committed twice", task->id, 0);
    t->committed[task->id] = true;
    t->result->commits++;
    t->held--;
}

static void act(struct tree *t, int32_t hub, const struct sched_action *a)
{
    const struct tree_node *n = &t->nodes[hub];
    struct sched_event e = {.task = a->task, .frame_w = t->plan->work->frame_w, .from = -1};
    switch (a->kind) {
    case SCHED_GIVE: e.kind = SCHED_TASK; break;
    case SCHED_ASK_FLUSH: e.kind = SCHED_FLUSH; break;
    case SCHED_COMMIT:
        if (hub == 0) commit(t, &a->task);
        return;
    case SCHED_SAY:
    case SCHED_BLAME:
    case SCHED_ABANDON:
    case SCHED_LEAVE: return;
    case SCHED_END:
    case SCHED_STOP: t->ended = t->ended || hub == 0; return;
    }
    if (a->slot < 0 || a->slot >= n->n) {
        tree_fail(t, "no such slot", a->slot, n->n);
        return;
    }
    e.task.to = -1; /* fan drops to=K */
    t->result->gives += hub == 0 && e.kind == SCHED_TASK;
    send_down(t, n->first + a->slot, e, passes(t, hub, &e));
}

void tree_step(struct tree *t, int32_t hub, const struct sched_event *e)
{
    t->policy->step(t->hubs[hub].state, e, t->now_us, &t->acts);
    for (size_t i = 0; i < t->acts.n; i++) act(t, hub, &t->acts.at[i]);
    t->acts.n = 0;
    tree_sleep(t, hub);
}

void tree_pass(struct tree *t, const struct sim_event *e)
{
    struct sim_event passed = {.kind = SIM_SCHED, .sched = e->sched};
    int64_t at_us = passes(t, t->nodes[e->slot].parent, &e->sched);
    if (at_us > t->now_us) schedule(t, at_us, e->slot, passed);
    else tree_take(t, e);
}

static void root_takes(struct tree *t, const struct sched_event *e)
{
    const struct lattice *at = &e->task.at;
    for (uint64_t i = 0, n = lattice_count(at); e->kind == SCHED_PIXELS && i < n; i++)
        coverage_set(&t->sent, lattice_pixel(at, e->frame_w, i));
}

/* The live driver passes a record on before the policy gets it. */
void tree_take(struct tree *t, const struct sim_event *e)
{
    int32_t hub = t->nodes[e->slot].parent;
    bool about_task = e->sched.kind == SCHED_DONE || e->sched.kind == SCHED_PIXELS;
    if (hub == 0) root_takes(t, &e->sched);
    else if (about_task) tree_say(t, hub, e->sched);
    tree_step(t, hub, &e->sched);
}
