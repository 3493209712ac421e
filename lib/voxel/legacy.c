/*
 * legacy: VTK's legacy files of an image (STRUCTURED_POINTS) or a rectilinear grid, with any arrays
 * of points and cells. "VTK File Formats", Kitware. lib/grid reads only files of one scalar.
 *
 * The places of numbers are noted; of text, after its words were counted.
 */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define FIELDS_MAX 1000 /* arrays of a FIELD */

struct reader {
    struct voxel *v;
    size_t at;
    char word[VOXEL_LINE]; /* the last word */
    bool binary, rectilinear, cells;
    bool given[4];   /* DIMENSIONS, and coordinates along x, y, z */
    double first[3]; /* EXTENT: the number of the first node; node 0 has the origin */
    uint64_t tuples; /* values of each array */
};

static const struct {
    const char *name;
    struct voxel_type type;
} types[] = {{"float", {4, VOXEL_REAL}}, {"double", {8, VOXEL_REAL}}, {"char", {1, VOXEL_SIGNED}},
    {"signed_char", {1, VOXEL_SIGNED}}, {"unsigned_char", {1, VOXEL_UNSIGNED}},
    {"short", {2, VOXEL_SIGNED}}, {"unsigned_short", {2, VOXEL_UNSIGNED}},
    {"int", {4, VOXEL_SIGNED}}, {"unsigned_int", {4, VOXEL_UNSIGNED}}, {"long", {8, VOXEL_SIGNED}},
    {"unsigned_long", {8, VOXEL_UNSIGNED}}, {"vtktypeint64", {8, VOXEL_SIGNED}},
    {"vtktypeuint64", {8, VOXEL_UNSIGNED}}, {"vtkidtype", {4, VOXEL_SIGNED}}};

/* ---- words ----------------------------------------------------------------------------------- */

/* False at the end of the file. */
static bool next(struct reader *r)
{
    const struct voxel *v = r->v;
    const size_t n = voxel_word(v->bytes, v->n_bytes, false, &r->at);
    snprintf(r->word, sizeof r->word, "%.*s", (int)(n < VOXEL_LINE ? n : 0),
        (const char *)v->bytes + r->at);
    r->at += n;
    return n > 0;
}
static bool is(const struct reader *r, const char *word) { return strcasecmp(r->word, word) == 0; }

static bool fail(struct reader *r, const char *expected)
{
    char shown[ERR_WORD];
    const unsigned char *p = r->v->bytes, *end = p + r->at;
    r->v->line = 1;
    for (; p < end; p++) r->v->line += *p == '\n';
    return voxel_fail(r->v, "%s, expected %s", err_word(shown, r->word, strlen(r->word)), expected);
}

/* The last word as a name: %XX stands for a byte. */
static void name_of(const struct reader *r, char name[GRID_NAME])
{
    size_t n = 0;
    for (const char *c = r->word; *c && n + 1 < GRID_NAME; c++) {
        static const char digits[] = "0123456789abcdef0123456789ABCDEF";
        const char *high = *c == '%' && c[1] ? strchr(digits, c[1]) : NULL;
        const char *low = high && c[2] ? strchr(digits, c[2]) : NULL;
        name[n++] = low ? (char)((high - digits) % 16 * 16 + (low - digits) % 16) : *c;
        if (low) c += 2;
    }
    name[n] = '\0';
}

static bool expect(struct reader *r, const char *word)
{
    next(r);
    return is(r, word) || fail(r, word);
}

static bool count(struct reader *r, const char *what, int64_t most, uint64_t *n)
{
    int64_t value;
    next(r);
    if (!parse_int(r->word, 0, most, &value)) return fail(r, what);
    *n = (uint64_t)value;
    return true;
}

static bool real(struct reader *r, double *out)
{
    next(r);
    return voxel_number((const unsigned char *)r->word, strlen(r->word), out) ||
           fail(r, "a number");
}

static bool type(struct reader *r, struct voxel_type *t)
{
    next(r);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (is(r, types[i].name)) {
            *t = types[i].type;
            return true;
        }
    return is(r, "bit") || is(r, "string") ? fail(r, "numbers of whole bytes")
                                           : fail(r, "a type of numbers");
}

