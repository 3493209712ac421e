/* Finding pixels in a log that lies in memory: see history.h. */
#include "history/history.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

bool history_frag_intact(struct history_frag *f)
{
    if (!f->summed)
        f->summed = wire_crc(f->body, f->bytes) == f->crc && wire_light(f->body, f->bytes);
    return f->summed;
}

static int compare(uint32_t a, uint32_t b) { return (a > b) - (a < b); }

/* Orders frags by frame and first pixel. */
static int by_start(const struct history_frag *a, uint32_t frame, const struct lattice *at)
{
    int order = compare(a->frame, frame);
    if (!order) order = compare(a->at.y, at->y);
    return order ? order : compare(a->at.x, at->x);
}

static const struct history_frag *all; /* while they are sorted */

static int by_number(const void *a, const void *b)
{
    size_t i = *(const size_t *)a, j = *(const size_t *)b;
    int order = by_start(&all[i], all[j].frame, &all[j].at);
    return order ? order : (i > j) - (i < j);
}

static void sort(struct history *l)
{
    l->sorted = xmalloc(l->n_frags, sizeof *l->sorted);
    for (size_t i = 0; i < l->n_frags; i++) l->sorted[i] = i;
    all = l->frags;
    qsort(l->sorted, l->n_frags, sizeof *l->sorted, by_number);
}

struct history_frag *history_frag_at(
    struct history *l, const struct history_frame *f, const struct lattice *at)
{
    if (!l->sorted) sort(l);
    size_t low = 0, high = l->n_frags;
    while (low < high) { /* binary search for the first frag not before it */
        size_t mid = low + (high - low) / 2;
        if (by_start(&l->frags[l->sorted[mid]], f->number, at) < 0) low = mid + 1;
        else high = mid;
    }
    for (; low < l->n_frags; low++) {
        struct history_frag *frag = &l->frags[l->sorted[low]];
        if (by_start(frag, f->number, at) != 0) return NULL;
        if (memcmp(&frag->at, at, sizeof *at) == 0) return frag;
    }
    return NULL;
}

static void find_places(struct history *l, struct history_frame *f)
{
    size_t n = (size_t)f->w * f->h;
    f->places = xmalloc(n, sizeof *f->places);
    for (size_t p = 0; p < n; p++) f->places[p].frag = HISTORY_NONE;
    for (size_t k = 0; k < l->n_frags; k++) {
        const struct history_frag *frag = &l->frags[k];
        if (frag->frame != f->number) continue;
        uint64_t count = lattice_count(&frag->at);
        for (uint64_t i = 0; i < count; i++) {
            struct history_place *place = &f->places[lattice_pixel(&frag->at, f->w, i)];
            if (place->frag == HISTORY_NONE)
                *place = (struct history_place){(int32_t)k, (uint32_t)i};
        }
    }
}

struct history_place history_place_of(struct history *l, const struct history_frame *f, uint64_t p)
{
    struct history_frame *own = &l->frames[f - l->frames];
    if (!own->places) find_places(l, own);
    return own->places[p];
}

/* ---- the pixels of a task -------------------------------------------------------------------- */

static bool refuse(
    const struct history_frame *f, uint64_t p, const char *why, char err[HISTORY_ERR])
{
    snprintf(err, HISTORY_ERR,
        "frame %" PRIu32 ": pixel %" PRIu64 ",%" PRIu64
        " %s, expected a log that has every pixel of the tasks",
        f->number, p % f->w, p / f->w, why);
    return false;
}

/* Adds the cost of n pixels of this frag, of which p is one. */
static bool add_cost(const struct history *l, const struct history_frame *f,
    struct history_frag *frag, uint64_t p, uint64_t n, double *us, char err[HISTORY_ERR])
{
    if (frag->done < 0) return refuse(f, p, "has no CPU time", err);
    if (!history_frag_intact(frag)) return refuse(f, p, "is damaged", err);
    const struct history_done *d = &l->dones[frag->done];
    *us += (double)d->cpu_us / (double)d->sent * (double)n;
    return true;
}

bool history_find(struct history *l, const struct history_frame *f, const struct lattice *at,
    struct history_found *found, char err[HISTORY_ERR])
{
    uint64_t n = lattice_count(at);
    struct history_frag *whole = history_frag_at(l, f, at);
    *found = (struct history_found){.at = *at, .whole = whole};
    if (whole) return add_cost(l, f, whole, lattice_pixel(at, f->w, 0), n, &found->cpu_us, err);
    for (uint64_t i = 0; i < n; i++) {
        uint64_t p = lattice_pixel(at, f->w, i);
        struct history_place place = history_place_of(l, f, p);
        if (place.frag < 0) return refuse(f, p, "is missing", err);
        if (!add_cost(l, f, &l->frags[place.frag], p, 1, &found->cpu_us, err)) return false;
    }
    return true;
}

void history_pixels(struct history *l, const struct history_frame *f,
    const struct history_found *found, uint64_t n0, uint32_t n, float *rgba)
{
    if (found->whole) {
        wire_pixels(found->whole->body + n0 * WIRE_PIXEL_BYTES, n, rgba);
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        struct history_place place =
            history_place_of(l, f, lattice_pixel(&found->at, f->w, n0 + i));
        const unsigned char *body = l->frags[place.frag].body;
        wire_pixels(body + (size_t)place.n * WIRE_PIXEL_BYTES, 1, rgba + 4 * (size_t)i);
    }
}
