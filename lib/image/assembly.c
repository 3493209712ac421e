/*
 * assembly: pictures from fragments: checks which fragments may be committed, and the idempotent
 * commit.
 *
 * Completeness is never inferred from pixel values; the coverage records it. The pixels of a
 * complete frame are kept until the next frame is complete, so that late copies (from an endgame)
 * are still compared.
 */
#include "image/store.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void assembly_init(struct assembly *a, bool keep_pixels, uint64_t most_bytes)
{
    *a = (struct assembly){.keep_pixels = keep_pixels,
        .room_bytes = most_bytes,
        .spill = {.above_px = ASSEMBLY_MEMORY_PX, .pages = ASSEMBLY_PAGES}};
}

static bool in_file(const struct assembly *a, const struct assembly_frame *f)
{
    return a->spill.dir && (uint64_t)f->have.w * f->have.h > a->spill.above_px;
}

static uint64_t frame_bytes(const struct assembly *a, const struct assembly_frame *f)
{
    uint64_t bitmap = (uint64_t)f->have.w * f->have.h / 8 + 8;
    if (!a->keep_pixels) return bitmap;
    return bitmap + store_memory(f->have.w, f->have.h, in_file(a, f), a->spill.pages);
}

/* Frees the pixels and the bitmap; the counts stay. */
static void close_frame(struct assembly *a, struct assembly_frame *f)
{
    if (!f->have.bits) return;
    a->room_bytes += frame_bytes(a, f);
    store_free(f->pixels);
    f->pixels = NULL;
    free(f->have.bits);
    f->have.bits = NULL;
}

void assembly_free(struct assembly *a)
{
    for (uint32_t i = 0; i < a->n_frames; i++) {
        close_frame(a, a->frames[i]);
        free(a->frames[i]);
    }
    free(a->frames);
    *a = (struct assembly){0};
}

/* Index of frame `number`, or the index where it would be inserted. */
static uint32_t place_of(const struct assembly *a, uint32_t number)
{
    uint32_t lo = 0, hi = a->n_frames;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (a->frames[mid]->number < number) lo = mid + 1;
        else hi = mid;
    }
    return lo;
}

struct assembly_frame *assembly_find(const struct assembly *a, uint32_t number)
{
    uint32_t at = place_of(a, number);
    return at < a->n_frames && a->frames[at]->number == number ? a->frames[at] : NULL;
}

static struct assembly_frame *add_frame(struct assembly *a, uint32_t number, uint32_t w, uint32_t h)
{
    uint32_t at = place_of(a, number);
    if ((a->n_frames & (a->n_frames - 1)) == 0) /* a power of two: full or empty */
        a->frames =
            xrealloc(a->frames, a->n_frames ? (size_t)a->n_frames * 2 : 1, sizeof(*a->frames));
    memmove(a->frames + at + 1, a->frames + at, (a->n_frames - at) * sizeof(*a->frames));
    struct assembly_frame *f = a->frames[at] = xcalloc(1, sizeof *f);
    a->n_frames++;
    f->number = number;
    f->have = (struct coverage){.w = w, .h = h};
    a->declared_px += (uint64_t)w * h;
    return f;
}

static bool same_job(const struct assembly_frame *f, const char *job)
{
    return strncmp(f->job, job, ASSEMBLY_NAME - 1) == 0;
}

enum assembly_verdict assembly_declare(
    struct assembly *a, uint32_t number, uint32_t w, uint32_t h, const char *job)
{
    struct assembly_frame *f = assembly_find(a, number);
    if (!f) {
        if (a->n_frames >= ASSEMBLY_FRAMES_MAX) return ASSEMBLY_NO_ROOM;
        f = add_frame(a, number, w, h);
        snprintf(f->job, ASSEMBLY_NAME, "%s", job);
    }
    return f->have.w == w && f->have.h == h && same_job(f, job) ? ASSEMBLY_TAKEN : ASSEMBLY_FOREIGN;
}

static enum assembly_verdict failed(struct assembly *a)
{
    a->error = errno;
    return ASSEMBLY_FAILED;
}

static void forget_recent(struct assembly *a)
{
    if (a->recent) close_frame(a, a->recent);
    a->recent = NULL;
}

static bool new_store(struct assembly *a, struct assembly_frame *f)
{
    const char *dir = in_file(a, f) ? a->spill.dir : NULL;
    f->pixels = store_new(f->have.w, f->have.h, dir, a->spill.pages);
    return f->pixels != NULL;
}

/* Allocates f at its first fragment. */
static enum assembly_verdict open_frame(struct assembly *a, struct assembly_frame *f)
{
    if (f->have.bits) return ASSEMBLY_TAKEN;
    uint64_t bytes = frame_bytes(a, f);
    if (bytes > a->room_bytes) forget_recent(a);
    if (bytes > a->room_bytes) return ASSEMBLY_NO_ROOM;
    if (a->keep_pixels && !new_store(a, f)) {
        forget_recent(a); /* it may have filled the disk */
        if (!new_store(a, f)) return failed(a);
    }
    a->room_bytes -= bytes;
    coverage_init(&f->have, f->have.w, f->have.h);
    return ASSEMBLY_TAKEN;
}

