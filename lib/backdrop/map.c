/* map: the graticule, the edges of the grid, and their labels. */
#include "backdrop/drawing.h"

#include <string.h>

static void segment(const struct drawing *s, const double a[3], const double b[3])
{
    for (int i = 0; i <= 64; i++) {
        double f = i / 64.0;
        backdrop_point(
            s, a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]));
    }
    buf_printf(s->out, "\n");
}

/* Draws a line along `axis` through `at`. */
static void along(const struct drawing *s, int axis, const double at[3])
{
    double a[3] = {at[0], at[1], at[2]}, b[3] = {at[0], at[1], at[2]};
    a[axis] = s->lo[axis];
    b[axis] = s->hi[axis];
    segment(s, a, b);
}

/* True if this side of the box (0 low, 1 high) is between the eye and the interior. */
static bool in_front(const struct drawing *s, int axis, int side)
{
    const double *scale = s->b->spec->scale;
    double here = (side ? s->hi : s->lo)[axis] * scale[axis];
    double there = (side ? s->lo : s->hi)[axis] * scale[axis];
    return here > there ? s->b->spec->from[axis] > here : s->b->spec->from[axis] < here;
}

/* Step of a graticule in degrees. */
static double degree_step(double range)
{
    static const double steps[] = {1, 2, 5, 10, 15, 30, 45, 60, 90};
    if (range <= 12) return backdrop_step(range, 12);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        if (range / steps[i] <= 12) return steps[i];
    return backdrop_step(range, 12);
}

/* Longitudes (axis 0) from 180 W to 180 E, latitudes unchanged. */
static void degrees_text(char *out, size_t n, int axis, double v)
{
    if (axis == 0) v = remainder(v, 360);
    const char *side = v < 0 ? axis ? "S" : "W" : axis ? "N" : "E";
    bool neither = v == 0 || (axis == 0 && fabs(v) == 180);
    snprintf(out, n, "%.6g°%s", fabs(v), neither ? "" : side);
}

#define KM_LEAST 2e4 /* metres: larger ranges are labelled in kilometres */

static void flat_text(const struct drawing *s, char *out, size_t n, double v)
{
    bool km = strcmp(s->b->flat, "m") == 0 && s->hi[0] - s->lo[0] >= KM_LEAST;
    snprintf(out, n, "%.6g %s%s", km ? v / 1000 : v, km ? "k" : "", s->b->flat);
}

static void place_text(const struct drawing *s, char *out, size_t n, int axis, double v)
{
    if (s->b->flat) flat_text(s, out, n, v);
    else degrees_text(out, n, axis, v);
}

static struct ticks graticule_of(const struct drawing *s, int axis)
{
    double wide = fmax(s->hi[0] - s->lo[0], s->hi[1] - s->lo[1]);
    return backdrop_ticks(
        s->lo[axis], s->hi[axis], s->b->flat ? backdrop_step(wide, 12) : degree_step(wide));
}

static struct ticks heights_of(const struct drawing *s)
{
    double a = fmin(s->lo[2], s->hi[2]), b = fmax(s->lo[2], s->hi[2]);
    return backdrop_ticks(a, b, backdrop_step(b - a, 6));
}

void backdrop_graticule(const struct drawing *s)
{
    for (int axis = 0; axis < 2; axis++) {
        struct ticks t = graticule_of(s, axis);
        for (int i = t.first; i <= t.last; i++) {
            double at[3] = {s->lo[0], s->lo[1], s->lo[2]};
            at[axis] = i * t.step;
            along(s, 1 - axis, at);
        }
    }
    struct ticks t = heights_of(s);
    for (int i = t.first; i <= t.last; i++)
        for (int wall = 0; wall < 4; wall++) {
            int axis = wall / 2, side = wall % 2;
            double at[3] = {s->lo[0], s->lo[1], i * t.step};
            if (side) at[axis] = s->hi[axis];
            if (!in_front(s, axis, side)) along(s, 1 - axis, at);
        }
}

/* An edge between two front sides is left out, because it is in front of the volume. The volume
 * covers everything drawn here. */