static bool line_end(struct reader *r)
{
    const unsigned char *p = r->v->bytes;
    const size_t n = r->v->n_bytes;
    while (r->at < n && (p[r->at] == ' ' || p[r->at] == '\t' || p[r->at] == '\r')) r->at++;
    if (r->at == n || p[r->at] != '\n') return fail(r, "a line end before bytes");
    r->at++;
    return true;
}

/* Passes over numbers; *s is where they are. */
static bool numbers(struct reader *r, struct voxel_type t, uint64_t n, struct voxel_source *s)
{
    const struct voxel *v = r->v;
    if (r->binary && n && !line_end(r)) return false;
    const uint64_t left = v->n_bytes - r->at;
    *s = (struct voxel_source){.p = v->bytes + r->at,
        .big = true,
        .packing = r->binary ? VOXEL_RAW : VOXEL_TEXT,
        .file = v->bytes};
    if (n > left / (r->binary ? t.size : 1))
        return voxel_fail(r->v, "bytes for fewer numbers, expected %llu", (unsigned long long)n);
    if (r->binary) r->at += n * t.size;
    for (uint64_t i = 0; i < n && !r->binary; i++) {
        const size_t length = voxel_word(v->bytes, v->n_bytes, false, &r->at);
        if (!length)
            return voxel_fail(
                r->v, "%llu numbers, expected %llu", (unsigned long long)i, (unsigned long long)n);
        r->at += length;
    }
    s->n = (size_t)(v->bytes + r->at - s->p);
    return true;
}

/* What VTK's writer puts after arrays: lines up to an empty one. */
static void skip_metadata(struct reader *r)
{
    char line[VOXEL_LINE], *text;
    *r->v->err = '\0';
    r->at += r->at < r->v->n_bytes && r->v->bytes[r->at] == '\n';
    while ((text = voxel_line(r->v, &r->at, line)) != NULL && *text) continue;
    r->v->line = 0;
}

/* Passes over strings: a line each; or bytes after their number, whose first two bits say how many
 * bytes it has. The line of their type ends before. */
static bool skip_strings(struct reader *r, uint64_t n)
{
    const struct voxel *v = r->v;
    for (uint64_t i = 0; i <= n; i++) {
        const unsigned char *p = v->bytes + r->at, *nl = NULL;
        const size_t left = v->n_bytes - r->at;
        uint64_t length = left && i && r->binary ? *p & 0x3f : 0;
        const size_t head = left && i && r->binary ? (size_t)8 >> (*p >> 6) : 0;
        for (size_t k = 1; k < head && k < left; k++) length = length << 8 | p[k];
        if (!head && left && (nl = memchr(p, '\n', left))) length = (size_t)(nl + 1 - p);
        if (!(head || nl) || head > left || length > left - head)
            return voxel_fail(r->v, "the file ends within strings, expected all");
        r->at += head + (size_t)length;
    }
    return true;
}

/* ---- geometry -------------------------------------------------------------------------------- */

static bool read_dimensions(struct reader *r)
{
    uint64_t n = 0;
    for (int i = 0; i < 3; i++)
        if (!count(r, "a number of nodes", INT32_MAX, &n) || !voxel_set_nodes(r->v, i, (int64_t)n))
            return false;
    r->given[0] = true;
    return true;
}

/* Instead of dimensions: the first and the last node on each axis. */
static bool read_extent(struct reader *r)
{
    for (int i = 0; i < 3; i++) {
        int64_t end[2] = {0};
        for (int k = 0; k < 2; k++) {
            next(r);
            if (!parse_int(r->word, -INT32_MAX, INT32_MAX, &end[k]))
                return fail(r, "the number of a node");
        }
        if (!voxel_set_nodes(r->v, i, end[1] - end[0] + 1)) return false;
        r->first[i] = (double)end[0];
    }
    r->given[0] = true;
    return true;
}

