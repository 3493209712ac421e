/* stream_lane: gives lanes their rays. */
#ifndef STORMRING_VOLUME_STREAM_LANE_H
#define STORMRING_VOLUME_STREAM_LANE_H

#include "volume/stream_begin.h"

static void park(struct stream *s, int lane)
{
    struct stream_lanes *l = &s->lanes;
    l->t[lane] = 0;
    l->exit[lane] = -1;
    l->node[lane] = 0;
    for (int a = 0; a < 3; a++) {
        l->next[a][lane] = HUGE_VAL;
        l->prev[a][lane] = l->rate[a][lane] = 0;
        l->start[a][lane] = -HUGE_VAL;
        l->inv[a][lane] = 1;
        l->plane[a][lane] = l->step[a][lane] = l->to_node[a][lane] = 0;
        l->number[a][lane] = l->way[a][lane] = 0;
    }
    l->byte[lane] = l->beyond[lane] = 0;
    l->end[lane] = 0;
}

static void put_axis(struct stream_lanes *l, int lane, const struct stream_starts *t, int i, int a)
{
    l->next[a][lane] = t->next[a][i];
    l->prev[a][lane] = t->prev[a][i];
    l->rate[a][lane] = t->rate[a][i];
    l->start[a][lane] = t->start[a][i];
    l->inv[a][lane] = t->inv[a][i];
    l->plane[a][lane] = t->plane[a][i];
    l->step[a][lane] = t->step[a][i];
    l->number[a][lane] = (double)t->plane[a][i];
    l->way[a][lane] = (double)t->step[a][i];
    l->to_node[a][lane] = t->to_node[a][i];
    l->base[a][lane] = (float)t->base[a][i];
    l->sign[a][lane] = (float)t->sign[a][i];
}

static void put_wide(struct stream_lanes *l, int lane, const struct stream_ray *r)
{
    l->before[lane] = r->before;
    for (int a = 0; a < 3; a++) {
        l->still[a][lane] = r->still[a];
        l->light[a][lane] = r->light[a];
        l->dir[a][lane] = r->dir[a];
    }
}

/* ---- the same in float (stream_fast.h) */

static void park_fast(struct stream *s, int lane)
{
    struct stream_fast *q = &s->quick;
    q->t[lane] = 0;
    q->exit[lane] = -1;
    q->node[lane] = q->passed[lane] = 0;
    for (int a = 0; a < 3; a++) {
        q->start[a][lane] = -(float)FAST_FAR, q->inv[a][lane] = 1;
        q->next[a][lane] = (float)FAST_FAR;
        q->number[a][lane] = q->way[a][lane] = q->base[a][lane] = q->rate[a][lane] = 0;
        q->to_node[a][lane] = 0;
    }
    stream_fast_end(q, lane);
}

/* Gives the lane the ray of start i. */
static void put_fast(struct stream *s, int lane, int i)
{
    const struct stream_starts *t = &s->starts;
    struct stream_fast *q = &s->quick;
    q->t[lane] = 0;
    q->exit[lane] = q->stop[lane] = (float)t->exit[i];
    q->node[lane] = (int32_t)t->node[i];
    q->passed[lane] = 0;
    UNROLLED
    for (int a = 0; a < 3; a++) {
        q->next[a][lane] = (float)t->next[a][i];
        q->number[a][lane] = (float)t->plane[a][i];
        q->way[a][lane] = (float)t->step[a][i];
        q->start[a][lane] = (float)t->start[a][i];
        q->inv[a][lane] = (float)t->inv[a][i];
        q->base[a][lane] = (float)(t->base[a][i] + t->sign[a][i]);
        q->rate[a][lane] = (float)(t->rate[a][i] * t->sign[a][i]);
        q->to_node[a][lane] = (int32_t)t->to_node[a][i];
    }
    stream_fast_end(q, lane);
}

/* Gives the lane the next pixel whose ray hits the grid. False if there is none. */
static bool put_start(struct stream *s, int lane)
{
    struct stream_lanes *l = &s->lanes;
    struct stream_starts *t = &s->starts;
    while (!t->hit && s->taken < s->n) begin(s);
    if (!t->hit) return false;
    int i = __builtin_ctzll(t->hit);
    t->hit &= t->hit - 1;
    l->ray[lane] = (int32_t)t->ray + i;
    if (s->fast) {
        put_fast(s, lane, i);
        return true;
    }
    l->t[lane] = t->enter[i];
    l->exit[lane] = l->stop[lane] = t->exit[i];
    l->node[lane] = t->node[i];
    l->passed[lane] = 0;
    UNROLLED
    for (int a = 0; a < 3; a++) put_axis(l, lane, t, i, a);
    stream_lane_end(l, lane);
    if (s->wide) put_wide(l, lane, &s->ray[l->ray[lane]]);
    return true;
}

static void take_ray(struct stream *s, int lane)
{
    struct volume_counts *c = &s->v->counts;
    uint32_t passed = (uint32_t)(s->fast ? s->quick.passed[lane] : s->lanes.passed[lane]);
    if (passed > c->most_cells) c->most_cells = passed;
}

/* Gives the lane the next ray that meets a live region, or parks it. */
static void put_ray(struct stream *s, int lane)
{
    while (put_start(s, lane)) {
        if (!s->leaps || volume_leap(s, lane)) return;
        take_ray(s, lane);
    }
    if (s->fast) park_fast(s, lane);
    else park(s, lane);
    s->parked |= 1u << lane;
}

#endif
