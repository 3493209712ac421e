/*
 * The arrangement of a block before it is packed. Bytes of one significance are alike, those of
 * neighbouring pixels even more; the packer finds that only if they stand together (F. Alted,
 * "Why Modern CPUs Are Starving and What Can Be Done about It", Computing in Science and
 * Engineering 12(2), 2010, calls it the shuffle filter).
 */
#include "coder/coder.h"

#include <string.h>

#define CHANNELS 4
#define WORD 4

static inline uint32_t word_at(const unsigned char *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* Small differences of either sign become small numbers. */
static inline uint32_t folded(uint32_t d) { return d << 1 ^ (0 - (d >> 31)); }

static inline uint32_t unfolded(uint32_t u) { return u >> 1 ^ (0 - (u & 1)); }

static void arrange_pixels(unsigned char *out, const unsigned char *p, size_t pixels)
{
    for (size_t c = 0; c < CHANNELS; c++) {
        unsigned char *plane = out + c * WORD * pixels;
        const unsigned char *at = p + c * WORD;
        uint32_t before = 0;
        for (size_t i = 0; i < pixels; i++, at += CODER_PIXEL_BYTES) {
            uint32_t word = word_at(at), u = folded(word - before);
            before = word;
            plane[i] = (unsigned char)u;
            plane[pixels + i] = (unsigned char)(u >> 8);
            plane[2 * pixels + i] = (unsigned char)(u >> 16);
            plane[3 * pixels + i] = (unsigned char)(u >> 24);
        }
    }
}

static void restore_pixels(unsigned char *out, const unsigned char *p, size_t pixels)
{
    for (size_t c = 0; c < CHANNELS; c++) {
        const unsigned char *plane = p + c * WORD * pixels;
        unsigned char *at = out + c * WORD;
        uint32_t word = 0;
        for (size_t i = 0; i < pixels; i++, at += CODER_PIXEL_BYTES) {
            uint32_t u = plane[i] | (uint32_t)plane[pixels + i] << 8 |
                         (uint32_t)plane[2 * pixels + i] << 16 |
                         (uint32_t)plane[3 * pixels + i] << 24;
            word += unfolded(u);
            for (int k = 0; k < WORD; k++) at[k] = (unsigned char)(word >> (8 * k));
        }
    }
}

static void arrange_words(unsigned char *out, const unsigned char *p, size_t words)
{
    for (size_t k = 0; k < WORD; k++)
        for (size_t i = 0; i < words; i++) out[k * words + i] = p[i * WORD + k];
}

static void restore_words(unsigned char *out, const unsigned char *p, size_t words)
{
    for (size_t k = 0; k < WORD; k++)
        for (size_t i = 0; i < words; i++) out[i * WORD + k] = p[k * words + i];
}

/* One direction, of n words or pixels. */
typedef void mover(unsigned char *out, const unsigned char *p, size_t n);

/* Moves whole words or pixels; the bytes after them stay as they are. */
static void move(unsigned char *out, enum coder_form form, const unsigned char *p, size_t n,
    mover *pixels, mover *words)
{
    size_t unit = form == CODER_PIXELS ? CODER_PIXEL_BYTES : WORD;
    size_t whole = form == CODER_BYTES ? 0 : n - n % unit;
    if (whole) (form == CODER_PIXELS ? pixels : words)(out, p, whole / unit);
    if (whole < n) memcpy(out + whole, p + whole, n - whole);
}

void coder_arrange(unsigned char *out, enum coder_form form, const unsigned char *p, size_t n)
{
    move(out, form, p, n, arrange_pixels, arrange_words);
}

void coder_restore(unsigned char *out, enum coder_form form, const unsigned char *p, size_t n)
{
    move(out, form, p, n, restore_pixels, restore_words);
}
