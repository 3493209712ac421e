/*
 * place: the grid of an array. Each axis of the file becomes the axis of space that it is parallel
 * to, and ascends. An axis that is parallel to none is refused: a rectilinear grid cannot have it.
 */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>

#define ASKEW_MAX .01 /* of a step: how far the end of an axis may be off. Headers are rounded. */
/* Bits of vtkGhostType: points that are hidden; cells that are hidden, or
 * refined by cells of another grid. */
#define HIDDEN_POINT 2
#define HIDDEN_CELL (8 | 32)
#define PI 3.14159265358979323846

struct placing {
    int from[3];     /* the axis of the file that becomes x, y, z */
    double first[3]; /* coordinate of the first node on it, and the step */
    double step[3];
};

static bool place_even(struct voxel *v, bool own, struct placing *p)
{
    bool taken[3] = {false};
    for (int i = 0; i < 3; i++) {
        const double *s = v->step[i];
        const double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        int to = i;
        for (int k = 0; !own && k < 3; k++)
            if (fabs(s[k]) > fabs(s[to])) to = k;
        if (!(length > 0 && length < HUGE_VAL))
            return voxel_fail(v, "axis %d has a step of %g, expected more than 0", i + 1, length);
        const double cosine = fabs(s[to]) / length, sine = sqrt(fmax(0, 1 - cosine * cosine));
        double aside = 0;
        for (int k = 0; k < 3; k++)
            if (k != to) aside += fabs(s[k]);
        if (!own && (aside * (v->n[i] - 1) > ASKEW_MAX * length || taken[to]))
            return voxel_fail(v,
                "axis %d is turned by %.3g degrees from %c, expected an axis "
                "parallel to x, y or z; -a takes the axes as they are",
                i + 1, (sine > .5 ? acos(cosine) : asin(sine)) * 180 / PI, "xyz"[to]);
        taken[to] = true;
        p->from[to] = i;
        p->step[to] = own ? length : s[to];
        p->first[to] = own ? 0 : v->origin[to];
    }
    return true;
}

/* Coordinates of nodes, or of centres of cells, as they come in the file. */
static void coordinates(
    const struct voxel *v, const struct placing *p, int axis, uint32_t n, bool cells, double *at)
{
    const double *given = v->at[axis];
    for (uint32_t i = 0; i < n; i++)
        if (given) at[i] = cells ? given[i] + (given[i + 1] - given[i]) / 2 : given[i];
        else at[i] = p->first[axis] + p->step[axis] * (cells ? i + .5 : i);
}

/* Axes of the grid; down: those that descend in the file. */
static bool place_axes(struct voxel *v, const struct voxel_array *a, const struct placing *p,
    struct grid *g, bool down[3])
{
    char why[GRID_FAULT];
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t n = g->n[axis] = voxel_side(v, a->cells, p->from[axis]);
        const bool cells = a->cells && n < v->n[p->from[axis]];
        if (n < 2 && (cells || axis < 2))
            return voxel_fail(v, "%u %s along %c, expected 2 at least%s", n,
                cells ? "cells" : "nodes", "xyz"[axis], cells ? "" : "; only z may have 1");
        double *at = g->at[axis] = xmalloc(n, sizeof *at);
        coordinates(v, p, axis, n, cells, at);
        for (uint32_t i = 0; i < n; i++)
            if (!(fabs(at[i]) <= GRID_MAX))
                return voxel_fail(v, "%c of node %u is %g, expected at most %g", "xyz"[axis], i + 1,
                    at[i], GRID_MAX);
        const uint32_t fault = grid_axis_fault(at, n);
        if (fault) grid_axis_why(at, fault, why);
        if (fault) return voxel_fail(v, "%c of node %u is %s", "xyz"[axis], fault + 1, why);
        down[axis] = n > 1 && at[1] < at[0];
        for (uint32_t i = 0, j = n - 1; down[axis] && i < j; i++, j--) {
            const double swap = at[i];
            at[i] = at[j];
            at[j] = swap;
        }
    }
    return true;
}

/* ---- values ---------------------------------------------------------------------------------- */

/* The numbers of an array, and how to reach those of a node. */
struct reading {
    struct voxel_row row, ghost; /* ghost: bits of each value; no bytes: none */
    unsigned hidden;             /* those of values that are not shown */
    uint64_t components, component, component_stride;
    uint64_t stride[3], last[3]; /* along x, y, z; last: of the last node; 0: the axis ascends */
    double slope, offset;
};

