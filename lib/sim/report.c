/* The figures of a run as a table. */
#include "sim/net.h"

#include <inttypes.h>

static void real(struct buf *out, const char *key, double v)
{
    buf_printf(out, "%s\t%.6f\n", key, v);
}

static void count(struct buf *out, const char *key, int64_t n)
{
    buf_printf(out, "%s\t%" PRId64 "\n", key, n);
}

void sim_report_faults(const struct sim_result *r, struct buf *out)
{
    const struct {
        const char *key;
        int64_t n;
    } table[] = {{"crashes", r->crashes}, {"silences", r->silences}, {"pauses", r->pauses},
        {"slows", r->slows}, {"hangs", r->hangs}, {"kills", r->kills}, {"returns", r->returns},
        {"twice", r->twice}, {"garbage", r->garbage}, {"lost", r->lost}, {"doubled", r->doubled},
        {"late", r->late}, {"poisoned", r->poisoned}, {"abandoned", (int64_t)r->abandoned},
        {"events", r->events}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) count(out, table[i].key, table[i].n);
    buf_printf(out, "trace\t%016" PRIx64 "\n", r->trace_hash);
}

/* Of a tree. */
static void report_hubs(const struct sim_result *r, struct buf *out)
{
    double s = (double)r->end_us * 1e-6;
    count(out, "hubs", r->hubs);
    count(out, "hub_slots", r->hub_slots);
    count(out, "hub_records", r->hub_records);
    real(out, "hub_records_per_s", s > 0 ? (double)r->hub_records / s : 0);
    real(out, "hub_bytes_per_s", s > 0 ? r->hub_bytes / s : 0);
    count(out, "hub_tasks", r->hub_tasks);
}

void sim_report(const struct sim_plan *p, const struct sim_result *r, struct buf *out)
{
    double bound = sim_bound_s(p), makespan = (double)r->end_us * 1e-6;
    bool whole = !r->uncommitted;
    count(out, "slots", p->slots);
    count(out, "tasks", p->tasks);
    count(out, "uncommitted", r->uncommitted);
    count(out, "computed", r->computed);
    real(out, "makespan_s", makespan);
    real(out, "busy_s", r->busy_us * 1e-6);
    real(out, "startup_s", r->startup_us * 1e-6);
    real(out, "waiting_s", r->waiting_us * 1e-6);
    real(out, "tail_s", r->tail_us * 1e-6);
    real(out, "work_s", r->work_us * 1e-6);
    real(out, "bound_s", bound);
    real(out, "least_s", sim_least_s(p));
    buf_printf(out, "efficiency\t%.4f\n", whole && makespan > 0 ? bound / makespan : 0);
    count(out, "records", r->records);
    real(out, "bytes", r->bytes);
    count(out, "messages", r->messages);
    count(out, "steals", r->steals);
    count(out, "passed", r->passed);
    count(out, "reports", r->reports);
    buf_printf(
        out, "messages_per_steal\t%.3f\n", r->steals ? (double)r->messages / (double)r->steals : 0);
    if (r->hubs) report_hubs(r, out);
    sim_report_faults(r, out);
}
