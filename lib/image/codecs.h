/*
 * codecs: the picture codecs and their sample conversion. Private to lib/image.
 *
 * A file's samples are 8 or 16 bit integers, big-endian, alpha not premultiplied. sampler_*
 * converts them to linear premultiplied floats, quantizer_* converts back.
 */
#ifndef STORMRING_IMAGE_CODECS_H
#define STORMRING_IMAGE_CODECS_H

#include "image/image.h"

/* Writes "what, expected what" into err. Returns -1. */
int image_fail(char err[IMAGE_ERR], const char *fmt, ...) PRINTF_LIKE(2, 3);
/* True if a picture of this size is allowed; otherwise the message is in err. */
bool image_size_ok(uint64_t w, uint64_t h, char err[IMAGE_ERR]);

/* True if row y of the picture is to be decoded. */
static inline bool image_wants(const struct image_part *part, const struct image *im, uint32_t y)
{
    return im->w != part->w || im->h != part->h || (y >= part->first && y < part->end);
}

int png_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR]);
int png_encode(FILE *f, const struct image_rows *rows, int bits, const char *job);
/* PAM, PPM, PGM. */
int pnm_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR]);
int pam_encode(FILE *f, const struct image_rows *rows, int bits);
int pfm_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR]);
int pfm_encode(FILE *f, const struct image_rows *rows);

double srgb_to_linear(double v);
double srgb_from_linear(double v);

/* Transfer curve of samples: an exponent > 0 (1: linear light), or sRGB. */
#define CURVE_SRGB 0.0
#define CURVE_UNSTATED (-1.0)
/* The curve of samples of at most 8 bits, or of more, in a file that states none. False with a
 * message if the part refuses it. */
bool sampler_curve(const struct image_part *part, bool deep, double *curve, char err[IMAGE_ERR]);

struct sampler {
    uint32_t max;  /* the sample value of 1.0 */
    float *linear; /* max + 1 values */
};

void sampler_init(struct sampler *s, uint32_t max, double curve);
void sampler_free(struct sampler *s);
/* Converts n pixels of `channels` (1 grey, 2 grey + alpha, 3 RGB, 4 RGBA). Samples have two bytes
 * if max > 255. False if a sample exceeds max. */
bool sampler_row(
    const struct sampler *s, const unsigned char *in, int channels, uint32_t n, float *rgba);

/* Floats below 2^-13 are 0 in 8-bit sRGB. From there to 1, each 1/128 of an octave contains at most
 * one threshold. */
#define SRGB_OCTAVES 13
#define SRGB_STEPS 128

struct quantizer {
    int bits, channels;   /* channels: 3 if every pixel is opaque, else 4 */
    float threshold[257]; /* [k]: the smallest float with code k; [256]: none */
    uint8_t below[SRGB_OCTAVES * SRGB_STEPS + 1]; /* code of the smallest float of each step */
};

void quantizer_init(struct quantizer *q, bool opaque, int bits);
static inline size_t quantizer_row_bytes(const struct quantizer *q, uint32_t w)
{
    return (size_t)w * (size_t)(q->channels * (q->bits / 8));
}
void quantizer_row(const struct quantizer *q, const float *rgba, uint32_t n, unsigned char *out);

#endif
