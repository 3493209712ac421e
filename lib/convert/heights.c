/*
 * heights: heights of pressures, in air and sea, and the values of columns at common heights.
 *
 * "U.S. Standard Atmosphere, 1976", NOAA, NASA, USAF, Washington 1976, is that of ICAO up to 32 km.
 * Heights are geopotential metres. Above its last layer, 84.852 km, that layer's lapse rate goes
 * on. Depths in the sea: P.M. Saunders and N.P. Fofonoff, Deep-Sea Research 23, 1976, as in N.P.
 * Fofonoff and R.C. Millard, "Algorithms for computation of fundamental properties of seawater",
 * UNESCO Technical Papers in Marine Science 44, 1983, of sea water at 0 degrees C and salinity 35.
 */
#include "convert/convert.h"
#include "units/units.h"

#include <stdlib.h>

#define GRAVITY 9.80665 /* m/s2 */
#define GAS 287.05287   /* J/(kg K), of dry air */

double convert_standard_height(double pressure_pa)
{
    static const struct {
        double base_m, lapse_k_m;
    } layers[] = {{0, -.0065}, {11000, 0}, {20000, .001}, {32000, .0028}, {47000, 0},
        {51000, -.0028}, {71000, -.002}};
    const int last = sizeof layers / sizeof *layers - 1;
    double p = 101325, t = 288.15; /* at the base of the layer */
    for (int i = 0;; i++) {
        double lapse = layers[i].lapse_k_m, base = layers[i].base_m;
        double rise = lapse == 0 ? GAS * t / GRAVITY * log(p / pressure_pa)
                                 : t / lapse * (pow(pressure_pa / p, -GAS * lapse / GRAVITY) - 1);
        if (i == last || base + rise <= layers[i + 1].base_m) return base + rise;
        double thick = layers[i + 1].base_m - base, above = t + lapse * thick;
        p *= lapse == 0 ? exp(-GRAVITY * thick / GAS / t) : pow(above / t, -GRAVITY / GAS / lapse);
        t = above;
    }
}

void convert_pressures(struct grid *g)
{
    const size_t n = grid_node(g, 0, 0, g->n[2]);
    for (size_t i = 0; i < n; i++) {
        double p = (double)g->value[i];
        g->value[i] = p > 0 ? (float)convert_standard_height(p) : (float)NAN;
    }
}

double convert_sea_depth(double p, double latitude_deg)
{
    const double sine = sin(latitude_deg * 3.14159265358979323846 / 180), x = sine * sine;
    const double gravity = 9.780318 * (1 + (5.2788e-3 + 2.36e-5 * x) * x) + 1.092e-6 * p;
    return (((-1.82e-15 * p + 2.279e-10) * p - 2.2512e-5) * p + 9.72659) * p / gravity;
}

void convert_sea_pressures(struct grid *g)
{
    float *v = g->value;
    for (uint32_t k = 0; k < g->n[2]; k++)
        for (uint32_t j = 0; j < g->n[1]; j++)
            for (uint32_t i = 0; i < g->n[0]; i++, v++)
                *v = (float)(0 - convert_sea_depth((double)*v / 1e4, g->at[1][j]));
}

enum convert_levels convert_levels_of(const char *unit)
{
    struct units_linear l;
    char err[ERR_BYTES];
    return units_linear(unit, "m", &l, err) ? CONVERT_LEVELS_HEIGHT : CONVERT_LEVELS_OTHER;
}

/* ---- planes --------------------------------------------------------------------------------- */

static int by_height(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

bool convert_planes(const struct grid *height, double *plane, char err[ERR_BYTES])
{
    const size_t layer = (size_t)height->n[0] * height->n[1];
    float *sorted = xmalloc(layer, sizeof *sorted);
    bool good = true;
    for (uint32_t k = 0; good && k < height->n[2]; k++) {
        size_t n = 0;
        for (size_t i = 0; i < layer; i++) {
            float h = height->value[k * layer + i];
            if (!isnan(h)) sorted[n++] = h;
        }
        qsort(sorted, n, sizeof *sorted, by_height);
        plane[k] = n ? (double)sorted[n / 4] : 0;
        const double z = height->at[2] ? height->at[2][k] : (double)k;
        if (!n) good = err_set(err, "all heights of the level %g are missing, expected some", z);
        else if (k && !(plane[k] - plane[k - 1] >= GRID_STEP_MIN))
            good = err_set(err, "the height of the level %g is %g after %g, expected it to ascend",
                z, plane[k], plane[k - 1]);
    }
    free(sorted);
    return good;
}

/* A column: the nodes whose heights are there and ascend. */
struct column {
    double *h, *v;
    uint32_t n;
};

/* The value at a height. Half a layer below the lowest node and above the highest one, it is that
 * of the node; beyond, it is missing. */
static double column_at(const struct column *c, double height)
{
    const double *h = c->h;
    if (c->n < 2) return (double)NAN;
    uint32_t top = c->n - 1, i = 1;
    if (height < h[0]) return h[0] - height <= (h[1] - h[0]) / 2 ? c->v[0] : (double)NAN;
    if (height > h[top])
        return height - h[top] <= (h[top] - h[top - 1]) / 2 ? c->v[top] : (double)NAN;
    while (i < top && h[i] < height) i++;
    double f = (height - h[i - 1]) / (h[i] - h[i - 1]);
    if (f == 0 || f == 1) return c->v[f == 0 ? i - 1 : i]; /* the other one may be missing */
    return c->v[i - 1] + (c->v[i] - c->v[i - 1]) * f;
}

void convert_to_planes(struct grid *g, const struct grid *height, const double *plane)
{
    const size_t layer = (size_t)g->n[0] * g->n[1];
    struct column c = {xmalloc(g->n[2], sizeof *c.h), xmalloc(g->n[2], sizeof *c.v), 0};
    for (size_t i = 0; i < layer; i++) {
        c.n = 0;
        for (size_t k = 0; k < g->n[2]; k++) {
            double h = (double)height->value[k * layer + i];
            if (!(c.n ? h > c.h[c.n - 1] : !isnan(h))) continue;
            c.h[c.n] = h;
            c.v[c.n++] = (double)g->value[k * layer + i];
        }
        for (size_t k = 0; k < g->n[2]; k++)
            g->value[k * layer + i] = (float)column_at(&c, plane[k]);
    }
    free(c.h);
    free(c.v);
}
