/* Links between the fan and its slots. */
#include "sim/world.h"

#define LATE_US 1e6 /* at most, for a datagram that others overtake */

/* Arrival from or at slot k over a link that keeps order, for a message sent at from_us; trips:
 * latencies. */
static int64_t arrival(struct world *w, int32_t k, int64_t from_us, double trips, int64_t *latest)
{
    double us = (double)net_link_of(w->plan, k).latency_us * trips;
    if (w->plan->jitter > 0) us *= 1 + w->plan->jitter * (2 * sim_draw(w) - 1);
    int64_t at = from_us + (int64_t)us;
    if (at < *latest) at = *latest;
    return *latest = at;
}

/* A ring message between nodes takes its hops on two links, half of them on each. */
static double trips_of(const struct world *w, bool between_nodes)
{
    return between_nodes ? w->plan->hops / 2 : 1;
}

static int64_t leaves(struct world *w, int32_t k, const struct sched_event *e, bool bulk)
{
    struct net_queue *q = &w->up[net_number_of(w->plan, k)];
    net_count(w->result, net_bytes(e));
    return net_send(q, net_bytes(e), net_link_of(w->plan, k).bytes_per_s, w->now_us, bulk);
}

/* Messages that keep their order with pixels. */
static bool is_bulk(const struct sched_event *e)
{
    return e->kind == SCHED_PIXELS || e->kind == SCHED_GONE || e->kind == SCHED_UP ||
           e->kind == SCHED_DRAIN;
}

/*
 * A ring message due at at_us. It may be lost, come twice, or be so late that others overtake it.
 * Links lose nothing, but the network of the published ring may.
 */
static void send_datagram(struct world *w, int64_t at_us, int32_t k, struct sim_event e)
{
    const struct sim_plan *p = w->plan;
    if (p->p_lose > 0 && sim_draw(w) < p->p_lose) {
        w->result->lost++;
        return;
    }
    if (p->p_late > 0 && sim_draw(w) < p->p_late) {
        w->result->late++;
        at_us += (int64_t)(sim_draw(w) * LATE_US);
    }
    sim_schedule(w, at_us, k, e);
    if (p->p_double <= 0 || sim_draw(w) >= p->p_double) return;
    w->result->doubled++;
    sim_schedule(w, at_us + (int64_t)(sim_draw(w) * LATE_US), k, e);
}

void sim_say(struct world *w, int32_t k, struct sched_event e)
{
    struct vslot *s = &w->slots[k];
    int64_t at;
    e.slot = k;
    e.frame_w = w->frame_w;
    int64_t left_us = leaves(w, k, &e, e.kind == SCHED_PIXELS);
    if (e.kind == SCHED_PIXELS) at = arrival(w, k, left_us, 1, &s->pixels_us);
    else {
        if (is_bulk(&e) && s->up_us < s->pixels_us) s->up_us = s->pixels_us;
        at = arrival(w, k, left_us, trips_of(w, e.kind == SCHED_RING), &s->up_us);
        if (is_bulk(&e)) s->pixels_us = at;
    }
    bool waits = w->plan->hub_bytes_per_s > 0 && is_bulk(&e);
    struct sim_event up = {.kind = waits ? SIM_AT_HUB : SIM_SCHED, .sched = e};
    if (e.kind == SCHED_RING) send_datagram(w, at, k, up);
    else sim_schedule(w, at, k, up);
}

void sim_pass_hub(struct world *w, const struct sim_event *e)
{
    struct sim_event passed = *e;
    w->hub_us = fmax(w->hub_us, (double)w->now_us);
    if (e->sched.kind == SCHED_PIXELS)
        w->hub_us += net_us(net_bytes(&e->sched), w->plan->hub_bytes_per_s);
    passed.kind = SIM_SCHED;
    sim_schedule(w, (int64_t)w->hub_us, e->slot, passed);
}

void sim_send_down(struct world *w, int32_t k, const struct sched_action *a)
{
    struct sched_event e = {.task = a->task, .frame_w = w->frame_w, .from = -1, .ring = a->ring};
    bool between_nodes = a->kind == SCHED_SAY && a->ring.kind != RING_PLACE;
    switch (a->kind) {
    case SCHED_GIVE:
        e.kind = SCHED_TASK;
        e.task.to = k;
        e.from = a->from;
        between_nodes = w->plan->node && a->from >= 0;
        break;
    case SCHED_SAY: e.kind = SCHED_RING; break;
    case SCHED_ASK_FLUSH: e.kind = SCHED_FLUSH; break;
    default: e.kind = SCHED_INPUT_END; break;
    }
    struct net_queue *q = &w->down_to[net_number_of(w->plan, k)];
    net_count(w->result, net_bytes(&e));
    int64_t at = net_send(q, net_bytes(&e), net_link_of(w->plan, k).bytes_per_s, w->now_us, true);
    at = arrival(w, k, at, trips_of(w, between_nodes), &w->slots[k].down_us);
    w->result->messages += between_nodes;
    struct sim_event down = {.kind = SIM_TO_SLOT, .sched = e};
    if (between_nodes) send_datagram(w, at, k, down);
    else sim_schedule(w, at, k, down);
}

void sim_prime(struct world *w, int32_t k)
{
    const struct sim_start *start = &w->plan->start;
    int32_t number = net_number_of(w->plan, k);
    if (start->state_bytes <= 0 && start->build_s <= 0) return;
    if (w->primed_us[number] < 0) {
        net_count(w->result, start->state_bytes);
        w->primed_us[number] = (double)net_send(&w->down_to[number], start->state_bytes,
            net_link_of(w->plan, k).bytes_per_s, w->now_us, true);
    }
    int64_t left_us = (int64_t)fmax(w->primed_us[number], (double)w->now_us);
    int64_t at = arrival(w, k, left_us, 1, &w->slots[k].down_us);
    sim_schedule(w, at, k, (struct sim_event){.kind = SIM_STATE});
}
