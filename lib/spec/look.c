/*
 * look: how a starter shows the values of a grid: as fog, slices, surfaces, or as deviations from
 * the means of levels. The numbers below were chosen by looking at winds, temperatures, humidities
 * and geopotential heights of the atmosphere and at temperatures and salinities of the ocean.
 */
#include "spec/starter.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char *const kinds[] = {
    [SPEC_FOG] = "fog",
    [SPEC_SLICES] = "slices",
    [SPEC_SURFACES] = "surfaces",
    [SPEC_ANOMALY] = "anomaly",
};

bool spec_kind(const char *name, enum spec_kind *kind)
{
    for (size_t i = SPEC_FOG; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(name, kinds[i]) == 0) return *kind = (enum spec_kind)i, true;
    return false;
}

/* ---- bands ---------------------------------------------------------------------------------- */

#define MEAN_DEPTH 3 /* mean optical depth of the rays that cross the grid */
#define MIDDLE .1    /* half of the part of the palette that the transparent middle has */
#define LEAST .01f   /* of the first band: so much above the least value */
#define PALE 2       /* extinction grows as this power of the place in the palette */
#define REACH                                                                                      \
    2 /* a value farther from the middle than this, in distances of the bulk's end,
                      * is an outlier, which does not stretch the palette */

/* Values between two quantiles that differ. From lo to hi, place and extinction are linear. */
struct band {
    float lo, hi;
    double from, to; /* the quantiles */
    double share;    /* of all values */
    double place[2], k[2];
};
struct bands {
    struct band band[2 * SPEC_RANKS];
    int n;
};

/* The values between which places in the palette are linear: the least and the greatest, but not
 * outliers. */
static void palette_range(const struct spec_survey *v, double range[2])
{
    const double low = (double)v->quantile[1], middle = (double)v->quantile[SPEC_RANKS / 2 - 1],
                 high = (double)v->quantile[SPEC_RANKS - 2];
    range[0] = (double)v->quantile[0], range[1] = (double)v->quantile[SPEC_RANKS - 1];
    if (low < middle) range[0] = fmax(range[0], low - REACH * (middle - low));
    if (high > middle) range[1] = fmin(range[1], high + REACH * (high - middle));
}

/* The place of a band is the mean of its rank and of its place between the least and the greatest
 * value: ranks alone would give the jet the colour of the tenth around it, and values alone give
 * all but an outlier one colour. */
static double place_of(double lo, double hi, double rank, const double range[2])
{
    const double linear = ((lo + hi) / 2 - range[0]) / (range[1] - range[0]);
    return (rank + fmax(0, fmin(linear, 1))) / 2;
}

/* Adds a band of one colour. */
static void put_band(struct bands *m, float lo, float hi, double from, double to, double place)
{
    const double k = pow(place, PALE);
    m->band[m->n++] = (struct band){lo, hi, from, to, fabs(to - from), {place, place}, {k, k}};
}

static struct bands bands_of(const struct spec_survey *v)
{
    struct bands m = {.n = 0};
    double range[2];
    palette_range(v, range);
    for (int i = 0; i + 1 < SPEC_RANKS; i++) {
        const float lo = v->quantile[i], hi = v->quantile[i + 1];
        if (!(lo < hi)) continue; /* many equal values: they belong to the bands beside them */
        double rank = (spec_rank[i] + spec_rank[i + 1]) / 2;
        double place = place_of((double)lo, (double)hi, rank, range);
        put_band(&m, lo, hi, spec_rank[i], spec_rank[i + 1], place);
        if (m.n == 1 && v->ground) m.band[0].k[0] = 0;
    }
    return m;
}

/* The least value, which many nodes have, gets no colour. */
static void drop_least(struct bands *m)
{
    if (m->n) m->band[0].lo += LEAST * (m->band[0].hi - m->band[0].lo);
}