/* NULL if the list is full. */
static struct assembly_dispute *dispute_of(
    struct assembly *a, uint32_t frame, uint16_t first, uint16_t second)
{
    for (uint32_t i = 0; i < a->n_disputes; i++) {
        struct assembly_dispute *d = &a->disputes[i];
        if (d->frame == frame && d->first == first && d->second == second) return d;
    }
    if (a->n_disputes == ASSEMBLY_DISPUTES_MAX) return NULL;
    struct assembly_dispute *d = &a->disputes[a->n_disputes++];
    *d = (struct assembly_dispute){.frame = frame, .first = first, .second = second};
    return d;
}

/* Compares a repeated pixel p of f with the first copy. */
static void meet_again(struct assembly *a, const struct assembly_frame *f, uint64_t p,
    const struct store_span *kept, uint16_t source, const float *rgba)
{
    const float *first = kept->rgba + 4 * (p - kept->first);
    if (memcmp(first, rgba, 4 * sizeof *rgba) == 0) return;
    a->differing++;
    struct assembly_dispute *d = dispute_of(a, f->number, kept->source[p - kept->first], source);
    if (!d) return;
    double most = 0;
    for (int c = 0; c < 4; c++) { /* with fmax, gcc 12 for aarch64 ends in an internal error */
        double off = fabs((double)first[c] - (double)rgba[c]);
        if (off > most) most = off;
    }
    if (d->pixels++ && most <= d->worst) return;
    d->worst = most;
    d->x = (uint32_t)(p % f->have.w);
    d->y = (uint32_t)(p / f->have.w);
}

/* Commits pixels of which only the presence is kept. */
static void commit_presence(struct assembly_frame *f, const struct lattice *at)
{
    for (uint64_t j = 0; j < at->h; j++) {
        uint64_t p = lattice_pixel(at, f->have.w, j * at->w);
        for (uint32_t i = 0; i < at->w; i++, p += at->sx) f->again += !coverage_set(&f->have, p);
    }
}

/* Keeps n pixels from p on, which are new. */
static void keep(struct assembly_frame *f, uint64_t p, uint64_t n, const struct store_span *kept,
    uint16_t source, const float *rgba)
{
    memcpy(kept->rgba + 4 * (p - kept->first), rgba, n * 4 * sizeof *rgba);
    uint16_t *sources = kept->source + (p - kept->first);
    bool clear = false;
    for (uint64_t i = 0; i < n; i++) {
        sources[i] = source;
        clear |= !(rgba[4 * i + 3] >= 1);
    }
    f->clear |= clear;
}

/* False with errno if pixels cannot be kept. */
static bool commit_pixels(struct assembly *a, struct assembly_frame *f, uint16_t source,
    const struct lattice *at, const float *rgba)
{
    struct store_span kept = {0};
    for (uint64_t j = 0; j < at->h; j++) {
        uint64_t p = lattice_pixel(at, f->have.w, j * at->w), n;
        for (uint64_t left = at->w; left; left -= n, p += n * at->sx, rgba += 4 * n) {
            if ((p < kept.first || p >= kept.end) && store_at(f->pixels, p, true, &kept) != 0)
                return false;
            uint64_t most = at->sx > 1 ? 1 : left < kept.end - p ? left : kept.end - p;
            for (n = 0; n < most && coverage_set(&f->have, p + n);) n++;
            if (n) keep(f, p, n, &kept, source, rgba);
            if (n) continue;
            f->again++;
            meet_again(a, f, p, &kept, source, rgba);
            n = 1;
        }
    }
    return true;
}

static enum assembly_verdict commit(struct assembly *a, uint32_t number, const char *job,
    uint16_t source, const struct lattice *at, const float *rgba)
{
    struct assembly_frame *f = assembly_find(a, number);
    if (!f) return ASSEMBLY_UNDECLARED;
    if (!same_job(f, job)) return ASSEMBLY_FOREIGN;
    if (!lattice_valid(at, f->have.w, f->have.h)) return ASSEMBLY_OUTSIDE;
    if (f->released && !f->have.bits) {
        f->late += lattice_count(at);
        return ASSEMBLY_TAKEN;
    }
    enum assembly_verdict opened = open_frame(a, f);
    if (opened != ASSEMBLY_TAKEN) return opened;
    uint64_t before = f->have.done;
    bool kept = true;
    if (f->pixels) kept = commit_pixels(a, f, source, at, rgba);
    else commit_presence(f, at);
    a->done_px += f->have.done - before;
    return kept ? ASSEMBLY_TAKEN : failed(a);
}

enum assembly_verdict assembly_commit(struct assembly *a, uint32_t number, const char *job,
    uint16_t source, const struct lattice *at, const float *rgba)
{
    enum assembly_verdict verdict = commit(a, number, job, source, at, rgba);
    if (verdict != ASSEMBLY_TAKEN) a->refused[verdict]++;
    return verdict;
}

static const float *row_of(const struct image_rows *rows, uint32_t y)
{
    return store_row(rows->ctx, y);
}

struct image_rows assembly_rows(const struct assembly_frame *f)
{
    bool opaque = coverage_full(&f->have) && !f->clear;
    return (struct image_rows){f->have.w, f->have.h, opaque, row_of, f->pixels};
}

uint64_t assembly_disk(uint32_t w, uint32_t h) { return store_disk(w, h); }

void assembly_release(struct assembly *a, struct assembly_frame *f)
{
    if (f->released) return;
    f->released = true;
    if (a->recent) close_frame(a, a->recent);
    a->recent = f;
}

bool assembly_whole(const struct assembly *a)
{
    return a->n_frames > 0 && a->done_px == a->declared_px;
}
