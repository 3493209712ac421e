/*
 * stream_cut: cells of the list that need more than one step. They are cut where the field crosses
 * knots of the map, as in piece.c. Pieces that miss the tolerance are divided into ever finer
 * parts.
 */
#ifndef STORMRING_VOLUME_STREAM_CUT_H
#define STORMRING_VOLUME_STREAM_CUT_H

#include "volume/stream_list.h"

#define ROOT_STEPS 5      /* Newton steps */
#define ROOT_LAST 0x1p-10 /* largest last step: its square is 0 in float. Else: cell done alone */
#define PARTS_MIN 8       /* parts of a piece */
#define PARTS_MAX 4096
#define SAME_ENTRY (-1) /* of a root at which the light's factor has a kink */

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

/* Queues the roots of g.l in cell j. False if there are too many. */
static bool ask_kinks(struct stream *s, uint32_t j, uint32_t before)
{
    const float h[4] = {s->light[0][j], s->light[1][j], s->light[2][j], s->light[3][j]};
    float w[4];
    int n = turns(h, w);
    for (int k = 1; k < n; k++) {
        if ((at(h, w[k - 1]) < 0) == (at(h, w[k]) < 0)) continue;
        if (s->roots.n - before == STREAM_PIECES - 1) return false;
        put_root(s, h, w[k - 1], w[k], 0, SAME_ENTRY);
    }
    return true;
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
    if (s->v->spec->lit && !ask_kinks(s, j, before)) return STREAM_PIECES;
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
    q->cell[n] = (int32_t)j;
}

/* The number of equal parts that a piece of cell j is cut into because of its turn. */
static uint32_t parts_of(const struct stream *s, uint32_t j, uint32_t pieces)
{
    uint32_t n = pieces == 1 ? 2 : 1;
    if (!s->shines) return 1;
    while ((float)n < s->turn[j] && n < STREAM_PIECES) n *= 2;
    while (n > 1 && n * pieces > STREAM_PIECES) n /= 2;
    return n;
}

static void put_parts(struct stream *s, uint32_t j, float a, float b, int32_t entry, uint32_t n)
{
    float step = (b - a) / (float)n;
    for (uint32_t i = 0; i < n; i++)
        put_piece(s, j, a + step * (float)i, i + 1 < n ? a + step * (float)(i + 1) : b, entry);
}

/* Queues the pieces between the n roots from index `from` on. False if a root was not found. */
static bool put_pieces(struct stream *s, uint32_t j, uint32_t from, uint32_t n)
{
    const struct stream_roots *r = &s->roots;
    const uint32_t parts = parts_of(s, j, n + 1);
    uint32_t order[STREAM_PIECES];
    int32_t entry = s->entry[j];
    float a = 0;
    for (uint32_t i = 0, k; i < n; i++) { /* kinks come after the knots */
        if (!r->good[from + i]) return false;
        for (k = i; k > 0 && r->w[order[k - 1]] > r->w[from + i]; k--) order[k] = order[k - 1];
        order[k] = from + i;
    }
    for (uint32_t i = 0; i < n; i++) {
        put_parts(s, j, a, r->w[order[i]], entry, parts);
        a = r->w[order[i]];
        if (r->entry[order[i]] != SAME_ENTRY) entry = r->entry[order[i]];
    }
    put_parts(s, j, a, 1, entry, parts);
    return true;
}

/* The part a .. b of p. */
SIMD_INLINE void part_of(const vf p[4], vf a, vf b, vf q[4])
{
    vf h = b - a, bend = p[2] + 3 * a * p[3];
    q[0] = at_v(p, a), q[1] = h * (p[1] + a * (p[2] + bend)), q[2] = h * h * bend;
    q[3] = h * h * h * p[3];
}

/* Integrates part a .. b of p, a segment of length len. */
SIMD_INLINE struct added part(
    const struct stream_map *m, bool few, vi entry, vf base, const vf p[4], vf a, vf b, vf len)
{
    vf q[4];
    part_of(p, a, b, q);
    return integrate_segment(m, few, entry, base, q, (b - a) * len);
}

/* The same with light and attenuation, in cells `cell` of the list. */
SIMD_INLINE struct added lit_part(
    const struct stream *s, vi entry, vf base, const vf p[4], vf a, vf b, vi cell)
{
    struct lit l = {.eye = vf_lookup(s->eye, false, cell), .len = vf_lookup(s->len, false, cell)};
    vf q[4], turn;
    for (int i = 0; i < LIGHT_VALUES && s->v->spec->lit; i++)
        l.v[i] = vf_lookup(s->light[i], false, cell);
    part_of(p, a, b, q);
    return integrate_lit(s, entry, base, q, &l, a, b, &turn);
}

