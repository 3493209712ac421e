/* curves: meridians and parallels on a plane of projection, and their labels. */
#include "backdrop/outline.h"

#include <stdlib.h>

#define SAMPLES 32    /* places in each direction where the extent of the map is looked for */
#define PIECES 96     /* of a curve */
#define MARGIN .04    /* of that extent, beyond it */
#define PARALLELS 1.5 /* 12 divided by this is the greatest number of parallels */

/* Meridians (0) and parallels (1), from lo to hi. */
struct mesh {
    double lo[2], hi[2];
    struct ticks ticks[2];
};

/* True if this pole is on the map. */
static bool has_pole(const struct drawing *s, double pole)
{
    struct plane_at at;
    return plane_forward(s->plane, (struct plane_at){0, pole}, &at) && at.x >= s->lo[0] &&
           at.x <= s->hi[0] && at.y >= s->lo[1] && at.y <= s->hi[1];
}

/* Longitudes and latitudes that the map has, of about half of the globe around its middle. */
static void extent(const struct drawing *s, struct mesh *m)
{
    const struct plane_at middle = {(s->lo[0] + s->hi[0]) / 2, (s->lo[1] + s->hi[1]) / 2};
    struct plane_at centre = {0, 0}, d;
    plane_inverse(s->plane, middle, &centre);
    m->lo[0] = m->lo[1] = HUGE_VAL;
    m->hi[0] = m->hi[1] = -HUGE_VAL;
    for (int i = 0; i <= SAMPLES; i++)
        for (int j = 0; j <= SAMPLES; j++) {
            const struct plane_at at = {s->lo[0] + (s->hi[0] - s->lo[0]) * i / SAMPLES,
                s->lo[1] + (s->hi[1] - s->lo[1]) * j / SAMPLES};
            if (!plane_inverse(s->plane, at, &d)) continue;
            const double v[2] = {centre.x + remainder(d.x - centre.x, 360), d.y};
            for (int a = 0; a < 2; a++) {
                m->lo[a] = fmin(m->lo[a], v[a]);
                m->hi[a] = fmax(m->hi[a], v[a]);
            }
        }
    for (int a = 0; a < 2; a++) {
        const double more = MARGIN * (m->hi[a] - m->lo[a]);
        m->lo[a] -= more;
        m->hi[a] += more;
    }
    const bool north = has_pole(s, 90), south = has_pole(s, -90);
    if (north || m->hi[1] > 90) m->hi[1] = 90;
    if (south || m->lo[1] < -90) m->lo[1] = -90;
    if (north || south || m->hi[0] - m->lo[0] > 360)
        m->lo[0] = centre.x - 180, m->hi[0] = centre.x + 180;
}

/* Meridians are about as far apart as parallels. False if the map is not on the globe. */
static bool mesh_of(const struct drawing *s, struct mesh *m)
{
    extent(s, m);
    const double wide = m->hi[0] - m->lo[0], high = m->hi[1] - m->lo[1];
    if (!(wide > 0 && high > 0 && fabs(m->lo[0]) < 1e6)) return false;
    const double lat = backdrop_degree_step(PARALLELS * high);
    const double middle = (m->hi[1] + m->lo[1]) / 2 * 3.14159265358979 / 180;
    const double n = fmax(4, fmin(12, wide * cos(middle) / lat));
    const double lon = backdrop_degree_step(wide * 12 / n);
    const double last = m->hi[0] - (wide > 359 ? lon / 100 : 0); /* the first one comes round */
    m->ticks[0] = backdrop_ticks(m->lo[0], last, lon);
    m->ticks[1] = backdrop_ticks(m->lo[1], m->hi[1], lat);
    return true;
}

/* Gives the pieces of a meridian (axis 0) or a parallel. */
static void curve(const struct drawing *s, const struct mesh *m, int axis, double v,
    outline_take *take, void *ctx)
{
    struct outline o = {.n = 0};
    const double lo = m->lo[1 - axis], hi = m->hi[1 - axis];
    for (int i = 0; i <= PIECES; i++) {
        const double other = lo + (hi - lo) * i / PIECES;
        outline_add(&o, axis ? (struct outline_point){other, v} : (struct outline_point){v, other});
    }
    outline_spread(s->plane, &o, false, take, ctx);
    outline_free(&o);
}

static void stroke(void *ctx, struct outline *piece, enum outline_piece kind)
{
    (void)kind;
    outline_bound(piece);
    outline_stroke(ctx, piece);
    outline_free(piece);
}

void backdrop_curves(const struct drawing *s)
{
    struct mesh m;
    struct drawing copy = *s; /* outline_take has no const */
    if (!mesh_of(s, &m)) return;
    for (int axis = 0; axis < 2; axis++)
        for (int i = m.ticks[axis].first; i <= m.ticks[axis].last; i++)
            curve(s, &m, axis, i * m.ticks[axis].step, stroke, &copy);
}

/* ---- labels --------------------------------------------------------------------------------- */

/* Where a curve meets a side of the map: 0 and 1 at the low and the high end of x, 2 and 3 of y. */
struct meeting {
    double at[2];
    int side, axis;
    double v;
};
struct meetings {
    const struct drawing *s;
    struct meeting *of; /* grown by xgrown */
    size_t n;
    int axis; /* of the curve */
    double v;
    double corner[2], pad[2];
    int order[2][4]; /* of the sides, for meridians and parallels: the next one if one has none */
};

