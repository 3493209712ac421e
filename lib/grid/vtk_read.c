/*
 * vtk_read: reads a VTK legacy file as a grid. "VTK File Formats", Kitware, describes the format;
 * stormring-grid(5) lists the supported part.
 *
 * Keywords and types are words in any case. In BINARY files a block of numbers begins after the
 * line end that follows its header, big-endian, with the length given in the header. A header's
 * count is not trusted until that many bytes are present.
 */
#include "grid/vtk_text.h"
#include "os/os.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

#define GIVE_BACK 65536 /* minimum number of bytes to return at once */
#define FIELDS_MAX 1000 /* arrays of a skipped FIELD */

/* ---- the parts of a file ------------------------------------------------------------------- */

/* Consumes the rest of the line. Returns its end. */
static const unsigned char *read_line(struct vtk_reader *r)
{
    const unsigned char *nl = memchr(r->at, '\n', (size_t)(r->end - r->at));
    const unsigned char *end = nl ? nl : r->end;
    r->at = nl ? nl + 1 : end;
    return end;
}

static void read_title(struct vtk_reader *r, char title[GRID_TITLE])
{
    size_t n = 0;
    const unsigned char *p = r->at, *end = read_line(r);
    for (; p < end && n < GRID_TITLE - 1; p++) title[n++] = *p < ' ' || *p == 0x7f ? ' ' : (char)*p;
    while (n && title[n - 1] == ' ') n--;
    title[n] = '\0';
}

static bool read_head(struct vtk_reader *r, struct grid *g)
{
    static const char magic[] = "# vtk DataFile Version ";
    if ((size_t)(r->end - r->at) < sizeof magic - 1 ||
        strncasecmp((const char *)r->at, magic, sizeof magic - 1) != 0)
        return vtk_fail(r, "no VTK legacy file, expected '%s' and a version", magic);
    read_line(r);
    read_title(r, g->title);
    r->binary = vtk_take(r, "BINARY");
    if (!r->binary && !vtk_take(r, "ASCII")) return vtk_fail_word(r, "form", "ASCII or BINARY");
    return vtk_expect(r, "third part", "DATASET") &&
           (vtk_take(r, "RECTILINEAR_GRID") ||
               vtk_fail_word(
                   r, "dataset", "RECTILINEAR_GRID; vol2vtk makes one of STRUCTURED_POINTS"));
}

/* Skips FIELD arrays that belong to the whole file, such as its time, except those of a brick. */
static bool read_field(struct vtk_reader *r)
{
    char name[GRID_NAME];
    struct vtk_type t = vtk_types[0];
    uint64_t arrays = 0, components = 0, tuples = 0;
    double v = 0;
    if (!vtk_name(r, name) || !vtk_count(r, "number of arrays", 0, FIELDS_MAX, &arrays))
        return false;
    for (; arrays; arrays--) {
        if (!vtk_name(r, name) || !vtk_count(r, "number of components", 0, 1000, &components) ||
            !vtk_count(r, "number of tuples", 0, UINT32_MAX, &tuples))
            return false;
        if (vtk_take(r, "string")) {
            if (!vtk_skip_strings(r, components * tuples)) return false;
            continue;
        }
        if (!vtk_type(r, &t) || !vtk_begin_numbers(r, "numbers of a field", t, components * tuples))
            return false;
        bool good = true, taken = vtk_brick_array(r, name, t, components * tuples, &good);
        if (!good) return false;
        for (uint64_t i = 0; !taken && i < components * tuples; i++)
            if (r->binary) r->at += t.size;
            else if (!vtk_text(r, "number of a field", t, &v)) return false;
        vtk_skip_metadata(r);
    }
    return true;
}

static bool read_axis(struct vtk_reader *r, int axis, struct grid *g)
{
    char keyword[] = "?_COORDINATES";
    keyword[0] = "XYZ"[axis];
    uint64_t n = 0;
    struct vtk_type t = vtk_types[0];
    if (!vtk_expect(r, "next part", keyword) ||
        !vtk_count(r, "number of coordinates", g->n[axis], g->n[axis], &n) || !vtk_type(r, &t) ||
        !vtk_begin_numbers(r, keyword, t, n))
        return false;
    double *at = g->at[axis] = xmalloc(n, sizeof *at);
    for (uint32_t i = 0; i < n; i++) {
        if (!vtk_number(r, keyword, t, &at[i])) return false;
        if (isnan(at[i]))
            return vtk_fail(r, "%s: number %u is nan, expected a number", keyword, i + 1);
    }
    uint32_t fault = grid_axis_fault(at, (uint32_t)n);
    if (fault) {
        char why[GRID_FAULT];
        grid_axis_why(at, fault, why);
        return vtk_fail(r, "%s: number %u is %s", keyword, fault + 1, why);
    }
    r->down[axis] = n > 1 && at[1] < at[0];
    for (uint32_t i = 0, j = (uint32_t)n - 1; r->down[axis] && i < j; i++, j--) {
        double swap = at[i];
        at[i] = at[j];
        at[j] = swap;
    }
    vtk_skip_metadata(r);
    return true;
}

