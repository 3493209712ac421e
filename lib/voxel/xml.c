/*
 * xml: VTK's XML files of an image (.vti) or a rectilinear grid (.vtr), in one or several pieces,
 * and lists of such files (.pvti, .pvtr). "VTK XML Formats", Kitware.
 *
 * libexpat finds the elements. Numbers stay where they are in the file: their places are noted. Raw
 * bytes at the end are no XML, so parsing stops at the element that has them. pieces.c makes the
 * grid.
 */
#include "voxel/xml.h"

#include <expat.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define PIECE (1U << 20) /* bytes that expat gets at a time */
#define ARRAYS_MAX 20000
#define PIECES_MAX 10000

struct parsing {
    struct voxel *v;
    XML_Parser parser;
    struct xml_grid *grid;
    bool failed, big, packed, list, listed; /* list: of files; listed: this is one of them */
    uint8_t word;
    enum xml_where where;
    int depth, inside; /* inside: the depth of the DataArray; 0: none is open */
    size_t first;      /* element of this file */
    size_t appended;   /* where appended numbers begin; 0: nowhere */
    bool base64;       /* they are in base64 */
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
    p->list = !p->listed && *type == 'P';
    const bool rectilinear = strcmp(type + p->list, "RectilinearGrid") == 0;
    if (!rectilinear && strcmp(type + p->list, "ImageData") != 0)
        fail(p, type, "ImageData (.vti) or RectilinearGrid (.vtr)");
    else if (p->listed && rectilinear != p->grid->rectilinear)
        fail(p, type, "the same kind of grid in each piece");
    p->grid->rectilinear = rectilinear;
    p->big = strcmp(attribute(a, "byte_order", "LittleEndian"), "BigEndian") == 0;
    p->word = strcmp(attribute(a, "header_type", "UInt32"), "UInt64") == 0 ? 8 : 4;
    p->packed = *by != '\0';
    if (p->packed && strcmp(by, "vtkZLibDataCompressor") != 0)
        fail(p, by, "no compressor, or vtkZLibDataCompressor");
}

static void open_grid(struct parsing *p, const char **a)
{
    struct xml_grid *g = p->grid;
    if (p->listed) return; /* the list counts */
    reals(p, "WholeExtent", attribute(a, "WholeExtent", ""), 6, g->extent);
    reals(p, "Origin", attribute(a, "Origin", "0 0 0"), 3, g->origin);
    reals(p, "Spacing", attribute(a, "Spacing", "1 1 1"), 3, g->spacing);
    reals(p, "Direction", attribute(a, "Direction", "1 0 0 0 1 0 0 0 1"), 9, g->direction);
}

