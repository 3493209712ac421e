/*
 * samples: converts file samples to linear light and back: the sRGB curve (IEC 61966-2-1), powers,
 * 16-bit linear.
 *
 * Encoding to 8 bits is exact: the leading bits of a float select a code, and one comparison with
 * the threshold to the next code decides. No pow per pixel, no approximation.
 */
#include "image/codecs.h"

#include <stdlib.h>
#include <string.h>

double srgb_to_linear(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

double srgb_from_linear(double v)
{
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

uint8_t srgb_encode8(float linear)
{
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    return (uint8_t)(255 * srgb_from_linear((double)linear) + 0.5);
}

float srgb_decode8(uint8_t v) { return (float)srgb_to_linear(v / 255.0); }

bool sampler_curve(const struct image_part *part, bool deep, double *curve, char err[IMAGE_ERR])
{
    *curve = !deep || part->deep == IMAGE_DEEP_SRGB ? CURVE_SRGB : 1.0;
    if (!deep || part->deep != IMAGE_DEEP_REFUSED) return true;
    image_fail(err, "16 bits that do not state their curve, expected option -g, 8 bits, "
                    "or a PNG with sRGB or gAMA");
    return false;
}

void sampler_init(struct sampler *s, uint32_t max, double curve)
{
    s->max = max;
    s->linear = xmalloc((size_t)max + 1, sizeof *s->linear);
    for (uint32_t v = 0; v <= max; v++) {
        double x = (double)v / max;
        s->linear[v] = (float)(curve == CURVE_SRGB ? srgb_to_linear(x)
                               : curve == 1.0      ? x
                                                   : pow(x, curve));
    }
}

void sampler_free(struct sampler *s) { free(s->linear); }

bool sampler_row(
    const struct sampler *s, const unsigned char *in, int channels, uint32_t n, float *rgba)
{
    int width = s->max > 255 ? 2 : 1, colours = channels < 3 ? 1 : 3;
    for (uint32_t i = 0; i < n; i++, rgba += 4) {
        uint32_t v[4];
        for (int c = 0; c < channels; c++, in += width) {
            v[c] = width == 1 ? in[0] : (uint32_t)in[0] << 8 | in[1];
            if (v[c] > s->max) return false;
        }
        float alpha = channels == colours ? 1.0f : (float)v[colours] / (float)s->max;
        for (int c = 0; c < 3; c++) rgba[c] = s->linear[v[colours == 1 ? 0 : c]] * alpha;
        rgba[3] = alpha;
    }
    return true;
}

static uint32_t float_bits(float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static float bits_float(uint32_t u)
{
    float x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* The step of x, 2^-13 <= x <= 1: its exponent and the 7 leading bits of its fraction. */
static uint32_t srgb_step(float x)
{
    const uint32_t first = (uint32_t)(127 - SRGB_OCTAVES) * SRGB_STEPS;
    return (float_bits(x) >> 16) - first;
}

static float srgb_threshold(int k)
{
    float x = (float)srgb_to_linear((k - 0.5) / 255);
    while (srgb_encode8(x) >= k) x = nextafterf(x, 0);
    while (srgb_encode8(x) < k) x = nextafterf(x, 1);
    return x;
}

static void srgb_steps_init(struct quantizer *q)
{
    q->threshold[0] = 0;
    for (int k = 1; k < 256; k++) q->threshold[k] = srgb_threshold(k);
    q->threshold[256] = INFINITY;
    const uint32_t first = float_bits(1.0f) - ((uint32_t)SRGB_OCTAVES << 23);
    unsigned k = 0;
    for (uint32_t i = 0; i <= SRGB_OCTAVES * SRGB_STEPS; i++) {
        while (bits_float(first + (i << 16)) >= q->threshold[k + 1]) k++;
        q->below[i] = (uint8_t)k;
    }
}

void quantizer_init(struct quantizer *q, bool opaque, int bits)
{
    q->bits = bits;
    q->channels = opaque ? 3 : 4;
    if (bits == 8) srgb_steps_init(q);
}

static inline unsigned encode_srgb(const struct quantizer *q, float x)
{
    if (!(x >= 0x1p-13f)) return 0;
    if (x >= 1) return 255;
    unsigned k = q->below[srgb_step(x)];
    return k + (x >= q->threshold[k + 1]);
}

static inline unsigned encode_linear(float x, unsigned max)
{
    if (!(x > 0)) return 0;
    return x >= 1 ? max : (unsigned)((double)x * max + 0.5);
}

void quantizer_row(const struct quantizer *q, const float *rgba, uint32_t n, unsigned char *out)
{
    for (uint32_t i = 0; i < n; i++, rgba += 4) {
        float alpha = rgba[3];
        for (int c = 0; c < q->channels; c++) {
            float x = rgba[c];
            if (c < 3 && alpha < 1) x = alpha > 0 ? x / alpha : 0;
            if (q->bits == 8) {
                *out++ = (unsigned char)(c < 3 ? encode_srgb(q, x) : encode_linear(x, 255));
            } else {
                unsigned v = encode_linear(x, 65535);
                *out++ = (unsigned char)(v >> 8);
                *out++ = (unsigned char)(v & 255);
            }
        }
    }
}
