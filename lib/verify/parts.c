/* Pieces and their parts: choosing pieces, cutting them into parts, and the sums over pixels. */
#include "verify/verify.h"

#include <stdlib.h>
#include <string.h>

void verify_init(struct verify *v, uint64_t seed, double fraction, const int32_t *place_of,
    int32_t slots, int32_t places)
{
    *v = (struct verify){.seed = seed,
        .fraction = fraction,
        .slots = slots,
        .place_of = place_of,
        .place = xcalloc((size_t)places, sizeof *v->place)};
    frames_init(&v->frames, sizeof(struct verify_frame));
}

void verify_free(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) free(v->part[i].more);
    free(v->part);
    free(v->cut);
    free(v->place);
    frames_free(&v->frames);
    *v = (struct verify){0};
}

void verify_frame(
    struct verify *v, uint32_t frame, uint32_t frame_w, uint32_t frame_h, const char *job)
{
    if (frames_find(&v->frames, frame)) return;
    struct verify_frame *f =
        frames_extra(&v->frames, frames_set(&v->frames, frame, frame_w, frame_h));
    if (job) snprintf(f->job, sizeof f->job, "%s", job);
}

/* The frame's width; 0 if t is not inside a known frame. */
static uint32_t width_of(const struct verify *v, const struct task *t)
{
    const struct frame_size *f = frames_find(&v->frames, t->frame);
    return f && lattice_valid(&t->at, f->w, f->h) ? f->w : 0;
}

/* ---- where the parts are --------------------------------------------------------------------- */

static uint64_t first_px(const struct lattice *at, uint32_t frame_w)
{
    return lattice_pixel(at, frame_w, 0);
}

static uint64_t last_px(const struct lattice *at, uint32_t frame_w)
{
    return lattice_pixel(at, frame_w, lattice_count(at) - 1);
}

static void add_part(struct verify *v, const struct verify_part *p, uint32_t frame_w)
{
    uint64_t span_px = last_px(&p->at, frame_w) - first_px(&p->at, frame_w);
    if (v->n == UINT32_MAX / 2) die(ST_SYSTEM, "more than %u parts", v->n);
    if (v->n == v->cap) {
        v->cap = v->cap ? v->cap * 2 : 64;
        v->part = xrealloc(v->part, v->cap, sizeof *v->part);
    }
    v->part[v->n++] = *p;
    if (span_px > v->span_px) v->span_px = span_px;
}

static int compare_parts(const void *a, const void *b)
{
    const struct verify_part *p = a, *q = b;
    const uint32_t key[][2] = {
        {p->frame, q->frame}, {p->at.y, q->at.y}, {p->at.x, q->at.x}, {p->piece, q->piece}};
    for (size_t i = 0; i < sizeof key / sizeof *key; i++)
        if (key[i][0] != key[i][1]) return key[i][0] < key[i][1] ? -1 : 1;
    return 0;
}

static void sort_parts(struct verify *v)
{
    if (v->n) qsort(v->part, v->n, sizeof *v->part, compare_parts);
}

/* The first part, of the frame or a later one, that begins at or after pixel px. */
static uint32_t part_from(const struct verify *v, uint32_t frame, uint64_t px, uint32_t frame_w)
{
    uint32_t low = 0, high = v->n;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        const struct verify_part *p = &v->part[middle];
        if (p->frame < frame || (p->frame == frame && first_px(&p->at, frame_w) < px))
            low = middle + 1;
        else high = middle;
    }
    return low;
}

uint32_t verify_of_frame(const struct verify *v, uint32_t frame, uint32_t *first)
{
    *first = part_from(v, frame, 0, 1);
    return frame == UINT32_MAX ? v->n : part_from(v, frame + 1, 0, 1);
}

/* ---- choosing and cutting -------------------------------------------------------------------- */

static bool chosen(const struct verify *v, uint32_t n)
{
    return rng_unit(v->seed + VERIFY_SEED_CHOICE, n) < v->fraction;
}

void verify_choose(struct verify *v, const struct task *t)
{
    struct verify_part p = {
        .at = t->at, .frame = t->frame, .piece = v->seen, .asked = -1, .failed = {-1, -1}};
    uint32_t frame_w = width_of(v, t);
    if (v->seen == UINT32_MAX) die(ST_SYSTEM, "more than %u fragments", v->seen);
    if (!chosen(v, v->seen++) || !frame_w) return;
    add_part(v, &p, frame_w);
    v->pieces++;
}

static void add_cut(struct verify *v, uint32_t part, uint64_t offset)
{
    if (!offset || offset >= lattice_count(&v->part[part].at)) return;
    if (v->n_cuts == v->cap_cuts) {
        v->cap_cuts = v->cap_cuts ? v->cap_cuts * 2 : 64;
        v->cut = xrealloc(v->cut, v->cap_cuts, sizeof *v->cut);
    }
    v->cut[v->n_cuts++] = (struct verify_cut){part, offset};
}

/* Cuts every piece that overlaps the fragment at the fragment's begin and end. Pieces may
 * overlap, because two slots may have delivered the same pixels. */
