/*
 * stream: the map in the kernels' layout; the test whether float is exact enough; pixels. One
 * machine with volume.c.
 */
#include "volume/stream.h"

#include <stdlib.h>

/* Bound on float rounding errors, relative to the range of a cell's values. */
#define ROUNDING 0x1p-20
#define TOLERANCE_MIN 0x1p-15
/* Narrowest span of a map: products of widths are floats without loss of precision. */
#define SPAN_MIN 0x1p-50
#define TILE 16 /* pixels; squares of it are STREAM_RAYS */
/* With a light: of 1 / edges, and their inverse. */
#define EDGE_MAX 1e15
/* Planes may differ from even spacing by at most this many cells: a float cannot resolve less. */
#define EVEN 0x1p-28

/* Rules for lit pieces; what their errors are: see stream_lit.h. */
static const struct lit_rule {
    int nodes;
    float straight, near[2], any[2];
} piece_rules[] = {
    {3, 1.2e-2F, {1.1e-2F, .15F}, {8e-2F, .35F}},
    {4, 1.8e-3F, {1.4e-3F, 1.5e-2F}, {1e-2F, 3.7e-2F}},
    {5, 2.4e-4F, {1.9e-4F, 2.1e-3F}, {1.6e-3F, 7.3e-3F}},
    {6, 3.5e-5F, {3.6e-5F, 2.1e-4F}, {2.2e-4F, 8e-4F}},
    {7, 1.1e-5F, {6e-6F, 3e-5F}, {4.1e-5F, 1.1e-4F}},
};

/* The cheapest that does for straight pieces; NULL if there is none. */
static const struct lit_rule *rule_for(const struct volume *v)
{
    for (size_t i = 0; i < sizeof piece_rules / sizeof *piece_rules; i++) {
        const struct lit_rule *r = &piece_rules[i];
        if (v->bright * fmax((double)r->straight, (double)r->near[0]) <= v->o.tolerance) return r;
    }
    return NULL;
}

/* True if 1 / edge is a float whose square is none of the extremes. */
static bool edges_fit(const struct volume *v)
{
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 0; i < v->cells[a]; i++)
            if (!(v->inv_edge[a][i] > 1 / EDGE_MAX && v->inv_edge[a][i] < EDGE_MAX)) return false;
    return true;
}

static bool spans_fit(const struct map *m)
{
    for (uint32_t i = 0; i < m->n; i++)
        if (!m->span[i].transparent && m->span[i].hi - m->span[i].lo < SPAN_MIN) return false;
    return true;
}

bool volume_stream_fits(const struct volume *v)
{
    if (v->o.method != VOLUME_ADAPTIVE || v->second || (is_lit(v) && !rule_for(v))) return false;
    if ((v->spec->lit && !edges_fit(v)) || !spans_fit(&v->map)) return false;
    return v->o.tolerance >= TOLERANCE_MIN;
}

/* The greatest length of a ray in a cell. */
static double longest(const struct volume *v)
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        double edge = 0;
        for (uint32_t i = 0; i < v->cells[a]; i++) edge = fmax(edge, 1 / v->inv_edge[a][i]);
        square += edge * edge;
    }
    return sqrt(square);
}

/*
 * A value's error is at most ROUNDING times its cell's range. The error of k, in parts of its
 * greatest value in the span, is at most that divided by the span's width. Alpha's error is at most
 * that of the optical depth. So this is the greatest range, if a cell is `length` long.
 */
static float room_in(const struct volume *v, const struct map_span *p, double length)
{
    const double width = p->hi - p->lo, depth = length * fmax(p->k0, p->k0 + p->k1 * width);
    return p->transparent ? HUGE_VALF : (float)(v->o.tolerance * width / ROUNDING / fmax(depth, 1));
}

static void find_room(struct stream *s)
{
    const struct volume *v = s->v;
    float *room = s->map.room;
    const double length = longest(v);
    s->least_room = room[0] = room[v->map.n + 1] = HUGE_VALF;
    for (uint32_t i = 0; i < v->map.n; i++) {
        room[i + 1] = room_in(v, &v->map.span[i], length);
        if (room[i + 1] < s->least_room) s->least_room = room[i + 1];
    }
    s->narrow = v->range > (double)s->least_room;
}

