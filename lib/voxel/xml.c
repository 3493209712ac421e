/*
 * xml: VTK's XML files of an image (.vti) or a rectilinear grid (.vtr). "VTK XML Formats", Kitware.
 *
 * libexpat finds the elements. Numbers stay where they are in the file: their places are noted. Raw
 * bytes at the end are no XML, so parsing stops at the element that has them.
 */
#include "voxel/voxel_int.h"

#include <expat.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define PIECE (1U << 20) /* bytes that expat gets at a time */
#define ARRAYS_MAX 10000

enum where { OUTSIDE, POINTS, CELLS, AXES }; /* the element around a DataArray */

/* A DataArray of the file. */
struct element {
    char name[GRID_NAME];
    enum where where;
    struct voxel_type type; /* size 0: no numbers */
    uint64_t components, offset;
    bool appended, text;
    size_t begin, end; /* of its own text in the file */
};

struct parsing {
    struct voxel *v;
    XML_Parser parser;
    bool failed, rectilinear, big, packed, piece;
    uint8_t word;
    double extent[6], origin[3], spacing[3], direction[9];
    enum where where;
    int depth, inside; /* inside: the depth of the DataArray; 0: none is open */
    struct element *at;
    size_t n, appended; /* appended: where appended numbers begin; 0: nowhere */
    bool base64;        /* they are in base64 */
};

/* ---- elements -------------------------------------------------------------------------------- */

static void fail(struct parsing *p, const char *what, const char *expected)
{
    if (p->failed) return;
    p->failed = true;
    char shown[ERR_WORD];
    p->v->line = (size_t)XML_GetCurrentLineNumber(p->parser);
    voxel_fail(p->v, "%s, expected %s", err_word(shown, what, strlen(what)), expected);
    XML_StopParser(p->parser, XML_FALSE);
}

static const char *attribute(const char **attributes, const char *name, const char *otherwise)
{
    for (; *attributes; attributes += 2)
        if (strcmp(*attributes, name) == 0) return attributes[1];
    return otherwise;
}

static void reals(struct parsing *p, const char *name, const char *text, size_t n, double *out)
{
    if (p->failed) return;
    p->v->line = (size_t)XML_GetCurrentLineNumber(p->parser);
    if (voxel_reals(p->v, name, text, n, out)) return;
    p->failed = true;
    XML_StopParser(p->parser, XML_FALSE);
}

static void open_file(struct parsing *p, const char **a)
{
    const char *type = attribute(a, "type", ""), *by = attribute(a, "compressor", "");
    p->rectilinear = strcmp(type, "RectilinearGrid") == 0;
    if (!p->rectilinear && strcmp(type, "ImageData") != 0)
        fail(p, type, "ImageData (.vti) or RectilinearGrid (.vtr) in one file");
    p->big = strcmp(attribute(a, "byte_order", "LittleEndian"), "BigEndian") == 0;
    p->word = strcmp(attribute(a, "header_type", "UInt32"), "UInt64") == 0 ? 8 : 4;
    p->packed = *by != '\0';
    if (p->packed && strcmp(by, "vtkZLibDataCompressor") != 0)
        fail(p, by, "no compressor, or vtkZLibDataCompressor");
}

static void open_grid(struct parsing *p, const char **a)
{
    reals(p, "WholeExtent", attribute(a, "WholeExtent", ""), 6, p->extent);
    reals(p, "Origin", attribute(a, "Origin", "0 0 0"), 3, p->origin);
    reals(p, "Spacing", attribute(a, "Spacing", "1 1 1"), 3, p->spacing);
    reals(p, "Direction", attribute(a, "Direction", "1 0 0 0 1 0 0 0 1"), 9, p->direction);
}

/* A file in several pieces has arrays of several names alike, each of a part. */
static void open_piece(struct parsing *p, const char **a)
{
    double extent[6] = {0};
    reals(p, "Extent", attribute(a, "Extent", ""), 6, extent);
    if (p->failed) return;
    bool whole = !p->piece;
    for (int i = 0; i < 6; i++) whole = whole && extent[i] == p->extent[i];
    if (!whole) {
        p->failed = true;
        voxel_fail(p->v, "a Piece of a part of the grid, expected one Piece of the whole");
        XML_StopParser(p->parser, XML_FALSE);
    }
    p->piece = true;
}

