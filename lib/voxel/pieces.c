/*
 * pieces: the grid of VTK's XML files, whose pieces may each have a part. Pieces share the nodes
 * between them, and may overlap by some cells.
 */
#include "voxel/xml.h"

#include <stdlib.h>
#include <string.h>

/* ---- the grid -------------------------------------------------------------------------------- */

/* The nodes of a piece. False if it has none. */
static bool is_piece(const struct xml_piece *piece)
{
    const double *e = piece->extent;
    return !piece->source && e[1] >= e[0] && e[3] >= e[2] && e[5] >= e[4];
}

static bool check_pieces(struct voxel *v, const struct xml_grid *g)
{
    size_t n = 0;
    for (size_t i = 0; i < g->n_pieces; i++) {
        const double *e = g->piece[i].extent, *whole = g->extent;
        if (!is_piece(&g->piece[i])) continue;
        n++;
        for (int k = 0; k < 6; k++)
            if (e[k] != floor(e[k]) || e[k] < whole[k / 2 * 2] || e[k] > whole[k / 2 * 2 + 1])
                return voxel_fail(v, "a Piece from %g to %g on axis %d, expected it in %g to %g",
                    e[k / 2 * 2], e[k / 2 * 2 + 1], k / 2 + 1, whole[k / 2 * 2],
                    whole[k / 2 * 2 + 1]);
    }
    return n || voxel_fail(v, "no Piece, expected one");
}

/* Coordinates of a piece. NaN stands where no piece had any yet. */
static bool read_axis(
    struct voxel *v, const struct xml_grid *g, const struct xml_array *e, int axis)
{
    struct voxel_row row = {.p = NULL};
    const double *extent = g->piece[e->piece].extent;
    const uint32_t first = (uint32_t)(extent[2 * axis] - g->extent[2 * axis]);
    const uint32_t n = (uint32_t)(extent[2 * axis + 1] - extent[2 * axis]) + 1;
    if (!e->type.size || e->components != 1)
        return voxel_fail(v, "coordinates of another type, expected numbers");
    const bool good = voxel_unpack(v, &e->source, e->type, n, &row);
    if (!v->at[axis]) {
        v->at[axis] = xmalloc(v->n[axis], sizeof *v->at[axis]);
        for (uint32_t i = 0; i < v->n[axis]; i++) v->at[axis][i] = (double)NAN;
    }
    for (uint32_t i = 0; good && i < n; i++)
        v->at[axis][first + i] = voxel_decode(row.p + (size_t)i * row.type.size, row.type, row.big);
    buf_free(&row.own);
    return good;
}

static bool read_axes(struct voxel *v, const struct xml_grid *g)
{
    int axis = 0;
    size_t piece = 0;
    for (size_t i = 0; i < g->n; i++) {
        const struct xml_array *e = &g->at[i];
        if (e->where != XML_AXES || !is_piece(&g->piece[e->piece])) continue;
        if (e->piece != piece) piece = e->piece, axis = 0;
        if (axis < 3 && !read_axis(v, g, e, axis++)) return false;
    }
    if (axis != 3) return voxel_fail(v, "%d arrays of coordinates, expected 3", axis);
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < v->n[k]; i++)
            if (isnan(v->at[k][i]))
                return voxel_fail(v,
                    "axis %d has no coordinate of node %u, expected numbers, and Pieces that "
                    "cover the grid",
                    k + 1, i + 1);
    return true;
}

/* Node 0 0 0 has the origin, also where the extent begins elsewhere. */
static void place(struct voxel *v, const struct xml_grid *g)
{
    for (int k = 0; k < 3; k++) {
        v->origin[k] = g->origin[k];
        for (int i = 0; i < 3; i++) {
            v->step[i][k] = g->direction[3 * k + i] * g->spacing[i];
            v->origin[k] += v->step[i][k] * g->extent[2 * i];
        }
    }
}

/* The array with the name of one of a piece. It is made for the first one. */
static struct voxel_array *array_of(struct voxel *v, const struct xml_array *e)
{
    const bool cells = e->where == XML_CELLS;
    for (size_t i = 0; i < v->n_arrays; i++)
        if (v->array[i].cells == cells && strcmp(v->array[i].name, e->name) == 0)
            return &v->array[i];
    return voxel_add(v, e->name, e->type, e->components, cells);
}

