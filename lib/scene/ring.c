/* Corners of a polygon: projection, orientation, ears. */
#include "scene/ring.h"
#include "scene/reader.h"

#include <stdlib.h>

/* Bound on the rounding error of cross2, relative to the sum of its two products' magnitudes
 * (J. R. Shewchuk, "Adaptive precision floating-point arithmetic ...", 1997: (3 + 16 eps) eps). */
#define CROSS_ERROR 3.4e-16
#define CORNERS_PER_CELL 2

/*
 * Twice the area of a b c, positive when counterclockwise; 0 when that is within its rounding
 * error.
 */
static double cross2(const struct corner *a, const struct corner *b, const struct corner *c)
{
    double l = (b->x - a->x) * (c->y - a->y), r = (b->y - a->y) * (c->x - a->x);
    return fabs(l - r) <= CROSS_ERROR * (fabs(l) + fabs(r)) ? 0 : l - r;
}

double ring_turn(const struct ring *g, uint32_t i)
{
    const struct corner *b = &g->c[i];
    return cross2(&g->c[b->prev], b, &g->c[b->next]);
}

bool ring_is_empty(const struct ring *g, uint32_t i)
{
    const struct corner *b = &g->c[i], *a = &g->c[b->prev], *c = &g->c[b->next];
    return (a->x - b->x) * (c->x - b->x) + (a->y - b->y) * (c->y - b->y) >= 0;
}

/* ---- ears ----------------------------------------------------------------------------- */

static bool same_place(const struct corner *a, const struct corner *b)
{
    return a->x == b->x && a->y == b->y;
}

/* Whether p lies strictly between the two edges that meet at corner b (a before it, c after). */
static bool in_wedge(
    const struct corner *a, const struct corner *b, const struct corner *c, const struct corner *p)
{
    return cross2(a, b, p) > 0 && cross2(b, c, p) > 0;
}

/*
 * Whether q, which is none of its corners, spoils the ear a b c. Where it coincides with one
 * (holes are joined to the outline by a bridge) it does so only if one of its own edges leads into
 * the ear.
 */
static bool spoils(const struct ring *g, const struct corner *a, const struct corner *b,
    const struct corner *c, const struct corner *q)
{
    const struct corner *p = &g->c[q->prev], *n = &g->c[q->next];
    if (same_place(q, b)) return in_wedge(a, b, c, p) || in_wedge(a, b, c, n);
    if (same_place(q, a)) return in_wedge(c, a, b, p) || in_wedge(c, a, b, n);
    if (same_place(q, c)) return in_wedge(b, c, a, p) || in_wedge(b, c, a, n);
    return cross2(a, b, q) >= 0 && cross2(b, c, q) >= 0 && cross2(c, a, q) >= 0;
}

static inline uint32_t cell_of(double v, double v0, double per, uint32_t side)
{
    double cell = (v - v0) * per;
    return cell >= side ? side - 1 : cell > 0 ? (uint32_t)cell : 0;
}

/* Whether no corner of one cell spoils the ear a b c. */
static bool cell_allows(struct ring *g, uint32_t *link, const struct corner *a,
    const struct corner *b, const struct corner *c)
{
    double x0 = fmin(fmin(a->x, b->x), c->x), x1 = fmax(fmax(a->x, b->x), c->x);
    double y0 = fmin(fmin(a->y, b->y), c->y), y1 = fmax(fmax(a->y, b->y), c->y);
    while (*link != RING_NONE) {
        const struct corner *q = &g->c[*link];
        if (q->gone || !q->blunt) { /* for good, in a polygon that does not cross itself */
            *link = g->grid.after[*link];
            continue;
        }
        link = &g->grid.after[*link];
        if (q->x < x0 || q->x > x1 || q->y < y0 || q->y > y1) continue;
        if (q != a && q != b && q != c && spoils(g, a, b, c, q)) return false;
    }
    return true;
}

/* Widens [x0, x1] by the part of edge p q that lies between y0 and y1. */
static void edge_extent(
    const struct corner *p, const struct corner *q, double y0, double y1, double *x0, double *x1)
{
    if (fmax(p->y, q->y) < y0 || fmin(p->y, q->y) > y1) return;
    const struct corner *end[2] = {p, q};
    for (int k = 0; k < 2; k++) {
        const struct corner *e = end[k], *f = end[!k];
        double y = fmin(fmax(e->y, y0), y1), x = e->x;
        if (y != e->y) x += (f->x - e->x) * ((y - e->y) / (f->y - e->y));
        *x0 = fmin(*x0, x);
        *x1 = fmax(*x1, x);
    }
}

bool ring_is_ear(struct ring *g, uint32_t i)
{
    const struct corner_grid *d = &g->grid;
    const struct corner *b = &g->c[i], *a = &g->c[b->prev], *c = &g->c[b->next];
    if (d->side == 1) return cell_allows(g, d->first, a, b, c);
    double y0 = fmin(fmin(a->y, b->y), c->y), y1 = fmax(fmax(a->y, b->y), c->y);
    uint32_t row = cell_of(y0, d->y0, d->per_y, d->side),
             last = cell_of(y1, d->y0, d->per_y, d->side);
    for (; row <= last; row++) {
        /* One cell more on every side than the ear reaches: no rounding loses a corner. */
        double low = d->y0 + (row - 1.0) / d->per_y, high = d->y0 + (row + 2.0) / d->per_y;
        double x0 = HUGE_VAL, x1 = -HUGE_VAL, more = 1 / d->per_x;
        edge_extent(a, b, low, high, &x0, &x1);
        edge_extent(b, c, low, high, &x0, &x1);
        edge_extent(c, a, low, high, &x0, &x1);
        uint32_t k = cell_of(x0 - more, d->x0, d->per_x, d->side);
        uint32_t end = cell_of(x1 + more, d->x0, d->per_x, d->side);
        for (; k <= end; k++)
            if (!cell_allows(g, &d->first[row * d->side + k], a, b, c)) return false;
    }
    return true;
}

