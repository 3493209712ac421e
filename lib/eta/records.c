/* What records of a run tell the estimate, and the line that shows it. */
#include "eta/eta.h"
#include "image/image.h"
#include "wire/wire.h"

void eta_record(struct eta *e, const struct record *r, uint32_t frame_h, double t_s)
{
    int64_t cpu_us = 0, wall_us = 0;
    if (r->kind == REC_HELLO) eta_begin(e);
    if (r->kind == REC_DONE) {
        rec_int(r, "cpu_us", 0, INT64_MAX, &cpu_us);
        rec_int(r, "wall_us", 0, INT64_MAX, &wall_us);
        /* On a busy machine the wall time is mostly chance. */
        eta_done(e, r->task.frame, r->task.id, (double)(cpu_us ? cpu_us : wall_us), t_s);
    }
    if (r->kind != REC_FRAG || !frame_h) return;
    const struct lattice *at = &r->task.at;
    double last = at->y + (double)(at->h - 1) * at->sy;
    eta_pixels(e, r->task.frame, r->task.id, (at->y + .5) / frame_h, (last + .5) / frame_h,
        (double)lattice_count(at));
}

static double clock_s(void) { return (double)now_us() * 1e-6; }

void eta_progress_note(
    struct eta_progress *p, const struct assembly *parts, const struct record *r, bool earlier)
{
    const struct assembly_frame *f = NULL;
    if (!p->line.on) return;
    if (r->kind == REC_FRAG) f = assembly_find(parts, r->task.frame);
    eta_record(&p->eta, r, f ? f->have.h : 0, earlier ? -1 : clock_s());
}

void eta_progress_show(struct eta_progress *p, const struct assembly *parts)
{
    const double done = (double)parts->done_px, all = (double)parts->declared_px;
    if (!progress_due(&p->line)) return;
    double left_s = eta_left_s(&p->eta, done, all, clock_s());
    progress_show(&p->line, parts->done_px, parts->declared_px, left_s);
}