/* A curve along which the globe is cut open comes twice. */
static bool is_met(const struct meetings *m, int side, struct outline_point p)
{
    for (const struct meeting *o = m->of; o < m->of + m->n; o++)
        if (o->axis == m->axis && o->v == m->v && o->side == side &&
            hypot(o->at[0] - p.x, o->at[1] - p.y) < m->pad[0] / 100)
            return true;
    return false;
}

static void meet_side(struct meetings *m, int side, struct outline_point p, struct outline_point q)
{
    const int a = side / 2;
    const double edge = side % 2 ? m->s->hi[a] : m->s->lo[a];
    const double from = (a ? p.y : p.x) - edge, to = (a ? q.y : q.x) - edge;
    if ((from < 0) == (to < 0)) return;
    const struct outline_point at = outline_between(p, q, from / (from - to));
    const double other = a ? at.x : at.y;
    if (other < m->s->lo[1 - a] || other > m->s->hi[1 - a] || is_met(m, side, at)) return;
    m->of = xgrown(m->of, m->n, sizeof *m->of);
    m->of[m->n++] = (struct meeting){{at.x, at.y}, side, m->axis, m->v};
}

static void meet(void *ctx, struct outline *piece, enum outline_piece kind)
{
    (void)kind;
    for (size_t i = 1; i < piece->n; i++)
        for (int side = 0; side < 4; side++) meet_side(ctx, side, piece->at[i - 1], piece->at[i]);
    outline_free(piece);
}

/* True if the box is between the eye and a point beside its lowest plane. */
static bool is_hidden(const struct drawing *s, const double at[2])
{
    const double *from = s->b->spec->from, *scale = s->b->spec->scale;
    double enter = 0, leave = 1;
    for (int a = 0; a < 3; a++) {
        const double eye = from[a], d = (a < 2 ? at[a] : s->lo[2]) * scale[a] - eye;
        const double near = (s->lo[a] * scale[a] - eye) / d, far = (s->hi[a] * scale[a] - eye) / d;
        enter = fmax(enter, fmin(near, far));
        leave = fmin(leave, fmax(near, far));
    }
    return enter < leave - 1e-6;
}

static bool is_at_heights(const struct meetings *m, const double at[2])
{
    return hypot((at[0] - m->corner[0]) / m->pad[0], (at[1] - m->corner[1]) / m->pad[1]) < 1.5;
}

/* The text extends away from the edge. */
static enum label place(const struct meetings *m, const struct meeting *at, bool behind)
{
    const struct drawing *s = m->s;
    const int a = at->side / 2;
    double beside[2] = {at->at[0], at->at[1]}, edge[2], xy[2];
    char text[64];
    beside[a] += at->side % 2 ? m->pad[a] : -m->pad[a];
    if (is_at_heights(m, at->at) || (behind && is_hidden(s, beside)) ||
        !backdrop_project(s, at->at[0], at->at[1], s->lo[2], edge) ||
        !backdrop_project(s, beside[0], beside[1], s->lo[2], xy))
        return LABEL_LEFT_OUT;
    const double slant = (xy[0] - edge[0]) / hypot(xy[0] - edge[0], xy[1] - edge[1]);
    backdrop_degrees_text(text, sizeof text, at->axis, at->v);
    return backdrop_label(s, text, xy, slant > .4 ? -1 : slant < -.4 ? 1 : 0);
}

/* At the first side where the curve has room for a label. */
static enum label label_curve(const struct drawing *s, const void *ctx, double v)
{
    const struct meetings *m = ctx;
    (void)s;
    for (int i = 0; i < 4; i++) {
        const int side = m->order[m->axis][i];
        bool placed = false;
        for (const struct meeting *at = m->of; at < m->of + m->n; at++) {
            if (at->side != side || at->axis != m->axis || at->v != v) continue;
            const enum label label = place(m, at, i > 1);
            if (label == LABEL_TOO_CLOSE) return label;
            placed |= label == LABEL_PLACED;
        }
        if (placed) return LABEL_PLACED;
    }
    return LABEL_LEFT_OUT;
}

/* The side of x that is in front, or else at the left of the picture. */
static int front_of_x(const struct drawing *s)
{
    const double y = (s->lo[1] + s->hi[1]) / 2;
    double xy[2], other[2];
    if (drawing_in_front(s, 0, 0)) return 0;
    if (drawing_in_front(s, 0, 1)) return 1;
    return backdrop_project(s, s->lo[0], y, s->lo[2], xy) &&
           backdrop_project(s, s->hi[0], y, s->lo[2], other) && xy[0] >= other[0];
}

void backdrop_label_curves(const struct drawing *s, bool low, const double corner[2])
{
    const int x = front_of_x(s), y = low ? 2 : 3;
    struct mesh mesh;
    struct meetings m = {.s = s,
        .corner = {corner[0], corner[1]},
        .pad = {.02 * drawing_longest(s, 0), .02 * drawing_longest(s, 1)},
        .order = {{y, x, 1 - x, 5 - y}, {x, y, 1 - x, 5 - y}}};
    if (!mesh_of(s, &mesh)) return;
    for (m.axis = 0; m.axis < 2; m.axis++)
        for (int i = mesh.ticks[m.axis].first; i <= mesh.ticks[m.axis].last; i++) {
            m.v = i * mesh.ticks[m.axis].step;
            curve(s, &mesh, m.axis, m.v, meet, &m);
        }
    for (m.axis = 0; m.axis < 2; m.axis++)
        backdrop_label_ticks(s, &mesh.ticks[m.axis], label_curve, &m);
    free(m.of);
}