static bool read_coordinates(struct reader *r, int axis)
{
    struct voxel *v = r->v;
    struct voxel_type t;
    struct voxel_source s;
    struct voxel_row row = {.p = NULL};
    uint64_t n = 0;
    if (!count(r, "a number of coordinates", INT32_MAX, &n) || !type(r, &t)) return false;
    if (!r->given[0] || n != v->n[axis] || r->given[axis + 1])
        return fail(r, "as many coordinates as DIMENSIONS says, once");
    bool good = numbers(r, t, n, &s) && voxel_unpack(v, &s, t, n, &row);
    if (good) v->at[axis] = xmalloc(n, sizeof *v->at[axis]);
    for (uint64_t i = 0; good && i < n; i++)
        v->at[axis][i] = voxel_decode(row.p + i * row.type.size, row.type, row.big);
    buf_free(&row.own);
    r->given[axis + 1] = good;
    return good;
}

/* ---- arrays ---------------------------------------------------------------------------------- */

/* Adds an array of points or cells. Arrays of the file as a whole are passed over. */
static bool add(
    struct reader *r, const char *name, struct voxel_type t, uint64_t components, uint64_t tuples)
{
    struct voxel_source s;
    if (components > VOXEL_NODES_MAX || tuples > UINT32_MAX * UINT64_C(256))
        return fail(r, "fewer numbers");
    if (!numbers(r, t, components * tuples, &s)) return false;
    if (!r->tuples || tuples != r->tuples || !components) return true;
    voxel_add(r->v, name, t, components, r->cells)->at = s;
    return true;
}

static bool read_field(struct reader *r)
{
    uint64_t arrays = 0, components = 0, tuples = 0;
    char name[GRID_NAME];
    next(r); /* its name */
    if (!count(r, "a number of arrays", FIELDS_MAX, &arrays)) return false;
    while (arrays) {
        struct voxel_type t;
        next(r);
        if (is(r, "METADATA")) {
            skip_metadata(r);
            continue;
        }
        name_of(r, name);
        if (!count(r, "a number of components", VOXEL_NODES_MAX, &components) ||
            !count(r, "a number of tuples", INT64_MAX, &tuples))
            return false;
        const size_t before = r->at;
        next(r);
        const bool strings = is(r, "string");
        if (!strings) r->at = before;
        if (strings ? !skip_strings(r, components * tuples)
                    : !type(r, &t) || !add(r, name, t, components, tuples))
            return false;
        arrays--;
    }
    return true;
}

static bool read_scalars(struct reader *r)
{
    char name[GRID_NAME];
    struct voxel_type t;
    uint64_t components = 1;
    next(r);
    name_of(r, name);
    if (!type(r, &t)) return false;
    next(r);
    if (!is(r, "LOOKUP_TABLE")) {
        int64_t n;
        if (!parse_int(r->word, 1, 4, &n)) return fail(r, "1 to 4 components, or LOOKUP_TABLE");
        components = (uint64_t)n;
        if (!expect(r, "LOOKUP_TABLE")) return false;
    }
    next(r);
    return add(r, name, t, components, r->tuples);
}

/* Arrays whose word says how many components they have. */
static bool read_named(struct reader *r, uint64_t components)
{
    char name[GRID_NAME];
    struct voxel_type t;
    next(r);
    name_of(r, name);
    return type(r, &t) && add(r, name, t, components, r->tuples);
}

/* Colours are bytes, and numbers from 0 to 1 as text. table: they belong to no node. */
static bool read_colours(struct reader *r, bool table)
{
    char name[GRID_NAME];
    uint64_t n = 0, components = 4;
    struct voxel_source s;
    const struct voxel_type t = {1, VOXEL_UNSIGNED};
    next(r);
    name_of(r, name);
    if (!count(r, "a number", INT32_MAX, &n)) return false;
    if (!table) components = n, n = r->tuples;
    if (table) return numbers(r, t, n * components, &s);
    const size_t before = r->v->n_arrays;
    if (!add(r, name, t, components, n)) return false;
    if (r->v->n_arrays > before) r->v->array[before].at.colours = !r->binary;
    return true;
}

