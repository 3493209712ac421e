/*
 * The ring as it was published, GDC: what its master does. The rules of the nodes are in
 * gdc_node.c; the quotations are from sections 3 and "Fault tolerance" of
 *
 *   C.-N. Lee, T.-Y. Lee, T.-C. Lu: Comparisons of Load Balancing Strategies for Ray Tracing on
 *   Network Clustered Environments. Proc. Int. Conf. on Networking and Multimedia, 1996.
 *
 *   a row of the table   meaning                       leaves that on
 *   early                of no node yet                SLOTS: -> promised
 *   promised             of a node not up yet          that node's first UP: -> sent;
 *                                                      CRASHED of that node: -> sent, to the heir
 *   sent                 sent to its node, once        (the table does not follow it from there)
 *   (any)                -                             its last PIXELS: complete
 *
 * Differs in that messages between nodes pass through the master's process, which forwards them
 * unread, and in that a node may come up late, or again.
 */
#include "sched/sched.h"

#include <stdlib.h>

struct member {
    bool up, met;          /* now; ever */
    struct task_list rows; /* of the table: those that phase 1 assigned to this node */
};

/* Payload of a row of the table. */
struct row {
    int32_t node;  /* the node to which phase 1 assigned it; -1: none yet */
    int32_t tries; /* how often it was sent: to its node, then to heirs */
    bool computed; /* a node has computed it; pixels are missing */
};

struct master {
    struct task_table table; /* the global scanline table: incomplete rows */
    struct task_list early;
    struct member *node;
    int32_t n;        /* nodes; 0 before SLOTS */
    int32_t computed; /* rows of the table that a node has computed */
    bool ended, flush, asked, closed;
    bool taken_over; /* a row was sent twice: a node may compute one that is not needed */
};

static void *master_create(const struct sched_params *p)
{
    struct master *m = xcalloc(1, sizeof *m);
    (void)p;
    tasks_init(&m->table, sizeof(struct row));
    m->early = TASK_LIST_EMPTY;
    return m;
}

static void master_destroy(void *state)
{
    struct master *m = state;
    if (!m) return;
    tasks_free(&m->table);
    free(m->node);
    free(m);
}

static struct row *row_at(const struct master *m, int32_t i) { return tasks_extra(&m->table, i); }

static bool is_node(const struct master *m, int32_t k) { return k >= 0 && k < m->n; }

/* ---- sending; messages to a dead node are lost without notice -------------------------------- */

static void send_ring(struct master *m, int32_t k, struct ring r, struct sched_actions *out)
{
    if (!m->node[k].up) return;
    sched_act(out, SCHED_SAY, k, NULL);
    out->at[out->n - 1].ring = r;
}

/* from: the previous owner; -1 in phase 1. */
static void send_row(
    struct master *m, int32_t k, const struct task *t, int32_t from, struct sched_actions *out)
{
    if (!m->node[k].up) return;
    sched_act(out, SCHED_GIVE, k, t);
    out->at[out->n - 1].origin_id = t->id;
    out->at[out->n - 1].from = from;
}

/* ---- phase 1 -------------------------------------------------------------------------------- */

static void send_assigned(struct master *m, int32_t i, struct sched_actions *out)
{
    struct row *r = row_at(m, i);
    if (r->tries || !m->node[r->node].met) return;
    r->tries = 1;
    send_row(m, r->node, &m->table.at[i].task, -1, out);
}

/*
 * Section 3: "In the first phase, similar to the interleaved scheme, it uses the equal partition to
 * assign scanline I to N workstations by I mod N."
 */
static void assign(struct master *m, int32_t i, struct sched_actions *out)
{
    const struct task *t = &m->table.at[i].task;
    int32_t k = is_node(m, t->to) ? t->to : (int32_t)(t->id % (uint32_t)m->n);
    row_at(m, i)->node = k;
    list_push_back(&m->table, &m->node[k].rows, i);
    send_assigned(m, i, out);
}

static void take_task(struct master *m, const struct sched_event *e, struct sched_actions *out)
{
    if (tasks_find(&m->table, e->task.frame, e->task.id) >= 0) return; /* the same key again */
    int32_t i = tasks_add(&m->table, &e->task, e->frame_w);
    row_at(m, i)->node = -1;
    if (m->n) assign(m, i, out);
    else list_push_back(&m->table, &m->early, i);
}

static void take_slots(struct master *m, int32_t n, struct sched_actions *out)
{
    if (m->n || n <= 0) return;
    m->n = n;
    m->node = xcalloc((size_t)n, sizeof *m->node);
    for (int32_t k = 0; k < n; k++) m->node[k].rows = TASK_LIST_EMPTY;
    while (m->early.count) {
        int32_t i = m->early.head;
        list_remove(&m->table, &m->early, i);
        assign(m, i, out);
    }
}

/* A node that was up before starts again, with no rows: the paper has no rule for this. */
static void take_up(struct master *m, int32_t k, struct sched_actions *out)
{
    struct member *node = &m->node[k];
    node->up = node->met = true;
    send_ring(m, k,
        (struct ring){RING_PLACE, .peer = -1, .next = -1, .me = k, .n = m->n, .published = true},
        out);
    for (int32_t i = node->rows.head; i >= 0; i = m->table.at[i].next) send_assigned(m, i, out);
}

/*
 * Section 3: "The master is responsible to collect the results which are sent from slaves and
 * display the image. But the master process does not attempt to dynamically adjust imbalance load."
 */
static void take_done(struct master *m, const struct task *t)
{
    int32_t i = tasks_find(&m->table, t->frame, t->id);
    if (i < 0) return;
    m->asked = false; /* nodes may hold back more than when they were asked */
    m->computed += !row_at(m, i)->computed;
    row_at(m, i)->computed = true;
}

