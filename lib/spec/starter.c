/*
 * starter: a specification for a grid that shows all of it, with a colour for each tenth of its
 * values. The numbers below were chosen by looking at winds, temperatures and humidities of the
 * atmosphere and at temperatures of the ocean.
 */
#include "geometry/geometry.h"
#include "spec/spec.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- the values ----------------------------------------------------------------------------- */

#define SAMPLES_MAX (1U << 20) /* values that are sorted; more hardly move a quantile */

/* Ends of bands. The last tenth is cut: jets and cores are there. */
static const double ranks[] = {0, .1, .2, .3, .4, .5, .6, .7, .8, .9, .97, 1};
#define RANKS ((int)(sizeof ranks / sizeof *ranks))

#define GROUND .1 /* part of the values from which the least one counts as empty space */

struct survey {
    float quantile[RANKS]; /* the first and the last are the least and the greatest value */
    size_t there, nodes;   /* values that are not missing */
    bool ground;           /* many values are the least one: quantiles are those of the others */
    double part;           /* of all nodes: those in the quantiles */
};

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void quantiles(struct survey *v, const struct grid *g)
{
    const bool all = v->nodes <= SAMPLES_MAX;
    const size_t most = all ? v->nodes : SAMPLES_MAX;
    float *sample = xmalloc(most, sizeof *sample);
    size_t n = 0, ground = 0;
    for (size_t i = 0; i < most; i++) {
        float value = g->value[all ? i : (size_t)(rng_u64(0, i) % v->nodes)];
        if (!isnan(value)) sample[n++] = value;
    }
    qsort(sample, n, sizeof *sample, by_value);
    while (ground < n && sample[ground] <= v->quantile[0]) ground++;
    v->ground = (double)ground > GROUND * (double)n && ground < n;
    if (!v->ground) ground = 0;
    v->part = (double)(n - ground + 1) / (double)(most + 1);
    for (int i = 1; i < RANKS - 1; i++)
        v->quantile[i] =
            n ? sample[ground + (size_t)(ranks[i] * (double)(n - 1 - ground))] : v->quantile[0];
    free(sample);
}

static struct survey survey(const struct grid *g)
{
    struct survey v = {.nodes = grid_node(g, 0, 0, g->n[2])};
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    for (size_t i = 0; i < v.nodes; i++) {
        if (isnan(g->value[i])) continue;
        v.there++;
        lo = fminf(lo, g->value[i]);
        hi = fmaxf(hi, g->value[i]);
    }
    v.quantile[0] = lo;
    v.quantile[RANKS - 1] = hi;
    if (v.there) quantiles(&v, g);
    return v;
}

/* True if a cell has all its corners: the others are transparent. */
static bool has_cell(const struct grid *g)
{
    for (uint32_t k = 0; k + 1 < g->n[2]; k++)
        for (uint32_t j = 0; j + 1 < g->n[1]; j++)
            for (uint32_t i = 0, whole = 0; i < g->n[0]; i++) {
                const float *at = g->value + grid_node(g, i, j, k);
                size_t row = g->n[0], layer = row * g->n[1];
                whole = isnan(at[0] + at[row] + at[layer] + at[row + layer]) ? 0 : whole + 1;
                if (whole == 2) return true;
            }
    return false;
}

/* ---- the colour map ------------------------------------------------------------------------- */

#define MEAN_DEPTH 3 /* mean optical depth of the rays that cross the grid */
#define PALE 2       /* extinction grows as this power of the place in the palette */

/* Values between two quantiles that differ: one colour and one extinction. */
struct band {
    float lo, hi;
    double from, to; /* ranks */
    double place, k;
};
struct map {
    struct band band[RANKS];
    int n;
};

/* The place of a band is the mean of its rank and of its place between the least and the greatest
 * value: ranks alone would give the jet the colour of the tenth around it, and values alone give
 * all but an outlier one colour. */
static struct map map_of(const struct survey *v)
{
    const double least = (double)v->quantile[0], range = (double)v->quantile[RANKS - 1] - least;
    struct map m = {.n = 0};
    for (int i = 0; i + 1 < RANKS; i++) {
        const float lo = v->quantile[i], hi = v->quantile[i + 1];
        if (!(lo < hi)) continue; /* many equal values: they belong to the bands beside them */
        double middle = ((double)lo + (double)hi) / 2, rank = (ranks[i] + ranks[i + 1]) / 2;
        double place = (rank + (middle - least) / range) / 2;
        m.band[m.n++] = (struct band){lo, hi, ranks[i], ranks[i + 1], place, pow(place, PALE)};
    }
    return m;
}

