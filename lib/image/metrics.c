/*
 * metrics: differences between two pictures. rmse_kept excludes the worst pixels by selection, not
 * by sorting. The error of the first excluded pixel is found by counting its leading, then its
 * trailing 16 bits. Needs no memory per pixel.
 */
#include "image/image.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define BINS 65536

/* Clamps to [0,1]; NaN stays. */
static double clamped(float x) { return x < 0 ? 0 : x > 1 ? 1 : (double)x; }

static double apart(float a, float b)
{
    if (isnan(a) || isnan(b)) return isnan(a) && isnan(b) ? 0 : 1;
    return fabs(clamped(a) - clamped(b));
}

/* Squared error of a pixel over R, G, B. As a float, because float bits sort like values. */
static float pixel_error(const struct image *a, const struct image *b, size_t i)
{
    double sum = 0;
    for (size_t c = 4 * i; c < 4 * i + 3; c++) {
        double d = apart(a->rgba[c], b->rgba[c]);
        sum += d * d;
    }
    return (float)sum;
}

static uint32_t bits_of(float x)
{
    uint32_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

/* The bin of the rank-th largest value (from 0), counted from the top bin. *rank becomes the rank
 * within that bin. */
static uint32_t bin_of_rank(const uint64_t *count, uint64_t *rank)
{
    uint32_t bin = BINS - 1;
    while (*rank >= count[bin]) *rank -= count[bin--];
    return bin;
}

/* Sum of squared errors without the `drop` largest of n pixels; drop < n. */
static double sum_kept(const struct image *a, const struct image *b, size_t n, uint64_t drop)
{
    uint64_t *count = xcalloc(BINS, sizeof *count), rank = drop;
    for (size_t i = 0; i < n; i++) count[bits_of(pixel_error(a, b, i)) >> 16]++;
    uint32_t high = bin_of_rank(count, &rank);
    memset(count, 0, BINS * sizeof *count);
    for (size_t i = 0; i < n; i++) {
        uint32_t u = bits_of(pixel_error(a, b, i));
        if (u >> 16 == high) count[u & 0xffff]++;
    }
    uint32_t low = bin_of_rank(count, &rank), pivot = high << 16 | low;
    uint64_t equal = count[low];
    free(count);
    /* The pivot is the largest kept value. Of the values equal to it, `rank` are dropped. */
    double sum = 0;
    float pivot_error;
    memcpy(&pivot_error, &pivot, sizeof pivot);
    for (size_t i = 0; i < n; i++) {
        float e = pixel_error(a, b, i);
        if (bits_of(e) < pivot) sum += (double)e;
    }
    return sum + (double)pivot_error * (double)(equal - rank);
}

static void compare_pixel(
    const float *a, const float *b, size_t i, uint32_t w, double tolerance, struct image_diff *d)
{
    if (memcmp(a, b, 4 * sizeof *a) == 0) return;
    double most = 0;
    bool differs = false;
    for (int c = 0; c < 4; c++) {
        most = fmax(most, apart(a[c], b[c]));
        if (a[c] != b[c] && !(isnan(a[c]) && isnan(b[c]))) differs = true;
    }
    d->differing += differs;
    d->over += most > tolerance;
    if (most <= d->worst) return;
    d->worst = most;
    d->worst_x = (uint32_t)(i % w);
    d->worst_y = (uint32_t)(i / w);
}

uint64_t image_share(double fraction, uint64_t n)
{
    return (uint64_t)fmin(fraction * (double)n * (1 + 4 * DBL_EPSILON), (double)n);
}

void image_compare(const struct image *a, const struct image *b, double tolerance, double drop,
    struct image_diff *d)
{
    size_t n = (size_t)a->w * a->h;
    double sum = 0;
    *d = (struct image_diff){.pixels = n, .dropped = image_share(drop, n)};
    for (size_t i = 0; i < n; i++) {
        sum += (double)pixel_error(a, b, i);
        compare_pixel(a->rgba + 4 * i, b->rgba + 4 * i, i, a->w, tolerance, d);
    }
    uint64_t kept = n - d->dropped;
    d->rmse = sqrt(sum / (3.0 * (double)n));
    d->psnr_db = sum > 0 ? -20 * log10(d->rmse) : (double)INFINITY;
    if (kept) d->rmse_kept = sqrt(sum_kept(a, b, n, d->dropped) / (3.0 * (double)kept));
}