static bool read_textures(struct reader *r)
{
    char name[GRID_NAME];
    uint64_t n = 0;
    struct voxel_type t;
    next(r);
    name_of(r, name);
    return count(r, "1 to 3 components", 3, &n) && type(r, &t) && add(r, name, t, n, r->tuples);
}

static bool read_attributes(struct reader *r, bool cells)
{
    const struct voxel *v = r->v;
    if (!r->given[0]) return fail(r, "DIMENSIONS before it");
    const uint64_t n = (uint64_t)voxel_side(v, cells, 0) * voxel_side(v, cells, 1);
    r->cells = cells;
    if (!count(r, "a number of values", INT64_MAX, &r->tuples)) return false;
    return (r->tuples && r->tuples / n == voxel_side(v, cells, 2) && r->tuples % n == 0) ||
           fail(r, cells ? "the number of cells" : "the number of nodes");
}

/* ---- the file -------------------------------------------------------------------------------- */

static bool read_part(struct reader *r)
{
    struct voxel *v = r->v;
    static const char *const axes[] = {"X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"};
    if (is(r, "DIMENSIONS")) return read_dimensions(r);
    if (is(r, "EXTENT")) return read_extent(r);
    if (is(r, "ORIGIN"))
        return real(r, &v->origin[0]) && real(r, &v->origin[1]) && real(r, &v->origin[2]);
    if (is(r, "SPACING") || is(r, "ASPECT_RATIO"))
        return real(r, &v->step[0][0]) && real(r, &v->step[1][1]) && real(r, &v->step[2][2]);
    for (int i = 0; i < 3; i++)
        if (is(r, axes[i])) return read_coordinates(r, i);
    if (is(r, "POINT_DATA")) return read_attributes(r, false);
    if (is(r, "CELL_DATA")) return read_attributes(r, true);
    if (is(r, "FIELD")) return read_field(r);
    if (is(r, "METADATA")) return skip_metadata(r), true;
    if (is(r, "LOOKUP_TABLE")) return read_colours(r, true);
    if (!r->tuples) return fail(r, "a part of an image or a rectilinear grid");
    if (is(r, "SCALARS")) return read_scalars(r);
    if (is(r, "VECTORS") || is(r, "NORMALS")) return read_named(r, 3);
    if (is(r, "TENSORS")) return read_named(r, 9);
    if (is(r, "TENSORS6")) return read_named(r, 6);
    if (is(r, "COLOR_SCALARS")) return read_colours(r, false);
    if (is(r, "TEXTURE_COORDINATES")) return read_textures(r);
    return fail(r, "SCALARS, VECTORS, FIELD or another kind of array");
}

static bool read_file_of(struct reader *r)
{
    char line[VOXEL_LINE];
    struct voxel *v = r->v;
    for (int i = 0; i < 2; i++)
        if (!voxel_line(v, &r->at, line))
            return i ? voxel_fail(v, "no title, expected a line") : false;
    v->line = 0;
    next(r);
    r->binary = is(r, "BINARY");
    if (!r->binary && !is(r, "ASCII")) return fail(r, "ASCII or BINARY");
    if (!expect(r, "DATASET")) return false;
    next(r);
    r->rectilinear = is(r, "RECTILINEAR_GRID");
    if (!r->rectilinear && !is(r, "STRUCTURED_POINTS"))
        return fail(r, "STRUCTURED_POINTS or RECTILINEAR_GRID");
    while (next(r))
        if (!read_part(r)) return false;
    for (int i = 0; i < 3; i++) v->origin[i] += v->step[i][i] * r->first[i];
    bool whole = r->given[0];
    for (int i = 1; i < 4; i++) whole = whole && r->given[i] == r->rectilinear;
    return whole || voxel_fail(v, "the file ends, expected all axes of the grid");
}

bool voxel_read_legacy(struct voxel *v)
{
    struct reader *r = xcalloc(1, sizeof *r);
    r->v = v;
    const bool good = read_file_of(r);
    free(r);
    return good;
}