static bool add_part(struct voxel *v, const struct xml_grid *g, const struct xml_array *e)
{
    struct voxel_array *a = array_of(v, e);
    const double *extent = g->piece[e->piece].extent;
    struct voxel_part part = {.at = e->source};
    for (int axis = 0; axis < 3; axis++) {
        part.first[axis] = (uint32_t)(extent[2 * axis] - g->extent[2 * axis]);
        part.n[axis] = (uint32_t)(extent[2 * axis + 1] - extent[2 * axis]) + 1;
        if (a->cells && v->n[axis] > 1) part.n[axis]--;
    }
    if (memcmp(&a->type, &e->type, sizeof a->type) != 0 || a->components != e->components)
        return voxel_fail(v, "'%s' has other numbers in another Piece, expected one type", e->name);
    a->part = xgrown(a->part, a->n_parts, sizeof *a->part);
    a->part[a->n_parts++] = part;
    return true;
}

bool voxel_take_xml(struct voxel *v, const struct xml_grid *g)
{
    v->line = 0;
    for (int i = 0; i < 3; i++) {
        const double n = g->extent[2 * i + 1] - g->extent[2 * i] + 1;
        if (!voxel_set_nodes(v, i, n >= 0 && n < 1e9 ? (int64_t)n : 0)) return false;
    }
    if (!check_pieces(v, g)) return false;
    place(v, g);
    if (g->rectilinear && !read_axes(v, g)) return false;
    for (size_t i = 0; i < g->n; i++) {
        const struct xml_array *e = &g->at[i];
        if (e->where == XML_AXES || !e->type.size || !is_piece(&g->piece[e->piece])) continue;
        if (!add_part(v, g, e)) return false;
    }
    return true;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static uint64_t numbers_of(const struct voxel_array *a, const struct voxel_part *part)
{
    return a->components * part->n[0] * part->n[1] * part->n[2];
}

/* Puts the numbers of a part into those of the grid, and notes which values are there. */
static void put(const struct voxel_array *a, const struct voxel_part *part,
    const struct voxel_row *from, double *to, bool *there)
{
    const unsigned char *p = from->p;
    for (uint32_t k = 0; k < part->n[2]; k++)
        for (uint32_t j = 0; j < part->n[1]; j++) {
            const uint64_t at = (part->first[2] + k) * a->stride[2] +
                                (part->first[1] + j) * a->stride[1] + part->first[0] * a->stride[0];
            for (uint64_t i = 0; i < part->n[0] * a->components; i++, p += from->type.size)
                to[at + i] = voxel_decode(p, from->type, from->big);
            memset(there + at / a->components, true, part->n[0]);
        }
}

/* Unpacks each part, and puts it into `to`, unless that is NULL. */
static bool unpack_parts(struct voxel *v, const struct voxel_array *a, double *to, bool *there)
{
    bool good = true;
    for (size_t i = 0; good && i < a->n_parts; i++) {
        struct voxel_row from = {.p = NULL};
        const struct voxel_part *part = &a->part[i];
        good = voxel_unpack(v, &part->at, a->type, numbers_of(a, part), &from);
        if (good && to) put(a, part, &from, to, there);
        buf_free(&from.own);
    }
    return good;
}

/* Joins the parts. Memory is taken when their numbers turned out to be there. */
static bool join(struct voxel *v, const struct voxel_array *a, uint64_t n, struct voxel_row *row)
{
    const uint64_t values = n / a->components;
    uint64_t sum = 0, missing = 0;
    for (size_t i = 0; i < a->n_parts && sum < n; i++) sum += numbers_of(a, &a->part[i]);
    if (sum >= n && !unpack_parts(v, a, NULL, NULL)) return false;
    bool *there = sum < n ? NULL : xcalloc(values, sizeof *there);
    double *to = sum < n ? NULL : (double *)(void *)buf_reserve(&row->own, n * sizeof *to);
    bool good = there && unpack_parts(v, a, to, there);
    for (uint64_t i = 0; good && i < values; i++) missing += !there[i];
    free(there);
    if (sum < n || missing)
        return voxel_fail(v,
            "'%s' has no values of a part of the grid, expected Pieces that "
            "cover it",
            a->name);
    row->own.len += good ? n * sizeof *to : 0;
    voxel_row_of_doubles(row);
    return good;
}

bool voxel_row(struct voxel *v, const struct voxel_array *a, struct voxel_row *row)
{
    const uint64_t n = voxel_numbers(v, a);
    const struct voxel_source *s = a->n_parts ? &a->part[0].at : &a->at;
    const bool whole = !a->n_parts || (a->n_parts == 1 && numbers_of(a, &a->part[0]) == n);
    *row = (struct voxel_row){.p = NULL};
    return whole ? voxel_unpack(v, s, a->type, n, row) : join(v, a, n, row);
}
