/*
 * stream_begin: the entry of rays into the grid: walk_begin of walk.c for VD rays at a time, by the
 * same operations.
 */
#ifndef STORMRING_VOLUME_STREAM_BEGIN_H
#define STORMRING_VOLUME_STREAM_BEGIN_H

#include "volume/stream_span.h"

/* Directions through the middles of pixels. */
SIMD_INLINE void aim_at(struct aim *m, const struct camera *c, vd x, vd y)
{
    const double f[3] = {c->forward.x, c->forward.y, c->forward.z};
    const double r[3] = {c->right.x, c->right.y, c->right.z};
    const double u[3] = {c->up.x, c->up.y, c->up.z};
    const double w = c->w, h = c->h;
    vd sx = (2 * x - w) / h, sy = (h - 2 * y) / h, d[3];
    UNROLLED
    for (int a = 0; a < 3; a++) d[a] = (f[a] + r[a] * sx) + u[a] * sy;
    vd unit = 1 / vd_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        d[a] = d[a] * unit;
        m->up[a] = (vl)(d[a] > vd_set(WALK_LEVEL));
        m->down[a] = (vl)(d[a] < vd_set(-WALK_LEVEL));
        vl moves = m->up[a] | m->down[a];
        m->d[a] = vd_choose(moves, d[a], vd_set(0));
        m->inv[a] = vd_choose(moves, 1 / d[a], vd_set(0));
    }
}

/* As narrow of walk.c. */
SIMD_INLINE void narrow_aim(struct aim *m, const struct volume *v)
{
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vd low = vd_set(v->inside[a][0]), high = vd_set(v->inside[a][1]);
        vd in = (vd_choose(m->down[a], high, low) - m->at[a]) * m->inv[a];
        vd out = (vd_choose(m->down[a], low, high) - m->at[a]) * m->inv[a];
        vl moves = m->up[a] | m->down[a];
        m->enter = vd_choose(moves & (vl)(in > m->enter), in, m->enter);
        m->exit = vd_choose(moves & (vl)(out < m->exit), out, m->exit);
        m->hit &= moves | ((vl)(low <= m->at[a]) & (vl)(high >= m->at[a]));
    }
    m->hit &= (vl)(m->enter < m->exit);
}

/* Clips the rays to the whole grid, then to where they are seen. */
SIMD_INLINE void clip_aim(struct aim *m, const struct volume *v)
{
    const double eye[3] = {v->camera.eye.x, v->camera.eye.y, v->camera.eye.z};
    vd far = vd_set(HUGE_VAL);
    m->near = vd_set(0);
    m->hit = ~(vl){0};
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vd low = vd_set(v->whole[a][0]), high = vd_set(v->whole[a][1]);
        m->in[a] = vd_choose(m->down[a], high, low);
        m->out[a] = vd_choose(m->down[a], low, high);
        vl moves = m->up[a] | m->down[a];
        vl inside = (vl)(low <= eye[a]) & (vl)(high >= eye[a]);
        vd near = (m->in[a] - eye[a]) * m->inv[a], away = (m->out[a] - eye[a]) * m->inv[a];
        m->near = vd_choose(moves & (vl)(near > m->near), near, m->near);
        far = vd_choose(moves & (vl)(away < far), away, far);
        m->hit &= moves | inside;
    }
    m->hit &= (vl)(m->near < far);
    m->exit = vd_set(HUGE_VAL);
    UNROLLED
    for (int a = 0; a < 3; a++) {
        vd low = vd_set(v->whole[a][0]), high = vd_set(v->whole[a][1]);
        vd at = eye[a] + m->near * m->d[a], near = (m->in[a] - eye[a]) * m->inv[a];
        vl entry = (vl)(m->near > vd_set(0)) & (vl)(m->near == near);
        at = vd_choose(entry, m->in[a], at);
        m->at[a] = at = vd_min(vd_max(at, low), high);
        vd exit = vd_choose(m->up[a] | m->down[a], (m->out[a] - at) * m->inv[a], vd_set(HUGE_VAL));
        m->exit = vd_min(m->exit, exit);
    }
    m->enter = vd_set(0);
    if (v->narrowed) narrow_aim(m, v);
}

/* Starts at the cells of the previous rays; the new cells are mostly these or neighbours. */
#define TRIES 3

/* True if the ray is already past cell i at its entry. */
SIMD_INLINE vl is_left(const struct aim *m, const double *plane, int a, vl i)
{
    vd p = vd_gather(plane + 1, i), met = (p - m->at[a]) * m->inv[a];
    vl still = ~(m->up[a] | m->down[a]);
    return (m->up[a] & (vl)(met <= m->enter)) | (m->down[a] & (vl)(met > m->enter)) |
           (still & (vl)(p <= m->at[a]));
}

