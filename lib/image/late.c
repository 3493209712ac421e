/*
 * late: pixels that come again when their frame is closed, so that there is nothing to compare them
 * with. Of a closed frame a sum of hashes is kept, one for each pixel with its place. When every
 * pixel has come again, equally often, which a sum of hashes of the places tells, the sum of the
 * late ones must be the same. So a second copy of a film is compared, in whatever cut it comes; a
 * part of a frame is only counted. It finds accidents: a liar can choose pixels of the same sum,
 * which balance -v finds by keys that it draws.
 */
#include "image/store.h"

#include <string.h>

static uint64_t hash_of(uint64_t p, const float *rgba)
{
    uint64_t bits[2];
    memcpy(bits, rgba, sizeof bits);
    return rng_u64(rng_u64(p, bits[0]), bits[1]);
}

void assembly_late_close(struct assembly_frame *f)
{
    const uint32_t w = f->have.w;
    if (!f->pixels || !coverage_full(&f->have)) return;
    f->late = (struct assembly_late){.known = true};
    for (uint32_t y = 0; y < f->have.h; y++) {
        const float *row = store_row(f->pixels, y);
        for (uint32_t x = 0; x < w; x++) {
            const uint64_t p = (uint64_t)y * w + x;
            f->late.first += hash_of(p, row + 4 * (size_t)x);
            f->late.all_places += rng_u64(0, p);
        }
    }
}

/* Compares the late pixels if they are whole copies. */
static void compare(struct assembly_late *l, uint64_t all)
{
    const uint64_t times = l->n / all;
    if (!l->known || l->n % all || l->places != times * l->all_places) return;
    if (l->again == times * l->first) l->same += l->n;
    else l->differs = true;
    l->n = l->again = l->places = 0;
}

void assembly_late_add(struct assembly_frame *f, const struct lattice *at, const float *rgba)
{
    f->late.n += lattice_count(at);
    for (uint64_t j = 0; j < at->h && f->late.known; j++) {
        uint64_t p = lattice_pixel(at, f->have.w, j * at->w);
        for (uint32_t i = 0; i < at->w; i++, p += at->sx, rgba += 4) {
            f->late.again += hash_of(p, rgba);
            f->late.places += rng_u64(0, p);
        }
    }
    compare(&f->late, (uint64_t)f->have.w * f->have.h);
}
