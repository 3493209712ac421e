/* points: points of a plane in a k-d tree; see points.h. */
#include "scene/points.h"

#define STACK_MAX 64 /* levels of the tree + 1 */
/* Four times the bound on the relative rounding error of a cross product (J. R. Shewchuk, 1997). */
#define SLACK 1.4e-15

uint32_t points_nodes(uint32_t n)
{
    uint32_t leaves = 1;
    while ((uint64_t)leaves * POINTS_LEAF < n) leaves *= 2;
    return 2 * leaves;
}

/* Index of the first point of a leaf. */
static uint32_t leaf_start(const struct points *p, uint32_t leaf)
{
    return (uint32_t)((uint64_t)leaf * p->n / p->leaves);
}

static uint32_t leaf_of(const struct points *p, uint32_t place)
{
    return (uint32_t)((((uint64_t)place + 1) * p->leaves - 1) / p->n);
}

static double along(const struct plane_point *p, bool y) { return y ? p->y : p->x; }

/* Moves the k lowest of n to the front (C. A. R. Hoare, "Algorithm 65: FIND", CACM 4(7), 1961). */
static void part(struct plane_point *a, uint32_t n, uint32_t k, bool y)
{
    int64_t low = 0, high = (int64_t)n - 1;
    for (uint64_t round = 0; low < high; round++) {
        double pivot =
            along(&a[low + (int64_t)(rng_u64(n, round) % (uint64_t)(high - low + 1))], y);
        int64_t i = low, j = high;
        while (i <= j) {
            while (along(&a[i], y) < pivot) i++;
            while (pivot < along(&a[j], y)) j--;
            if (i > j) break;
            struct plane_point swap = a[i];
            a[i++] = a[j];
            a[j--] = swap;
        }
        if ((int64_t)k <= j) high = j;
        else if ((int64_t)k >= i) low = i;
        else return;
    }
}

static void build(struct points *p, uint32_t node, uint32_t leaf, uint32_t leaf_end)
{
    uint32_t first = leaf_start(p, leaf), end = leaf_start(p, leaf_end);
    struct points_node b = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL, end - first};
    for (uint32_t i = first; i < end; i++) {
        const struct plane_point *q = &p->at[i];
        b.x0 = fmin(b.x0, q->x), b.x1 = fmax(b.x1, q->x);
        b.y0 = fmin(b.y0, q->y), b.y1 = fmax(b.y1, q->y);
        p->place[q->id] = i;
    }
    p->node[node] = b;
    if (leaf_end - leaf == 1) return;
    uint32_t middle = leaf + (leaf_end - leaf) / 2;
    part(p->at + first, end - first, leaf_start(p, middle) - first, b.y1 - b.y0 > b.x1 - b.x0);
    build(p, 2 * node, leaf, middle);
    build(p, 2 * node + 1, middle, leaf_end);
}

void points_build(struct points *p)
{
    p->leaves = points_nodes(p->n) / 2;
    build(p, 1, 0, p->leaves);
}

void points_remove(struct points *p, uint32_t id)
{
    uint32_t i = p->place[id], leaf = leaf_of(p, i);
    uint32_t last = leaf_start(p, leaf) + p->node[p->leaves + leaf].left - 1;
    p->at[i] = p->at[last];
    p->place[p->at[i].id] = i;
    for (uint32_t k = p->leaves + leaf; k; k /= 2) p->node[k].left--;
}

/* True if the whole box lies to the right of the triangle's edge i. Tests the corner that is
 * farthest to the left. */
static bool beyond(const struct points_node *b, const struct points_triangle *t, int i)
{
    int j = i < 2 ? i + 1 : 0;
    double dx = t->x[j] - t->x[i], dy = t->y[j] - t->y[i];
    double x = (dy < 0 ? b->x1 : b->x0) - t->x[i], y = (dx > 0 ? b->y1 : b->y0) - t->y[i];
    return dx * y - dy * x < -SLACK * (fabs(dx) * t->height + fabs(dy) * t->width);
}

bool points_any(const struct points *p, const struct points_triangle *t,
    bool (*is)(void *ctx, uint32_t id), void *ctx)
{
    double x0 = fmin(fmin(t->x[0], t->x[1]), t->x[2]), x1 = fmax(fmax(t->x[0], t->x[1]), t->x[2]);
    double y0 = fmin(fmin(t->y[0], t->y[1]), t->y[2]), y1 = fmax(fmax(t->y[0], t->y[1]), t->y[2]);
    uint32_t stack[STACK_MAX] = {1}, n = 1;
    while (n) {
        uint32_t k = stack[--n];
        const struct points_node *b = &p->node[k];
        if (!b->left || b->x1 < x0 || b->x0 > x1 || b->y1 < y0 || b->y0 > y1) continue;
        if (beyond(b, t, 0) || beyond(b, t, 1) || beyond(b, t, 2)) continue;
        if (k < p->leaves) {
            stack[n++] = 2 * k;
            stack[n++] = 2 * k + 1;
            continue;
        }
        const struct plane_point *q = &p->at[leaf_start(p, k - p->leaves)];
        for (const struct plane_point *end = q + b->left; q < end; q++)
            if (q->x >= x0 && q->x <= x1 && q->y >= y0 && q->y <= y1 && is(ctx, q->id)) return true;
    }
    return false;
}
