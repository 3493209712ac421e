/*
 * slice: planes across an axis, in the colours of the map. A ray crosses a plane at a time that is
 * computed as those of the grid's planes are. So it is within the segment of exactly one layer of
 * cells, or at the end of two, of which the first one has it.
 */
#include "volume/volume_int.h"

#include <stdlib.h>

#define TIE 0x1p-30 /* of a segment: nearer sheets are in one place, and rounding moved them */

uint32_t crossing_insert(struct crossing *list, uint32_t n, struct crossing x)
{
    /* A slice in a face is of the first cell, so it is in front of a surface in its place. */
    const double tie = x.iso ? 0 : TIE;
    uint32_t i = n;
    for (; i > 0 && list[i - 1].w > x.w - (list[i - 1].iso ? tie : 0); i--) list[i] = list[i - 1];
    if (i < n) x.w = fmin(x.w, list[i + 1].w);
    list[i] = x;
    return n + 1;
}

/* Marks the layers of cells that touch a slice. */
static void mark_layers(struct volume *v, const struct slice *s)
{
    const double *plane = v->plane[s->axis];
    for (uint32_t i = 0; i < v->cells[s->axis]; i++)
        if (plane[i] <= s->at && plane[i + 1] >= s->at) v->sliced[s->axis][i] = true;
}

void slice_init(struct volume *v)
{
    const struct spec *s = v->spec;
    v->n_slices = s->n_slices;
    v->slice = xcalloc(v->n_slices + 1, sizeof *v->slice);
    for (int a = 0; a < 3; a++) v->sliced[a] = xcalloc(v->cells[a], sizeof *v->sliced[a]);
    for (size_t i = 0; i < v->n_slices; i++) {
        const struct spec_slice *of = &s->slice[i];
        const double *whole = v->whole[of->axis];
        const double at = grid_within(of->at * s->scale[of->axis], whole[0], whole[1]);
        v->slice[i] = (struct slice){of->axis, at, of->opacity};
        mark_layers(v, &v->slice[i]);
    }
}

void slice_free(struct volume *v)
{
    for (int a = 0; a < 3; a++) free(v->sliced[a]);
    free(v->slice);
}

uint32_t slice_crossings(const struct volume *v, const struct segment *s, const double o[3],
    const double d[3], bool fresh, uint32_t n)
{
    for (size_t i = 0; i < v->n_slices; i++) {
        const struct slice *of = &v->slice[i];
        if (d[of->axis] == 0) continue;
        double t = (of->at - o[of->axis]) * (1 / d[of->axis]);
        if (!(t <= s->t1 && (t > s->t0 || (fresh && t == s->t0)))) continue;
        n = crossing_insert(
            v->crossing, n, (struct crossing){(t - s->t0) / (s->t1 - s->t0), NULL, of->opacity});
    }
    return n;
}

bool slice_colour(const struct path *p, double w, double rgb[3])
{
    const double fade = path_fade(p, w);
    if (map_find(&p->v->map, p->cell->base + cubic_at(p->cell->p, w)) < 0) return false;
    volume_colour(p, w, rgb);
    for (int c = 0; c < 3; c++) rgb[c] *= fade;
    return true;
}