static bool read_geometry(struct vtk_reader *r, struct grid *g, uint64_t *nodes)
{
    static const char *const what[] = {"nodes along x", "nodes along y", "nodes along z"};
    uint64_t n = 2;
    if (vtk_take(r, "FIELD") && !read_field(r)) return false;
    if (!vtk_expect(r, "next part", "DIMENSIONS")) return false;
    *nodes = 1;
    for (int a = 0; a < 3; a++) {
        if (!vtk_count(r, what[a], a == 2 ? 1 : 2, INT32_MAX, &n)) return false;
        g->n[a] = (uint32_t)n;
        /* At least one byte per node, so that nothing overflows later. */
        if (*nodes > (uint64_t)(r->end - r->bytes) / n)
            return vtk_fail(
                r, "the file is too short for its DIMENSIONS, expected a number per node");
        *nodes *= n;
    }
    for (int a = 0; a < 3; a++)
        if (!read_axis(r, a, g)) return false;
    return vtk_brick(r, g);
}

/* Reads the header of the one scalar: SCALARS, or a FIELD of one array. */
static bool read_scalar_head(
    struct vtk_reader *r, uint64_t nodes, struct grid *g, struct vtk_type *t)
{
    char field[GRID_NAME];
    uint64_t n = 0;
    if (vtk_take(r, "FIELD"))
        return vtk_name(r, field) && vtk_count(r, "number of arrays", 1, 1, &n) &&
               vtk_name(r, g->name) && vtk_count(r, "number of components", 1, 1, &n) &&
               vtk_count(r, "number of tuples", nodes, nodes, &n) && vtk_type(r, t);
    if (vtk_next_is(r, "VECTORS"))
        return vtk_fail(r, "VECTORS, expected SCALARS; vol2vtk -k takes a component or the length");
    if (!vtk_take(r, "SCALARS")) return vtk_fail_word(r, "first word of the point data", "SCALARS");
    if (!vtk_name(r, g->name) || !vtk_type(r, t)) return false;
    if (!vtk_next_is(r, "LOOKUP_TABLE") && !vtk_count(r, "number of components", 1, 1, &n))
        return false;
    return vtk_expect(r, "next part", "LOOKUP_TABLE") && vtk_name(r, field);
}

/* Returns pages that were read to the system. */
static void give_back(struct vtk_reader *r)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t skip = -(uintptr_t)r->kept & (page - 1), n = (size_t)(r->at - r->kept);
    if (n < GIVE_BACK + skip) return;
    unsigned char *from = r->kept + skip, *to = from + ((n - skip) & ~(page - 1));
    r->line += vtk_lines(r->kept, to);
    r->kept = to;
    os_discard(from, (size_t)(to - from));
}

bool vtk_row(struct vtk_reader *r, struct vtk_type t, uint32_t n, bool down, float *row)
{
    double v = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!vtk_number(r, "values", t, &v)) return false;
        row[down ? n - 1 - i : i] = (float)v;
    }
    if (r->kept) give_back(r);
    return true;
}

/* Reads the values in file order and stores them with every axis ascending. */
static bool read_values(struct vtk_reader *r, struct vtk_type t, struct grid *g)
{
    const uint32_t *n = g->n;
    const bool *down = r->down;
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++) {
            float *row =
                g->value + grid_node(g, 0, down[1] ? n[1] - 1 - j : j, down[2] ? n[2] - 1 - k : k);
            if (!vtk_row(r, t, n[0], down[0], row)) return false;
        }
    return true;
}

bool vtk_head(struct vtk_reader *r, struct grid *g, struct vtk_type *t)
{
    uint64_t nodes = 0, n = 0;
    return read_head(r, g) && read_geometry(r, g, &nodes) &&
           (vtk_take(r, "POINT_DATA") || vtk_fail_word(r, "word after the coordinates",
                                             "POINT_DATA; vol2vtk moves CELL_DATA")) &&
           vtk_count(r, "number of point data", nodes, nodes, &n) &&
           read_scalar_head(r, nodes, g, t) && vtk_begin_numbers(r, "values", *t, nodes);
}

bool vtk_tail(struct vtk_reader *r)
{
    vtk_skip_metadata(r);
    return !vtk_peek(r) || vtk_fail_word(r, "word after the values",
                               "one scalar and the file's end; vol2vtk takes one");
}

static bool read_one(struct vtk_reader *r, struct grid *g)
{
    struct vtk_type t = vtk_types[0];
    if (!vtk_head(r, g, &t)) return false;
    g->value = xmalloc(grid_node(g, 0, 0, g->n[2]), sizeof *g->value);
    if (!read_values(r, t, g)) return false;
    vtk_skip_metadata(r);
    return true;
}

