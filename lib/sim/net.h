/*
 * Links and the bytes of messages, for run.c and tree.c. A record has the length that lib/wire
 * gives it between a fan and a worker; its pixels have 16 bytes each. What ssh and TCP add is not
 * counted.
 */
#ifndef STORMRING_SIM_NET_H
#define STORMRING_SIM_NET_H

#include "sim/sim.h"

/* The link of slot k: its host's, or that of the plan. */
static inline struct sim_link net_link_of(const struct sim_plan *p, int32_t k)
{
    return p->links ? p->links[p->link_of[k]] : p->link;
}
/* Slots of one host share its link: its number, below net_links(). */
static inline int32_t net_number_of(const struct sim_plan *p, int32_t k)
{
    return p->links ? p->link_of[k] : k;
}
static inline int32_t net_links(const struct sim_plan *p)
{
    return p->links ? p->n_links : p->slots;
}
/* The least latency of a slot, and the most. */
int64_t net_least_us(const struct sim_plan *p);
int64_t net_most_us(const struct sim_plan *p);

/* The bytes of the record of this event, its pixels included; 0: no record. */
double net_bytes(const struct sched_event *e);
/* The time that these bytes take; 0 if there is no limit. */
static inline double net_us(double bytes, double bytes_per_s)
{
    return bytes_per_s > 0 ? 1e6 * bytes / bytes_per_s : 0;
}
/*
 * One direction of a link. Records without pixels overtake those with pixels, whose queue is
 * `bulk`; both take time of the link.
 */
struct net_queue {
    double small_us, bulk_us; /* when the last one has left; not rounded: many are short */
};
/* Sends a message at now_us, and returns the time at which its last byte leaves. */
int64_t net_send(struct net_queue *q, double bytes, double bytes_per_s, int64_t now_us, bool bulk);
/* Counts what is sent; 0 bytes are no record. */
static inline void net_count(struct sim_result *r, double bytes)
{
    r->records += bytes > 0;
    r->bytes += bytes;
}
/* All bytes of the run's tasks, each sent once: their records and pixels. */
double net_all_bytes(const struct sim_plan *p);
/* The least rate of a link or a hub, in bytes per second; 0: no limit. */
double net_least_rate(const struct sim_plan *p);

#endif