/* The same as first_cell of walk.c. */
SIMD_INLINE vl find_cell(const struct aim *m, const struct volume *v, int a, int64_t *guess)
{
    const double *plane = v->plane[a];
    const vl last = (vl){0} + (int64_t)(v->cells[a] - 1);
    vl lo = vl_load(guess);
    for (int i = 0; i < TRIES; i++) {
        vl up = is_left(m, plane, a, lo) & (lo < last);
        vl down = ~is_left(m, plane, a, lo - 1) & (lo > 0);
        if (!vl_signs(up | down)) {
            vl_store(guess, lo);
            return lo;
        }
        lo += (down & ~up) - up;
    }
    vl hi = last;
    lo = (vl){0};
    for (uint32_t n = v->cells[a]; n > 1; n = (n + 1) / 2) {
        vl middle = (lo + hi) >> 1, open = lo < hi;
        vl left = is_left(m, plane, a, middle);
        lo = vl_choose(open & left, middle + 1, lo);
        hi = vl_choose(open & ~left, middle, hi);
    }
    vl_store(guess, lo);
    return lo;
}

/* The same on an even grid, for a ray that begins at plane `at`. Near an inner plane rounding may
 * choose the neighbour, in which a ray within the face would stay: then the cell is looked up. */
#define NEAR_PLANE 0x1p-20
SIMD_INLINE vl even_cell(const struct aim *m, const struct volume *v, int a, vd at, int64_t *guess)
{
    const vl last = (vl){0} + (int64_t)(v->cells[a] - 1);
    vl cell = __builtin_convertvector(at, vl);
    cell = vl_choose(cell > last, last, vl_choose(cell < 0, (vl){0}, cell));
    vd into = at - __builtin_convertvector(cell, vd);
    const vl below = (vl)(into < vd_set(NEAR_PLANE)), above = (vl)(into > vd_set(1 - NEAR_PLANE));
    if (!vl_signs((below & (cell > 0)) | (above & (cell < last)))) return cell;
    vl_store(guess, cell);
    return find_cell(m, v, a, guess);
}

static struct start start_uneven(
    struct stream_starts *s, const struct aim *m, const struct volume *v, int a)
{
    const double *plane = v->plane[a];
    const vl cell = find_cell(m, v, a, s->guess[a]), moves = m->up[a] | m->down[a];
    struct start r = {.cell = cell, .step = m->down[a] - m->up[a], .plane = cell - m->up[a]};
    r.start = vd_choose(moves, m->at[a], vd_set(-HUGE_VAL));
    r.inv = vd_choose(moves, m->inv[a], vd_set(1));
    r.next = (vd_gather(plane, r.plane) - r.start) * r.inv;
    r.prev = (vd_gather(plane, r.plane - r.step) - r.start) * r.inv;
    r.rate = 1 / (r.next - r.prev);
    r.per_edge = vd_gather(v->inv_edge[a], cell);
    r.still = (m->at[a] - vd_gather(plane, cell)) * r.per_edge;
    r.plane += plane - v->plane[0];
    return r;
}

/* With s->fast, a ray that crosses less than this part of a cell on an axis, on its whole way
 * through the grid, is taken as parallel to the planes of that axis. */
#define SLOW 0x1p-24
static void stop_slow(struct aim *m, const struct volume *v, int a, double edge)
{
    double square = 0;
    for (int b = 0; b < 3; b++) {
        double side = v->plane[b][v->cells[b]] - v->plane[b][0];
        square += side * side;
    }
    vl moves = (vl)(vd_abs(m->d[a]) * sqrt(square) > vd_set(SLOW * edge));
    m->up[a] &= moves, m->down[a] &= moves;
}

/* On an even grid, planes are where their numbers are. Ends the ray where it meets the last one. */
SIMD_INLINE struct start start_even(
    struct stream_starts *s, struct aim *m, const struct volume *v, int a, bool fast)
{
    const double *plane = v->plane[a], edge = (plane[v->cells[a]] - plane[0]) / v->cells[a];
    const vd at = (m->at[a] - plane[0]) / edge, zero = vd_set(0);
    const vl cell =
        v->narrowed ? find_cell(m, v, a, s->guess[a]) : even_cell(m, v, a, at, s->guess[a]);
    if (fast) stop_slow(m, v, a, edge);
    const vl moves = m->up[a] | m->down[a];
    struct start r = {.cell = cell, .step = m->down[a] - m->up[a], .plane = cell - m->up[a]};
    r.start = vd_choose(moves, at, vd_set(fast ? -FAST_FAR : -FAR));
    r.inv = vd_choose(moves, m->inv[a] * edge, vd_set(1));
    if (fast) r.start = vd_rounded(r.start), r.inv = vd_rounded(r.inv);
    r.next = met_at(__builtin_convertvector(r.plane, vd), r.start, r.inv, fast);
    r.prev = zero;
    r.rate = vd_abs(m->d[a]) / edge;
    r.per_edge = vd_set(v->inv_edge[a][0]);
    r.still = at - __builtin_convertvector(cell, vd);
    vd last = vd_choose(m->up[a], vd_set(v->cells[a]), zero);
    m->exit = vd_min(m->exit, met_at(last, r.start, r.inv, fast));
    return r;
}

