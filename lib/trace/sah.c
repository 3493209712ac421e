/*
 * sah: splits by the surface area heuristic (J. Goldsmith, J. Salmon, "Automatic creation of object
 * hierarchies for ray tracing", IEEE CG&A 7(5), 1987; binned as in I. Wald, "On fast construction
 * of SAH-based bounding volume hierarchies", RT 2007). One pass bins along all three axes. For up
 * to FEW references all splits are compared.
 *
 * Chunks of a large span are binned and partitioned on several threads. The span alone decides
 * where they begin. Boxes and counts join exactly, in any order.
 */
#include "trace/bins.h"

#include <stdlib.h>

#define FEW 4
#define SAH_DEPTH 64   /* deeper nodes are halved: the depth is at most SAH_DEPTH + log2 n */
#define COST_NODE 0.4f /* of one binary step, relative to a block of four items; measured */
#define CHUNK 4096     /* refs */

float sah_area(const struct box *b) { return area(loaded(b)); }

static void swap_refs(struct ref *a, struct ref *b)
{
    struct ref t = *a;
    *a = *b;
    *b = t;
}

/* Moves refs of the first ref's kind to the front. Returns their number. */
static uint32_t part_by_kind(struct ref *r, uint32_t n)
{
    uint32_t i = 1, j = n, kind = r[0].kind;
    while (i < j) {
        if (r[i].kind == kind) i++;
        else swap_refs(&r[i], &r[--j]);
    }
    return i;
}

/* ---- chunks --------------------------------------------------------------------------------- */

static uint32_t chunks(uint32_t n) { return (n + CHUNK - 1) / CHUNK; }

struct chunked {
    struct ref *refs;
    uint32_t n;
    struct binning binning;
    struct choice choice;
    struct bins *bins;     /* of each chunk */
    struct parted *parted; /* of each chunk */
    struct bounds *bounds; /* of each chunk */
};

static struct ref *chunk(const struct chunked *c, uint32_t i, uint32_t *n)
{
    uint32_t first = i * CHUNK, left = c->n - first;
    *n = left < CHUNK ? left : CHUNK;
    return c->refs + first;
}

static void measure_chunk(void *ctx, uint32_t i)
{
    struct chunked *c = ctx;
    uint32_t n;
    const struct ref *r = chunk(c, i, &n);
    c->bounds[i] = bounds_of(r, n);
}

static void bin_chunk(void *ctx, uint32_t i)
{
    struct chunked *c = ctx;
    uint32_t n;
    const struct ref *r = chunk(c, i, &n);
    bins_all(&c->bins[i], &c->binning, r, n);
}

static void part_chunk(void *ctx, uint32_t i)
{
    struct chunked *c = ctx;
    uint32_t n;
    struct ref *r = chunk(c, i, &n);
    c->parted[i] = part(r, n, &c->binning, &c->choice);
}

static void run(struct parallel *p, uint32_t n, parallel_job job, void *ctx)
{
    if (p) parallel_run(p, n, job, ctx);
    else
        for (uint32_t i = 0; i < n; i++) job(ctx, i);
}

/* Swaps right refs of the first chunks with left refs of the last ones. */
static void join_chunks(const struct chunked *c, struct parted *all)
{
    uint32_t n_chunks = chunks(c->n), n;
    *all = (struct parted){0, {bounds_none(), bounds_none()}};
    for (uint32_t i = 0; i < n_chunks; i++) {
        all->left += c->parted[i].left;
        for (int k = 0; k < 2; k++) all->side[k] = bounds_join(all->side[k], c->parted[i].side[k]);
    }
    uint32_t from = n_chunks; /* its left refs below `last` move */
    struct ref *last = NULL, *stop = NULL;
    for (uint32_t i = 0; i * CHUNK < all->left; i++) {
        struct ref *r = chunk(c, i, &n);
        for (uint32_t k = c->parted[i].left; k < n && r + k < c->refs + all->left; k++) {
            while (last == stop) {
                uint32_t n_from;
                stop = chunk(c, --from, &n_from);
                last = stop + c->parted[from].left;
            }
            swap_refs(r + k, --last);
        }
    }
}

/* ---- splits --------------------------------------------------------------------------------- */

static struct span span_of(struct bounds b, uint32_t first, uint32_t n, int depth)
{
    return (struct span){stored(b.box), stored(b.centres), first, n, depth};
}

struct span sah_all(struct ref *refs, uint32_t n, struct parallel *p)
{
    uint32_t n_chunks = chunks(n);
    struct chunked c = {.refs = refs, .n = n};
    struct bounds all = bounds_none();
    c.bounds = xaligned(n_chunks, sizeof *c.bounds);
    run(p, n_chunks, measure_chunk, &c);
    for (uint32_t i = 0; i < n_chunks; i++) all = bounds_join(all, c.bounds[i]);
    free(c.bounds);
    return span_of(all, 0, n, 0);
}

