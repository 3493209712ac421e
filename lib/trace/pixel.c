/*
 * pixel: where in a pixel samples are taken, and when more are. All of it depends on the pixel's number in the frame
 * and on its own samples: a pixel is the same whoever computes it and whatever else they compute.
 */
#include "trace/trace_int.h"

/* Stratum k of n * n, each in one of the n * n squares of the pixel; the first four are spread over its quarters. */
struct strata {
    int n;
    int first[4];
};

static void strata_init(struct strata *s, int samples)
{
    s->n = 1;
    while ((s->n + 1) * (s->n + 1) <= samples) s->n++;
    int a = s->n / 4, b = s->n - 1 - a;
    s->first[0] = a * s->n + a;
    s->first[1] = a * s->n + b;
    s->first[2] = b * s->n + a;
    s->first[3] = b * s->n + b;
}

static struct vec3 sample(struct tracer *t, const struct strata *s, uint64_t pixel, int stratum)
{
    struct ray r;
    double x = (double)(pixel % t->camera.w), y = (double)(pixel / t->camera.w), fx = 0.5, fy = 0.5;
    if (s->n > 1) {
        fx = (stratum % s->n + rng_unit(pixel, 2 * (uint64_t)stratum)) / s->n;
        fy = (stratum / s->n + rng_unit(pixel, 2 * (uint64_t)stratum + 1)) / s->n;
    }
    camera_ray(t, x + fx, y + fy, &r);
    return trace_colour(t, &r);
}

static double spread(double a, double b, double c, double d)
{
    return fmax(fmax(a, b), fmax(c, d)) - fmin(fmin(a, b), fmin(c, d));
}

static bool disagree(const struct vec3 c[4], double threshold)
{
    return spread(c[0].x, c[1].x, c[2].x, c[3].x) > threshold ||
           spread(c[0].y, c[1].y, c[2].y, c[3].y) > threshold ||
           spread(c[0].z, c[1].z, c[2].z, c[3].z) > threshold;
}

static struct vec3 pixel_colour(struct tracer *t, const struct strata *s, uint64_t pixel)
{
    if (s->n == 1) return sample(t, s, pixel, 0);
    struct vec3 c[4], sum = v3(0, 0, 0);
    for (int i = 0; i < 4; i++) {
        c[i] = sample(t, s, pixel, s->first[i]);
        sum = v3_add(sum, c[i]);
    }
    if (s->n == 2 || (t->options.threshold >= 0 && !disagree(c, t->options.threshold)))
        return v3_scale(sum, 1.0 / 4);
    for (int i = 0; i < s->n * s->n; i++)
        if (i != s->first[0] && i != s->first[1] && i != s->first[2] && i != s->first[3])
            sum = v3_add(sum, sample(t, s, pixel, i));
    return v3_scale(sum, 1.0 / (s->n * s->n));
}

void tracer_pixels(struct tracer *t, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba)
{
    struct strata s;
    strata_init(&s, t->options.samples);
    for (uint32_t i = 0; i < n; i++) {
        struct vec3 c = pixel_colour(t, &s, lattice_pixel(l, t->camera.w, n0 + i));
        rgba[4 * i] = (float)c.x;
        rgba[4 * i + 1] = (float)c.y;
        rgba[4 * i + 2] = (float)c.z;
        rgba[4 * i + 3] = 1;
    }
}
