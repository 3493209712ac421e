/*
 * pixel: where samples lie in a pixel, and when a pixel takes more. Both depend only on the pixel's
 * number in the frame and on its own samples. So a pixel is the same in every worker and in every
 * group of pixels.
 */
#include "trace/shade.h"
#include "trace/trace_int.h"

/*
 * The pixel is divided into n * n squares; stratum k has one sample in square k. Each of the n * n
 * columns and rows of the pixel has one sample as well: correlated multi-jittered samples (A.
 * Kensler, "Correlated Multi-Jittered Sampling", Pixar TM 13-01, 2013; differs in: the permutations
 * are shuffles). RMS error of 16 and 64 of them, relative to as many that are only stratified, and
 * that of a regular grid; 96x96 pixels:
 *
 *     balls     .86 .84   grid .78 .77          glass     .87      grid .68
 *     gears     .84 .81   grid .76 .72          polygons  .82 .78  grid .67 .71
 *     tetra     .85 .77   grid .76 .83          checker   .84 .81  grid .72 .59
 *     marbles   .83 .79   grid .68 .62          stripes   .51 .38  grid 1.3 2.8
 *     chess     .79 .80   grid .69 .78
 *
 * Stripes a third of a pixel wide show why it is no grid: a grid aliases. With adaptive
 * sampling, the first m * m samples decide. They include the pixel's corners, because a feature
 * that crosses the pixel separates the corners more often than samples further inside. Measured at
 * 256x256, 64 samples, threshold .02: the share of pixels with an error over .02, with 4 first
 * samples in the middle of the quarters, with 4 in the corners, with 9, with 16; after each, the
 * CPU time relative to always taking 64.
 *
 *     gears   6.4 % .40   0.22 % .57   0.038 % .63   0.009 % .70
 *     balls   2.7 % .75   0.31 % .80   0.063 % .83   0.011 % .90
 *     chess   1.4 % .21   0.05 % .34   0.005 % .41   0.000 % .51
 */
#define FIRST_SIDE_MAX 3 /* m is this if m * m is at most a quarter of all samples, else 2 */

struct strata {
    int n, n_first;
    int first[FIRST_SIDE_MAX * FIRST_SIDE_MAX];
};

/* Column (or row) i of m, spread from edge to edge over n columns of strata. */
static int spread(int i, int m, int n)
{
    return 2 * i < m ? i * (n - 1) / (m - 1) : n - 1 - (m - 1 - i) * (n - 1) / (m - 1);
}

static void strata_init(struct strata *s, int samples)
{
    s->n = 1;
    while ((s->n + 1) * (s->n + 1) <= samples) s->n++;
    int m = s->n >= 2 * FIRST_SIDE_MAX ? FIRST_SIDE_MAX : 2;
    s->n_first = m * m;
    for (int i = 0; i < s->n_first; i++)
        s->first[i] = spread(i / m, m, s->n) * s->n + spread(i % m, m, s->n);
}

static bool is_first(const struct strata *s, int k)
{
    for (int i = 0; i < s->n_first; i++)
        if (s->first[i] == k) return true;
    return false;
}

#define SIDE_MAX 32 /* SIDE_MAX^2 is TRACE_SAMPLES_MAX */
_Static_assert(SIDE_MAX *SIDE_MAX == TRACE_SAMPLES_MAX, "sides of pixels");
#define GROUP WAVE_RAYS /* pixels sampled together: no more than the samples of a wave */

struct group {
    struct tracer *t;
    struct strata strata;
    uint32_t x[GROUP], y[GROUP];
    uint32_t column[SIDE_MAX], row[SIDE_MAX]; /* permutations of the pixel that is sampled now */
    struct vec3 sum[GROUP];                   /* sum of the samples so far */
    struct vec3 lo[GROUP], hi[GROUP]; /* bounds of the samples; unused with one sample per pixel */
    /* Samples that wait for the next wave, and the pixels they belong to. */
    double at_x[WAVE_RAYS], at_y[WAVE_RAYS]; /* in pixels */
    uint32_t owner[WAVE_RAYS], waiting;
    struct ray ray[WAVE_RAYS];
};

static struct vec3 lower(struct vec3 a, struct vec3 b)
{
    return v3(a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z);
}

static struct vec3 higher(struct vec3 a, struct vec3 b)
{
    return v3(a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z);
}

/* The colours of the waiting samples. */
static void trace_waiting(struct group *g, struct vec3 *colour)
{
    const struct tracer *t = g->t;
    t->shaders->eye_rays(&t->camera, t->view.hither, g->at_x, g->at_y, g->waiting, g->ray);
    wave_colours(g->t, g->ray, g->waiting, colour);
}

static void flush(struct group *g)
{
    struct vec3 colour[WAVE_RAYS];
    if (g->waiting == 0) return;
    trace_waiting(g, colour);
    for (uint32_t i = 0; i < g->waiting; i++) {
        uint32_t k = g->owner[i];
        g->sum[k] = v3_add(g->sum[k], colour[i]);
        g->lo[k] = lower(g->lo[k], colour[i]);
        g->hi[k] = higher(g->hi[k], colour[i]);
    }
    g->waiting = 0;
}

static uint64_t pixel_number(const struct group *g, uint32_t k)
{
    return (uint64_t)g->y[k] * g->t->camera.w + g->x[k];
}

