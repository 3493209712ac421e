/* The surfaces of a specification that a user can move: iso, slices and clip planes. */
#include "viewer/viewer_int.h"

static size_t surfaces(const struct spec *p)
{
    return p->n_isos + p->n_slices + (p->clipped ? 6 : 0);
}

/* The surface of this number: its kind, and its number among those. */
static enum surface surface_of(const struct spec *p, size_t i, size_t *k)
{
    *k = i;
    if (i < p->n_isos) return SURFACE_ISO;
    *k = i - p->n_isos;
    if (*k < p->n_slices) return SURFACE_SLICE;
    *k -= p->n_slices;
    return SURFACE_CLIP;
}

static void name_surface(const struct subject *s, char said[ERR_BYTES])
{
    static const char *const ends[] = {"from", "to"};
    const struct spec *p = &s->spec;
    size_t k;
    switch (surface_of(p, s->surface, &k)) {
    case SURFACE_ISO: err_set(said, "iso %.6g", p->iso[k].s); return;
    case SURFACE_SLICE:
        err_set(said, "slice %c %.6g", "xyz"[p->slice[k].axis], p -> slice[k].at);
        return;
    case SURFACE_CLIP:
        err_set(said, "clip %c %s %.6g", "xyz"[k / 2], ends[k % 2], p -> clip[k / 2][k % 2]);
    }
}

void subject_select(struct subject *s, char said[ERR_BYTES])
{
    const size_t n = surfaces(&s->spec);
    if (!n) {
        err_set(said, "no iso, slice or clip to move");
        return;
    }
    s->surface = (s->surface + 1) % n;
    name_surface(s, said);
}

/* The place of the surface, in *next, which has its own lists, and its range. */
static double *place_of(
    const struct subject *s, struct spec *next, size_t i, double *from, double *to)
{
    size_t k;
    int axis = 0;
    double *place = NULL;
    switch (surface_of(next, i, &k)) {
    case SURFACE_ISO: *from = s->least, *to = s->most; return &next->iso[k].s;
    case SURFACE_SLICE: axis = next->slice[k].axis, place = &next->slice[k].at; break;
    case SURFACE_CLIP: axis = (int)k / 2, place = &next->clip[axis][k % 2];
    }
    *from = s->grid.at[axis][0];
    *to = s->grid.at[axis][s->grid.n[axis] - 1];
    return place;
}

/* Sorting may have given it another number. */
static void find_surface(struct subject *s, double value)
{
    const size_t n = surfaces(&s->spec), before = s->surface;
    for (size_t i = 0; i < n; i++) {
        double from, to;
        s->surface = (before + i) % n;
        if (*place_of(s, &s->spec, s->surface, &from, &to) == value) return;
    }
}

bool subject_shift(struct subject *s, double part, char said[ERR_BYTES])
{
    struct buf b = {0};
    double from, to;
    if (!surfaces(&s->spec)) return subject_select(s, said), false;
    double *place = place_of(s, &s->spec, s->surface, &from, &to);
    const double before = *place, after = fmin(fmax(before + part * (to - from), from), to);
    *place = after;
    subject_text(s, &b);
    *place = before;
    if (!subject_adopt(s, &b, said)) return false;
    find_surface(s, after);
    name_surface(s, said);
    return true;
}
