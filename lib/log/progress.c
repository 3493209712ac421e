/* The progress line of a run. */
#include "log/log.h"

static double clock_s(void) { return (double)now_us() * 1e-6; }

void log_progress_note(
    struct log_progress *p, const struct assembly *parts, const struct record *r, bool earlier)
{
    const struct assembly_frame *f = NULL;
    if (!p->line.on) return;
    if (r->kind == REC_FRAG) f = assembly_find(parts, r->task.frame);
    wire_eta(&p->eta, r, f ? f->have.h : 0, earlier ? -1 : clock_s());
}

void log_progress_show(struct log_progress *p, const struct assembly *parts)
{
    const double done = (double)parts->done_px, all = (double)parts->declared_px;
    if (!progress_due(&p->line)) return;
    double left_s = eta_left_s(&p->eta, done, all, clock_s());
    progress_show(&p->line, parts->done_px, parts->declared_px, left_s);
}
