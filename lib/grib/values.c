/* values: converts a stack's axes and values to a grid. */
#include "grib/grib_int.h"

#include <stdlib.h>
#include <string.h>

#define MISSING 9.9e35 /* ecCodes stores this where the bitmap marks a missing value */

const struct gb_measure *gb_measure_of(const char *levels)
{
    static const struct gb_measure measures[] = {{"isobaricInhPa", "hPa", true},
        {"isobaricLayer", "hPa", true}, {"heightAbove", "m", false},
        {"pressureFromGround", "Pa", false}, {"theta", "K", false}, {"depthBelow", "m", true},
        {"soil", "1", true}, {"oceanModel", "1", true}, {"hybridHeight", "1", false},
        {"hybrid", "1", true}, {"sigma", "1", true}, {"eta", "1", true},
        {"generalVertical", "1", true}, {"", "", false}};
    const struct gb_measure *m = measures;
    while (strncmp(levels, m->prefix, strlen(m->prefix)) != 0) m++;
    return m;
}

bool gb_counts_down(const struct gb_entry *e)
{
    return gb_measure_of(e->levels)->down && !e->no_pv;
}

bool gb_is_projected(const char *kind)
{
    return !strstr(kind, "_ll") && strcmp(kind, "regular_gg") != 0;
}

/* ---- axes ----------------------------------------------------------------------------------- */

static void spread(double *at, uint32_t n, double first, double last)
{
    for (uint32_t i = 0; i < n; i++) at[i] = first + (last - first) * i / (n - 1);
}

/* Metres on the plane; if that is not known, from the corner with the lowest x and y. */
static bool plane_axes(const codes_handle *h, const char *kind, struct grid *g, char err[ERR_BYTES])
{
    struct gb_plane p;
    gb_find_plane(h, kind, &p);
    const double first[2] = {p.x, p.y};
    if (strcmp(kind, "space_view") == 0 && !(fabs(p.step[0] * p.step[1]) > 0))
        return err_set(err, "what a satellite sees from far away or not from over the equator, "
                            "expected one over the equator, at a height in the file");
    for (int a = 0; a < 2; a++) {
        const double length = p.step[a] * (g->n[a] - 1);
        const double least = *p.text ? first[a] + fmin(length, 0) : 0;
        spread(g->at[a], g->n[a], least, least + fabs(length));
    }
    return true;
}

/* Degrees, eastwards from the western edge, beyond 360 if needed. */
static void sphere_axes(const codes_handle *h, const char *kind, struct grid *g)
{
    double first = gb_real(h, "longitudeOfFirstGridPointInDegrees");
    double last = gb_real(h, "longitudeOfLastGridPointInDegrees");
    double a = gb_real(h, "latitudeOfFirstGridPointInDegrees");
    double b = gb_real(h, "latitudeOfLastGridPointInDegrees");
    bool westwards = gb_long(h, "iScansNegatively");
    double west = westwards ? last : first, east = westwards ? first : last;
    spread(g->at[0], g->n[0], west, east <= west ? east + 360 : east);
    spread(g->at[1], g->n[1], fmin(a, b), fmax(a, b));
    size_t n = 0;
    if (strcmp(kind, "regular_gg") != 0 ||
        codes_get_size(h, "distinctLatitudes", &n) != CODES_SUCCESS || n != g->n[1])
        return;
    double *gaussian = xmalloc(n, sizeof *gaussian);
    if (codes_get_double_array(h, "distinctLatitudes", gaussian, &n) == CODES_SUCCESS)
        for (size_t i = 0; i < n; i++)
            g->at[1][i] = gaussian[gaussian[0] > gaussian[n - 1] ? n - 1 - i : i];
    free(gaussian);
}

static bool check_axes(const struct grid *g, char err[ERR_BYTES])
{
    for (int a = 0; a < 3; a++) {
        const double *at = g->at[a];
        uint32_t end = g->n[a] - 1, i = grid_axis_fault(at, g->n[a]);
        if (i)
            return err_set(
                err, "%g follows %g along %c, expected all to ascend", at[i], at[i - 1], "xyz"[a]);
        if (!(fabs(at[0]) <= GRID_MAX && fabs(at[end]) <= GRID_MAX))
            return err_set(err, "%c goes from %g to %g, expected %g at most", "xyz"[a], at[0],
                at[end], GRID_MAX);
    }
    return true;
}