void verify_cut(struct verify *v, const struct task *t)
{
    uint32_t frame_w = width_of(v, t);
    if (!frame_w) return;
    if (!v->cut) sort_parts(v);
    if (!v->cut) v->cut = xmalloc(v->cap_cuts = 64, sizeof *v->cut);
    uint64_t first = first_px(&t->at, frame_w), last = last_px(&t->at, frame_w);
    for (uint32_t i = part_from(v, t->frame, first + 1, frame_w); i-- > 0;) {
        const struct verify_part *p = &v->part[i];
        if (p->frame != t->frame || first_px(&p->at, frame_w) + v->span_px < last) break;
        int64_t n0 = lattice_offset(&p->at, frame_w, &t->at);
        if (n0 < 0) continue;
        add_cut(v, i, (uint64_t)n0);
        add_cut(v, i, (uint64_t)n0 + lattice_count(&t->at));
    }
}

static int compare_cuts(const void *a, const void *b)
{
    const struct verify_cut *c = a, *d = b;
    if (c->part != d->part) return c->part < d->part ? -1 : 1;
    return (c->offset > d->offset) - (c->offset < d->offset);
}

/* The parts of p, which is cut at these places, in ascending order; a place may occur twice. */
static void divide(
    struct verify *v, struct verify_part p, const struct verify_cut *cut, const size_t n)
{
    const struct lattice whole = p.at;
    const uint32_t frame_w = frames_find(&v->frames, p.frame)->w;
    const uint64_t count = lattice_count(&whole);
    size_t c = 0;
    for (uint64_t at = 0; at < count; at += lattice_count(&p.at)) {
        while (c < n && cut[c].offset <= at) c++;
        p.at = lattice_cut(&whole, frame_w, at, (c < n ? cut[c].offset : count) - at);
        add_part(v, &p, frame_w);
    }
}

void verify_split(struct verify *v)
{
    struct verify_part *whole = v->part;
    const uint32_t n = v->n;
    size_t from = 0, to = 0;
    if (v->n_cuts) {
        qsort(v->cut, v->n_cuts, sizeof *v->cut, compare_cuts);
        v->part = NULL;
        v->n = v->cap = 0;
        for (uint32_t i = 0; i < n; i++, from = to) {
            while (to < v->n_cuts && v->cut[to].part == i) to++;
            divide(v, whole[i], v->cut + from, to - from);
        }
        free(whole);
    }
    free(v->cut);
    v->cut = NULL;
    v->n_cuts = v->cap_cuts = 0;
    sort_parts(v);
}

/* ---- opinions -------------------------------------------------------------------------------- */

/* Adds an opinion of a part: pixels n0 and following of the given ones. */
static void sum_up(const struct verify *v, const struct verify_part *p, struct verify_opinion *o,
    uint32_t frame_w, const float *pixels, uint64_t n0)
{
    const uint64_t count = lattice_count(&p->at);
    for (uint64_t k = 0; k < count; k++) {
        uint32_t word[4];
        uint64_t px = lattice_pixel(&p->at, frame_w, k);
        memcpy(word, pixels + 4 * (n0 + k), sizeof word);
        for (uint64_t c = 0; c < 4; c++)
            for (uint64_t key = 0; key < 2; key++)
                o->sum[key] += rng_u64(v->seed + VERIFY_SEED_KEYS + key, 4 * px + c) * word[c];
    }
}

static void add_opinion(struct verify_part *p, const struct verify_opinion *o)
{
    for (uint32_t i = 0; i < p->n; i++) {
        const struct verify_opinion *have = verify_opinion(p, i);
        if (have->slot == o->slot && have->place == o->place && verify_same(have, o)) return;
    }
    if (p->n >= VERIFY_INLINE) {
        p->more = xrealloc(p->more, p->n + 1 - VERIFY_INLINE, sizeof *p->more);
        p->more[p->n - VERIFY_INLINE] = *o;
    } else p->by[p->n] = *o;
    p->n++;
}

/* Adds opinions to all parts in t; for the log, to the parts of the piece that t is. */
static void add_opinions(struct verify *v, const struct task *t, int32_t slot, int32_t place,
    const float *pixels, bool log)
{
    uint32_t frame_w = width_of(v, t), piece = v->again - 1;
    if (!frame_w) return;
    uint64_t first = first_px(&t->at, frame_w), last = last_px(&t->at, frame_w);
    for (uint32_t i = part_from(v, t->frame, first, frame_w); i < v->n; i++) {
        struct verify_part *p = &v->part[i];
        if (p->frame != t->frame || first_px(&p->at, frame_w) > last) break;
        if (log && (p->piece != piece || p->n)) continue;
        int64_t n0 = lattice_offset(&t->at, frame_w, &p->at);
        if (n0 < 0) continue;
        struct verify_opinion o = {.slot = slot, .place = place};
        sum_up(v, p, &o, frame_w, pixels, (uint64_t)n0);
        add_opinion(p, &o);
    }
}

void verify_first(
    struct verify *v, const struct task *t, int32_t slot, int32_t place, const float *pixels)
{
    if (chosen(v, v->again++)) add_opinions(v, t, slot, place, pixels, true);
}

void verify_again(
    struct verify *v, const struct task *t, int32_t slot, int32_t place, const float *pixels)
{
    if (place >= 0) add_opinions(v, t, slot, place, pixels, false);
}
