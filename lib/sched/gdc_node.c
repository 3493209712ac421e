/*
 * The ring as it was published, GDC: the rules of a node. The master's are in gdc_master.c; the
 * quotations are from the paper named there, sections 3 and "Fault tolerance".
 *
 *   a node is  when                       ASK            NONE of the node  a row       timeout
 *                                                        asked, HEIR
 *   computing  its worker is on a row     waits until    -                 queued      -
 *                                         that is done
 *   asking     it is idle, and has asked  answers none   asks the next;    computing   asks again;
 *              P(next)                                   or ended                      says CRASHED
 *   ended      it is idle, and next is    answers none   -                 computing   -
 *              itself
 *
 * A row of the master's first phase begins the ring again: next is P(i+1) again. The paper leaves
 * some points open. They are decided as follows:
 *
 * - A node repeats a request that was not answered within TIMEOUT_ROWS times the longest row that
 *   the node itself has computed, and at least PATIENCE_PUBLISHED_US. After TRIES_MOST repetitions
 *   each further timeout is reported to the master, until an answer comes.
 * - Requests have no numbers. Each is answered, repeated ones too, and any answer of the node asked
 *   counts as the answer to the latest request.
 * - A node that gets no row of phase 1 within PATIENCE_PUBLISHED_US asks too.
 * - Messages are read between rows: when a row is done and the next one begins.
 * - Visited are the nodes between P(i) and P(next), going up. So a hint that leads back, or to P(i)
 *   itself, is not followed.
 * - An ended node asks no more. It computes rows that still come: late answers to earlier requests.
 */
#include "patience/patience.h"
#include "sched/node_int.h"

#include <stdlib.h>

#define TRIES_MOST 3
#define TIMEOUT_ROWS 2
#define ASKED_MOST 4                    /* waiting requests, per node of the ring; more are lost */
#define ROW_MOST_US INT64_C(3600000000) /* longer times are not believed */

struct gdc_node {
    int32_t next;       /* the node it asks; itself: it has visited all */
    bool found;         /* P(next) was not idle when it answered last */
    int32_t tries;      /* requests to it without an answer; 0: none outstanding */
    int64_t due_us;     /* when the wait for an answer or for phase 1 times out; INT64_MAX: never */
    int64_t longest_us; /* the longest time of a row computed here */
    int32_t *asked;     /* nodes whose requests wait, in order */
    int32_t n_asked, cap_asked;
};

/*
 * Section 3, phase 2, 1: "N processors are connected by using a ring structure as shown in
 * Figure 5." P(i+1) is after P(i), P(0) after the last.
 */
static int32_t after(const struct node *n, int32_t k) { return (k + 1) % n->place.n; }

/* Distance up the ring from this node to node k. */
static int32_t distance(const struct node *n, int32_t k)
{
    return (k - n->place.me + n->place.n) % n->place.n;
}

static void search_on(struct node *n, int32_t next)
{
    n->gdc->next = next;
    n->gdc->found = false;
    n->gdc->tries = 0;
    n->gdc->due_us = INT64_MAX;
}

static void take_place(struct node *n, int64_t now)
{
    if (n->gdc) return; /* a PLACE for an earlier connection on this slot */
    n->gdc = xcalloc(1, sizeof *n->gdc);
    search_on(n, after(n, n->place.me));
    n->gdc->due_us = now + PATIENCE_PUBLISHED_US;
}

/* ---- asking ---------------------------------------------------------------------------------- */

static void say_and_wait(
    struct node *n, enum ring_kind kind, int64_t now, struct sched_actions *out)
{
    struct gdc_node *g = n->gdc;
    int64_t wait_us = TIMEOUT_ROWS * g->longest_us;
    g->due_us = now + (wait_us > PATIENCE_PUBLISHED_US ? wait_us : PATIENCE_PUBLISHED_US);
    g->tries++;
    node_say(kind, g->next, out);
}

/*
 * Section 3, phase 2, 2: "During rendering, when a processor P(i) becomes idle, it sends a message
 * to its next processor P(i+1) to request unfinished scanlines."
 * Case 2: "If P(i) wants to request a new job, P(i) will skip the processes between P(i) and P(m)
 * and directly ask a new job from P(m)."
 *
 * 3: "If P(i) has visited itself, then the processor P(i) will terminate."
 */
static void ask(struct node *n, int64_t now, struct sched_actions *out)
{
    bool idle = n->width && !n->fed.count && !n->queue.count;
    if (!idle || n->ended || n->gdc->due_us != INT64_MAX || n->gdc->next == n->place.me) return;
    say_and_wait(n, RING_ASK, now, out);
}

/*
 * Fault tolerance, 2: "In order to distinguish whether the processor P(i+1) is crashed or busy, we
 * must set the timeout. If P(i+1) does not response the request more than three times, we can
 * regard that P(i+1) is crashed."
 * 3: "If P(i+1) is crashed, P(i) will send a message to the master and ask master for checking the
 * global scanline table."
 */
