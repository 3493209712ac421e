/*
 * stream_cut: cells of the list that need more than one step. They are cut where the field crosses
 * knots of the map, as in piece.c. Pieces that miss the tolerance are divided into ever finer
 * parts.
 */
#ifndef STORMRING_VOLUME_STREAM_CUT_H
#define STORMRING_VOLUME_STREAM_CUT_H

#include "volume/stream_cell.h"

#define ROOT_STEPS 5      /* Newton steps */
#define ROOT_LAST 0x1p-10 /* largest last step: its square is 0 in float. Else: cell done alone */
#define PARTS_MIN 8       /* parts of a piece */
#define PARTS_MAX 4096

SIMD_INLINE vf at_v(const vf p[4], vf w) { return p[0] + w * (p[1] + w * (p[2] + w * p[3])); }
static inline float at(const float p[4], float w)
{
    return p[0] + w * (p[1] + w * (p[2] + w * p[3]));
}

/* ---- where ---------------------------------------------------------------------------------- */

/* True if p is certainly monotone on 0 .. 1: the control points of its derivative have one sign. */
static bool is_monotone(const float p[4])
{
    float a = p[1], b = a + p[2], c = b + p[2] + 3 * p[3];
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/* The ends and turning points of p on 0 .. 1. Returns their count. */
static int turns(const float p[4], float w[4])
{
    double wide[4], q[4] = {(double)p[0], (double)p[1], (double)p[2], (double)p[3]};
    w[0] = 0, w[1] = 1;
    if (is_monotone(p)) return 2;
    int n = cubic_monotone(q, wide);
    for (int i = 0; i < n; i++) w[i] = (float)wide[i];
    return n;
}

static void put_root(struct stream *s, const float p[4], float a, float b, float y, int32_t entry)
{
    struct stream_roots *r = &s->roots;
    uint32_t n = r->n++;
    for (int i = 0; i < 4; i++) r->p[i][n] = p[i];
    r->a[n] = a, r->b[n] = b, r->y[n] = y;
    r->entry[n] = entry;
}

/* Queues the roots of cell j. Returns their number, or STREAM_PIECES if there are too many. */
static uint32_t ask_roots(struct stream *s, uint32_t j)
{
    const struct stream_map *m = &s->map;
    const float p[4] = {s->p[0][j], s->p[1][j], s->p[2][j], s->p[3][j]}, base = s->base[j];
    const int32_t first = s->first[j], last = s->last[j];
    const uint32_t before = s->roots.n;
    float w[4];
    int n = first == last ? 0 : turns(p, w);
    s->entry[j] = first;
    for (int32_t e = first; e < last; e++)
        s->entry[j] += !(p[0] < (m->edge_high[e] - base) + m->edge_low[e]);
    for (int k = 1; k < n; k++) {
        float from = at(p, w[k - 1]), to = at(p, w[k]);
        bool up = from < to;
        for (int32_t i = first; i < last; i++) {
            int32_t e = up ? i : first + last - 1 - i;
            float y = (m->edge_high[e] - base) + m->edge_low[e];
            if ((from < y) == (to < y)) continue;
            if (s->roots.n - before == STREAM_PIECES - 1) return STREAM_PIECES;
            put_root(s, p, w[k - 1], w[k], y, up ? e + 1 : e);
        }
    }
    return s->roots.n - before;
}

/* Newton steps within a bracket; bisects if a step leaves it. */
static void find_roots(struct stream_roots *r)
{
    for (uint32_t j = 0; j < r->n; j += VF) {
        const vf p[4] = {
            vf_load(r->p[0] + j), vf_load(r->p[1] + j), vf_load(r->p[2] + j), vf_load(r->p[3] + j)};
        vf a = vf_load(r->a + j), b = vf_load(r->b + j), y = vf_load(r->y + j);
        vf fa = at_v(p, a) - y, fb = at_v(p, b) - y;
        vf w = vf_min(vf_max(a + (b - a) * (fa / (fa - fb)), a), b), step = w;
        vi below = fa < vf_set(0);
        for (int i = 0; i < ROOT_STEPS; i++) {
            vf f = at_v(p, w) - y, d = p[1] + w * (2 * p[2] + w * 3 * p[3]);
            vi side = (f < vf_set(0)) == below;
            a = vf_choose(side, w, a);
            b = vf_choose(side, b, w);
            vf next = w - f / d;
            next = vf_choose((next >= a) & (next <= b), next, (a + b) * 0.5f);
            step = vf_abs(next - w);
            w = next;
        }
        vf_store(r->w + j, w);
        vi_store(r->good + j, step <= vf_set(ROOT_LAST));
    }
}

/* ---- pieces --------------------------------------------------------------------------------- */

static void put_piece(struct stream *s, uint32_t j, float a, float b, int32_t entry)
{
    struct stream_pieces *q = &s->pieces;
    if (!(a < b) || s->map.transparent[entry]) return;
    uint32_t n = q->n++;
    for (int i = 0; i < 4; i++) q->p[i][n] = s->p[i][j];
    q->base[n] = s->base[j];
    q->len[n] = s->len[j];
    q->a[n] = a, q->b[n] = b;
    q->entry[n] = entry;
}

/* Queues the pieces between roots `from` and `to`. False if a root was not found. */
static bool put_pieces(struct stream *s, uint32_t j, uint32_t from, uint32_t to)
{
    const struct stream_roots *r = &s->roots;
    int32_t entry = s->entry[j];
    float a = 0;
    for (uint32_t i = from; i < to; i++)
        if (!r->good[i]) return false;
    for (uint32_t i = from; i < to; i++) {
        put_piece(s, j, a, r->w[i], entry);
        a = r->w[i];
        entry = r->entry[i];
    }
    put_piece(s, j, a, 1, entry);
    return true;
}

/* Integrates part a .. b of p, a segment of length len. */
SIMD_INLINE struct added part(
    const struct stream_map *m, bool few, vi entry, vf base, const vf p[4], vf a, vf b, vf len)
{
    vf h = b - a, bend = p[2] + 3 * a * p[3];
    const vf q[4] = {at_v(p, a), h * (p[1] + a * (p[2] + bend)), h * h * bend, h * h * h * p[3]};
    return integrate_segment(m, few, entry, base, q, h * len);
}

SIMD_INLINE void integrate_pieces(struct stream *s, bool few)
{
    struct stream_pieces *q = &s->pieces;
    for (uint32_t j = q->n; j % VF; j++) q->entry[j] = 0;
    for (uint32_t j = 0; j < q->n; j += VF) {
        const vf p[4] = {
            vf_load(q->p[0] + j), vf_load(q->p[1] + j), vf_load(q->p[2] + j), vf_load(q->p[3] + j)};
        struct added r = part(&s->map, few, vi_load(q->entry + j), vf_load(q->base + j), p,
            vf_load(q->a + j), vf_load(q->b + j), vf_load(q->len + j));
        put_added(q->add + j, &r);
        vf_store(q->error + j, r.error);
    }
}

/* Adds the contribution of a segment to a ray's rgb and alpha. */
SIMD_INLINE void add_to(double sum[4], const float add[4])
{
#if SIMD_BYTES >= 32
    __m256d seen = (1 - sum[3]) * _mm256_cvtps_pd(_mm_loadu_ps(add));
    _mm256_storeu_pd(sum, _mm256_loadu_pd(sum) + seen);
#else
    double transmittance = 1 - sum[3];
    for (int c = 0; c < 4; c++) sum[c] += transmittance * (double)add[c];
#endif
}

/* Sums the pieces of cell j, unless one needs refinement. */
static void put_whole(struct stream *s, uint32_t j)
{
    const struct stream_pieces *q = &s->pieces;
    double sum[4] = {0};
    for (uint32_t i = s->piece[j]; i < s->piece_end[j]; i++) {
        if (!(q->error[i] <= s->tolerance)) return;
        add_to(sum, q->add[i]);
    }
    for (int c = 0; c < 4; c++) s->add[j][c] = (float)sum[c];
    s->whole[j] = (uint8_t)(1 + s->piece_end[j] - s->piece[j]);
}

/* Cuts all cells of the list that are not simple. */
static void cut(struct stream *s)
{
    uint32_t root[STREAM_ROOM], todo[STREAM_ROOM], n = 0;
    s->roots.n = s->pieces.n = 0;
    for (uint32_t g = 0; g < s->cells; g += VF)
        for (unsigned m = ~s->simple[g / VF] & ALL_LANES; m; m &= m - 1) {
            uint32_t j = g + (uint32_t)__builtin_ctz(m);
            if (j >= s->cells) break;
            root[n] = s->roots.n;
            s->piece[j] = ask_roots(s, j) == STREAM_PIECES ? STREAM_ALONE : 0;
            todo[n++] = j;
        }
    root[n] = s->roots.n;
    find_roots(&s->roots);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = todo[i], first = s->pieces.n;
        bool good = s->piece[j] != STREAM_ALONE && put_pieces(s, j, root[i], root[i + 1]);
        s->piece[j] = good ? first : STREAM_ALONE;
        s->piece_end[j] = s->pieces.n;
    }
    if (s->map.entries <= 8) integrate_pieces(s, true);
    else integrate_pieces(s, false);
    memset(s->whole, 2, s->cells);
    for (uint32_t i = 0; i < n; i++) {
        s->whole[todo[i]] = 0;
        if (s->piece[todo[i]] != STREAM_ALONE) put_whole(s, todo[i]);
    }
}

