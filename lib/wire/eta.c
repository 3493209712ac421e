/* Costs and pixels of records for the estimate of the time left: see wire.h. */
#include "wire/wire.h"

void wire_eta(struct eta *e, const struct record *r, uint32_t frame_h, double t_s)
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