/* Bands of one colour on either side of a middle that is transparent. */
static struct bands bands_around(const struct spec_deviations *d)
{
    struct bands m = {.n = 0};
    const double most = fmin((double)d->cut[SPEC_CUTS - 1], REACH * (double)d->cut[SPEC_CUTS - 3]);
    for (int k = 1 - SPEC_CUTS; k < SPEC_CUTS; k++) {
        const int i = abs(k) - 1; /* from the middle outwards */
        const float near = i < 0 ? 0 : d->cut[i], far = i < 0 ? d->cut[0] : d->cut[i + 1];
        const float lo = fmaxf(k < 0 ? -far : k > 0 ? near : -far, d->least);
        const float hi = fminf(k < 0 ? -near : far, d->most);
        if (!(lo < hi)) continue;
        const double linear = fmin(((double)near + (double)far) / 2 / most, 1);
        const double away = ((i + 1.) / (SPEC_CUTS - 1) + linear) / 2;
        const double from = k ? spec_cut[i] : 0, to = k ? spec_cut[i + 1] : spec_cut[0];
        put_band(&m, lo, hi, k < 0 ? to : from, k < 0 ? from : to, .5 + (k < 0 ? -away : away) / 2);
        struct band *b = &m.band[m.n - 1];
        b->k[0] = b->k[1] = k ? pow(away, PALE) : 0;
        if (!k) b->place[0] = .5 - MIDDLE, b->place[1] = .5 + MIDDLE;
    }
    return m;
}

/* Scales extinctions so that a ray with this chord has the mean depth; 0: makes them 0. */
static void set_depth(struct bands *m, double chord, double depth)
{
    double sum = 0, share = 0; /* a sum of 0: all are transparent */
    for (int i = 0; i < m->n; i++) {
        sum += m->band[i].k[1] * m->band[i].share;
        share += m->band[i].share;
    }
    for (int i = 0; i < m->n && sum > 0; i++)
        for (int end = 0; end < 2; end++) m->band[i].k[end] *= depth / chord / (sum / share);
}

/* ---- lines ---------------------------------------------------------------------------------- */

/* Prints an outermost knot, which is a double, so that it encloses the value. */
static void print_outer(char text[32], float v, bool least)
{
    double knot;
    print_float(text, v, 3);
    bool read = parse_real(text, -GRID_MAX, GRID_MAX, &knot);
    if (!read || (least ? knot > (double)v : knot < (double)v)) print_real(text, (double)v, 3);
}

static void put_knot(struct buf *out, const char *s, const struct band *b, int end,
    const char *what, double quantile)
{
    buf_printf(
        out, "map %s %.3g %.3g\t# %s %.3g %%\n", s, b->place[end], b->k[end], what, 100 * quantile);
}

static void put_bands(struct buf *out, const struct bands *m)
{
    char lo[32], hi[32];
    for (int i = 0; i < m->n; i++) {
        const struct band *b = &m->band[i];
        if (i == 0) print_outer(lo, b->lo, true);
        else print_float(lo, b->lo, 3);
        if (i + 1 == m->n) print_outer(hi, b->hi, false);
        else print_float(hi, b->hi, 3);
        put_knot(out, lo, b, 0, "from", b->from);
        put_knot(out, hi, b, 1, "to", b->to);
    }
}

/* All values are equal: a band around them. */
static void put_one_value(struct buf *out, double s, double k)
{
    const double d = fmax(fabs(s) / 1000, 1e-6);
    for (int side = -1; side <= 1; side += 2)
        buf_printf(out, "map %.9g .5 %.4g\n", fmax(-GRID_MAX, fmin(s + side * d, GRID_MAX)), k);
}

/* ---- kinds ---------------------------------------------------------------------------------- */

#define LOW .05    /* the level of a slice is higher, in the grid's height */
#define NORTH .6   /* the place of a slice along y */
#define FLAT_OPACITY .65 /* of a flat field: coasts below it are seen */
#define LAYERED .6 /* of the variance is between levels: a picture of the field shows little else */

/* True if the field has both signs, alike on both sides of 0. */
static bool is_signed(const struct spec_survey *v)
{
    const double low = -(double)v->quantile[1], high = (double)v->quantile[SPEC_RANKS - 3];
    const double middle = (double)v->quantile[SPEC_RANKS / 2 - 1];
    return low > 0 && high > 0 && fmax(low, high) < 2 * fmin(low, high) &&
           fabs(middle) < (low + high) / 8;
}