static double value_at(const struct reading *r, uint64_t at)
{
    const struct voxel_row *row = &r->row;
    double sum = 0;
    if (r->component != VOXEL_LENGTH) {
        at += r->component * r->component_stride;
        return voxel_decode(row->p + at * row->type.size, row->type, row->big) * r->slope +
               r->offset;
    }
    for (uint64_t c = 0; c < r->components; c++, at += r->component_stride) {
        const double d = voxel_decode(row->p + at * row->type.size, row->type, row->big);
        sum += (d * r->slope + r->offset) * (d * r->slope + r->offset);
    }
    return sqrt(sum);
}

/* True if VTK does not show the value. A ghost has one number, the value `components`. */
static bool is_hidden(const struct reading *r, uint64_t at)
{
    const struct voxel_row *row = &r->ghost;
    if (!row->p) return false;
    const double bits =
        voxel_decode(row->p + at / r->components * row->type.size, row->type, row->big);
    return bits >= 0 && bits < 256 && ((unsigned)bits & r->hidden) != 0;
}

static uint64_t offset(const struct reading *r, int axis, uint32_t i)
{
    return r->last[axis] ? r->last[axis] - i * r->stride[axis] : i * r->stride[axis];
}

static bool read_values(struct voxel *v, const struct reading *r, struct grid *g)
{
    float *to = g->value = xmalloc(grid_node(g, 0, 0, g->n[2]), sizeof *g->value);
    for (uint32_t k = 0; k < g->n[2]; k++)
        for (uint32_t j = 0; j < g->n[1]; j++) {
            const uint64_t row = offset(r, 2, k) + offset(r, 1, j);
            for (uint32_t i = 0; i < g->n[0]; i++) {
                const uint64_t at = row + offset(r, 0, i);
                const double d = is_hidden(r, at) ? (double)NAN : value_at(r, at);
                if (fabs(d) > GRID_MAX)
                    return voxel_fail(v,
                        "a value is %g, expected numbers from %g to %g, and nan "
                        "for missing ones",
                        d, -GRID_MAX, GRID_MAX);
                *to++ = (float)d;
            }
        }
    return true;
}

bool voxel_grid(const struct voxel *volume, size_t array, uint64_t component, bool own,
    struct grid *g, char err[ERR_BYTES])
{
    struct voxel copy = *volume, *v = &copy; /* for messages */
    const struct voxel_array *a = &v->array[array];
    struct placing p = {.from = {0, 1, 2}};
    bool down[3] = {false};
    *g = (struct grid){.value = NULL};
    v->err = err, v->line = 0;
    if (component != VOXEL_LENGTH && component >= a->components)
        return voxel_fail(v, "component %llu of '%s', expected one below %llu",
            (unsigned long long)component, a->name, (unsigned long long)a->components);
    bool good = (v->at[0] || place_even(v, own, &p)) && place_axes(v, a, &p, g, down);
    struct reading r = {.components = a->components,
        .component = component,
        .component_stride = a->component_stride,
        .hidden = a->cells ? HIDDEN_CELL : HIDDEN_POINT,
        .slope = v->slope,
        .offset = v->offset};
    const struct voxel_array *ghost = &v->ghost[a->cells];
    for (int axis = 0; axis < 3; axis++) {
        r.stride[axis] = a->stride[p.from[axis]];
        if (down[axis]) r.last[axis] = (g->n[axis] - 1) * r.stride[axis];
    }
    good = good && (!ghost->components || voxel_row(v, ghost, &r.ghost)) &&
           voxel_row(v, a, &r.row) && read_values(v, &r, g);
    buf_free(&r.ghost.own);
    buf_free(&r.row.own);
    memcpy(g->name, a->name, sizeof g->name);
    if (!good) grid_free(g);
    return good;
}

/* Names and units come from files, and "; " is between the parts of a title. */
static void put_text(struct buf *title, const char *text)
{
    for (; *text; text++) buf_append(title, *text == ';' ? "," : text, 1);
}

void voxel_title(
    const struct voxel *v, const struct grid *g, const char *unit, bool own, struct buf *title)
{
    put_text(title, g->name);
    buf_printf(title, " [");
    put_text(title, unit ? unit : v->unit);
    for (int axis = 0; axis < 3; axis++) {
        buf_printf(title, "]; %c %s [", "xyz"[axis],
            own ? (const char *[]){"x", "y", "z"}[axis] : v->axis[axis]);
        put_text(title, v->length);
    }
    buf_printf(title, "]");
}