static void take_timeout(struct node *n, int64_t now, struct sched_actions *out)
{
    struct gdc_node *g = n->gdc;
    if (now < g->due_us) return;
    g->due_us = INT64_MAX;
    if (!g->tries) return; /* phase 1 brought nothing */
    say_and_wait(n, g->tries > TRIES_MOST ? RING_CRASHED : RING_ASK, now, out);
}

/*
 * Case 2: "If P(i) finds an unvisited process P(m) that is not idle, P(i) process will keep its
 * integer task identifier."
 */
static void take_row(struct node *n, int32_t from)
{
    struct gdc_node *g = n->gdc;
    if (from < 0) search_on(n, after(n, n->place.me));
    if (g->tries && from == g->next) g->found = true;
    g->tries = 0;
    g->due_us = INT64_MAX;
}

/*
 * Case 2: "If the processor P(i+1) has finished its pre-assigned tasks (i.e., in the first phase),
 * then P(i) will use P(i+2), P(i+3), ... P(i-1) sequence to search an unvisited processor that is
 * not idle."
 * Case 3: "If P(i)'s next processor P(j) was idle, but P(j) has found a processor P(m) that is not
 * idle [...] P(j) will acknowledge P(i) that P(i) can ask a new job from P(m) instead. Thus, the
 * processor P(i) does not have to waste time to repeat the same process."
 */
static void take_none(struct node *n, const struct ring *r)
{
    struct gdc_node *g = n->gdc;
    if (!g->tries || r->peer != g->next) return;
    bool hint = r->idle && r->next >= 0 && r->next < n->place.n &&
                distance(n, r->next) > distance(n, g->next);
    search_on(n, hint ? r->next : after(n, g->next));
}

/*
 * Fault tolerance, 3: "The information includes how many scanlines P(i+1) has not finished and the
 * processor identifier of P(i+1)'s next processor. At present, P(i) can replace P(i+1) to connect
 * with the P(i+1)'s next processor." The scanlines follow, as rows.
 */
static void take_heir(struct node *n, const struct ring *r)
{
    if (!n->gdc->tries || r->peer != n->gdc->next || r->next < 0 || r->next >= n->place.n) return;
    search_on(n, r->next);
}

/* ---- being asked ----------------------------------------------------------------------------- */

static void note_asker(struct node *n, int32_t peer)
{
    struct gdc_node *g = n->gdc;
    if (peer < 0 || peer >= n->place.n || g->n_asked >= ASKED_MOST * n->place.n) return;
    if (g->n_asked == g->cap_asked) {
        g->cap_asked = g->cap_asked ? 2 * g->cap_asked : 8;
        g->asked = xrealloc(g->asked, (size_t)g->cap_asked, sizeof *g->asked);
    }
    g->asked[g->n_asked++] = peer;
}

/*
 * Case 1: "If P(i+1) is not idle, P(i+1) will send an" unfinished scanline to P(i). (The end of the
 * sentence is illegible in the copy at hand.) That scanline is one not begun: a node that has only
 * its worker's current row has nothing to give.
 *
 * Case 3: an idle node answers with the node that it remembers.
 */
static void answer(struct node *n, int32_t peer, struct sched_actions *out)
{
    const struct gdc_node *g = n->gdc;
    if (n->queue.count) {
        node_give(n, n->queue.tail, peer, out);
        return;
    }
    struct ring *r = node_say(RING_NONE, peer, out);
    r->idle = !n->fed.count;
    r->next = r->idle && g->found ? g->next : -1;
}

/*
 * Fault tolerance, 1: "There are two cases to consider. One is when P(i+1) is busy that can not
 * response to the request of P(i)." It answers when its row is done.
 */
static void answer_all(struct node *n, const struct sched_event *e, struct sched_actions *out)
{
    if (n->fed.count && e->kind != SCHED_DONE) return;
    for (int32_t i = 0; i < n->gdc->n_asked; i++) answer(n, n->gdc->asked[i], out);
    n->gdc->n_asked = 0;
}

/* ---- a step ---------------------------------------------------------------------------------- */

static void take_ring(struct node *n, const struct ring *r, int64_t now)
{
    switch (r->kind) {
    case RING_PLACE: take_place(n, now); break;
    case RING_ASK: note_asker(n, r->peer); break;
    case RING_NONE: take_none(n, r); break;
    case RING_HEIR: take_heir(n, r); break;
    case RING_GIVE:
    case RING_CRASHED: break; /* these go up only */
    }
}

void gdc_node_step(
    struct node *n, const struct sched_event *e, int64_t now, struct sched_actions *out)
{
    if (e->kind == SCHED_RING) take_ring(n, &e->ring, now);
    if (e->kind == SCHED_TASK) take_row(n, e->from);
    if (e->kind == SCHED_DONE && e->wall_us > n->gdc->longest_us && e->wall_us < ROW_MOST_US)
        n->gdc->longest_us = e->wall_us;
    answer_all(n, e, out);
    take_timeout(n, now, out);
    ask(n, now, out);
}

int64_t gdc_node_wake_us(const struct node *n) { return n->gdc->due_us; }

void gdc_node_free(struct node *n)
{
    if (n->gdc) free(n->gdc->asked);
    free(n->gdc);
}