/* Row i is complete, or given up. */
static void leave(struct master *m, int32_t i, struct sched_actions *out)
{
    const struct row *r = row_at(m, i);
    sched_act(out, SCHED_COMMIT, r->node, &m->table.at[i].task);
    m->computed -= r->computed;
    list_remove(&m->table, r->node >= 0 ? &m->node[r->node].rows : &m->early, i);
    tasks_remove(&m->table, i);
}

static void take_pixels(struct master *m, const struct task *t, struct sched_actions *out)
{
    int32_t i = tasks_find(&m->table, t->frame, t->id);
    if (i >= 0 && tasks_deliver(&m->table, i, &t->at) && tasks_whole(&m->table, i))
        leave(m, i, out);
}

/* The paper has no rule for a task that cannot be computed: it is given up. */
static void take_fail(struct master *m, const struct task *t, struct sched_actions *out)
{
    int32_t i = tasks_find(&m->table, t->frame, t->id);
    if (i < 0) return;
    sched_act(out, SCHED_ABANDON, -1, &m->table.at[i].task);
    leave(m, i, out);
}

/* ---- phase 2, and fault tolerance ----------------------------------------------------------- */

/*
 * "P(i) will send a message to the master and ask master for checking the global scanline table.
 * Then master will notify P(i) to take over the incomplete tasks that were owned by the process
 * P(i+1). The information includes how many scanlines P(i+1) has not finished and the processor
 * identifier of P(i+1)'s next processor."
 *
 * The rows follow the identifier. The table knows the node to which phase 1 assigned a row, and
 * whether the row is complete. It does not know which node stole it or took it over, or whether the
 * report of a crash is right.
 */
static void take_crashed(struct master *m, int32_t heir, int32_t dead, struct sched_actions *out)
{
    send_ring(m, heir, (struct ring){RING_HEIR, .peer = dead, .next = (dead + 1) % m->n}, out);
    for (int32_t i = m->node[dead].rows.head; i >= 0; i = m->table.at[i].next) {
        struct row *r = row_at(m, i);
        m->taken_over = m->taken_over || r->tries > 0;
        m->asked = false;
        m->computed -= r->computed;
        r->computed = false;
        r->tries++;
        send_row(m, heir, &m->table.at[i].task, dead, out);
    }
}

/* Forwards a message of node k to another node, with k as its peer; or handles one to the
 * master. */
static void take_ring(
    struct master *m, int32_t k, const struct sched_event *e, struct sched_actions *out)
{
    struct ring r = e->ring;
    int32_t to = r.peer, i;
    if (!is_node(m, to) || to == k) return;
    r.peer = k;
    switch (r.kind) {
    case RING_ASK:
    case RING_NONE: send_ring(m, to, r, out); break;
    case RING_GIVE:
        i = tasks_find(&m->table, e->task.frame, e->task.id);
        if (i >= 0) send_row(m, to, &m->table.at[i].task, k, out);
        break;
    case RING_CRASHED: take_crashed(m, k, to, out); break;
    case RING_PLACE:
    case RING_HEIR: break; /* nodes do not send these */
    }
}

/* ---- the end -------------------------------------------------------------------------------- */

/* Once everything is computed, asks all nodes to flush. */
static void ask_flush(struct master *m, struct sched_actions *out)
{
    if (m->asked || !m->table.count || m->computed < m->table.count) return;
    m->asked = true;
    for (int32_t k = 0; k < m->n; k++)
        if (m->node[k].up) sched_act(out, SCHED_ASK_FLUSH, k, NULL);
}

static void master_step(
    void *state, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    struct master *m = state;
    (void)now;
    switch (e->kind) {
    case SCHED_TASK: take_task(m, e, out); break;
    case SCHED_INPUT_END: m->ended = true; break;
    case SCHED_FLUSH: m->flush = true; break;
    case SCHED_SLOTS: take_slots(m, e->n, out); break;
    case SCHED_UP:
        if (is_node(m, e->slot)) take_up(m, e->slot, out);
        break;
    /* The paper has no rule for this: a node is dead when another one reports it. */
    case SCHED_GONE:
        if (is_node(m, e->slot)) m->node[e->slot].up = false;
        break;
    case SCHED_DONE: take_done(m, &e->task); break;
    case SCHED_FAIL: take_fail(m, &e->task, out); break;
    case SCHED_PIXELS: take_pixels(m, &e->task, out); break;
    case SCHED_RING:
        if (is_node(m, e->slot)) take_ring(m, e->slot, e, out);
        break;
    case SCHED_DRAIN:
    case SCHED_WAKE: break;
    }
    if (m->ended || m->flush) ask_flush(m, out);
    if (!m->table.count) m->flush = false;
    if (!m->ended || m->table.count || m->closed) return;
    m->closed = true;
    sched_act(out, m->taken_over ? SCHED_STOP : SCHED_END, -1, NULL);
}

static int32_t master_uncommitted(const void *state, uint32_t generation)
{
    return tasks_in_generation(&((const struct master *)state)->table, generation);
}

/* The master does not know where a row is, or whether it was begun. */
static int64_t master_waiting(const void *state)
{
    const struct master *m = state;
    return m->table.count - m->computed;
}

static int32_t master_tries(const void *state, int32_t slot, uint32_t frame, uint32_t id)
{
    const struct master *m = state;
    int32_t i = tasks_find(&m->table, frame, id);
    (void)slot;
    return i < 0 ? 0 : row_at(m, i)->tries;
}

const struct policy policy_published = {"ringctl", master_create, master_step, master_uncommitted,
    master_waiting, master_tries, NULL, master_destroy, false};