SIMD_INLINE void integrate_pieces(struct stream *s, bool few)
{
    struct stream_pieces *q = &s->pieces;
    for (uint32_t j = q->n; j % VF; j++) q->entry[j] = q->cell[j] = 0;
    for (uint32_t j = 0; j < q->n; j += VF) {
        const vf p[4] = {
            vf_load(q->p[0] + j), vf_load(q->p[1] + j), vf_load(q->p[2] + j), vf_load(q->p[3] + j)};
        vi entry = vi_load(q->entry + j);
        vf base = vf_load(q->base + j), a = vf_load(q->a + j), b = vf_load(q->b + j);
        struct added r;
        if (s->shines) r = lit_part(s, entry, base, p, a, b, vi_load(q->cell + j));
        else r = part(&s->map, few, entry, base, p, a, b, vf_load(q->len + j));
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

/* The number of samples of a piece. */
static inline uint32_t samples_of(const struct stream *s)
{
    return s->shines ? (uint32_t)s->nodes : 1;
}

/* Sums the pieces of cell j, unless one needs refinement. */
static void put_whole(struct stream *s, uint32_t j)
{
    const struct stream_pieces *q = &s->pieces;
    const uint32_t first = s->piece[j], end = s->piece_end[j];
    double sum[4] = {0};
    bool whole = true;
    for (uint32_t i = first; i < end; i++) {
        whole = whole && q->error[i] <= s->tolerance;
        if (whole) add_to(sum, q->add[i]);
        if (q->error[i] == HUGE_VALF) s->piece[j] = STREAM_ALONE;
    }
    if (!whole) return;
    for (int c = 0; c < 4; c++) s->add[j][c] = (float)sum[c];
    s->whole[j] = (uint8_t)(1 + (end - first) * samples_of(s));
}

/* True if cell j is certainly left to surface.c or lit.c. */
static bool is_alone(const struct stream *s, uint32_t j)
{
    if (s->wide && s->hard[j / VF] >> j % VF & 1) return true;
    return s->shines && s->turn[j] > 2 * STREAM_PIECES;
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
            s->piece[j] = is_alone(s, j) || ask_roots(s, j) == STREAM_PIECES ? STREAM_ALONE : 0;
            todo[n++] = j;
        }
    root[n] = s->roots.n;
    find_roots(&s->roots);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = todo[i], first = s->pieces.n;
        bool good = s->piece[j] != STREAM_ALONE && put_pieces(s, j, root[i], root[i + 1] - root[i]);
        s->piece[j] = good ? first : STREAM_ALONE;
        s->piece_end[j] = s->pieces.n;
    }
    if (s->map.entries <= 8) integrate_pieces(s, true);
    else integrate_pieces(s, false);
    memset(s->whole, 1 + (int)samples_of(s), s->cells);
    memset(s->parts, 0, s->cells / VF + 1);
    for (uint32_t i = 0; i < n; i++) {
        s->whole[todo[i]] = 0;
        if (s->piece[todo[i]] != STREAM_ALONE) put_whole(s, todo[i]);
        if (!s->whole[todo[i]]) s->parts[todo[i] / VF] = true;
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
        const vf from = a + count * step, to = a + (count + 1) * step, base = vf_set(q->base[j]);
        const vi entry = vi_set(q->entry[j]);
        struct added x;
        if (s->shines) x = lit_part(s, entry, base, p, from, to, vi_set(q->cell[j]));
        else x = part(&s->map, s->map.entries <= 8, entry, base, p, from, to, vf_set(q->len[j]));
        /* The turn was good enough for the whole piece. */
        unsigned good = vi_signs((x.error <= vf_set(s->tolerance)) | (x.error == HUGE_VALF));
        put_added(add, &x);
        for (int k = 0; k < VF && i + k < n && sum[3] < limit; k++) {
            if (!(good >> k & 1) && n < PARTS_MAX) return false;
            add_to(sum, add[k]);
            s->v->counts.samples += samples_of(s);
        }
    }
    return true;
}

static void add_piece(struct stream *s, uint32_t j, double sum[4])
{
    if (s->pieces.error[j] <= s->tolerance) {
        add_to(sum, s->pieces.add[j]);
        s->v->counts.samples += samples_of(s);
        return;
    }
    double before[4];
    memcpy(before, sum, sizeof before);
    int n = PARTS_MIN;
    while (n < PARTS_MAX && s->pieces.error[j] > s->tolerance * (float)(n * n)) n *= 2;
    for (; !add_parts(s, j, n, sum); n *= 2) memcpy(sum, before, sizeof before);
}

#endif