/* A random permutation of 0 .. n-1. R. Durstenfeld, "Algorithm 235: Random permutation", 1964. */
static void shuffle(uint32_t *a, int n, uint64_t seed, uint64_t counter)
{
    for (int i = 0; i < n; i++) {
        int k = (int)(rng_unit(seed, counter + (uint64_t)i) * (i + 1));
        a[i] = a[k];
        a[k] = (uint32_t)i;
    }
}

/* Draws the permutations of pixel k. The counters follow those of the samples. */
static void begin_pixel(struct group *g, uint32_t k)
{
    uint64_t pixel = pixel_number(g, k);
    shuffle(g->column, g->strata.n, pixel, 2 * TRACE_SAMPLES_MAX);
    shuffle(g->row, g->strata.n, pixel, 2 * TRACE_SAMPLES_MAX + SIDE_MAX);
}

/* Queues a sample. A pixel's samples are summed in the order of its calls, independent of other
 * pixels. */
static void sample(struct group *g, uint32_t k, int stratum)
{
    int n = g->strata.n;
    uint64_t pixel = pixel_number(g, k), seed = (uint64_t)stratum;
    uint32_t i = (uint32_t)(stratum % n), j = (uint32_t)(stratum / n);
    g->at_x[g->waiting] = g->x[k] + (i + (g->column[j] + rng_unit(pixel, 2 * seed)) / n) / n;
    g->at_y[g->waiting] = g->y[k] + (j + (g->row[i] + rng_unit(pixel, 2 * seed + 1)) / n) / n;
    g->owner[g->waiting] = k;
    if (++g->waiting == WAVE_RAYS) flush(g);
}

static bool disagree(const struct group *g, uint32_t k)
{
    double limit = g->t->options.threshold;
    struct vec3 spread = v3_sub(g->hi[k], g->lo[k]);
    return limit < 0 || spread.x > limit || spread.y > limit || spread.z > limit;
}

/* Computes the first n pixels of the group into sum, with a sample in the centre of each. */
static void centre_colours(struct group *g, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++) g->at_x[k] = g->x[k] + 0.5, g->at_y[k] = g->y[k] + 0.5;
    g->waiting = n;
    trace_waiting(g, g->sum);
    g->waiting = 0;
}

/* The same with more than one sample in each. */
static void colours(struct group *g, uint32_t n)
{
    const struct strata *s = &g->strata;
    for (uint32_t k = 0; k < n; k++) {
        g->sum[k] = v3(0, 0, 0);
        g->lo[k] = v3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
        g->hi[k] = v3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
        begin_pixel(g, k);
        for (int i = 0; i < s->n_first; i++) sample(g, k, s->first[i]);
    }
    flush(g);
    bool more[GROUP];
    for (uint32_t k = 0; k < n; k++) more[k] = s->n > 2 && disagree(g, k);
    for (uint32_t k = 0; k < n; k++) {
        if (!more[k]) continue;
        begin_pixel(g, k);
        for (int i = 0; i < s->n * s->n; i++)
            if (!is_first(s, i)) sample(g, k, i);
    }
    flush(g);
    for (uint32_t k = 0; k < n; k++)
        g->sum[k] = v3_scale(g->sum[k], 1.0 / (more[k] ? s->n * s->n : s->n_first));
}

void tracer_corners(struct tracer *t)
{
    double at_x[WAVE_RAYS], at_y[WAVE_RAYS];
    struct ray ray[WAVE_RAYS];
    struct vec3 colour[WAVE_RAYS];
    uint32_t w = t->camera.w, h = t->camera.h, n = 0;
    for (uint32_t y = 0; y <= h; y++)
        for (uint32_t x = 0; x <= w; x++) {
            at_x[n] = x, at_y[n++] = y;
            if (n < WAVE_RAYS && (x < w || y < h)) continue;
            t->shaders->eye_rays(&t->camera, t->view.hither, at_x, at_y, n, ray);
            wave_colours(t, ray, n, colour);
            n = 0;
        }
}

/* Finds the coordinates of lattice pixels first .. first + n. Divides once per row, not per
 * pixel. */
static void locate(struct group *g, const struct lattice *l, uint64_t first, uint32_t n)
{
    uint32_t w = g->t->camera.w, i = (uint32_t)(first % l->w);
    uint64_t p = lattice_pixel(l, w, first);
    uint32_t x = (uint32_t)(p % w), y = (uint32_t)(p / w);
    for (uint32_t k = 0; k < n; k++) {
        g->x[k] = x;
        g->y[k] = y;
        x += l->sx;
        if (++i < l->w && x < w) continue;
        if (i == l->w) i = 0;
        if (k + 1 < n) p = lattice_pixel(l, w, first + k + 1);
        x = (uint32_t)(p % w), y = (uint32_t)(p / w);
    }
}

void tracer_pixels(struct tracer *t, const struct lattice *l, uint64_t n0, uint32_t n, float *rgba)
{
    struct group g; /* large: members are set on first use, not here */
    g.t = t;
    g.waiting = 0;
    strata_init(&g.strata, t->options.samples);
    for (uint32_t done = 0; done < n;) {
        uint32_t count = n - done < GROUP ? n - done : GROUP;
        locate(&g, l, n0 + done, count);
        if (g.strata.n == 1) centre_colours(&g, count);
        else colours(&g, count);
        for (uint32_t k = 0; k < count; k++) {
            float *c = rgba + (size_t)4 * (done + k);
            c[0] = (float)g.sum[k].x;
            c[1] = (float)g.sum[k].y;
            c[2] = (float)g.sum[k].z;
            c[3] = 1;
        }
        done += count;
    }
}