/* Scales extinctions so that a ray with this chord has the mean depth. */
static void set_depth(struct map *m, double chord)
{
    double sum = 0, share = 0;
    for (int i = 0; i < m->n; i++) {
        sum += m->band[i].k * (m->band[i].to - m->band[i].from);
        share += m->band[i].to - m->band[i].from;
    }
    for (int i = 0; i < m->n; i++) m->band[i].k *= MEAN_DEPTH / chord / (sum / share);
}

/* Prints an outermost knot, which is a double, so that it encloses the value. */
static void print_outer(char text[32], float v, bool least)
{
    double knot;
    print_float(text, v, 3);
    bool read = parse_real(text, -GRID_MAX, GRID_MAX, &knot);
    if (!read || (least ? knot > (double)v : knot < (double)v)) print_real(text, (double)v, 3);
}

static void put_map(struct buf *out, const struct survey *v, const struct map *m, double chord)
{
    char lo[32], hi[32];
    if (m->n == 0) { /* one value: a band around it */
        double s = (double)v->quantile[0], d = fmax(fabs(s) / 1000, 1e-6);
        for (int side = -1; side <= 1; side += 2)
            buf_printf(out, "map %.9g .5 %.4g\n", fmax(-GRID_MAX, fmin(s + side * d, GRID_MAX)),
                MEAN_DEPTH / chord);
    }
    for (int i = 0; i < m->n; i++) {
        const struct band *b = &m->band[i];
        if (i == 0) print_outer(lo, b->lo, true);
        else print_float(lo, b->lo, 3);
        if (i + 1 == m->n) print_outer(hi, b->hi, false);
        else print_float(hi, b->hi, 3);
        double k = i == 0 && v->ground ? 0 : b->k;
        buf_printf(out, "map %s %.3g %.3g\t# from %.3g %%\n", lo, b->place, k, 100 * b->from);
        buf_printf(out, "map %s %.3g %.3g\t# to %.3g %%\n", hi, b->place, b->k, 100 * b->to);
    }
}

/* ---- the view ------------------------------------------------------------------------------- */

#define HEIGHT .25 /* least height of the box, in its longest side */
#define WIDTH .125 /* least width or depth */
#define TALL 4     /* greatest height */
#define ANGLE 30   /* degrees */
#define FILL .9    /* part of the frame that the box fills */
#define TURNS 50   /* of a fit; each brings the box to a part of the last error */

struct frame {
    double scale[3];
    struct vec3 lo, hi; /* corners of the box, scaled */
    struct vec3 from, at;
    double step; /* to which places are rounded: a thousandth of the frame's width, or less */
};

/* Metres in a unit of length; 0: no length. A degree is one of latitude. */
static double metres(const char *unit)
{
    if (strncasecmp(unit, "degree", 6) == 0) return 111195;
    if (strcasecmp(unit, "km") == 0) return 1000;
    return strcasecmp(unit, "m") == 0 || strncasecmp(unit, "meter", 5) == 0 ||
                   strncasecmp(unit, "metre", 5) == 0
               ? 1
               : 0;
}

/* As a specification has it. */
static double six_digits(double v)
{
    char text[32];
    snprintf(text, sizeof text, "%.6g", v);
    parse_real(text, -HUGE_VAL, HUGE_VAL, &v);
    return v;
}

/* False if no scale that a specification may have is large enough. */
static bool set_scale(const struct grid *g, struct frame *f, const struct grid_named unit[3])
{
    double e[3];
    for (int a = 0; a < 3; a++) e[a] = g->at[a][g->n[a] - 1] - g->at[a][0];
    const double longest = fmax(e[0], e[1]);
    const double base = longest > 1e9 ? 1e-9 : longest < 1e-9 ? 1e9 : 1;
    for (int a = 0; a < 3; a++) {
        double least = a == 2 ? HEIGHT : WIDTH, fitting = 1;
        bool same = a != 2 || strcmp(unit[0].unit, unit[2].unit) == 0;
        if (e[a] < least * longest || !same) fitting = least * longest / e[a];
        else if (e[a] > TALL * longest) fitting = TALL * longest / e[a];
        f->scale[a] = six_digits(fmax(base * fmin(fitting, base > 1 ? 1 : 1e9), 1e-9));
        if (e[a] * f->scale[a] < least / 2 * longest * base) return false;
    }
    f->lo = v3(g->at[0][0] * f->scale[0], g->at[1][0] * f->scale[1], g->at[2][0] * f->scale[2]);
    f->hi = v3_add(f->lo, v3(e[0] * f->scale[0], e[1] * f->scale[1], e[2] * f->scale[2]));
    return true;
}

