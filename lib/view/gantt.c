/* A log as a timeline: the intervals of stormring-tsv(5). */
#include "view/view.h"

#include <inttypes.h>

void view_gantt(const struct account *a, double bound_s, const char *name, struct buf *out)
{
    static const char *const word[ACCOUNT_KINDS] = {"task", "task given again", "wasted"};
    const struct history *l = a->log;
    const char *kind = l->n_frames && l->frames[0].replayed ? "replayed" : "real";
    buf_printf(out,
        "# x: time\n# y: slot\n# note: efficiency %.3f: at least %.3g s, and it took %.3g s%s\n",
        account_efficiency(a, bound_s), bound_s, a->makespan_s,
        l->n_runs > 1 ? ", all runs together" : "");
    buf_printf(out, "# lanes:");
    for (size_t k = 0; k < a->n_slots; k++) buf_printf(out, " %s", a->slots[k].name);
    buf_printf(out, "\nexperiment\tkind\tmethod\tx\tx_unit\ty\ty_unit\tsample\tseed\tuntil\n");
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct span *s = &a->spans[i];
        double zero_s = a->zero_s[s->run];
        buf_printf(out, "%s\t%s\t%s\t%.6f\ts\t%" PRIu32 "\t1\t%zu\t0\t%.6f\n", name, kind,
            word[account_kind(a, i)], zero_s + s->begin_s, s->slot, i + 1, zero_s + s->end_s);
    }
}
