/*
 * leap: rays of the stream leap over empty regions. Regions are cubes of cells. stream_span.h finds
 * the spans of each ray in regions with live cells. Planes of regions are planes of cells, and the
 * time at a plane depends on nothing but the plane. So a ray that has leapt is exactly where single
 * steps would have brought it.
 */
#include "volume/stream.h"

#include <stdlib.h>

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
    size_t planes = 0;
    for (int a = 0; a < 3; a++) {
        s->regions[a] = ((v->cells[a] - 1) >> REGION_SHIFT) + 1;
        planes += (size_t)s->regions[a] + 1;
        n *= s->regions[a];
    }
    double *plane = s->region_plane = xcalloc(planes, sizeof *plane);
    for (int a = 0; a < 3; a++) {
        for (int64_t i = 0; i < s->regions[a]; i++) *plane++ = place(s, a, i << REGION_SHIFT);
        *plane++ = place(s, a, v->cells[a]);
    }
    s->region = xcalloc((size_t)n, sizeof *s->region);
    for (uint32_t z = 0, i = 0; z < v->blocks[2]; z++)
        for (uint32_t y = 0; y < v->blocks[1]; y++)
            for (uint32_t x = 0; x < v->blocks[0]; x++, i++)
                if (v->block[i])
                    s->region[((z >> shift) * s->regions[1] + (y >> shift)) * s->regions[0] +
                              (x >> shift)] = 1;
    for (int64_t i = 0; i < n; i++) live += s->region[i] > 0;
    s->leaps = (n - live) * EMPTY_LEAST >= n;
}

void volume_leap_free(struct stream *s)
{
    free(s->region_plane);
    free(s->region);
}

/* A ray on an axis, as its lane has it. */
struct on_axis {
    int64_t plane, step; /* the index of the next plane */
    double start, inv;
};

static struct on_axis on_axis(const struct stream *s, int a, int lane)
{
    const struct stream_lanes *l = &s->lanes;
    const struct stream_fast *q = &s->quick;
    if (s->fast)
        return (struct on_axis){(int64_t)q->number[a][lane], (int64_t)q->way[a][lane],
            (double)q->start[a][lane], (double)q->inv[a][lane]};
    int64_t plane = s->even ? (int64_t)l->number[a][lane]
                            : l->plane[a][lane] - (s->v->plane[a] - s->v->plane[0]);
    return (struct on_axis){plane, l->step[a][lane], l->start[a][lane], l->inv[a][lane]};
}

/* When plane i is met: the same bits as in the walk. */
static double met(const struct stream *s, const struct on_axis *x, int a, int64_t i)
{
    const double way = place(s, a, i) - x->start;
    return s->fast ? (double)(float)((double)(float)way * x->inv) : way * x->inv;
}

/* The first plane that is met after time t, which may be one past the grid. */
static int64_t plane_after(const struct stream *s, const struct on_axis *x, int a, double t)
{
    int64_t low = 0, high = (x->step > 0 ? s->v->cells[a] - x->plane : x->plane) + 1;
    if (s->even) {
        low = ((int64_t)(x->start + t / x->inv) - x->plane) * x->step;
        while (met(s, x, a, x->plane + (low - 1) * x->step) > t) low--;
        while (met(s, x, a, x->plane + low * x->step) <= t) low++;
        return x->plane + low * x->step;
    }
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (met(s, x, a, x->plane + middle * x->step) <= t) low = middle + 1;
        else high = middle;
    }
    return x->plane + low * x->step;
}

/* Brings the lane to time t. */
static void leap_to(struct stream *s, int lane, double t)
{
    struct stream_lanes *l = &s->lanes;
    struct stream_fast *q = &s->quick;
    for (int a = 0; a < 3; a++) {
        const struct on_axis x = on_axis(s, a, lane);
        if (x.step == 0) continue;
        const int64_t i = plane_after(s, &x, a, t), passed = (i - x.plane) * x.step;
        if (s->fast) {
            q->next[a][lane] = (float)met(s, &x, a, i);
            q->number[a][lane] = (float)i;
            q->node[lane] += (int32_t)passed * q->to_node[a][lane];
            q->passed[lane] += (int32_t)passed;
            continue;
        }
        l->next[a][lane] = met(s, &x, a, i);
        if (!s->even) {
            l->prev[a][lane] = met(s, &x, a, i - x.step);
            l->rate[a][lane] = 1 / (l->next[a][lane] - l->prev[a][lane]);
        }
        l->plane[a][lane] += i - x.plane;
        l->number[a][lane] = (double)i;
        l->node[lane] += passed * l->to_node[a][lane];
        l->passed[lane] += passed;
    }
    if (s->fast) {
        q->t[lane] = (float)t;
        stream_fast_end(q, lane);
    } else {
        l->t[lane] = t;
        stream_lane_end(l, lane);
    }
}

bool volume_leap(struct stream *s, int lane)
{
    struct stream_spans *of = &s->spans[s->lanes.ray[lane]];
    const double t = s->fast ? (double)s->quick.t[lane] : s->lanes.t[lane];
    const double stop = s->fast ? (double)s->quick.stop[lane] : s->lanes.stop[lane];
    if (of->taken == of->n) {
        /* The cells until the end of the grid count, if they may make the greatest number. */
        if (t < stop && of->most > (int64_t)s->v->counts.most_cells) leap_to(s, lane, stop);
        return false;
    }
    const double begin = of->begin[of->taken], end = of->end[of->taken];
    of->taken++;
    if (begin > t) leap_to(s, lane, begin);
    if (s->fast) s->quick.exit[lane] = (float)end;
    else s->lanes.exit[lane] = end;
    return true;
}
