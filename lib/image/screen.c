/* Pixels for a screen: as an 8 bit PNG has them, with something behind them. */
#include "image/codecs.h"

#include <stdlib.h>

struct image_screen {
    struct quantizer quantizer;
    float linear[256];
};

struct image_screen *image_screen_new(void)
{
    struct image_screen *s = xmalloc(1, sizeof *s);
    quantizer_init(&s->quantizer, true, 8);
    for (int v = 0; v < 256; v++) s->linear[v] = srgb_decode8((uint8_t)v);
    return s;
}

void image_screen_free(struct image_screen *s) { free(s); }

/* A pixel over another, in linear light. */
static void put_over(const struct image_screen *s, const float *rgba, uint32_t back, float *out)
{
    for (int c = 0; c < 3; c++)
        out[c] = rgba[c] + (1 - rgba[3]) * s->linear[back >> (16 - 8 * c) & 255];
    out[3] = 1;
}

void image_screen_row(const struct image_screen *s, const float *rgba, const uint32_t *back,
    uint32_t n, uint32_t *out)
{
    for (uint32_t i = 0; i < n; i++, rgba += 4) {
        float mixed[4];
        unsigned char v[3];
        const bool clear = rgba[3] < 1;
        if (clear) put_over(s, rgba, back ? back[i] : 0, mixed);
        quantizer_row(&s->quantizer, clear ? mixed : rgba, 1, v);
        out[i] = UINT32_C(0xff000000) | (uint32_t)v[0] << 16 | (uint32_t)v[1] << 8 | v[2];
    }
}
