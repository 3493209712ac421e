/*
 * image: pixel buffers; PNG (through libpng), PAM and PFM; metrics.
 *
 * Pixels are linear light, premultiplied RGBA, float32, row 0 on top. Files: PNG 8 bit holds sRGB, PNG 16 bit
 * linear light (gAMA 1); alpha is written, not premultiplied, only where some pixel is not opaque. PAM
 * is as PNG without compression (8 bit sRGB, 16 bit linear). PFM is float RGB, bottom row first, and has no alpha.
 */
#ifndef STORMRING_IMAGE_H
#define STORMRING_IMAGE_H

#include "base/base.h"
#include "task/task.h"

struct image {
    uint32_t w, h;
    float *rgba; /* 4 * w * h */
};

enum image_format { IMAGE_PNG, IMAGE_PAM, IMAGE_PFM };

#define IMAGE_ERR 256

void image_init(struct image *im, uint32_t w, uint32_t h); /* transparent black */
void image_free(struct image *im);
/* By suffix (.png .pam .pfm); false when it is none of them. */
bool image_format_of(const char *path, enum image_format *format);
/*
 * Reads a PNG (any kind; without gAMA or sRGB chunk 8 bit counts as sRGB, 16 bit as linear), PAM, PPM or PFM,
 * told apart by content. 0, or -1 with "what, expected what" in err. Nothing is allocated on failure.
 */
int image_read(const char *path, struct image *im, char err[IMAGE_ERR]);
/* bits 8 or 16 (PFM: ignored). job: NULL or the hash put in PNG's text chunk. 0, or -1 with errno. */
int image_write(FILE *f, const struct image *im, enum image_format format, int bits, const char *job);

/* The sRGB transfer functions (IEC 61966-2-1); encode clamps to [0,1] and rounds to nearest. */
uint8_t srgb_encode8(float linear);
float srgb_decode8(uint8_t v);

struct image_diff {
    double rmse;        /* over R, G, B of pixels clamped to [0,1], linear */
    double rmse_kept;   /* the same without the worst `drop` fraction of pixels */
    double psnr_db;     /* 20 log10(1/rmse); INFINITY when equal */
    double worst;       /* largest difference of a component, R G B A */
    uint32_t worst_x, worst_y;
    uint64_t over;      /* pixels with a component off by more than tolerance */
    uint64_t differing; /* pixels that differ at all, alpha included */
};
/* Sizes must be equal (the caller checks). */
void image_compare(const struct image *a, const struct image *b, double tolerance, double drop, struct image_diff *d);

#endif
