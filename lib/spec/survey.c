/* survey: quantiles of a grid's values, and of their deviations from the means of levels. */
#include "spec/starter.h"

#include <stdlib.h>

#define SAMPLES_MAX (1U << 20) /* values that are sorted; more hardly move a quantile */
#define GROUND .1              /* part of the values from which the least one is empty space */

const double spec_rank[SPEC_RANKS] = {0, .1, .2, .3, .4, .5, .6, .7, .8, .9, .97, 1};
const double spec_cut[SPEC_CUTS] = {.5, .7, .85, .94, .985, 1};

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Values of a grid: all of them, or some that are drawn at random. */
struct sample {
    const struct grid *g;
    size_t nodes, most, layer; /* most: to be drawn */
};
static struct sample sample_of(const struct grid *g)
{
    const size_t nodes = grid_node(g, 0, 0, g->n[2]);
    return (struct sample){
        g, nodes, nodes < SAMPLES_MAX ? nodes : SAMPLES_MAX, (size_t)g->n[0] * g->n[1]};
}
static inline size_t sample_node(const struct sample *s, size_t i)
{
    return s->most == s->nodes ? i : (size_t)(rng_u64(0, i) % s->nodes);
}

/* Of a level or of all levels. */
struct moments {
    double n, sum, squares; /* of what values are above the least one */
};
static void add(struct moments *m, const struct moments *of)
{
    m->n += of->n, m->sum += of->sum, m->squares += of->squares;
}
/* The sum of the squared distances from the mean. */
static double spread(const struct moments *m)
{
    return m->n > 0 ? fmax(m->squares - m->sum * m->sum / m->n, 0) : 0;
}

static void quantiles(struct spec_survey *v, const struct sample *s)
{
    float *sample = xmalloc(s->most, sizeof *sample);
    struct moments *level = xcalloc(s->g->n[2], sizeof *level), all = {0};
    size_t n = 0, ground = 0;
    double within = 0;
    for (size_t i = 0; i < s->most; i++) {
        const size_t node = sample_node(s, i);
        const float value = s->g->value[node];
        if (isnan(value)) continue;
        const double above = (double)value - (double)v->quantile[0];
        add(&level[node / s->layer], &(struct moments){1, above, above * above});
        sample[n++] = value;
    }
    for (uint32_t k = 0; k < s->g->n[2]; k++) add(&all, &level[k]), within += spread(&level[k]);
    v->by_level = spread(&all) > 0 ? 1 - within / spread(&all) : 0;
    free(level);
    qsort(sample, n, sizeof *sample, by_value);
    while (ground < n && sample[ground] <= v->quantile[0]) ground++;
    v->ground = (double)ground > GROUND * (double)n && ground < n;
    if (!v->ground) ground = 0;
    v->part = (double)(n - ground + 1) / (double)(s->most + 1);
    for (int i = 1; i < SPEC_RANKS - 1; i++)
        v->quantile[i] =
            n ? sample[ground + (size_t)(spec_rank[i] * (double)(n - 1 - ground))] : v->quantile[0];
    free(sample);
}

void spec_survey(const struct grid *g, struct spec_survey *v)
{
    const struct sample s = sample_of(g);
    *v = (struct spec_survey){.nodes = s.nodes};
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    for (size_t i = 0; i < v->nodes; i++) {
        if (isnan(g->value[i])) continue;
        v->there++;
        lo = fminf(lo, g->value[i]);
        hi = fmaxf(hi, g->value[i]);
    }
    v->quantile[0] = lo;
    v->quantile[SPEC_RANKS - 1] = hi;
    if (v->there) quantiles(v, &s);
}

/* The mean of the values, in the digits in which it is printed; NaN: there are none. */
static double mean_of(const float *value, size_t n)
{
    char text[32];
    double sum = 0, mean;
    size_t there = 0;
    for (size_t i = 0; i < n; i++)
        if (!isnan(value[i])) sum += (double)value[i], there++;
    if (!there) return (double)NAN;
    snprintf(text, sizeof text, "%.9g", sum / (double)there);
    return parse_real(text, -GRID_MAX, GRID_MAX, &mean) ? mean : 0;
}

void spec_survey_deviations(const struct grid *g, bool from_zero, struct spec_deviations *d)
{
    const struct sample s = sample_of(g);
    *d = (struct spec_deviations){.mean = xcalloc(g->n[2], sizeof *d->mean)};
    if (!s.layer) return; /* no grid that was read */
    for (uint32_t k = 0; k < g->n[2]; k++) {
        const float *value = g->value + k * s.layer;
        const double mean = d->mean[k] = from_zero ? 0 : mean_of(value, s.layer);
        float lo = HUGE_VALF, hi = -HUGE_VALF; /* fminf and fmaxf pass over NaN */
        for (size_t i = 0; i < s.layer; i++) lo = fminf(lo, value[i]), hi = fmaxf(hi, value[i]);
        if (!(lo <= hi)) continue;
        d->least = fminf(d->least, (float)((double)lo - mean));
        d->most = fmaxf(d->most, (float)((double)hi - mean));
    }
    float *sample = xmalloc(s.most, sizeof *sample);
    size_t n = 0;
    for (size_t i = 0; i < s.most; i++) {
        const size_t node = sample_node(&s, i);
        const float value = g->value[node];
        if (!isnan(value)) sample[n++] = (float)fabs((double)value - d->mean[node / s.layer]);
    }
    qsort(sample, n, sizeof *sample, by_value);
    for (int i = 0; i < SPEC_CUTS - 1; i++)
        d->cut[i] = n ? sample[(size_t)(spec_cut[i] * (double)(n - 1))] : 0;
    d->cut[SPEC_CUTS - 1] = fmaxf(-d->least, d->most);
    free(sample);
}

bool spec_is_section(const struct grid *g)
{
    const size_t row = g->n[0];
    if (g->n[1] != 2) return false;
    for (size_t k = 0; k < g->n[2]; k++)
        for (size_t i = 0; i < row; i++) {
            const float a = g->value[2 * k * row + i], b = g->value[(2 * k + 1) * row + i];
            if (a != b && !(isnan(a) && isnan(b))) return false;
        }
    return true;
}