static float *table(const struct stream_map *m)
{
    return xcalloc(m->entries + STREAM_LANES, sizeof(float));
}

/* Splits x into a sum of two floats. */
static void split(double x, float *high, float *low)
{
    *high = (float)x;
    *low = (float)(x - (double)*high);
}

static void map_tables(struct stream_map *t, const struct map *m)
{
    t->edges = m->n + 1;
    t->entries = m->n + 2;
    t->closed = m->closed;
    float **const all[] = {&t->edge_high, &t->edge_low, &t->k0, &t->k1, &t->rgb0[0], &t->rgb0[1],
        &t->rgb0[2], &t->rgb1[0], &t->rgb1[1], &t->rgb1[2], &t->slope, &t->from_high, &t->from_low,
        &t->room};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) *all[i] = table(t);
    t->transparent = xcalloc(t->entries, sizeof *t->transparent);
    t->transparent[0] = t->transparent[m->n + 1] = true;
    for (uint32_t i = 0; i < m->n; i++) {
        const struct map_span *p = &m->span[i];
        t->transparent[i + 1] = p->transparent;
        split(p->lo, &t->edge_high[i], &t->edge_low[i]);
        split(p->lo, &t->from_high[i + 1], &t->from_low[i + 1]);
        t->k0[i + 1] = (float)p->k0;
        t->k1[i + 1] = (float)p->k1;
        t->slope[i + 1] = (float)p->slope;
        for (int c = 0; c < 3; c++) {
            t->rgb0[c][i + 1] = (float)p->rgb0[c];
            t->rgb1[c][i + 1] = (float)p->rgb1[c];
        }
    }
    if (m->n > 0) split(m->span[m->n - 1].hi, &t->edge_high[m->n], &t->edge_low[m->n]);
    else t->edge_high[0] = HUGE_VALF;
}

/* What light, attenuation and surfaces need. */
static void widen(struct stream *s)
{
    const struct spec *spec = s->v->spec;
    s->shines = is_lit(s->v) && s->v->map.n > 0;
    find_room(s);
    s->wide = s->narrow || is_lit(s->v) || volume_has_sheets(s->v) || spec->clipped || s->v->ground;
    s->value_high = xcalloc(spec->n_isos + 1, sizeof *s->value_high);
    s->value_low = xcalloc(spec->n_isos + 1, sizeof *s->value_low);
    s->above = xcalloc(spec->n_isos + 1, STREAM_RAYS * sizeof *s->above);
    if (s->v->ground) s->ground = xcalloc(STREAM_RAYS, sizeof *s->ground);
    for (size_t i = 0; i < spec->n_isos; i++)
        split(spec->iso[i].s, &s->value_high[i], &s->value_low[i]);
    if (!is_lit(s->v)) return;
    const struct lit_rule *r = rule_for(s->v);
    struct rule nodes;
    volume_gauss_rule(&nodes, r->nodes);
    s->nodes = r->nodes;
    for (int i = 0; i < r->nodes; i++) {
        s->at[i] = (float)nodes.node[i];
        s->weight[i] = (float)nodes.weight[i];
    }
    s->bright = (float)s->v->bright;
    s->straight = r->straight;
    memcpy(s->near, r->near, sizeof s->near);
    memcpy(s->any, r->any, sizeof s->any);
}

/* The widest that the options allow and the machine has. */
static stream_kernel *widest(enum isa isa)
{
    stream_kernel *k = isa == ISA_AUTO || isa == ISA_AVX512 ? volume_kernel_avx512() : NULL;
    if (!k && isa != ISA_SSE2) k = volume_kernel_avx2();
    return k ? k : volume_kernel_sse2();
}

/* True if each plane is where even distances would have it, except for rounding. A slice needs the
 * times of the planes themselves. */
static bool is_even(const struct volume *v)
{
    if (v->n_slices > 0) return false;
    for (int a = 0; a < 3; a++) {
        const double *plane = v->plane[a], edge = (plane[v->cells[a]] - plane[0]) / v->cells[a];
        for (uint32_t i = 1; i < v->cells[a]; i++)
            if (!(fabs(plane[i] - (plane[0] + i * edge)) <= EVEN * edge)) return false;
    }
    return true;
}