/* A piece has a part of each array, or is in a file of its own. */
static void open_piece(struct parsing *p, const char **a)
{
    struct xml_grid *g = p->grid;
    if (g->n_pieces == PIECES_MAX) fail(p, "a Piece", "10000 at most");
    if (p->failed) return;
    g->piece = xgrown(g->piece, g->n_pieces, sizeof *g->piece);
    struct xml_piece *piece = &g->piece[g->n_pieces++];
    *piece = (struct xml_piece){.source = NULL};
    reals(p, "Extent", attribute(a, "Extent", ""), 6, piece->extent);
    if (p->list) piece->source = xstrdup(attribute(a, "Source", ""));
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
    struct xml_grid *g = p->grid;
    if (g->n == ARRAYS_MAX) fail(p, "a DataArray", "20000 at most");
    if (!parse_int(attribute(a, "NumberOfComponents", "1"), 1, VOXEL_NODES_MAX, &components))
        fail(p, attribute(a, "NumberOfComponents", ""), "NumberOfComponents, 1 or more");
    if (!parse_int(attribute(a, "offset", "0"), 0, INT64_MAX, &offset))
        fail(p, attribute(a, "offset", ""), "an offset in bytes");
    if (p->failed) return;
    g->at = xgrown(g->at, g->n, sizeof *g->at);
    struct xml_array *e = &g->at[g->n++];
    *e = (struct xml_array){.where = p->where,
        .piece = g->n_pieces - 1,
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
    else if (p->depth == 4 && strcmp(name, "PointData") == 0) p->where = XML_POINTS;
    else if (p->depth == 4 && strcmp(name, "CellData") == 0) p->where = XML_CELLS;
    else if (p->depth == 4 && strcmp(name, "Coordinates") == 0) p->where = XML_AXES;
    else if (p->depth == 5 && p->where != XML_OUTSIDE && strcmp(name, "DataArray") == 0)
        open_array(p, a);
}

static void XMLCALL closed(void *ctx, const char *name)
{
    struct parsing *p = ctx;
    (void)name;
    if (p->inside == p->depth) p->inside = 0;
    if (p->depth == 4) p->where = XML_OUTSIDE;
    p->depth--;
}

static void XMLCALL texts(void *ctx, const char *text, int n)
{
    struct parsing *p = ctx;
    if (!p->inside || p->depth != p->inside) return;
    struct xml_array *e = &p->grid->at[p->grid->n - 1];
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

/* ---- files ----------------------------------------------------------------------------------- */

static bool find_numbers(struct parsing *p, struct xml_array *e)
{
    struct voxel *v = p->v;
    if (e->appended && (!p->appended || e->offset > v->n_bytes - p->appended))
        return voxel_fail(v,
            "'%s': its values begin after the end of the file, expected an offset "
            "within it",
            e->name);
    const size_t begin = e->appended ? p->appended + (size_t)e->offset : e->begin;
    e->source = (struct voxel_source){.p = v->bytes + begin,
        .n = (e->appended ? v->n_bytes : e->end) - begin,
        .packing = e->text ? VOXEL_TEXT : VOXEL_BLOCKS,
        .big = p->big,
        .base64 = e->appended ? p->base64 : true,
        .packed = p->packed,
        .word = p->word,
        .name = v->name,
        .file = v->bytes};
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

/* Adds the pieces and arrays of the file. */
static bool read_one(struct voxel *v, bool listed, struct xml_grid *g)
{
    struct parsing p = {
        .v = v, .grid = g, .listed = listed, .first = g->n, .parser = XML_ParserCreate(NULL)};
    if (!p.parser) die(ST_SYSTEM, "no memory to parse");
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, opened, closed);
    XML_SetCharacterDataHandler(p.parser, texts);
    XML_SetStartDoctypeDeclHandler(p.parser, declared);
    bool good = parse(&p);
    XML_ParserFree(p.parser);
    v->line = 0;
    for (size_t i = p.first; good && i < g->n; i++) good = find_numbers(&p, &g->at[i]);
    return good;
}

/* Reads the file of a piece of a list. */
static bool read_listed(struct voxel *v, const char *name, struct xml_grid *g)
{
    struct voxel one = *v;
    struct buf bytes = {.data = NULL};
    if (!voxel_beside(v, name, &bytes)) return false;
    v->piece = xgrown(v->piece, v->n_pieces, sizeof *v->piece);
    v->piece[v->n_pieces++] = (struct voxel_file){xstrdup(name), bytes};
    one.name = v->piece[v->n_pieces - 1].name;
    one.bytes = buf_data(&bytes);
    one.n_bytes = buf_size(&bytes);
    return read_one(&one, true, g);
}

bool voxel_read_xml(struct voxel *v)
{
    struct xml_grid g = {.piece = NULL};
    bool good = read_one(v, false, &g);
    const size_t listed = g.n_pieces;
    for (size_t i = 0; good && i < listed; i++)
        if (g.piece[i].source) good = read_listed(v, g.piece[i].source, &g);
    good = good && voxel_take_xml(v, &g);
    for (size_t i = 0; i < g.n_pieces; i++) free(g.piece[i].source);
    free(g.piece);
    free(g.at);
    return good;
}