static void put_palette(struct buf *out, const char *wish, const char *usual)
{
    buf_printf(out, "palette %s\n", wish ? wish : usual);
}

/* False if all deviations are 0. */
static bool put_anomaly(const struct grid *g, const struct spec_survey *v,
    const struct spec_wish *wish, double chord, struct buf *out)
{
    const bool zero = is_signed(v);
    struct spec_deviations d;
    spec_survey_deviations(g, zero, &d);
    struct bands m = bands_around(&d);
    set_depth(&m, chord, g->flat ? 0 : MEAN_DEPTH);
    const bool any = m.n > 0;
    if (any) {
        put_palette(out, wish->palette, "vik");
        if (!zero) {
            if (g->flat) buf_printf(out, "# The mean is subtracted.\n");
            else
                buf_printf(out,
                    "# The mean of each level is subtracted: it has %.3g %% of the variance.\n",
                    100 * v->by_level);
            for (uint32_t k = 0; k < (g->flat ? 1 : g->n[2]); k++) {
                char z[32];
                print_real(z, g->at[2][k], 3);
                if (!isnan(d.mean[k])) buf_printf(out, "profile %s %.9g\n", z, d.mean[k]);
            }
        }
        if (!g->flat)
            buf_printf(out, "# The half of the values that is nearest to 0 is transparent.\n");
        put_bands(out, &m);
    }
    free(d.mean);
    return any;
}

/* The height of the lowest level, above the bottom, that has half as many values as another. */
static double low_level(const struct grid *g)
{
    const size_t layer = (size_t)g->n[0] * g->n[1];
    const double lo = g->at[2][0], hi = g->at[2][g->n[2] - 1];
    size_t *there = xcalloc(g->n[2], sizeof *there), most = 0;
    for (size_t i = 0; i < layer * g->n[2]; i++)
        if (!isnan(g->value[i])) there[i / layer]++;
    for (uint32_t k = 0; k < g->n[2]; k++) most = there[k] > most ? there[k] : most;
    uint32_t k = 0;
    while (k + 1 < g->n[2] && (g->at[2][k] < lo + LOW * (hi - lo) || 2 * there[k] < most)) k++;
    free(there);
    return g->at[2][k];
}

static void put_slices(struct buf *out, const struct grid *g)
{
    if (g->flat) {
        buf_printf(out, "slice z %.15g %g\n", g->at[2][0], FLAT_OPACITY);
        return;
    }
    const double *x = g->at[0], *y = g->at[1];
    if (spec_is_section(g)) {
        buf_printf(out, "slice y %.15g 1\n", (y[0] + y[1]) / 2);
        return;
    }
    buf_printf(out, "slice x %.15g 1\n", (x[0] + x[g->n[0] - 1]) / 2);
    buf_printf(out, "slice y %.15g 1\n", y[0] + NORTH * (y[g->n[1] - 1] - y[0]));
    buf_printf(out, "slice z %.15g 1\n", low_level(g));
}

/* Surfaces at quantiles, which are rounded to digits that keep them apart. */
static void put_surfaces(struct buf *out, const struct bands *m, struct vec3 lamp)
{
    static const double opacity[] = {.25, .4, .9};
    const int of[] = {m->n / 2, m->n * 3 / 4, m->n - 1};
    double least = HUGE_VAL;
    for (int i = of[0]; i < m->n; i++)
        least = fmin(least, (double)m->band[i].hi - (double)m->band[i].lo);
    const double unit = pow(10, floor(log10(least)) - 1);
    buf_printf(out, "light %.4g %.4g %.4g\n", lamp.x, lamp.y, lamp.z);
    for (int i = 0; i < 3; i++) {
        const struct band *b = &m->band[of[i]];
        if (i && of[i] == of[i - 1]) continue;
        buf_printf(out, "iso %.12g %.3g %.3g\t# %.3g %%\n",
            round((double)b->lo / unit) * unit + 0.0, b->place[0], opacity[i], 100 * b->from);
    }
}

