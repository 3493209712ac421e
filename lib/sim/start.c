/* Before the first task: the time at which a slot joins, and the times of its preparation. The
 * least time of any schedule follows from them. */
#include "sim/world.h"

#define CONNECT (UINT64_C(1) << 60) /* draws of hosts, apart from others of the seed */
#define BUILD (UINT64_C(1) << 61)

size_t sim_first_load(const struct sim_plan *p, int32_t k)
{
    size_t from = 0, to = p->n_loads;
    while (from < to) {
        size_t mid = from + (to - from) / 2;
        if (p->loads[mid].slot < k) from = mid + 1;
        else to = mid;
    }
    return from;
}

int64_t sim_joins_us(const struct sim_plan *p, int32_t k)
{
    size_t i = sim_first_load(p, k);
    if (i == p->n_loads || p->loads[i].slot != k || p->loads[i].share > 0) return 0;
    return p->loads[i + 1].at_us;
}

/* The host of slot k takes us, times a factor of its own. */
static double drawn(const struct sim_plan *p, int32_t k, uint64_t what, double us)
{
    double unit = 2 * rng_unit(p->seed, what + (uint64_t)net_number_of(p, k)) - 1;
    return us * pow(fmax(p->start.spread, 1), unit);
}

int64_t sim_connect_us(const struct sim_plan *p, int32_t k)
{
    return llround(drawn(p, k, CONNECT, 1e6 * p->start.connect_s));
}

double sim_build_us(const struct sim_plan *p, int32_t k)
{
    return drawn(p, k, BUILD, 1e6 * p->start.build_s);
}

/* ---- the least time -------------------------------------------------------------------------- */

/* The work at power 1 that slot k can do from its first message until its last pixels must leave,
 * in microseconds. */
static double work_until(const struct sim_plan *p, int32_t k, double end_us)
{
    const struct sim_link link = net_link_of(p, k);
    double latency_us = (double)link.latency_us * (1 - p->jitter), us = 0, share = 1;
    double from = (double)(sim_joins_us(p, k) + sim_connect_us(p, k)) + 2 * latency_us;
    from += net_us(p->start.state_bytes, link.bytes_per_s);
    end_us -= latency_us;
    for (size_t i = sim_first_load(p, k); i < p->n_loads && p->loads[i].slot == k; i++) {
        double to = fmin((double)p->loads[i].at_us, end_us);
        us += share * fmax(to - from, 0);
        from = fmax(from, to);
        share = p->loads[i].share;
    }
    us += share * fmax(end_us - from, 0);
    return fmax(us * p->work->power[k] - sim_build_us(p, k), 0);
}

static double all_until(const struct sim_plan *p, double end_us)
{
    double us = 0;
    for (int32_t k = 0; k < p->slots; k++) us += work_until(p, k, end_us);
    return us;
}

double sim_least_s(const struct sim_plan *p)
{
    double us = 0, from = 1e6 * sim_bound_s(p);
    from += 3 * (double)net_least_us(p) * (1 - p->jitter);
    for (size_t i = 0, n = (size_t)p->work->frame_w * p->work->frame_h; i < n; i++)
        us += p->work->pixel_us[i];
    double to = fmax(from, 1);
    while (all_until(p, to) < us) to *= 2;
    while (to - from > 1e-3 && to - from > 1e-9 * to) {
        double mid = (from + to) / 2;
        if (all_until(p, mid) < us) from = mid;
        else to = mid;
    }
    return 1e-6 * from;
}
