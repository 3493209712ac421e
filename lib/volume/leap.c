/*
 * leap: rays of the stream leap over empty regions. Regions are cubes of REGION cells. A ray walks
 * from region to region, and then from cell to cell only where regions have a live cell. Planes of
 * regions are planes of cells, and the time at a plane depends on nothing but the plane. So a ray
 * that has leapt is exactly where single steps would have brought it.
 * One machine with stream.c.
 */
#include "volume/stream.h"

#include <stdlib.h>

#define REGION_SHIFT 4
#define REGION (1 << REGION_SHIFT)
#define EMPTY_LEAST 3 /* leaps pay if one region of this many is empty */

/* Where plane i is, as the lanes measure it. */
static double place(const struct stream *s, int a, int64_t i)
{
    return s->even ? (double)i : s->v->plane[a][i];
}

void volume_leap_init(struct stream *s)
{
    const struct volume *v = s->v;
    const int shift = REGION_SHIFT - BLOCK_SHIFT;
    int64_t n = 1, live = 0;
    for (int a = 0; a < 3; a++) {
        s->regions[a] = ((v->cells[a] - 1) >> REGION_SHIFT) + 1;
        s->region_plane[a] = xcalloc((size_t)s->regions[a] + 1, sizeof(double));
        for (uint32_t i = 0; i < s->regions[a]; i++)
            s->region_plane[a][i] = place(s, a, i << REGION_SHIFT);
        s->region_plane[a][s->regions[a]] = place(s, a, v->cells[a]);
        n *= s->regions[a];
    }
    s->region = xcalloc((size_t)n, 1);
    for (uint32_t z = 0, i = 0; z < v->blocks[2]; z++)
        for (uint32_t y = 0; y < v->blocks[1]; y++)
            for (uint32_t x = 0; x < v->blocks[0]; x++, i++)
                s->region[((z >> shift) * s->regions[1] + (y >> shift)) * s->regions[0] +
                          (x >> shift)] |= v->block[i];
    for (int64_t i = 0; i < n; i++) live += s->region[i];
    s->leaps = (n - live) * EMPTY_LEAST >= n;
}

void volume_leap_free(struct stream *s)
{
    for (int a = 0; a < 3; a++) free(s->region_plane[a]);
    free(s->region);
}

/* A ray among regions: the planes that end its region, and their times. */
struct leap {
    const double *plane[3];
    double next[3], start[3], inv[3], stop;
    ptrdiff_t step[3], stride[3];
    const uint8_t *region;
};

static inline double met(const struct leap *p, int a, double plane)
{
    return (plane - p->start[a]) * p->inv[a];
}

/* The index of the lane's next plane. */
static int64_t plane_of(const struct stream *s, int a, int lane)
{
    if (s->even) return (int64_t)s->lanes.number[a][lane];
    return s->lanes.plane[a][lane] - (s->v->plane[a] - s->v->plane[0]);
}

static struct leap leap_begin(const struct stream *s, int lane)
{
    const struct stream_lanes *l = &s->lanes;
    struct leap p = {.stop = l->stop[lane], .region = s->region};
    ptrdiff_t stride = 1;
    for (int a = 0; a < 3; a++) {
        const int64_t up = l->step[a][lane] > 0;
        const int64_t region = (plane_of(s, a, lane) - up) >> REGION_SHIFT;
        p.start[a] = l->start[a][lane];
        p.inv[a] = l->inv[a][lane];
        p.step[a] = l->step[a][lane];
        p.stride[a] = p.step[a] * stride;
        p.plane[a] = s->region_plane[a] + region + up;
        p.next[a] = met(&p, a, *p.plane[a]);
        p.region += region * stride;
        stride *= s->regions[a];
    }
    return p;
}

static inline double least(double a, double b) { return a < b ? a : b; }

static inline double region_end(const struct leap *p)
{
    return least(least(p->next[0], p->next[1]), p->next[2]);
}

/* Goes to the next region, at *t. False if the ray leaves the grid. No branch selects the axis,
 * because it would be unpredictable. */
static inline bool leap_on(struct leap *p, double *t)
{
    *t = region_end(p);
    if (!(*t < p->stop)) return false;
    for (int a = 0; a < 3; a++) {
        ptrdiff_t passes = p->next[a] <= *t;
        p->plane[a] += passes * p->step[a];
        p->region += passes * p->stride[a];
        p->next[a] = met(p, a, *p->plane[a]);
    }
    return true;
}

/* Brings the lane to time t, when the ray is in this region. */
static void leap_to(struct stream *s, int lane, const struct leap *p, double t)
{
    struct stream_lanes *l = &s->lanes;
    for (int a = 0; a < 3; a++) {
        const int64_t step = p->step[a], from = plane_of(s, a, lane), cells = s->v->cells[a];
        if (step == 0) continue;
        /* From the first plane in the region on. */
        int64_t region = p->plane[a] - s->region_plane[a] - (step > 0);
        int64_t begin = (region + (step < 0)) << REGION_SHIFT;
        int64_t i = (begin < cells ? begin : cells) + step;
        while (met(p, a, place(s, a, i)) <= t) i += step;
        l->next[a][lane] = met(p, a, place(s, a, i));
        if (!s->even) {
            l->prev[a][lane] = met(p, a, place(s, a, i - step));
            l->rate[a][lane] = 1 / (l->next[a][lane] - l->prev[a][lane]);
        }
        l->plane[a][lane] += i - from;
        l->number[a][lane] = (double)i;
        l->node[lane] += (i - from) * step * l->to_node[a][lane];
        l->passed[lane] += (i - from) * step;
    }
    l->t[lane] = t;
    stream_lane_end(l, lane);
}

/* Counts the cells until the end of the grid, if that may be the greatest number. */
static void count_rest(struct stream *s, int lane, const struct leap *p)
{
    int64_t most = s->lanes.passed[lane];
    for (int a = 0; a < 3; a++) {
        int64_t end = (p->plane[a] - s->region_plane[a]) << REGION_SHIFT;
        if (p->step[a] != 0) most += (end - plane_of(s, a, lane)) * p->step[a] + 1;
    }
    if (most > (int64_t)s->v->counts.most_cells) leap_to(s, lane, p, p->stop);
}

bool volume_leap(struct stream *s, int lane)
{
    double t = s->lanes.t[lane];
    if (!(t < s->lanes.stop[lane])) return false; /* it is past the last plane */
    struct leap p = leap_begin(s, lane);
    bool in = true;
    while (in && !(*p.region && region_end(&p) > t)) in = leap_on(&p, &t);
    if (!in) {
        if (t > s->lanes.t[lane]) count_rest(s, lane, &p);
        return false;
    }
    if (t > s->lanes.t[lane]) leap_to(s, lane, &p, t);
    while (in && *p.region) in = leap_on(&p, &t);
    s->lanes.exit[lane] = in ? t : p.stop;
    return true;
}
