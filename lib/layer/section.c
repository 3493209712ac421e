/* section: the field above a line between two places. */
#include "layer/layer.h"

#include <stdlib.h>
#include <string.h>

#define EARTH_KM 6371.0088 /* the mean radius, IUGG 1980 */
#define THICK .02          /* of the length: between the two equal rows of a section */
#define RAD (3.14159265358979323846 / 180)

static void unit_vector(struct layer_point p, double v[3])
{
    v[0] = cos(p.y * RAD) * cos(p.x * RAD);
    v[1] = cos(p.y * RAD) * sin(p.x * RAD);
    v[2] = sin(p.y * RAD);
}

/* The angle between two vectors, which need not be unit vectors. */
static double angle_of(const double a[3], const double b[3])
{
    const double c[] = {
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    return atan2(
        sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

double layer_length(struct layer_point a, struct layer_point b, bool globe)
{
    double u[3], v[3];
    if (!globe) return hypot(b.x - a.x, b.y - a.y);
    unit_vector(a, u);
    unit_vector(b, v);
    return EARTH_KM * angle_of(u, v);
}

/* The point at a part f of the way, on the great circle if they are on the globe. */
static struct layer_point between(struct layer_point a, struct layer_point b, bool globe, double f)
{
    double u[3], v[3], w[3];
    if (!globe) return (struct layer_point){a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
    unit_vector(a, u);
    unit_vector(b, v);
    const double all = angle_of(u, v), p = sin((1 - f) * all), q = sin(f * all);
    for (int i = 0; i < 3; i++) w[i] = p * u[i] + q * v[i];
    return (struct layer_point){atan2(w[1], w[0]) / RAD, atan2(w[2], hypot(w[0], w[1])) / RAD};
}

/* Puts a place into the grid's coordinates, with a longitude moved by whole circles to the first
 * one that is not west of the grid. One that is not on the plane becomes NaN. */
static void locate(const struct grid *g, const struct layer_on *on, struct layer_point *p)
{
    const double slack = 1e-9, west = g->at[0][0];
    struct plane_at at = {p->x, p->y};
    if (on->plane && !plane_forward(on->plane, (struct plane_at){p->x, p->y}, &at))
        at.x = at.y = (double)NAN;
    *p = (struct layer_point){at.x, at.y};
    const double x = grid_within(p->x, west, g->at[0][g->n[0] - 1]);
    if (on->circles && !(x >= west && x <= g->at[0][g->n[0] - 1]))
        p->x += 360 * ceil((west - slack - p->x) / 360);
    for (int a = 0; a < 2; a++) { /* rounding leaves no end of a grid */
        double *v = a ? &p->y : &p->x, lo = g->at[a][0], hi = g->at[a][g->n[a] - 1];
        *v = grid_within(*v, lo, hi);
        if (fabs(*v - lo) < slack) *v = lo;
        if (fabs(*v - hi) < slack) *v = hi;
    }
}

bool layer_inside(const struct grid *g, struct layer_point p, const struct layer_on *on)
{
    locate(g, on, &p);
    return p.x >= g->at[0][0] && p.x <= g->at[0][g->n[0] - 1] && p.y >= g->at[1][0] &&
           p.y <= g->at[1][g->n[1] - 1];
}

/* The first part of the title, axes of the section, and z and t as they were; no projection, which
 * is not one of the section. */
static void set_title(const struct grid *g, const char *unit, struct grid *out)
{
    const char *z = strstr(g->title, "; z ");
    const size_t n = strcspn(g->title, ";");
    struct grid_named scalar;
    const bool known = grid_title(g->title, 0, &scalar);
    const char *proj = z ? strstr(z, "; proj ") : NULL;
    snprintf(out->title, sizeof out->title, "%.*s; x distance [%s]; y across [%s]%.*s",
        (int)(known ? n : 0), g->title, unit, unit, (int)(proj ? proj - z : GRID_TITLE),
        z ? z : "");
    snprintf(out->name, sizeof out->name, "%s", g->name);
}

void layer_section(const struct grid *g, struct layer_point a, struct layer_point b,
    const struct layer_on *on, const char *unit, uint32_t n, struct grid *out)
{
    const double length = layer_length(a, b, on->globe);
    *out = (struct grid){.n = {n, 2, g->n[2]}};
    for (int i = 0; i < 3; i++) out->at[i] = xmalloc(out->n[i], sizeof *out->at[i]);
    out->value = xmalloc(grid_node(out, 0, 0, out->n[2]), sizeof *out->value);
    out->at[1][0] = 0;
    out->at[1][1] = THICK * length;
    memcpy(out->at[2], g->at[2], g->n[2] * sizeof *g->at[2]);
    for (uint32_t i = 0; i < n; i++) {
        struct layer_point p = between(a, b, on->globe, (double)i / (n - 1));
        out->at[0][i] = length * i / (n - 1);
        locate(g, on, &p);
        for (uint32_t k = 0; k < g->n[2]; k++)
            out->value[grid_node(out, i, 0, k)] = out->value[grid_node(out, i, 1, k)] =
                (float)layer_at(g, g->value + grid_node(g, 0, 0, k), p);
    }
    set_title(g, unit, out);
}