void backdrop_edges(const struct drawing *s)
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 4; side++) {
            int b = (axis + 1) % 3, c = (axis + 2) % 3, sb = side & 1, sc = side >> 1;
            double at[3] = {0};
            at[b] = (sb ? s->hi : s->lo)[b];
            at[c] = (sc ? s->hi : s->lo)[c];
            if (!in_front(s, b, sb) || !in_front(s, c, sc)) along(s, axis, at);
        }
}

/* ---- labels ---------------------------------------------------------------------------------- */

/* Places a label beside an edge of the map. The text extends away from the edge. */
static void label_beside(const struct drawing *s, const char *text, const double at[2], double pad)
{
    double edge[2], xy[2];
    if (!backdrop_project(s, at[0], at[1], s->lo[2], edge)) return;
    if (!backdrop_project(s, at[0], at[1] + pad, s->lo[2], xy)) return;
    double slant = (xy[0] - edge[0]) / hypot(xy[0] - edge[0], xy[1] - edge[1]);
    backdrop_label(s, text, xy, slant > .4 ? "left" : slant < -.4 ? "right" : "center");
}

/* Below the map as seen from the eye, except at the corner of the heights. */
static void label_longitudes(const struct drawing *s, const double corner[2], double pad)
{
    double middle = (s->lo[1] + s->hi[1]) / 2 * s->b->spec->scale[1];
    bool low = (s->b->spec->from[1] < middle) == (s->b->spec->scale[1] > 0);
    double y = low ? s->lo[1] : s->hi[1];
    struct ticks t = graticule_of(s, 0);
    char text[128];
    for (int i = t.first; i <= t.last; i++) {
        double at[2] = {i * t.step, y};
        if (y == corner[1] && fabs(at[0] - corner[0]) < .3 * t.step) continue;
        place_text(s, text, sizeof text, 0, at[0]);
        label_beside(s, text, at, low ? -pad : pad);
    }
}

static void label_latitudes(const struct drawing *s, double pad)
{
    struct ticks t = graticule_of(s, 1);
    double xy[2], other[2];
    char text[128];
    for (int i = t.first; i <= t.last; i++) {
        place_text(s, text, sizeof text, 1, i * t.step);
        bool a = backdrop_project(s, s->lo[0] - pad / 2, i * t.step, s->lo[2], xy);
        bool b = backdrop_project(s, s->hi[0] + pad / 2, i * t.step, s->lo[2], other);
        if (!a || !b) continue;
        bool left = in_front(s, 0, 0) || in_front(s, 0, 1) ? in_front(s, 0, 0) : xy[0] < other[0];
        bool first = xy[0] < other[0] ? left : !left;
        backdrop_label(s, text, left ? xy : other, first ? "right" : "left");
    }
}

static void label_heights(const struct drawing *s, const double corner[2])
{
    struct ticks t = heights_of(s);
    double xy[2];
    char text[128];
    for (int i = t.first; i <= t.last; i++) {
        snprintf(text, sizeof text, "%.6g %s", (s->b->down ? -i : i) * t.step + 0.0, s->b->unit);
        if (backdrop_project(s, corner[0], corner[1], i * t.step, xy))
            backdrop_label(s, text, xy, "left offset 0.7,0");
    }
}

/* Finds the corner that is furthest to the right. */
static void find_corner(const struct drawing *s, double corner[2])
{
    double most = -HUGE_VAL, xy[2];
    corner[0] = s->lo[0];
    corner[1] = s->lo[1];
    for (int i = 0; i < 4; i++) {
        double x = i & 1 ? s->hi[0] : s->lo[0], y = i & 2 ? s->hi[1] : s->lo[1];
        if (!backdrop_project(s, x, y, s->lo[2], xy) || xy[0] <= most) continue;
        most = xy[0];
        corner[0] = x;
        corner[1] = y;
    }
}

void backdrop_labels(const struct drawing *s)
{
    double pad = .025 * fmax(s->hi[0] - s->lo[0], s->hi[1] - s->lo[1]), corner[2];
    find_corner(s, corner);
    label_longitudes(s, corner, pad);
    label_latitudes(s, pad);
    label_heights(s, corner);
}