static void put_fog(
    struct buf *out, const struct spec_survey *v, struct bands *m, double chord, bool slices)
{
    set_depth(m, chord, slices ? 0 : MEAN_DEPTH);
    buf_printf(out, "# Each tenth of the values has a colour%s%s.\n",
        slices ? "" : " and an extinction",
        v->ground && !slices ? "; the least value, which many nodes have, is transparent" : "");
    put_bands(out, m);
}

void spec_look(const struct grid *g, const struct spec_survey *v, const struct spec_wish *wish,
    const struct spec_box *box, struct buf *out)
{
    struct bands m = bands_of(v);
    enum spec_kind kind = wish->kind;
    if (g->flat && kind != SPEC_ANOMALY) kind = is_signed(v) && !kind ? SPEC_ANOMALY : SPEC_SLICES;
    if (g->flat && v->ground) drop_least(&m);
    if (kind == SPEC_AUTO && spec_is_section(g)) kind = SPEC_SLICES;
    if (kind == SPEC_AUTO) kind = v->by_level > LAYERED || is_signed(v) ? SPEC_ANOMALY : SPEC_FOG;
    if (kind == SPEC_ANOMALY && put_anomaly(g, v, wish, box->chord, out)) {
        if (g->flat) put_slices(out, g);
        return;
    }
    put_palette(out, wish->palette, SPEC_STARTER_PALETTE);
    if (m.n == 0) {
        put_one_value(out, (double)v->quantile[0], g->flat ? 0 : MEAN_DEPTH / box->chord);
        if (g->flat) put_slices(out, g);
        return;
    }
    if (kind == SPEC_SURFACES) put_surfaces(out, &m, box->lamp);
    else put_fog(out, v, &m, box->chord, kind == SPEC_SLICES);
    if (kind == SPEC_SLICES) put_slices(out, g);
}

/* ---- the ground ------------------------------------------------------------------------------ */

static const struct {
    double metres, r, g, b;
} heights[] = {{-9000, .005, .02, .1}, {-4000, .02, .07, .25}, {-200, .1, .25, .45},
    {0, .25, .45, .6}, {0, .05, .18, .05}, {500, .2, .3, .1}, {1500, .35, .25, .12},
    {3000, .3, .2, .15}, {5000, .85, .85, .85}};

/* Blue below 0, green, brown and white above it. A unit other than metres gets the same range. */
static void put_terrain(const struct grid *g, struct buf *out)
{
    struct grid_named z;
    const bool km = grid_title(g->title, 'z', &z) && strcasecmp(z.unit, "km") == 0;
    buf_printf(out, "# the ground, by its height\n");
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++)
        buf_printf(out, "ground %g %g %g %g\n", heights[i].metres / (km ? 1000 : 1), heights[i].r,
            heights[i].g, heights[i].b);
}

void spec_put_ground(const struct grid *g, bool terrain, struct buf *out)
{
    double palette[SPEC_PALETTE_POINTS][3], rgb[3];
    char lo[32], hi[32];
    struct spec_survey v;
    if (terrain) {
        put_terrain(g, out);
        return;
    }
    spec_survey(g->ground, &v);
    struct bands m = bands_of(&v);
    if (v.ground) drop_least(&m);
    if (!v.there || !m.n) return;
    spec_palette("magma", strlen("magma"), palette);
    buf_printf(out, "# the flat field, by its values\nflat %.15g %g\n", g->at[2][0], FLAT_OPACITY);
    for (int i = 0; i < m.n; i++) {
        const struct band *b = &m.band[i];
        spec_palette_at((const double(*)[3])palette, 1 - b->place[0], rgb);
        if (i == 0) print_outer(lo, b->lo, true);
        else print_float(lo, b->lo, 3);
        if (i + 1 == m.n) print_outer(hi, b->hi, false);
        else print_float(hi, b->hi, 3);
        for (int end = 0; end < 2; end++)
            buf_printf(out, "ground %s %.3g %.3g %.3g\n", end ? hi : lo, rgb[0], rgb[1], rgb[2]);
    }
}