/* ---- the queue ------------------------------------------------------------------------ */

static void push(struct ring *g, uint32_t i)
{
    g->queue[(g->queue_at + g->queue_n++) % g->n] = i;
    g->c[i].queued = true;
}

uint32_t ring_pop(struct ring *g)
{
    while (g->queue_n) {
        uint32_t i = g->queue[g->queue_at];
        struct corner *c = &g->c[i];
        g->queue_at = (g->queue_at + 1) % g->n;
        g->queue_n--;
        c->queued = false;
        if (c->gone) continue;
        if (!c->later) return i;
        c->later = false;
        push(g, i);
    }
    return RING_NONE;
}

static void put_off(struct ring *g, uint32_t i)
{
    struct corner *c = &g->c[i];
    c->blunt = ring_turn(g, i) <= 0;
    if (c->queued) c->later = true;
    else push(g, i);
}

void ring_remove(struct ring *g, uint32_t i)
{
    struct corner *b = &g->c[i];
    g->c[b->prev].next = b->next;
    g->c[b->next].prev = b->prev;
    b->gone = true;
    g->left--;
    put_off(g, b->prev);
    put_off(g, b->next);
}

/* ---- making one ----------------------------------------------------------------------- */

static struct vec3 newell(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = v3(0, 0, 0);
    /* Relative to the first vertex: a polygon far from the origin keeps its normal. */
    for (uint32_t i = 1; i + 1 < n; i++)
        sum = v3_add(sum, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0])));
    return sum;
}

struct vec3 newell_unit(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = newell(v, n);
    double len = v3_len(sum);
    return len > 0 ? v3_scale(sum, 1 / len) : v3(0, 0, 1);
}

/*
 * The projection along the normal's largest component, turned so that the polygon is
 * counterclockwise. It takes coordinates as they were read, so nothing is rounded before the
 * orientation tests.
 */
static void project(struct ring *g, const struct vec3 *v, struct vec3 normal)
{
    double ax = fabs(normal.x), ay = fabs(normal.y), az = fabs(normal.z);
    for (uint32_t i = 0; i < g->n; i++) {
        struct corner *c = &g->c[i];
        bool flip;
        if (az >= ax && az >= ay) c->x = v[i].x, c->y = v[i].y, flip = normal.z < 0;
        else if (ax >= ay) c->x = v[i].y, c->y = v[i].z, flip = normal.x < 0;
        else c->x = v[i].z, c->y = v[i].x, flip = normal.y < 0;
        if (flip) c->x = -c->x;
        c->prev = (i ? i : g->n) - 1;
        c->next = i + 1 < g->n ? i + 1 : 0;
        c->gone = c->later = false;
    }
}

/* Chains the blunt corners, each in its cell. */
static void fill_grid(struct ring *g)
{
    struct corner_grid *d = &g->grid;
    double x1 = -HUGE_VAL, y1 = -HUGE_VAL;
    d->x0 = d->y0 = HUGE_VAL;
    for (uint32_t i = 0; i < g->n; i++) {
        d->x0 = fmin(d->x0, g->c[i].x), x1 = fmax(x1, g->c[i].x);
        d->y0 = fmin(d->y0, g->c[i].y), y1 = fmax(y1, g->c[i].y);
    }
    d->per_x = d->side / (x1 - d->x0); /* not 0: the polygon has an area */
    d->per_y = d->side / (y1 - d->y0);
    for (uint32_t k = 0; k < d->side * d->side; k++) d->first[k] = RING_NONE;
    for (uint32_t i = g->n; i-- > 0;) {
        struct corner *c = &g->c[i];
        c->blunt = ring_turn(g, i) <= 0;
        if (!c->blunt) continue;
        uint32_t cell = cell_of(c->y, d->y0, d->per_y, d->side) * d->side +
                        cell_of(c->x, d->x0, d->per_x, d->side);
        d->after[i] = d->first[cell];
        d->first[cell] = i;
    }
}

bool ring_init(struct ring *g, const struct vec3 *v, uint32_t n)
{
    struct vec3 normal = newell(v, n);
    if (normal.x == 0 && normal.y == 0 && normal.z == 0) return false;
    g->n = g->left = n;
    g->queue_at = g->queue_n = 0;
    g->c = g->stack_c;
    uint32_t *u = g->stack_u;
    g->grid.side = 1;
    if (n > RING_STACK) {
        g->c = xmalloc(n, sizeof *g->c);
        u = xmalloc(n, 3 * sizeof *u);
        while ((uint64_t)(g->grid.side + 1) * (g->grid.side + 1) * CORNERS_PER_CELL <= n)
            g->grid.side++;
    }
    g->queue = u;
    g->grid.after = u + n;
    g->grid.first = u + 2 * (size_t)n;
    project(g, v, normal);
    fill_grid(g);
    for (uint32_t i = 0; i < n; i++) push(g, i + 1 < n ? i + 1 : 0);
    return true;
}

void ring_free(struct ring *g)
{
    if (g->c == g->stack_c) return;
    free(g->c);
    free(g->queue);
}