/* Writes the starts from index i on. Returns the cell's offset on this axis. */
SIMD_INLINE vl put_start_axis(struct stream_starts *s, uint32_t i, const struct aim *m,
    const struct start *r, int a, int64_t stride)
{
    const vl turned = (vl){0} - (stride < 0), rises = m->up[a] ^ turned;
    const vl moves = m->up[a] | m->down[a];
    const vd base = vd_choose(turned, 1 - r->still, r->still), zero = vd_set(0), one = vd_set(1);
    vd_store(s->start[a] + i, r->start);
    vd_store(s->inv[a] + i, r->inv);
    vd_store(s->next[a] + i, r->next);
    vd_store(s->prev[a] + i, vd_choose(moves, r->prev, zero));
    vd_store(s->rate[a] + i, vd_choose(moves, r->rate, zero));
    vd_store(s->base[a] + i, vd_choose(moves, vd_choose(rises, zero, one), base));
    vd_store(s->sign[a] + i, vd_choose(moves, vd_choose(rises, one, -one), zero));
    vl_store(s->plane[a] + i, r->plane);
    vl_store(s->step[a] + i, r->step);
    vl_store(s->to_node[a] + i, r->step * stride);
    vd_store(s->still[a] + i, vd_choose(moves, zero, r->per_edge));
    return r->cell * stride;
}

/* What s->wide needs of the ray of starts i + k, which is `lane` k of the aim. */
static void keep_ray(struct stream *s, uint32_t i, uint32_t k, const struct aim *m)
{
    struct stream_ray *r = &s->ray[s->starts.ray + i + k];
    r->before = m->near[k];
    r->last = -1;
    for (int a = 0; a < 3; a++) {
        double mirror = s->v->stride[a] < 0 ? -1 : 1;
        r->o[a] = m->at[a][k];
        r->d[a] = m->d[a][k];
        r->light[a] = (s->v->spec->light[a] - r->o[a]) * mirror;
        r->dir[a] = r->d[a] * mirror;
        r->still[a] = s->starts.still[a][i + k];
    }
}

/* Ends rays at the ground: n of them from start i on. */
static void meet_ground(struct stream *s, uint32_t i, uint32_t n, struct aim *m)
{
    for (uint32_t k = 0; k < VD && k < n; k++) {
        const struct vec3 d = v3(m->d[0][k], m->d[1][k], m->d[2][k]);
        struct meeting *g = &s->ground[s->starts.ray + i + k];
        *g = ground_meet(s->v->ground, s->v->spec, d);
        if (g->is && g->t - m->near[k] < m->exit[k]) m->exit[k] = g->t - m->near[k];
    }
    m->hit &= (vl)(m->enter < m->exit);
}

/* Sets up the rays of the next pixels. `hit` marks those that hit the grid. */
static void begin(struct stream *s)
{
    struct volume *v = s->v;
    struct stream_starts *t = &s->starts;
    t->ray = s->taken;
    t->hit = 0;
    uint32_t n = s->n - s->taken < STREAM_STARTS ? s->n - s->taken : STREAM_STARTS;
    for (uint32_t i = 0; i < n; i += VD) {
        struct aim m;
        vd x, y;
        for (uint32_t k = 0; k < VD; k++) {
            uint32_t at = s->taken + (i + k < n ? i + k : i);
            uint64_t p = lattice_pixel(s->pixels, v->camera.w, s->n0 + at);
            x[k] = (double)(p % v->camera.w) + 0.5;
            y[k] = (double)(p / v->camera.w) + 0.5;
        }
        aim_at(&m, &v->camera, x, y);
        clip_aim(&m, v);
        if (s->ground) meet_ground(s, i, n - i, &m);
        t->hit |= (uint64_t)vl_signs(m.hit) << i;
        vd_store(t->enter + i, m.enter);
        vl node = (vl){0} + (int64_t)v->origin;
        if (s->fast) m.exit = vd_set(HUGE_VAL); /* the time of a plane, as the walk has it */
        struct start r[3];
        UNROLLED
        for (int a = 0; a < 3; a++) {
            r[a] = s->fast   ? start_even(t, &m, v, a, true)
                   : s->even ? start_even(t, &m, v, a, false)
                             : start_uneven(t, &m, v, a);
            node += put_start_axis(t, i, &m, &r[a], a, v->stride[a]);
        }
        if (s->leaps) find_spans(s, t->ray + i, n - i, &m, r);
        vd_store(t->exit + i, m.exit);
        vl_store(t->node + i, node);
        for (uint32_t k = 0; s->wide && k < VD && i + k < n; k++) keep_ray(s, i, k, &m);
    }
    if (n < 64) t->hit &= ((uint64_t)1 << n) - 1;
    s->taken += n;
    v->counts.rays += n;
    v->counts.hits += (uint64_t)__builtin_popcountll(t->hit);
}

#endif
