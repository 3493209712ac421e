/* stream_list: integrates the cells of the list; marks those that are done with that. */
#ifndef STORMRING_VOLUME_STREAM_LIST_H
#define STORMRING_VOLUME_STREAM_LIST_H

#include "volume/stream_lit.h"

/* May surfaces be within lo .. hi? By a margin that rounding does not exceed. */
SIMD_INLINE unsigned meets_surface(const struct stream *s, const struct cubics *c, vf lo, vf hi)
{
    vf margin = c->range * SURFACE_MARGIN;
    vi meets = {0};
    for (size_t i = 0; i < s->v->spec->n_isos; i++) {
        vf y = (s->value_high[i] - c->base) + s->value_low[i];
        meets |= (y >= lo - margin) & (y <= hi + margin);
    }
    return vi_signs(meets);
}

/* Is the range of the cell's values too great for the precision of float in its entries? */
SIMD_INLINE unsigned is_coarse(const struct stream *s, const struct cubics *c, vi first, vi last)
{
    vf room = vf_lookup(s->map.room, s->map.entries <= 8, first);
    return vi_signs(c->range > vf_choose(first == last, room, vf_set(s->least_room)));
}

/* Which of the cells from j on touch a slice? */
static unsigned meets_slice(const struct stream *s, uint32_t j)
{
    unsigned meets = 0;
    for (uint32_t k = 0; k < VF; k++) {
        int32_t i[3];
        cell_of_index(s->v, s->node[j + k], i);
        meets |= (unsigned)volume_is_sliced(s->v, i) << k;
    }
    return meets;
}

/* Computes the field in the cells of the list. */
SIMD_INLINE void fields(struct stream *s, bool wide)
{
    /* Pads the list with copies of its first cell. */
    for (uint32_t j = s->cells; j % VF; j++) s->node[j] = s->node[0];
    for (uint32_t j = 0; j < s->cells; j += VF) {
        struct cubics c = cubics(s, j);
        vf lo, hi;
        vi first, last;
        bounds(c.p, &lo, &hi);
        if (wide && s->narrow) {
            entries(&s->map, c.base, lo - c.range * SURFACE_MARGIN, hi + c.range * SURFACE_MARGIN,
                &first, &last);
        } else {
            entries(&s->map, c.base, lo, hi, &first, &last);
        }
        UNROLLED
        for (int i = 0; i < 4; i++) vf_store(s->p[i] + j, c.p[i]);
        vf_store(s->base + j, c.base);
        vi_store(s->first + j, first);
        vi_store(s->last + j, last);
        if (!wide) continue;
        unsigned hard = meets_surface(s, &c, lo, hi);
        if (s->narrow) hard |= is_coarse(s, &c, first, last);
        if (s->v->n_slices) hard |= meets_slice(s, j);
        s->hard[j / VF] = (uint16_t)hard;
        if (s->shines && s->v->spec->lit) put_light(s, j, &c);
    }
}

/* Integrates all cells; marks those that are simple. (A separate loop, because short iterations
 * overlap in the processor.) */
SIMD_INLINE void integrate_simple(struct stream *s, bool few)
{
    for (uint32_t j = 0; j < s->cells; j += VF) {
        const vf p[4] = {
            vf_load(s->p[0] + j), vf_load(s->p[1] + j), vf_load(s->p[2] + j), vf_load(s->p[3] + j)};
        vi first = vi_load(s->first + j), last = vi_load(s->last + j);
        struct added r =
            integrate_segment(&s->map, few, first, vf_load(s->base + j), p, vf_load(s->len + j));
        unsigned simple = vi_signs((first == last) & (r.error <= vf_set(s->tolerance)));
        put_added(s->add + j, &r);
        s->simple[j / VF] = (uint16_t)simple;
    }
}

static void cells(struct stream *s)
{
    if (s->wide) fields(s, true);
    else fields(s, false);
    if (s->shines) integrate_lit_cells(s);
    else if (s->map.entries <= 8) integrate_simple(s, true);
    else integrate_simple(s, false);
    for (uint32_t j = 0; s->wide && j < s->cells; j += VF) s->simple[j / VF] &= ~s->hard[j / VF];
}

#endif
