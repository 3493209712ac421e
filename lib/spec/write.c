/* write: a specification as text, which reads back with the same numbers. */
#include "spec/spec_int.h"

static void put(struct buf *out, const char *word, const double *v, int n)
{
    char text[32];
    buf_printf(out, "%s", word);
    for (int i = 0; i < n; i++) {
        print_real(text, v[i], 6);
        buf_printf(out, " %s", text);
    }
}

static void put_line(struct buf *out, const char *word, const double *v, int n)
{
    put(out, word, v, n);
    buf_printf(out, "\n");
}

/* With colours; extinction: it has one. */
static void put_knots(
    struct buf *out, const char *word, const struct spec_knot *k, size_t n, bool extinction)
{
    for (size_t i = 0; i < n; i++, k++) {
        const double v[5] = {k->s, k->rgb[0], k->rgb[1], k->rgb[2], k->k};
        put_line(out, word, v, extinction ? 5 : 4);
    }
}

static void put_surfaces(struct buf *out, const struct spec *s)
{
    for (size_t i = 0; i < s->n_isos; i++) {
        const struct spec_iso *p = &s->iso[i];
        put_line(out, "iso", (double[]){p->s, p->rgb[0], p->rgb[1], p->rgb[2], p->opacity}, 5);
    }
    for (size_t i = 0; i < s->n_slices; i++) {
        const struct spec_slice *p = &s->slice[i];
        char word[] = "slice x";
        word[6] = "xyz"[p->axis];
        put_line(out, word, (double[]){p->at, p->opacity}, 2);
    }
}

void spec_write(const struct spec *s, struct buf *out)
{
    put_line(out, "from", s->from, 3);
    put_line(out, "at", s->at, 3);
    put_line(out, "up", s->up, 3);
    put_line(out, "angle", &s->angle, 1);
    buf_printf(out, "resolution %u %u\n", s->w, s->h);
    put_line(out, "scale", s->scale, 3);
    if (s->lit) put_line(out, "light", s->light, 3);
    if (s->attenuation > 0) put_line(out, "attenuation", &s->attenuation, 1);
    if (s->opacity_limit != SPEC_LIMIT) put_line(out, "limit", &s->opacity_limit, 1);
    if (s->backed) put_line(out, "background", s->background, 3);
    if (s->clipped) {
        const double v[] = {s->clip[0][0], s->clip[1][0], s->clip[2][0], s->clip[0][1],
            s->clip[1][1], s->clip[2][1]};
        put_line(out, "clip", v, 6);
    }
    if (s->flat) put_line(out, "flat", (double[]){s->flat_at, s->flat_opacity}, 2);
    for (size_t i = 0; i < s->n_profile; i++)
        put_line(out, "profile", (double[]){s->profile[i].z, s->profile[i].s}, 2);
    put_knots(out, "map", s->knot, s->n_knots, true);
    put_knots(out, "colour", s->colour, s->n_colours, false);
    put_knots(out, "ground", s->ground, s->n_grounds, false);
    put_surfaces(out, s);
}

/* ---- other colours --------------------------------------------------------------------------- */

#define ALIKE 1e-9 /* of colours that differ by rounding only */

/* The place of the colour in the palette; negative: it is not there. */
static double place_of(const double rgb[3], const double palette[SPEC_PALETTE_POINTS][3])
{
    for (int i = 0; i < SPEC_PALETTE_POINTS - 1; i++) {
        const double *a = palette[i], *b = palette[i + 1];
        double along = 0, length = 0, off = 0;
        for (int c = 0; c < 3; c++) {
            along += (rgb[c] - a[c]) * (b[c] - a[c]);
            length += (b[c] - a[c]) * (b[c] - a[c]);
        }
        const double f = along / length;
        for (int c = 0; c < 3; c++) off = fmax(off, fabs(a[c] + (b[c] - a[c]) * f - rgb[c]));
        if (f > -ALIKE && f < 1 + ALIKE && off < ALIKE)
            return fmin(fmax((i + f) / (SPEC_PALETTE_POINTS - 1), 0), 1);
    }
    return -1;
}

/* The palette that all these colours are of. */
static bool palette_of(const struct spec_knot *k, size_t n, double palette[SPEC_PALETTE_POINTS][3])
{
    for (int p = 0; p < SPEC_N_PALETTES; p++) {
        size_t i = 0;
        spec_palette(spec_palettes[p], strlen(spec_palettes[p]), palette);
        while (i < n && place_of(k[i].rgb, (const double(*)[3])palette) >= 0) i++;
        if (i == n) return true;
    }
    return false;
}

/* Lines with places in a palette: those that the colours had in theirs, or else by value. */
static void put_places(
    struct buf *out, const char *word, const struct spec_knot *k, size_t n, bool extinction)
{
    double old[SPEC_PALETTE_POINTS][3];
    const bool known = palette_of(k, n, old);
    const double range = n ? k[n - 1].s - k[0].s : 0;
    for (size_t i = 0; i < n; i++) {
        const double by_value = range > 0 ? (k[i].s - k[0].s) / range : .5;
        const double place = known ? place_of(k[i].rgb, (const double(*)[3])old) : by_value;
        put_line(out, word, (double[]){k[i].s, place, k[i].k}, extinction ? 3 : 2);
    }
}

void spec_write_in(const struct spec *s, const char *palette, struct buf *out)
{
    struct spec rest = *s;
    const bool second = s->n_colours > 0; /* gives the colours of the map */
    if (second) rest.n_colours = 0;
    else rest.n_knots = 0;
    rest.n_grounds = 0;
    buf_printf(out, "palette %s\n", palette);
    spec_write(&rest, out);
    if (second) put_places(out, "colour", s->colour, s->n_colours, false);
    else put_places(out, "map", s->knot, s->n_knots, true);
    put_places(out, "ground", s->ground, s->n_grounds, false);
}
