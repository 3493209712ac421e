/* A small copy of an assembled picture: its cost is that of the pixels that have come. */
#include "image/store.h"

/* The first pixel from p on that is present; `end` if there is none before that. */
static uint64_t next_present(const struct coverage *have, uint64_t p, uint64_t end)
{
    while (p < end && !coverage_has(have, p)) p += have->bits[p >> 6] ? 1 : 64 - (p & 63);
    return p < end ? p : end;
}

static uint32_t least(uint32_t a, uint32_t b) { return a < b ? a : b; }

static bool add_row(const struct assembly_frame *f, uint32_t y, uint32_t k, struct image *to)
{
    const uint32_t w = f->have.w, rows = least(f->have.h - y / k * k, k);
    const uint64_t first = (uint64_t)y * w, end = first + w;
    struct store_span at = {0};
    for (uint64_t p = first; (p = next_present(&f->have, p, end)) < end; p++) {
        if ((p < at.first || p >= at.end) && store_at(f->pixels, p, false, &at) != 0) return false;
        const uint32_t x = (uint32_t)(p - first), columns = least(w - x / k * k, k);
        const float *rgba = at.rgba + 4 * (p - at.first);
        float *mean = to->rgba + 4 * ((size_t)(y / k) * to->w + x / k);
        for (int c = 0; c < 4; c++) mean[c] += rgba[c] / ((float)columns * (float)rows);
    }
    return true;
}

bool assembly_small(const struct assembly_frame *f, uint32_t side, struct image *to)
{
    const uint32_t w = f->have.w, h = f->have.h, k = ((w > h ? w : h) + side - 1) / side;
    image_init(to, (w + k - 1) / k, (h + k - 1) / k);
    for (uint32_t y = 0; y < h; y++) {
        if (add_row(f, y, k, to)) continue;
        image_free(to);
        return false;
    }
    return true;
}
