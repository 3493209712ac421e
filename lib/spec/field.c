/*
 * field: the lines of a specification that say what is seen of the field.
 */
#include "spec/spec_int.h"

#include <stdlib.h>

static void push_knot(struct spec_list *l, double value, const double rgb[3], double k)
{
    if (l->n == l->room) {
        l->room = l->n ? 2 * l->n : 16;
        l->knot = xrealloc(l->knot, l->room, sizeof *l->knot);
    }
    l->knot[l->n] = (struct spec_knot){.s = value, .k = k};
    spec_copy(l->knot[l->n++].rgb, rgb);
}

/* Adds a knot for each colour of the palette between the last knot and one of this value, place and
 * extinction, because linear light from one end to the other has other colours. */
static void push_palette(
    const struct spec_reader *r, struct spec_list *l, double value, double place, double k)
{
    const struct spec_knot a = l->knot[l->n - 1];
    const double steps = SPEC_PALETTE_POINTS - 1, way = place - l->place;
    for (int i = 1; i < SPEC_PALETTE_POINTS - 1; i++) {
        int colour = way > 0 ? i : SPEC_PALETTE_POINTS - 1 - i;
        double f = (colour / steps - l->place) / way; /* way 0: no number, or infinite */
        double s = a.s + (value - a.s) * f;
        if (f > 0 && f < 1 && s > l->knot[l->n - 1].s && s < value)
            push_knot(l, s, r->palette[colour], a.k + (k - a.k) * f);
    }
}

bool spec_add_knot(struct spec_reader *r, int list, const double v[5], double place)
{
    static const char *const words[] = {"map", "colour", "ground"};
    struct spec_list *l = &r->list[list];
    const size_t n = l->n;
    if (n && v[0] < l->knot[n - 1].s)
        return spec_fail(
            r, "%s: %g after %g, expected values that ascend", words[list], v[0], l->knot[n - 1].s);
    if (n > 1 && v[0] <= l->knot[n - 2].s)
        return spec_fail(
            r, "%s: %g for the third time, expected a value twice at most", words[list], v[0]);
    if (n && place >= 0 && l->place >= 0) push_palette(r, l, v[0], place, v[4]);
    push_knot(l, v[0], v + 1, v[4]);
    l->place = place;
    return true;
}

bool spec_add_iso(struct spec_reader *r, const double v[5])
{
    struct spec *s = r->s;
    if (s->n_isos == r->room_isos) {
        r->room_isos = s->n_isos ? 2 * s->n_isos : 16;
        s->iso = xrealloc(s->iso, r->room_isos, sizeof *s->iso);
    }
    s->iso[s->n_isos] = (struct spec_iso){.s = v[0], .opacity = v[4]};
    spec_copy(s->iso[s->n_isos++].rgb, v + 1);
    return true;
}

bool spec_add_slice(struct spec_reader *r, int axis, const double v[2])
{
    struct spec *s = r->s;
    if (s->n_slices == r->room_slices) {
        r->room_slices = s->n_slices ? 2 * s->n_slices : 16;
        s->slice = xrealloc(s->slice, r->room_slices, sizeof *s->slice);
    }
    s->slice[s->n_slices++] = (struct spec_slice){axis, v[0], v[1]};
    return true;
}

bool spec_take_clip(struct spec_reader *r, const double v[6])
{
    for (int a = 0; a < 3; a++) {
        if (!(v[a] < v[a + 3]))
            return spec_fail(r, "clip: %c from %g to %g, expected numbers that ascend", "xyz"[a],
                v[a], v[a + 3]);
        r->s->clip[a][0] = v[a];
        r->s->clip[a][1] = v[a + 3];
    }
    return r->s->clipped = true;
}

static void take_lists(struct spec_reader *r)
{
    struct spec *s = r->s;
    struct spec_knot **const knot[] = {&s->knot, &s->colour, &s->ground};
    size_t *const n[] = {&s->n_knots, &s->n_colours, &s->n_grounds};
    for (int i = 0; i < SPEC_LISTS; i++) {
        *knot[i] = r->list[i].knot;
        *n[i] = r->list[i].n;
    }
}

static int by_value(const void *a, const void *b)
{
    double x = ((const struct spec_iso *)a)->s, y = ((const struct spec_iso *)b)->s;
    return (x > y) - (x < y);
}

static int by_place(const void *a, const void *b)
{
    const struct spec_slice *x = a, *y = b;
    if (x->axis != y->axis) return x->axis - y->axis;
    return (x->at > y->at) - (x->at < y->at);
}

static bool check_slices(struct spec_reader *r)
{
    struct spec *s = r->s;
    if (!s->n_slices) return true;
    if (!s->n_knots) return spec_fail(r, "slice: no map, expected map lines, which colour it");
    qsort(s->slice, s->n_slices, sizeof *s->slice, by_place);
    for (size_t i = 1; i < s->n_slices; i++)
        if (by_place(&s->slice[i], &s->slice[i - 1]) == 0)
            return spec_fail(r, "slice: %c %g twice, expected a place once",
                "xyz"[s->slice[i].axis], s -> slice[i].at);
    return true;
}

bool spec_check_field(struct spec_reader *r)
{
    struct spec *s = r->s;
    take_lists(r);
    if (!s->n_knots && !s->n_isos && !s->n_grounds)
        return spec_fail(r, "nothing is visible, expected map, iso or ground lines");
    if (!s->n_knots && s->n_colours)
        return spec_fail(r, "colour: no map, expected map lines, whose extinction it colours");
    if (s->flat && s->n_grounds < 2)
        return spec_fail(r, "flat: %zu ground lines, expected two or more, which colour it",
            s->n_grounds);
    if (s->n_knots == 1) return spec_fail(r, "one map line, expected two or more");
    if (s->n_isos) qsort(s->iso, s->n_isos, sizeof *s->iso, by_value);
    for (size_t i = 1; i < s->n_isos; i++)
        if (s->iso[i].s <= s->iso[i - 1].s)
            return spec_fail(r, "iso: %g twice, expected a value once", s->iso[i].s);
    return check_slices(r);
}
