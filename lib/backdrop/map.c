/* map: the graticule, the edges of the grid, and their labels. */
#include "backdrop/drawing.h"

#include <string.h>

static void segment(const struct drawing *s, const double a[3], const double b[3])
{
    for (int i = 0; i <= 64; i++) {
        double f = i / 64.0;
        drawing_point(
            s, a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]));
    }
    mark_break(s->list);
}

/* Draws a line along `axis` through `at`. */
static void along(const struct drawing *s, int axis, const double at[3])
{
    double a[3] = {at[0], at[1], at[2]}, b[3] = {at[0], at[1], at[2]};
    a[axis] = s->lo[axis];
    b[axis] = s->hi[axis];
    segment(s, a, b);
}

#define KM_LEAST 2e4 /* metres: larger ranges are labelled in kilometres */

static void flat_text(const struct drawing *s, char *out, size_t n, double v)
{
    bool km = strcmp(s->b->flat, "m") == 0 && s->hi[0] - s->lo[0] >= KM_LEAST;
    const char *blank = strcmp(s->b->flat, BACKDROP_DEGREE) == 0 ? "" : " ";
    snprintf(out, n, "%.10g%s%s%s", km ? v / 1000 : v, blank, km ? "k" : "", s->b->flat);
}

static void place_text(const struct drawing *s, char *out, size_t n, int axis, double v)
{
    if (s->b->flat) flat_text(s, out, n, v);
    else backdrop_degrees_text(out, n, axis, v);
}

static struct ticks graticule_of(const struct drawing *s, int axis)
{
    double wide = drawing_longest(s, axis);
    double step = s->b->flat ? backdrop_step(wide, 12) : backdrop_degree_step(wide);
    return backdrop_ticks(s->lo[axis], s->hi[axis], step);
}

static struct ticks heights_of(const struct drawing *s)
{
    double a = fmin(s->lo[2], s->hi[2]), b = fmax(s->lo[2], s->hi[2]);
    if (!(a < b)) return (struct ticks){1, 0, -1}; /* one level */
    return backdrop_ticks(a, b, backdrop_step(b - a, 6));
}

void backdrop_graticule(const struct drawing *s)
{
    if (s->plane) backdrop_curves(s);
    for (int axis = 0; axis < 2 && !s->plane; axis++) {
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
            if (!drawing_in_front(s, axis, side)) along(s, 1 - axis, at);
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
            if (!drawing_in_front(s, b, sb) || !drawing_in_front(s, c, sc)) along(s, axis, at);
        }
}

/* ---- labels ---------------------------------------------------------------------------------- */

/* Where labels are: beside an edge of the map, or the edge of the heights. */
struct beside {
    double corner[2]; /* of the heights */
    double y, pad;    /* longitudes: the edge, and how far away from it */
    double step;
    bool bare; /* heights: numbers only, because some would leave the picture with their unit */
};

/* Places a label beside an edge of the map. The text extends away from the edge. */
static enum label label_longitude(const struct drawing *s, const void *ctx, double v)
{
    const struct beside *b = ctx;
    double edge[2], xy[2];
    char text[128];
    if (b->y == b->corner[1] && fabs(v - b->corner[0]) < .3 * b->step) return LABEL_LEFT_OUT;
    if (!backdrop_project(s, v, b->y, s->lo[2], edge)) return LABEL_LEFT_OUT;
    if (!backdrop_project(s, v, b->y + b->pad, s->lo[2], xy)) return LABEL_LEFT_OUT;
    double slant = (xy[0] - edge[0]) / hypot(xy[0] - edge[0], xy[1] - edge[1]);
    place_text(s, text, sizeof text, 0, v);
    return backdrop_label(s, text, xy, slant > .4 ? -1 : slant < -.4 ? 1 : 0);
}

static enum label label_latitude(const struct drawing *s, const void *ctx, double v)
{
    const struct beside *b = ctx;
    double xy[2], other[2];
    char text[128];
    place_text(s, text, sizeof text, 1, v);
    if (!backdrop_project(s, s->lo[0] - b->pad / 2, v, s->lo[2], xy) ||
        !backdrop_project(s, s->hi[0] + b->pad / 2, v, s->lo[2], other))
        return LABEL_LEFT_OUT;
    bool low = drawing_in_front(s, 0, 0), high = drawing_in_front(s, 0, 1);
    bool left = low || high ? low : xy[0] < other[0];
    bool first = xy[0] < other[0] ? left : !left;
    return backdrop_label(s, text, left ? xy : other, first ? 1 : -1);
}