/* ---- parts ---------------------------------------------------------------------------------- */

/* Integrates in n parts. False if n is too small; sum is then invalid. */
static bool add_parts(struct stream *s, uint32_t j, int n, double sum[4])
{
    const struct stream_pieces *q = &s->pieces;
    const vf p[4] = {
        vf_set(q->p[0][j]), vf_set(q->p[1][j]), vf_set(q->p[2][j]), vf_set(q->p[3][j])};
    const float a = q->a[j], step = (q->b[j] - a) / (float)n;
    const double limit = s->v->spec->opacity_limit;
    vf count;
    for (int i = 0; i < VF; i++) count[i] = (float)i;
    for (int i = 0; i < n; i += VF, count += VF) {
        float add[VF][4];
        struct added x = part(&s->map, s->map.entries <= 8, vi_set(q->entry[j]), vf_set(q->base[j]),
            p, a + count * step, a + (count + 1) * step, vf_set(q->len[j]));
        unsigned good = vi_signs(x.error <= vf_set(s->tolerance));
        put_added(add, &x);
        for (int k = 0; k < VF && i + k < n && sum[3] < limit; k++) {
            if (!(good >> k & 1) && n < PARTS_MAX) return false;
            add_to(sum, add[k]);
            s->v->counts.samples++;
        }
    }
    return true;
}

static void add_piece(struct stream *s, uint32_t j, double sum[4])
{
    if (s->pieces.error[j] <= s->tolerance) {
        add_to(sum, s->pieces.add[j]);
        s->v->counts.samples++;
        return;
    }
    double before[4];
    memcpy(before, sum, sizeof before);
    int n = PARTS_MIN;
    while (n < PARTS_MAX && s->pieces.error[j] > s->tolerance * (float)(n * n)) n *= 2;
    for (; !add_parts(s, j, n, sum); n *= 2) memcpy(sum, before, sizeof before);
}

#endif
