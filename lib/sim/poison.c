/* Pixels that cost the slots that compute them, and states that slots refuse. */
#include "sim/world.h"

const struct poison *sim_poison_in(const struct world *w, const struct task *t)
{
    for (size_t i = 0; i < w->n_poison; i++) {
        const struct poison *p = &w->poison[i];
        const struct lattice one = {p->x, p->y, 1, 1, t->at.sx, t->at.sy};
        if (lattice_offset(&t->at, w->frame_w, &one) >= 0) return p;
    }
    return NULL;
}

void sim_plan_poison(struct world *w)
{
    const struct sim_plan *p = w->plan;
    w->poison = xcalloc(p->n_faults + (size_t)p->poison + 1, sizeof *w->poison);
    for (size_t i = 0; i < p->n_faults; i++)
        if (p->faults[i].kind == SIM_POISON)
            w->poison[w->n_poison++] =
                (struct poison){p->faults[i].x, p->faults[i].y, p->faults[i].power > 0};
    for (int32_t i = 0; i < p->poison && p->tasks; i++) {
        const double where = rng_unit(p->seed, 5000 + 2 * (uint64_t)i);
        const int64_t px = (int64_t)(where * p->tasks * p->rows * w->frame_w);
        w->poison[w->n_poison++] = (struct poison){(uint32_t)(px % w->frame_w),
            (uint32_t)(px / w->frame_w), rng_unit(p->seed, 5001 + 2 * (uint64_t)i) < .5};
    }
}

bool sim_refuses(const struct world *w, int32_t k, uint32_t generation)
{
    const struct sim_plan *p = w->plan;
    for (size_t i = 0; i < p->n_faults; i++) {
        const struct sim_fault *f = &p->faults[i];
        if (f->kind == SIM_REFUSE && f->slot == k && f->y == generation) return true;
    }
    const uint64_t draw = 10000 + (uint64_t)generation * (uint64_t)p->slots + (uint64_t)k;
    return k && p->p_refuse > 0 && rng_unit(p->seed, draw) < p->p_refuse;
}