static void height_text(const struct drawing *s, bool bare, double z, char *out, size_t n)
{
    double v = (s->b->down ? -z : z) + 0.0;
    if (bare) snprintf(out, n, "%.10g", v);
    else if (s->b->levels) snprintf(out, n, "%.40s %.10g", s->b->levels, v);
    else snprintf(out, n, "%.10g %s", v, s->b->unit);
}

/* Where the text of a height begins, whose edge is at x: at the edge of the picture, closer to the
 * edge of the grid, or over it. A number may be over it as a whole. */
static double height_x(const struct drawing *s, bool bare, double x, double wide)
{
    return fmax(x - (bare ? wide : s->em), fmin(x + s->em / 2, s->w - wide));
}

static enum label label_height(const struct drawing *s, const void *ctx, double z)
{
    const struct beside *b = ctx;
    double xy[2];
    char text[128];
    height_text(s, b->bare, z, text, sizeof text);
    if (!backdrop_project(s, b->corner[0], b->corner[1], z, xy)) return LABEL_LEFT_OUT;
    xy[0] = height_x(s, b->bare, xy[0], backdrop_text_width(s, text) + 1);
    return backdrop_label(s, text, xy, -1);
}

/* True if all heights that are in the picture have room beside their edge. */
static bool heights_fit(const struct drawing *s, const struct beside *b, const struct ticks *t)
{
    char text[128];
    for (int i = t->first; i <= t->last; i++) {
        double xy[2], z = i * t->step;
        if (!backdrop_project(s, b->corner[0], b->corner[1], z, xy)) continue;
        height_text(s, false, z, text, sizeof text);
        double wide = backdrop_text_width(s, text) + 1;
        bool inside = xy[0] <= s->w && xy[1] >= 0 && xy[1] <= s->h;
        if (inside && height_x(s, false, xy[0], wide) + wide > s->w) return false;
    }
    return true;
}

/* The unit of bare numbers, once: above them, below them, or at their left. */
static void label_unit(const struct drawing *s, const struct beside *b)
{
    const char *text = s->b->levels ? s->b->levels : s->b->unit;
    if (!*text) return;
    double wide = backdrop_text_width(s, text) + 1, line = 1.1 * BACKDROP_TEXT_HIGH * s->em;
    double ends[2][2];
    for (int i = 0; i < 2; i++)
        if (!backdrop_project(s, b->corner[0], b->corner[1], (i ? s->hi : s->lo)[2], ends[i]))
            return;
    const double *low = ends[ends[0][1] > ends[1][1]], *high = ends[ends[0][1] <= ends[1][1]];
    const double right = fmin(s->w - wide, high[0]);
    const double places[][2] = {{right, fmin(high[1] + line, s->h - line / 2)},
        {fmin(s->w - wide, low[0]), fmax(low[1] - line, line / 2)},
        {right - 4 * s->em, fmin(high[1], s->h - line / 2)}, {s->w - wide, s->h - line / 2}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        if (backdrop_label(s, text, places[i], -1) == LABEL_PLACED) return;
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

/* Longitudes are below the map as seen from the eye, except at the corner of the heights. */
void backdrop_labels(const struct drawing *s)
{
    const double pad = .025 * drawing_longest(s, 1);
    double middle = (s->lo[1] + s->hi[1]) / 2 * s->b->spec->scale[1];
    bool low = (s->b->spec->from[1] <= middle) == (s->b->spec->scale[1] > 0); /* = : from above */
    struct ticks x = graticule_of(s, 0), y = graticule_of(s, 1), z = heights_of(s);
    struct beside b = {.y = low ? s->lo[1] : s->hi[1], .pad = low ? -pad : pad, .step = x.step};
    find_corner(s, b.corner);
    if (s->plane) backdrop_label_curves(s, low, b.corner);
    else {
        backdrop_label_ticks(s, &x, label_longitude, &b);
        b.pad = .025 * drawing_longest(s, 0);
        backdrop_label_ticks(s, &y, label_latitude, &b);
    }
    b.bare = !heights_fit(s, &b, &z);
    backdrop_label_ticks(s, &z, label_height, &b);
    if (b.bare) label_unit(s, &b);
}