static struct voxel_type type_of(const char *name)
{
    static const struct {
        const char *name;
        struct voxel_type type;
    } types[] = {{"Int8", {1, VOXEL_SIGNED}}, {"UInt8", {1, VOXEL_UNSIGNED}},
        {"Int16", {2, VOXEL_SIGNED}}, {"UInt16", {2, VOXEL_UNSIGNED}}, {"Int32", {4, VOXEL_SIGNED}},
        {"UInt32", {4, VOXEL_UNSIGNED}}, {"Int64", {8, VOXEL_SIGNED}},
        {"UInt64", {8, VOXEL_UNSIGNED}}, {"Float32", {4, VOXEL_REAL}},
        {"Float64", {8, VOXEL_REAL}}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(name, types[i].name) == 0) return types[i].type;
    return (struct voxel_type){0, 0};
}

static void open_array(struct parsing *p, const char **a)
{
    const char *format = attribute(a, "format", "ascii");
    int64_t components = 0, offset = 0;
    if (p->n == ARRAYS_MAX) fail(p, "a DataArray", "10000 at most");
    if (!parse_int(attribute(a, "NumberOfComponents", "1"), 1, VOXEL_NODES_MAX, &components))
        fail(p, attribute(a, "NumberOfComponents", ""), "NumberOfComponents, 1 or more");
    if (!parse_int(attribute(a, "offset", "0"), 0, INT64_MAX, &offset))
        fail(p, attribute(a, "offset", ""), "an offset in bytes");
    if (p->failed) return;
    p->at = xgrown(p->at, p->n, sizeof *p->at);
    struct element *e = &p->at[p->n++];
    *e = (struct element){.where = p->where,
        .type = type_of(attribute(a, "type", "")),
        .components = (uint64_t)components,
        .offset = (uint64_t)offset,
        .appended = strcmp(format, "appended") == 0,
        .text = strcmp(format, "ascii") == 0};
    snprintf(e->name, sizeof e->name, "%s", attribute(a, "Name", ""));
    p->inside = p->depth;
}

/* Numbers follow a line of blanks and an underscore. */
static void open_appended(struct parsing *p, const char **a)
{
    size_t at = (size_t)XML_GetCurrentByteIndex(p->parser);
    at += (size_t)XML_GetCurrentByteCount(p->parser);
    while (at < p->v->n_bytes && p->v->bytes[at] != '_') at++;
    p->appended = at < p->v->n_bytes ? at + 1 : at;
    p->base64 = strcmp(attribute(a, "encoding", "raw"), "base64") == 0;
    XML_StopParser(p->parser, XML_FALSE);
}

static void XMLCALL opened(void *ctx, const char *name, const char **a)
{
    struct parsing *p = ctx;
    p->depth++;
    if (p->failed) return;
    if (p->depth == 1 && strcmp(name, "VTKFile") != 0) fail(p, name, "VTKFile");
    else if (p->depth == 1) open_file(p, a);
    else if (p->depth == 2 && strcmp(name, "AppendedData") == 0) open_appended(p, a);
    else if (p->depth == 2) open_grid(p, a);
    else if (p->depth == 3 && strcmp(name, "Piece") == 0) open_piece(p, a);
    else if (p->depth == 4 && strcmp(name, "PointData") == 0) p->where = POINTS;
    else if (p->depth == 4 && strcmp(name, "CellData") == 0) p->where = CELLS;
    else if (p->depth == 4 && strcmp(name, "Coordinates") == 0) p->where = AXES;
    else if (p->depth == 5 && p->where != OUTSIDE && strcmp(name, "DataArray") == 0)
        open_array(p, a);
}

static void XMLCALL closed(void *ctx, const char *name)
{
    struct parsing *p = ctx;
    (void)name;
    if (p->inside == p->depth) p->inside = 0;
    if (p->depth == 4) p->where = OUTSIDE;
    p->depth--;
}

static void XMLCALL texts(void *ctx, const char *text, int n)
{
    struct parsing *p = ctx;
    if (!p->inside || p->depth != p->inside) return;
    struct element *e = &p->at[p->n - 1];
    int i = 0;
    while (i < n && strchr(" \t\r\n", text[i])) i++;
    if (i == n) return;
    const size_t at = (size_t)XML_GetCurrentByteIndex(p->parser);
    if (!e->end) e->begin = at;
    e->end = at + (size_t)XML_GetCurrentByteCount(p->parser);
}

static void XMLCALL declared(
    void *ctx, const char *name, const char *system, const char *public, int internal)
{
    (void)name, (void)system, (void)public, (void)internal;
    fail(ctx, "DOCTYPE", "no declarations");
}

