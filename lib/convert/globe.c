/* globe: longitudes that begin elsewhere, and the last column of a circle. */
#include "convert/convert_int.h"

#include <stdlib.h>
#include <string.h>

#define SLACK .01 /* of a step: coordinates are rounded, to float or to some decimals */

static double greatest_step(const struct grid *g)
{
    double step = 0;
    for (uint32_t i = 1; i < g->n[0]; i++) step = fmax(step, g->at[0][i] - g->at[0][i - 1]);
    return step;
}

static void check_longitude(
    const struct convert_options *o, const struct converter *c, const char *option)
{
    if (!c->degrees)
        die(ST_USAGE, "%s: %s: %s: x is not a longitude in degrees", o->file, c->what, option);
}

/* ---- where it begins ------------------------------------------------------------------------- */

struct convert_roll convert_find_roll(
    const struct convert_options *o, const struct converter *c, struct grid *g)
{
    double *x = g->at[0], *moved;
    const uint32_t n = g->n[0];
    const double step = greatest_step(g), range = x[n - 1] - x[0], slack = SLACK * step;
    struct convert_roll roll = {0, n};
    check_longitude(o, c, "-r");
    const bool closed = fabs(360 - range) <= slack;
    const bool globe = closed || (range < 360 && 360 - range <= step + slack);
    roll.period -= closed;
    moved = xmalloc(n, sizeof *moved);
    for (uint32_t i = 0; i < n; i++) {
        double turns = floor((x[i] - o->from) / 360);
        moved[i] = x[i] - 360 * turns;
        if (moved[i] - o->from >= 360 - slack) moved[i] -= 360;
        if (i < roll.period && moved[i] < moved[roll.first]) roll.first = i;
    }
    if (!globe) {
        roll.first = 0;
        for (uint32_t i = n; i-- > 0;) x[i] += moved[0] - x[0];
    } else {
        for (uint32_t i = 0; i < roll.period; i++) x[i] = moved[(i + roll.first) % roll.period];
        if (closed) x[n - 1] = x[0] + 360;
    }
    free(moved);
    return roll;
}

void convert_roll(const struct convert_roll *roll, struct grid *g)
{
    const size_t first = roll->first, period = roll->period;
    if (!first) return;
    float *row = xmalloc(period, sizeof *row), *at = g->value;
    for (size_t k = (size_t)g->n[1] * g->n[2]; k-- > 0; at += g->n[0]) {
        memcpy(row, at + first, (period - first) * sizeof *row);
        memcpy(row + period - first, at, first * sizeof *row);
        memcpy(at, row, period * sizeof *row);
        if (period < g->n[0]) at[period] = at[0];
    }
    free(row);
}

/* ---- the last column ------------------------------------------------------------------------- */

bool convert_wants_closing(
    const struct convert_options *o, const struct converter *c, struct grid *g)
{
    const double *x = g->at[0], range = x[g->n[0] - 1] - x[0], step = greatest_step(g);
    check_longitude(o, c, "-c");
    if (fabs(360 - range) <= SLACK * step) return false;
    if (range > 360 || 360 - range > (1 + SLACK) * step)
        die(ST_USAGE, "%s: %s: -c: x goes from %g to %g, expected a circle without its last step",
            o->file, c->what, x[0], x[0] + range);
    g->at[0] = xrealloc(g->at[0], g->n[0] + 1, sizeof *g->at[0]);
    g->at[0][g->n[0]] = g->at[0][0] + 360;
    g->value = xrealloc(g->value, (size_t)(g->n[0] + 1) * g->n[1], g->n[2] * sizeof *g->value);
    return true;
}

void convert_close(struct grid *g)
{
    const size_t n = g->n[0]++;
    for (size_t row = (size_t)g->n[1] * g->n[2]; row-- > 0;) {
        float *to = g->value + row * (n + 1);
        memmove(to, g->value + row * n, n * sizeof *to);
        to[n] = to[0];
    }
}