/* The smallest rectangle around the box in the frame: -1 and 1 are the frame's edges. */
static void outline(const struct frame *f, const struct camera *c, double lo[2], double hi[2])
{
    const double unit = v3_dot(c->up, c->up), aspect = (double)c->w / c->h;
    for (int i = 0; i < 2; i++) lo[i] = HUGE_VAL, hi[i] = -HUGE_VAL;
    for (int k = 0; k < 8; k++) {
        struct vec3 p =
            v3(k & 1 ? f->hi.x : f->lo.x, k & 2 ? f->hi.y : f->lo.y, k & 4 ? f->hi.z : f->lo.z);
        p = v3_sub(p, f->from);
        double depth = v3_dot(p, c->forward) * unit;
        double at[2] = {v3_dot(p, c->right) / depth / aspect, v3_dot(p, c->up) / depth};
        for (int i = 0; i < 2; i++) lo[i] = fmin(lo[i], at[i]), hi[i] = fmax(hi[i], at[i]);
    }
}

/* Finds the eye from which the box fills the frame. */
static void set_view(struct frame *f, uint32_t w, uint32_t h)
{
    const struct vec3 towards =
        v3_unit(v3(-.35, -1, .9)); /* the eye: south, a little west, above */
    const double size = v3_len(v3_sub(f->hi, f->lo));
    double distance = 2 * size, lo[2], hi[2];
    f->at = v3_scale(v3_add(f->lo, f->hi), .5);
    for (int turn = 0; turn < TURNS; turn++) {
        f->from = v3_mad(f->at, towards, distance);
        struct camera c = camera_new(f->from, f->at, v3(0, 0, 1), ANGLE);
        c.w = w, c.h = h;
        outline(f, &c, lo, hi);
        f->at = v3_mad(f->at, c.right, distance * (lo[0] + hi[0]) / 2 * w / h);
        f->at = v3_mad(f->at, c.up, distance * (lo[1] + hi[1]) / 2);
        distance = fmax(distance * fmax(hi[0] - lo[0], hi[1] - lo[1]) / 2 / FILL, size);
    }
    f->from = v3_mad(f->at, towards, distance);
    f->step = pow(10, floor(log10(distance * fmin(1, (double)w / h))) - 3);
}

static void put_place(struct buf *out, const char *word, struct vec3 p, double step)
{
    buf_printf(out, "%s %.15g %.15g %.15g\n", word, round(p.x / step) * step,
        round(p.y / step) * step, round(p.z / step) * step);
}

/* ---- comments ------------------------------------------------------------------------------- */

/* Text of a file becomes a comment: it stays on its line. */
static void put_words(struct buf *out, const char *text)
{
    for (; *text; text++)
        buf_printf(out, "%c", (unsigned char)*text < ' ' || *text == 0x7f ? '?' : *text);
}

static void put_about(
    struct buf *out, const struct grid *g, const struct survey *v, const struct grid_named unit[3])
{
    struct grid_named scalar;
    bool known = grid_title(g->title, 0, &scalar);
    char lo[32], hi[32];
    buf_printf(out, "# ");
    put_words(out, known ? scalar.name : g->name);
    print_float(lo, v->quantile[0], 3), print_float(hi, v->quantile[RANKS - 1], 3);
    buf_printf(out, ": %s to %s ", lo, hi);
    if (known) put_words(out, scalar.unit);
    buf_printf(out, " at %u x %u x %u nodes", g->n[0], g->n[1], g->n[2]);
    if (v->there < v->nodes)
        buf_printf(out, ", %.3g %% missing", 100 - 100 * ((double)v->there / (double)v->nodes));
    for (int a = 0; a < 3; a++) {
        double from = g->at[a][0], to = g->at[a][g->n[a] - 1];
        bool down = unit[a].down;
        buf_printf(
            out, "\n# %c: %.6g to %.6g ", "xyz"[a], down ? 0 - from : from, down ? 0 - to : to);
        put_words(out, unit[a].unit);
        if (down) buf_printf(out, ", negated in the grid");
    }
    buf_printf(out, "\n");
}

