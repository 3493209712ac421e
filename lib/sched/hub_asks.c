/*
 * The hub: asks and their answers. An ask has at most one victim at a time, which has not answered
 * yet. All such asks are in a list in the order of time, so that the first one is late first.
 *
 *   asks     is remembered (hungry) until the node is given a task, from whichever node
 *   asked    answers with tasks, or with NONE: then it is dry until it is given a task, or has done
 *            one, and the ask is remembered again; it is not dry if it was given a task while the
 *            ask was under way, because perhaps it answered before it saw that task
 *
 * The loss of an unreachable node is known only after seconds. A node that asked waits only
 * for a multiple of the longest recent answer. Then its ask is remembered again, and the
 * victim is silent: it is not asked until it sends something. Its answer may still come: its GIVE
 * counts, whatever the asking node waits for by then.
 */
#include "patience/patience.h"
#include "sched/hub_int.h"

#define ANSWERS_OF_LATE 16 /* the number of recent answers, about, of which it is the longest */

void hub_pair(struct hub *h, int32_t k, int32_t thief)
{
    struct hub_node *s = &h->nodes[k], *t = &h->nodes[thief];
    t->victim = k;
    t->given_before = s->given;
    t->since_us = h->now_us;
    t->older = h->newest;
    t->newer = -1;
    *(h->newest >= 0 ? &h->nodes[h->newest].newer : &h->oldest) = thief;
    h->newest = thief;
    t->before = -1;
    t->after = s->thief;
    if (s->thief >= 0) h->nodes[s->thief].before = thief;
    s->thief = thief;
    s->thieves++;
    hub_mark(h, k);
    hub_mark(h, thief);
}

/* Ends the outstanding ask of node thief, if there is one. */
static void part(struct hub *h, int32_t thief)
{
    struct hub_node *t = &h->nodes[thief];
    int32_t k = t->victim;
    if (k < 0) return;
    if (t->before >= 0) h->nodes[t->before].after = t->after;
    else h->nodes[k].thief = t->after;
    if (t->after >= 0) h->nodes[t->after].before = t->before;
    *(t->older >= 0 ? &h->nodes[t->older].newer : &h->oldest) = t->newer;
    *(t->newer >= 0 ? &h->nodes[t->newer].older : &h->newest) = t->older;
    t->victim = -1;
    h->nodes[k].thieves--;
    hub_mark(h, k);
    hub_mark(h, thief);
}

void hub_served(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = s->told = s->passed_on = s->dry = false;
    s->given++;
    part(h, k);
    hub_mark(h, k);
}

void hub_asks(struct hub *h, int32_t k)
{
    h->nodes[k].asking = true;
    hub_mark(h, k);
}

void hub_answers(struct hub *h, int32_t k, int32_t peer)
{
    if (peer < 0 || peer >= h->n_nodes || h->nodes[peer].victim != k) return;
    int64_t us = h->now_us - h->nodes[peer].since_us;
    h->answer_us -= h->answer_us / ANSWERS_OF_LATE;
    if (us > h->answer_us) h->answer_us = us;
}

void hub_has_none(struct hub *h, int32_t k, int32_t peer)
{
    if (peer < 0 || peer >= h->n_nodes || h->nodes[peer].victim != k) return;
    hub_answers(h, k, peer);
    h->nodes[k].dry = h->nodes[k].given == h->nodes[peer].given_before;
    h->nodes[peer].passed_on = true;
    part(h, peer);
    hub_mark(h, k);
}

/* The asks that wait for node k go to other victims. */
static void pass_on(struct hub *h, int32_t k)
{
    while (h->nodes[k].thief >= 0) {
        h->nodes[h->nodes[k].thief].passed_on = true;
        part(h, h->nodes[k].thief);
    }
    hub_mark(h, k);
}

void hub_lost(struct hub *h, int32_t k)
{
    struct hub_node *s = &h->nodes[k];
    s->asking = s->told = s->passed_on = s->dry = s->silent = false;
    part(h, k);
    pass_on(h, k);
}

int64_t hub_late_us(const struct hub *h)
{
    if (h->oldest < 0) return INT64_MAX;
    int64_t late_us = h->answer_us ? PATIENCE_ANSWER_TIMES * h->answer_us + PATIENCE_ANSWER_US
                                   : PATIENCE_FIRST_ANSWER_US;
    return h->nodes[h->oldest].since_us + late_us;
}

void hub_late(struct hub *h)
{
    while (h->now_us >= hub_late_us(h)) {
        int32_t k = h->nodes[h->oldest].victim;
        h->nodes[k].silent = true;
        pass_on(h, k);
    }
}
