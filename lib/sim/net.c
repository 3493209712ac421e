/* Links: their latencies and rates, and the bytes of messages. */
#include "sim/net.h"

#define SUM " sum=89abcdef\n"
#define FRAG_PIXELS_MOST 65536 /* longer tasks come in several records */

static int digits(uint64_t v)
{
    int n = 1;
    while (v /= 10) n++;
    return n;
}

/* The numbers of a task or a part of it, each with a blank before it. */
static double lattice_bytes(const struct task *t)
{
    const struct lattice *l = &t->at;
    return 8 + digits(t->frame) + digits(t->id) + digits(l->x) + digits(l->y) + digits(l->w) +
           digits(l->h) + digits(l->sx) + digits(l->sy);
}

#define LENGTH(text) ((double)sizeof(text) - 1)

double net_bytes(const struct sched_event *e)
{
    const struct task *t = &e->task;
    double px = (double)lattice_count(&t->at), us = e->wall_us > 0 ? (double)e->wall_us : 0;
    int time = digits((uint64_t)us);
    switch (e->kind) {
    case SCHED_TASK: return LENGTH("task" SUM) + lattice_bytes(t);
    case SCHED_FLUSH: return LENGTH("flush\n");
    case SCHED_DONE:
        return LENGTH("done   cpu_us= wall_us=" SUM) + digits(t->frame) + digits(t->id) + 2 * time;
    case SCHED_PIXELS: {
        double bytes = px * SIM_PIXEL_BYTES, records = ceil(px / FRAG_PIXELS_MOST);
        double line =
            LENGTH("frag job=0123456789abcdef0123456789abcdef ch=4 crc=4294967295 bytes=" SUM "\n");
        line += lattice_bytes(t) + digits((uint64_t)(bytes / records));
        return records * line + bytes;
    }
    case SCHED_UP:
        return LENGTH("hello rtworker " STORMRING_VERSION " format=4 selftest=0123456789abcdef"
                      " power=1.23456 slots=1 alive=1 zstd=1" SUM);
    case SCHED_RING: return LENGTH("none peer=1234 next=1234" SUM);
    case SCHED_INPUT_END:
    case SCHED_SLOTS:
    case SCHED_GONE:
    case SCHED_WAKE:
    case SCHED_FAIL:
    case SCHED_DRAIN: break;
    }
    return 0;
}

int64_t net_least_us(const struct sim_plan *p)
{
    int64_t us = net_link_of(p, 0).latency_us;
    for (int32_t k = 1; k < p->slots; k++)
        if (net_link_of(p, k).latency_us < us) us = net_link_of(p, k).latency_us;
    return us;
}

int64_t net_most_us(const struct sim_plan *p)
{
    int64_t us = 0;
    for (int32_t k = 0; k < p->slots; k++)
        if (net_link_of(p, k).latency_us > us) us = net_link_of(p, k).latency_us;
    return us;
}

double net_all_bytes(const struct sim_plan *p)
{
    double bytes = 0;
    for (int32_t i = 0; p->work && i < p->tasks; i++) {
        struct sched_event e = {.kind = SCHED_PIXELS, .task = p->work->tasks[i]};
        bytes += net_bytes(&e);
        e.kind = SCHED_DONE;
        bytes += net_bytes(&e);
    }
    return bytes;
}

double net_least_rate(const struct sim_plan *p)
{
    double rate = p->hub_bytes_per_s;
    for (int32_t k = 0; k < p->slots; k++) {
        double of = net_link_of(p, k).bytes_per_s;
        if (of > 0 && (rate <= 0 || of < rate)) rate = of;
    }
    return rate;
}

int64_t net_send(struct net_queue *q, double bytes, double bytes_per_s, int64_t now_us, bool bulk)
{
    double us = net_us(bytes, bytes_per_s);
    q->bulk_us = fmax(q->bulk_us, (double)now_us) + us;
    if (bulk) return (int64_t)q->bulk_us;
    q->small_us = fmax(q->small_us, (double)now_us) + us;
    return (int64_t)q->small_us;
}
