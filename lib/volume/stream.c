/*
 * stream: the map in the kernels' layout; the test whether float suffices; pixels. One machine
 * with volume.c.
 */
#include "volume/stream.h"

#include <stdlib.h>

/* Bound on float rounding errors, relative to the range of a cell's values. */
#define ROUNDING 0x1p-20
#define TOLERANCE_MIN 0x1p-15

/*
 * A value's error is at most ROUNDING times its cell's range. The relative error of k is at most
 * that divided by the span's width; alpha's error is smaller.
 */
bool volume_stream_fits(const struct volume *v)
{
    double width = HUGE_VAL;
    if (v->o.method != VOLUME_ADAPTIVE || v->map.n == 0 || v->spec->n_isos > 0 || is_lit(v))
        return false;
    for (uint32_t i = 0; i < v->map.n; i++)
        if (!v->map.span[i].transparent) width = fmin(width, v->map.span[i].hi - v->map.span[i].lo);
    return v->o.tolerance >= TOLERANCE_MIN && ROUNDING * v->range <= v->o.tolerance * width;
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
        &t->rgb0[2], &t->rgb1[0], &t->rgb1[1], &t->rgb1[2], &t->slope, &t->from_high, &t->from_low};
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
    split(m->span[m->n - 1].hi, &t->edge_high[m->n], &t->edge_low[m->n]);
}

/* The widest that the options allow and the machine has. */
static stream_kernel *widest(enum isa isa)
{
    stream_kernel *k = isa == ISA_AUTO || isa == ISA_AVX512 ? volume_kernel_avx512() : NULL;
    if (!k && isa != ISA_SSE2) k = volume_kernel_avx2();
    return k ? k : volume_kernel_sse2();
}

struct stream *volume_stream_new(struct volume *v)
{
    unsigned char *room = xcalloc(1, sizeof(struct stream) + STREAM_LINE);
    struct stream *s = (void *)(room + STREAM_LINE - (uintptr_t)room % STREAM_LINE);
    s->room = room;
    s->v = v;
    s->kernel = widest(v->o.isa);
    s->tolerance = (float)v->o.tolerance;
    map_tables(&s->map, &v->map);
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
        t->rgb0[2], t->rgb1[0], t->rgb1[1], t->rgb1[2], t->slope, t->from_high, t->from_low};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    free(t->transparent);
    free(s->room);
}

void volume_stream_pixels(
    struct stream *s, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba)
{
    for (uint32_t at = 0, some; at < n; at += some) {
        some = n - at < STREAM_RAYS ? n - at : STREAM_RAYS;
        s->kernel(s, l, n0 + at, some);
        for (uint32_t i = 0; i < some; i++) {
            const double *sum = s->sum[i];
            volume_put(s->v, sum, 1 - sum[3], rgba + 4 * (size_t)(at + i));
        }
    }
}