/* True if the walk may be in float: its errors take a quarter of what float may be wrong by. */
static bool is_fast(const struct stream *s)
{
    const struct volume *v = s->v;
    double nodes = 1, most = 0;
    for (int a = 0; a < 3; a++) {
        nodes *= v->cells[a] + 1.0;
        most = fmax(most, v->cells[a]);
    }
    return s->even && !s->wide && !v->narrowed && nodes < INT32_MAX && most < 0x1p24 &&
           edges_fit(v) &&
           4 * v->range * most * STREAM_FAST_ERROR <= (double)s->least_room * ROUNDING;
}

struct stream *volume_stream_new(struct volume *v)
{
    unsigned char *room = xcalloc(1, sizeof(struct stream) + STREAM_LINE);
    struct stream *s = (void *)(room + STREAM_LINE - (uintptr_t)room % STREAM_LINE);
    s->room = room;
    s->v = v;
    s->kernel = widest(v->o.isa);
    s->tolerance = (float)v->o.tolerance;
    s->even = is_even(v);
    map_tables(&s->map, &v->map);
    widen(s);
    volume_leap_init(s);
    s->fast = is_fast(s);
    s->walkers = s->fast ? STREAM_WALKERS : STREAM_LANES;
    for (unsigned mask = 0; mask < 256; mask++) {
        int n = 0;
        for (unsigned i = 0; i < 8; i++)
            if (mask >> i & 1) s->pack[mask] |= (uint64_t)i << 8 * n++;
        n = 0;
        for (unsigned i = 0; i < 4 && mask < 16; i++)
            if (mask >> i & 1) s->half_pack[mask] |= (uint64_t)(i * 0x202 + 0x100) << 16 * n++;
    }
    return s;
}

void volume_stream_free(struct stream *s)
{
    if (!s) return;
    struct stream_map *t = &s->map;
    float *const all[] = {t->edge_high, t->edge_low, t->k0, t->k1, t->rgb0[0], t->rgb0[1],
        t->rgb0[2], t->rgb1[0], t->rgb1[1], t->rgb1[2], t->slope, t->from_high, t->from_low,
        t->room};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    free(t->transparent);
    free(s->value_high);
    free(s->value_low);
    free(s->above);
    free(s->ground);
    volume_leap_free(s);
    free(s->room);
}

/* Renders n pixels of the lattice into rows of w, of which they may have several. */
static void put_pixels(
    struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n, uint32_t w, float *rgba)
{
    s->kernel(s, l, n0, n);
    for (uint32_t i = 0, x = 0; i < n; i++) {
        const double *sum = s->sum[i];
        if (s->ground && s->ground[i].is)
            volume_put_ground(s->v, &s->ground[i], sum, 1 - sum[3], rgba);
        else volume_put(s->v, sum, 1 - sum[3], rgba);
        rgba += 4;
        if (++x == l->w) {
            x = 0;
            rgba += 4 * (size_t)(w - l->w);
        }
    }
}

/* Whole rows go in tiles: the rays of a tile share cells, so that fewer come from memory. */
static void put_tiles(struct stream *s, const struct lattice *l, float *rgba)
{
    const uint32_t high = l->h < TILE ? l->h : TILE, wide = STREAM_RAYS / high;
    for (uint32_t y = 0; y < l->h; y += high)
        for (uint32_t x = 0; x < l->w; x += wide) {
            const struct lattice tile = {l->x + x * l->sx, l->y + y * l->sy,
                l->w - x < wide ? l->w - x : wide, l->h - y < high ? l->h - y : high, l->sx, l->sy};
            put_pixels(s, &tile, 0, tile.w * tile.h, l->w, rgba + 4 * ((size_t)y * l->w + x));
        }
}

void volume_stream_pixels(
    struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba)
{
    if (n0 == 0 && n == lattice_count(l) && l->h > 1) {
        put_tiles(s, l, rgba);
        return;
    }
    for (uint32_t at = 0, some; at < n; at += some) {
        some = n - at < STREAM_RAYS ? n - at : STREAM_RAYS;
        put_pixels(s, l, n0 + at, some, l->w, rgba + 4 * (size_t)at);
    }
}