static bool same_axes(const struct grid *g, const struct grid *h)
{
    for (int a = 0; a < 3; a++) {
        if (g->n[a] != h->n[a]) return false;
        for (uint32_t i = 0; i < g->n[a]; i++)
            if (g->at[a][i] != h->at[a][i]) return false;
    }
    return true;
}

void vtk_name_further(struct grid *g, const struct grid *h)
{
    const bool ground = h->n[2] == 1;
    memcpy(ground ? g->ground_name : g->second_name, h->name, sizeof h->name);
    memcpy(ground ? g->ground_title : g->second_title, h->title, sizeof h->title);
}

/* A second level with the values of the only one. */
static void thicken(struct grid *g)
{
    const size_t n = (size_t)g->n[0] * g->n[1];
    g->flat = true;
    g->n[2] = 2;
    g->at[2] = xrealloc(g->at[2], 2, sizeof *g->at[2]);
    g->at[2][1] = g->at[2][0] + fmax(1, fabs(g->at[2][0]) * 0x1p-20);
    g->value = xrealloc(g->value, 2 * n, sizeof *g->value);
    memcpy(g->value + n, g->value, n * sizeof *g->value);
}

/* Makes h the ground or the second field of g. */
static bool take_further(struct vtk_reader *r, struct grid *g, struct grid *h)
{
    if (g->brick.is || h->brick.is)
        return vtk_fail(r, "a brick and another grid, expected one of them");
    vtk_name_further(g, h);
    if (h->n[2] == 1) {
        if (g->ground) return vtk_fail(r, "a second grid of one level, expected one at most");
        g->ground = xmalloc(1, sizeof *g->ground);
        *g->ground = *h;
        *h = (struct grid){0};
        grid_turn_ground(g->ground, g);
        return true;
    }
    if (g->flat)
        return vtk_fail(
            r, "a grid of several levels after one of one, expected it before that one");
    if (g->second) return vtk_fail(r, "a third grid of several levels, expected two at most");
    if (!same_axes(g, h)) grid_turn_second(h, g);
    if (!same_axes(g, h))
        return vtk_fail(r, "a second grid with other coordinates, expected those of the first, or "
                           "one level: a ground");
    const size_t nodes = grid_node(g, 0, 0, g->n[2]);
    for (size_t i = 0; i < nodes; i++)
        if (isnan(h->value[i])) g->value[i] = NAN;
        else if (isnan(g->value[i])) h->value[i] = NAN;
    g->second = h->value;
    h->value = NULL;
    return true;
}

static bool read_grid(struct vtk_reader *r, struct grid *g)
{
    bool good = read_one(r, g);
    if (good && g->n[2] == 1) thicken(g);
    while (good && vtk_next_is(r, "#")) {
        struct grid h = {0};
        r->has[0] = r->has[1] = false;
        good = read_one(r, &h) && take_further(r, g, &h);
        grid_free(&h);
    }
    return good && vtk_tail(r);
}

static int read_from(struct vtk_reader r, struct grid *g, char err[ERR_BYTES])
{
    *g = (struct grid){0};
    r.err = err;
    err[0] = '\0';
    if (read_grid(&r, g)) return 0;
    grid_free(g);
    return -1;
}

uint64_t grid_nodes(const unsigned char *start, size_t n)
{
    char err[ERR_BYTES];
    struct grid g = {0};
    struct vtk_reader r = {.bytes = start, .at = start, .end = start + n, .name = "", .err = err};
    uint64_t nodes = 1, planes = 0;
    if (!read_head(&r, &g) || (vtk_take(&r, "FIELD") && !read_field(&r)) ||
        !vtk_expect(&r, "next part", "DIMENSIONS"))
        return 0;
    for (int a = 0; a < 3; a++) {
        if (!vtk_count(&r, "nodes", 1, INT32_MAX, &planes) ||
            nodes > UINT32_MAX * UINT64_C(64) / planes)
            return 0;
        nodes *= a == 2 && planes == 1 ? 2 : planes;
    }
    return nodes;
}

int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES])
{
    struct vtk_reader r = {.bytes = bytes, .at = bytes, .end = bytes + n, .name = name};
    return read_from(r, g, err);
}

int grid_consume(
    const char *name, unsigned char *bytes, size_t n, struct grid *g, char err[ERR_BYTES])
{
    struct vtk_reader r = {.bytes = bytes, .at = bytes, .end = bytes + n, .name = name};
    r.kept = bytes;
    return read_from(r, g, err);
}

int grid_load(const char *path, struct grid *g, char err[ERR_BYTES])
{
    struct buf b;
    *g = (struct grid){.value = NULL};
    if (!load_file(path, &b, err)) return -1;
    int failed = grid_read(path, buf_data(&b), buf_size(&b), g, err);
    buf_free(&b);
    return failed;
}