bool gb_axes(const char *path, const struct gb_stack *s, struct grid *g, char err[ERR_BYTES])
{
    const struct gb_entry *e = s->at;
    const size_t n[] = {(size_t)e->nx, (size_t)e->ny, s->n_levels};
    const bool down = gb_counts_down(e);
    struct gb_file in;
    *g = (struct grid){.value = NULL};
    if (!gb_open_at(path, e->number, &in, err)) return false;
    for (int a = 0; a < 3; a++) {
        g->n[a] = (uint32_t)n[a];
        g->at[a] = xcalloc(n[a], sizeof *g->at[a]);
    }
    for (size_t k = 0; k < n[2]; k++)
        g->at[2][down ? n[2] - 1 - k : k] = (down ? -e[k].level : e[k].level) + 0.0; /* no -0 */
    bool good = true;
    if (gb_is_projected(e->kind)) good = plane_axes(in.h, e->kind, g, err);
    else sphere_axes(in.h, e->kind, g);
    gb_close(&in);
    good = good && check_axes(g, err);
    size_t nodes;
    if (good && __builtin_mul_overflow(n[0] * n[1], n[2], &nodes))
        good = err_set(err, "too many nodes, expected as many as fit in memory");
    if (good) g->value = xcalloc(nodes, sizeof *g->value);
    else grid_free(g);
    return good;
}

/* ---- values --------------------------------------------------------------------------------- */

/* Stores the values of one message. They come row by row or column by column, in either direction
 * along each axis; every other row may be reversed. */
static bool take_values(
    codes_handle *h, struct grid *g, size_t k, double *values, char err[ERR_BYTES])
{
    const size_t nx = g->n[0], ny = g->n[1];
    const bool columns = gb_long(h, "jPointsAreConsecutive");
    const bool turns = gb_long(h, "alternativeRowScanning");
    const bool leftwards = gb_runs_west(h), up = gb_runs_north(h);
    size_t n = nx * ny, row = columns ? ny : nx, there = 0;
    codes_set_double(h, "missingValue", MISSING);
    int status = codes_get_size(h, "values", &there);
    if (!status && there != n)
        return err_set(err, "a message has %zu values, expected %zu", there, n);
    if (!status) status = codes_get_double_array(h, "values", values, &n);
    if (status) return err_set(err, "%s", codes_get_error_message(status));
    for (size_t m = 0; m < n; m++) {
        size_t along = m % row, across = m / row;
        if (turns && across % 2) along = row - 1 - along;
        size_t i = columns ? across : along, j = columns ? along : across;
        float *to = g->value + (k * ny + (up ? j : ny - 1 - j)) * nx + (leftwards ? nx - 1 - i : i);
        double v = values[m] == MISSING ? (double)NAN : values[m];
        if (fabs(v) > GRID_MAX)
            return err_set(err, "a value is %g, expected %g at most", v, GRID_MAX);
        *to = (float)v;
    }
    return true;
}

bool gb_values(
    const char *path, const struct gb_stack *s, size_t time, struct grid *g, char err[ERR_BYTES])
{
    const struct gb_entry *level = s->at + time * s->n_levels;
    const bool down = gb_counts_down(s->at); /* as gb_axes has it, for all times */
    struct gb_file in;
    size_t taken = 0;
    if (!gb_open(path, &in, err)) return false;
    double *values = xmalloc((size_t)g->n[0] * g->n[1], sizeof *values);
    bool good;
    while ((good = gb_next(&in, err)) && in.h && taken < s->n_levels)
        for (size_t k = 0; good && k < s->n_levels; k++) {
            if (level[k].number != in.number) continue;
            good = take_values(in.h, g, down ? s->n_levels - 1 - k : k, values, err);
            if (!good) goto out;
            taken++;
        }
out:
    free(values);
    gb_close(&in);
    if (good && taken < s->n_levels)
        good = err_set(err, "the file has changed, expected the same messages");
    return good;
}
