/* The power of a slot by short runs of its self-test: worker.h. */
#include "worker/worker.h"

/* Three runs, for the first loads pages; no further one begins after these times. */
#define RUNS_LEAST 3
#define RUNS_MOST 8
#define CPU_MOST_US 4000
#define WALL_MOST_US 20000

void worker_power_add(struct worker_power *p, int64_t cpu_us, int64_t wall_us)
{
    const int64_t us = cpu_us > 0 && cpu_us < wall_us ? cpu_us : wall_us;
    if (!p->n || us < p->best_us) p->best_us = us;
    if (p->n) p->later_us += wall_us;
    p->cpu_us += us;
    p->wall_us += wall_us;
    p->n++;
}

bool worker_power_known(const struct worker_power *p)
{
    if (p->best_us >= WALL_MOST_US || p->n == RUNS_MOST) return true;
    return p->n >= RUNS_LEAST && (p->wall_us >= WALL_MOST_US || p->cpu_us >= CPU_MOST_US);
}

static double power_of(double us, double processors)
{
    return WORKER_SELFTEST_REFERENCE_US / fmax(us, 1) * fmin(processors, 1);
}

double worker_power_best(const struct worker_power *p, double processors)
{
    return power_of((double)p->best_us, processors);
}

double worker_power_least(const struct worker_power *p, double processors)
{
    const double us = p->n > 1 ? (double)p->later_us / (p->n - 1) : (double)p->wall_us;
    return fmin(power_of(us, 1), worker_power_best(p, processors));
}