/* Says how z is stretched. */
static void put_stretch(struct buf *out, const struct frame *f, const struct grid_named unit[3])
{
    const double ratio = f->scale[2] / f->scale[0];
    const double x = metres(unit[0].unit), z = metres(unit[2].unit);
    bool none = !unit[0].unit[0] && !unit[2].unit[0];
    if ((x > 0 && z > 0) || none)
        buf_printf(out, "# vertical exaggeration: %.3g\n", ratio * (none ? 1 : x / z));
    else {
        buf_printf(out, "# as high as 1 ");
        put_words(out, unit[0].unit[0] ? unit[0].unit : "x");
        buf_printf(out, " is wide: %.3g ", 1 / ratio);
        put_words(out, unit[2].unit[0] ? unit[2].unit : "z");
        buf_printf(out, "\n");
    }
}

/* ---- computed tomography --------------------------------------------------------------------- */

/* In Hounsfield units (G. N. Hounsfield, "Computerized transverse axial scanning", British Journal
 * of Radiology, 1973) air is -1000 and water 0. Air is not seen, tissue is haze, and bone, which
 * begins near 300, has a surface. */
static const struct {
    int hu;
    double r, g, b, depth; /* depth: optical, of the mean chord */
    const char *what;
} tissues[] = {{-300, .8, .45, .35, 0, "air ends"}, {-50, .85, .5, .4, .4, "fat"},
    {100, .75, .2, .15, .8, "soft tissue"}, {300, 1, .95, .85, 4, "bone begins"},
    {3000, 1, 1, .95, 40, "metal"}};

static bool is_tomogram(const struct grid *g)
{
    struct grid_named scalar;
    return grid_title(g->title, 0, &scalar) && strcasecmp(scalar.unit, "HU") == 0;
}

static void put_tissues(struct buf *out, const struct frame *f, double chord)
{
    const double size = v3_len(v3_sub(f->hi, f->lo));
    buf_printf(
        out, "# Hounsfield units: air is transparent, tissue is haze, bone has a surface.\n");
    put_place(out, "light", v3_add(f->from, v3(0, 0, size)), f->step);
    buf_printf(out, "iso 300 1 0.95 0.85 1\n");
    for (size_t i = 0; i < sizeof tissues / sizeof *tissues; i++)
        buf_printf(out, "map %d %g %g %g %.3g\t# %s\n", tissues[i].hu, tissues[i].r, tissues[i].g,
            tissues[i].b, tissues[i].depth / chord, tissues[i].what);
}

bool spec_starter(const struct grid *g, const char *palette, uint32_t w, uint32_t h,
    struct buf *out, char err[ERR_BYTES])
{
    struct grid_named unit[3];
    struct frame f;
    if (g->brick.is) return err_set(err, "is a brick, expected a whole grid");
    const struct survey v = survey(g);
    if (!v.there) return err_set(err, "all values are missing, expected some that are not");
    if (!has_cell(g))
        return err_set(err, "each cell has a missing corner, expected one that has none");
    for (int a = 0; a < 3; a++)
        if (!grid_title(g->title, "xyz"[a], &unit[a])) unit[a] = (struct grid_named){.down = false};
    if (!set_scale(g, &f, unit))
        return err_set(err, "an axis is 1e9 times as long as another, expected lengths closer");
    set_view(&f, w, h);
    const struct vec3 e = v3_sub(f.hi, f.lo);
    /* The mean chord of a convex body is 4 volume / surface (A. Cauchy, 1841). Where much is empty,
     * it is that of a body with the volume of the rest. */
    const double chord = cbrt(v.part) * 2 * e.x * e.y * e.z / (e.x * e.y + e.y * e.z + e.z * e.x);
    struct map m = map_of(&v);
    set_depth(&m, chord);

    put_about(out, g, &v, unit);
    put_place(out, "from", f.from, f.step);
    put_place(out, "at", f.at, f.step);
    buf_printf(out, "up 0 0 1\nangle %d\nresolution %u %u\n", ANGLE, w, h);
    put_stretch(out, &f, unit);
    buf_printf(out, "scale %.6g %.6g %.6g\n", f.scale[0], f.scale[1], f.scale[2]);
    buf_printf(out, "# Without this line the picture is transparent, for a map: backdrop(1)\n");
    buf_printf(out, "background .02 .02 .025\n");
    if (is_tomogram(g)) return put_tissues(out, &f, chord), true;
    buf_printf(out, "palette %s\n", palette);
    buf_printf(out, "# Each tenth of the values has a colour and an extinction%s.\n",
        v.ground ? "; the least value, which many nodes have, is transparent" : "");
    put_map(out, &v, &m, chord);
    return true;
}