/* The halves of a span of which `left` refs go left. */
static bool halves(
    const struct span *s, uint32_t left, const struct bounds side[2], struct span half[2])
{
    half[0] = span_of(side[0], s->first, left, s->depth + 1);
    half[1] = span_of(side[1], s->first + left, s->n - left, s->depth + 1);
    return true;
}

static bool measured(struct ref *refs, const struct span *s, uint32_t left, struct span half[2])
{
    const struct ref *r = refs + s->first;
    const struct bounds side[2] = {bounds_of(r, left), bounds_of(r + left, s->n - left)};
    return halves(s, left, side, half);
}

static bool split_large(
    struct ref *refs, const struct span *s, struct span half[2], struct parallel *p)
{
    uint32_t n_chunks = chunks(s->n);
    struct chunked c = {.refs = refs + s->first, .n = s->n, .binning = binning_of(s)};
    c.bins = xaligned(n_chunks, sizeof *c.bins);
    run(p, n_chunks, bin_chunk, &c);
    for (uint32_t i = 1; i < n_chunks; i++) bins_join(&c.bins[0], &c.bins[i], BINS);
    c.choice = choose(&c.bins[0], &c.binning);
    if (c.choice.axis >= 0) {
        struct parted all;
        c.parted = xaligned(n_chunks, sizeof *c.parted);
        run(p, n_chunks, part_chunk, &c);
        join_chunks(&c, &all);
        halves(s, all.left, all.side, half);
        free(c.parted);
    }
    free(c.bins);
    return c.choice.axis >= 0 || measured(refs, s, s->n / 2, half);
}

/* Finds the best of all ways to split up to FEW refs: each fills a block. Bit i of *set stands for
 * ref i. */
static float best_set(const struct ref *r, uint32_t n, unsigned *set)
{
    struct vbox a = of_ref(&r[0]), b = of_ref(&r[1]);
    struct vbox c = n > 2 ? of_ref(&r[2]) : empty(), d = n > 3 ? of_ref(&r[3]) : empty();
    struct vbox ab = join(a, b), ac = join(a, c), ad = join(a, d);
    struct vbox bc = join(b, c), bd = join(b, d), cd = join(c, d);
    /* Without a ref a box is infinitely large. */
    vf one = areas(a, b, c, d) + areas(join(b, cd), join(a, cd), join(ab, d), join(ab, c));
    vf two = areas(ab, ac, ad, a) + areas(cd, bd, bc, a);
    float least = FLT_MAX;
    *set = 1;
    for (unsigned i = 0; i < FEW; i++)
        if (one[i] < least) least = one[i], *set = 1u << i;
    for (unsigned i = 0; i < 3; i++)
        if (two[i] < least) least = two[i], *set = 1u | 2u << i;
    return least;
}

static bool split_few(struct ref *refs, const struct span *s, struct span half[2])
{
    struct ref *r = refs + s->first, old[FEW];
    unsigned set;
    float least = best_set(r, s->n, &set), whole = sah_area(&s->box);
    if (whole <= whole * COST_NODE + least) {
        uint32_t same = part_by_kind(r, s->n);
        return same < s->n && measured(refs, s, same, half);
    }
    uint32_t n[2] = {0, 0}, left = (uint32_t)__builtin_popcount(set);
    memcpy(old, r, s->n * sizeof *r);
    struct bounds side[2] = {bounds_none(), bounds_none()};
    for (uint32_t i = 0; i < s->n; i++) {
        unsigned right = !(set >> i & 1);
        r[right * left + n[right]++] = old[i];
        bounds_add(&side[right], &old[i]);
    }
    return halves(s, left, side, half);
}

bool sah_split(struct ref *refs, const struct span *s, struct span half[2], struct parallel *p)
{
    struct ref *r = refs + s->first;
    uint32_t n = s->n;
    if (n == 1) return false;
    if (s->depth >= SAH_DEPTH) {
        if (n > LANES * LEAF_BLOCKS_MAX) return measured(refs, s, n / 2, half);
        uint32_t same = part_by_kind(r, n);
        return same < n && measured(refs, s, same, half);
    }
    if (n <= FEW) return split_few(refs, s, half);
    if (n > CHUNK) return split_large(refs, s, half, p);
    struct binning g = binning_of(s);
    struct bins bins;
    bins_all(&bins, &g, r, n);
    struct choice c = choose(&bins, &g);
    if (n <= LANES * LEAF_BLOCKS_MAX) {
        float whole = sah_area(&s->box);
        if (c.axis < 0 || whole * blocks(n) <= whole * COST_NODE + c.cost) {
            uint32_t same = part_by_kind(r, n);
            return same < n && measured(refs, s, same, half);
        }
    }
    if (c.axis < 0) return measured(refs, s, n / 2, half);
    struct parted all = part(r, n, &g, &c);
    return halves(s, all.left, all.side, half);
}