/* ---- the grid -------------------------------------------------------------------------------- */

static bool source_of(struct parsing *p, const struct element *e, struct voxel_source *s)
{
    struct voxel *v = p->v;
    if (e->appended && (!p->appended || e->offset > v->n_bytes - p->appended))
        return voxel_fail(v,
            "'%s': its values begin after the end of the file, expected an offset "
            "within it",
            e->name);
    const size_t begin = e->appended ? p->appended + (size_t)e->offset : e->begin;
    *s = (struct voxel_source){.p = v->bytes + begin,
        .n = (e->appended ? v->n_bytes : e->end) - begin,
        .packing = e->text ? VOXEL_TEXT : VOXEL_BLOCKS,
        .big = p->big,
        .base64 = e->appended ? p->base64 : true,
        .packed = p->packed,
        .word = p->word};
    return true;
}

static bool read_axis(struct parsing *p, int axis, const struct element *e)
{
    struct voxel *v = p->v;
    struct voxel_source s;
    struct voxel_row row = {.p = NULL};
    if (!e->type.size || e->components != 1)
        return voxel_fail(v, "coordinates of another type, expected numbers");
    bool good = source_of(p, e, &s) && voxel_unpack(v, &s, e->type, v->n[axis], &row);
    if (good) v->at[axis] = xmalloc(v->n[axis], sizeof *v->at[axis]);
    for (uint32_t i = 0; good && i < v->n[axis]; i++)
        v->at[axis][i] = voxel_decode(row.p + (size_t)i * row.type.size, row.type, row.big);
    buf_free(&row.own);
    return good;
}

static bool read_axes(struct parsing *p)
{
    int axis = 0;
    for (size_t i = 0; i < p->n; i++)
        if (p->at[i].where == AXES && axis < 3 && !read_axis(p, axis++, &p->at[i])) return false;
    return axis == 3 || voxel_fail(p->v, "%d arrays of coordinates, expected 3", axis);
}

/* Node 0 0 0 has the origin, also where the extent begins elsewhere. */
static void place(struct parsing *p)
{
    struct voxel *v = p->v;
    for (int k = 0; k < 3; k++) {
        v->origin[k] = p->origin[k];
        for (int i = 0; i < 3; i++) {
            v->step[i][k] = p->direction[3 * k + i] * p->spacing[i];
            v->origin[k] += v->step[i][k] * p->extent[2 * i];
        }
    }
}

static bool take(struct parsing *p)
{
    struct voxel *v = p->v;
    v->line = 0;
    if (!p->piece) return voxel_fail(v, "no Piece, expected one");
    for (int i = 0; i < 3; i++) {
        const double n = p->extent[2 * i + 1] - p->extent[2 * i] + 1;
        if (!voxel_set_nodes(v, i, n >= 0 && n < 1e9 ? (int64_t)n : 0)) return false;
    }
    place(p);
    if (p->rectilinear && !read_axes(p)) return false;
    for (size_t i = 0; i < p->n; i++) {
        const struct element *e = &p->at[i];
        if (e->where == AXES || !e->type.size) continue;
        struct voxel_array *a = voxel_add(v, e->name, e->type, e->components, e->where == CELLS);
        if (!source_of(p, e, &a->at)) return false;
    }
    return true;
}

static bool parse(struct parsing *p)
{
    struct voxel *v = p->v;
    enum XML_Status status = XML_STATUS_OK;
    for (size_t at = 0; status == XML_STATUS_OK && at <= v->n_bytes; at += PIECE) {
        const size_t left = v->n_bytes - at;
        const bool last = left <= PIECE;
        status =
            XML_Parse(p->parser, (const char *)v->bytes + at, (int)(last ? left : PIECE), last);
        if (last) break;
    }
    if (status == XML_STATUS_OK || p->failed || p->appended) return !p->failed;
    v->line = (size_t)XML_GetCurrentLineNumber(p->parser);
    return voxel_fail(v, "%s, expected XML of VTK", XML_ErrorString(XML_GetErrorCode(p->parser)));
}

bool voxel_read_xml(struct voxel *v)
{
    struct parsing p = {.v = v, .parser = XML_ParserCreate(NULL)};
    if (!p.parser) die(ST_SYSTEM, "no memory to parse");
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, opened, closed);
    XML_SetCharacterDataHandler(p.parser, texts);
    XML_SetStartDoctypeDeclHandler(p.parser, declared);
    const bool good = parse(&p) && take(&p);
    XML_ParserFree(p.parser);
    free(p.at);
    return good;
}
