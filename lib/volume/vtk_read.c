/*
 * A VTK legacy file as a grid. The format is described in "VTK File Formats", Kitware; what of it
 * is taken, in stormring-grid(5).
 *
 * Keywords and types are words in any case; in BINARY files a block of numbers begins after the
 * line end that follows its header, big-endian, and is as long as the header says. Nothing that a
 * header says is believed before as many bytes are there.
 */
#include "volume/volume.h"
#include "volume/vtk_type.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <unistd.h>

#define NUMBER_LEN_MAX 63 /* characters */
#define GIVE_BACK 65536   /* bytes read, or more, at a time */
#define FIELDS_MAX 1000   /* arrays of a FIELD that is passed over */

struct reader {
    const unsigned char *bytes, *at, *end; /* at .. end is unread */
    const char *name;                      /* stands in messages */
    char *err;                             /* VOLUME_ERR bytes */
    bool binary;
    bool down[3];        /* this axis descends in the file */
    unsigned char *kept; /* to here pages were given back; NULL: none are */
    size_t line;         /* that begins what is kept, from 0 */
};

/* ---- messages ------------------------------------------------------------------------------ */

static size_t lines(const unsigned char *p, const unsigned char *end)
{
    size_t n = 0;
    for (; p < end; p++) n += *p == '\n';
    return n;
}

static bool fail(struct reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
static bool fail(struct reader *r, const char *fmt, ...)
{
    size_t line = r->line + lines(r->kept ? r->kept : r->bytes, r->at);
    int n = snprintf(r->err, VOLUME_ERR, "%.100s:%zu: ", r->name, line + 1);
    if (n < 0 || n >= VOLUME_ERR) n = 0;
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(r->err + n, VOLUME_ERR - (size_t)n, fmt, ap);
    va_end(ap);
    return false;
}

/* ---- words --------------------------------------------------------------------------------- */

static inline bool is_blank(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* To the next word; its length, 0 at the end of the file. */
static size_t peek(struct reader *r)
{
    while (r->at < r->end && is_blank(*r->at)) r->at++;
    const unsigned char *p = r->at;
    while (p < r->end && !is_blank(*p)) p++;
    return (size_t)(p - r->at);
}

static bool fail_word(struct reader *r, const char *what, const char *expected)
{
    char shown[32];
    size_t n = peek(r), k = 0;
    if (!n) return fail(r, "the file ends where %s is due, expected %s", what, expected);
    for (; k < n && k + 1 < sizeof shown; k++)
        shown[k] = r->at[k] > ' ' && r->at[k] < 0x7f ? (char)r->at[k] : '?';
    shown[k] = '\0';
    return fail(r, "%s is '%s%s', expected %s", what, shown, k < n ? "..." : "", expected);
}

static bool next_is(struct reader *r, const char *word)
{
    size_t n = peek(r);
    return n == strlen(word) && strncasecmp((const char *)r->at, word, n) == 0;
}

static bool take(struct reader *r, const char *word)
{
    if (!next_is(r, word)) return false;
    r->at += strlen(word);
    return true;
}

static bool expect(struct reader *r, const char *what, const char *word)
{
    return take(r, word) || fail_word(r, what, word);
}

static bool read_count(struct reader *r, const char *what, uint64_t min, uint64_t max, uint64_t *v)
{
    char text[NUMBER_LEN_MAX + 1], range[80];
    int64_t value;
    size_t n = peek(r);
    if (min == max) snprintf(range, sizeof range, "%llu", (unsigned long long)min);
    else
        snprintf(range, sizeof range, "an integer from %llu to %llu", (unsigned long long)min,
            (unsigned long long)max);
    if (!n || n > NUMBER_LEN_MAX) return fail_word(r, what, range);
    memcpy(text, r->at, n);
    text[n] = '\0';
    if (strlen(text) != n || !parse_int(text, (int64_t)min, (int64_t)max, &value))
        return fail_word(r, what, range);
    r->at += n;
    *v = (uint64_t)value;
    return true;
}

static bool read_type(struct reader *r, struct vtk_type *t)
{
    for (size_t i = 0; i < VTK_TYPES; i++)
        if (take(r, vtk_types[i].name)) {
            *t = vtk_types[i];
            return true;
        }
    return fail_word(r, "type of numbers", "float, double or an integer type of VTK");
}

static int hex(unsigned char c)
{
    static const char digits[] = "0123456789abcdef";
    const char *at = c ? strchr(digits, c | 0x20) : NULL;
    return at && !(c < '0') ? (int)(at - digits) : -1;
}

/* The name of an array, as much of it as there is room for; %XX is a byte. */
static bool read_name(struct reader *r, char name[VOLUME_NAME])
{
    size_t n = peek(r), k = 0;
    if (!n) return fail_word(r, "name of an array", "a word");
    for (size_t i = 0; i < n && k + 1 < VOLUME_NAME; i++) {
        unsigned char c = r->at[i];
        if (c == '%' && n - i > 2 && hex(r->at[i + 1]) >= 0 && hex(r->at[i + 2]) >= 0) {
            c = (unsigned char)(hex(r->at[i + 1]) * 16 + hex(r->at[i + 2]));
            i += 2;
        }
        name[k++] = c < ' ' || c == 0x7f ? '?' : (char)c;
    }
    name[k] = '\0';
    r->at += n;
    return true;
}

/* ---- numbers ------------------------------------------------------------------------------- */

/* `count` numbers of this type follow; true when the bytes for them are there. */
static bool begin_numbers(struct reader *r, const char *what, struct vtk_type t, uint64_t count)
{
    uint64_t room;
    if (r->binary) {
        while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r')) r->at++;
        if (r->at == r->end || *r->at != '\n') return fail_word(r, what, "a line end before them");
        r->at++;
        room = (uint64_t)(r->end - r->at) / t.size;
    } else {
        room = ((uint64_t)(r->end - r->at) + 1) / 2; /* a digit and a blank */
    }
    if (count <= room) return true;
    return fail(r, "%s: %llu are announced, and the file has bytes for %llu, expected all", what,
        (unsigned long long)count, (unsigned long long)room);
}

/* A number as text; "nan", as printf writes it, is one. */
static bool read_text(struct reader *r, const char *what, double *v)
{
    char text[NUMBER_LEN_MAX + 1];
    size_t n = peek(r), sign = n && (*r->at == '-' || *r->at == '+');
    if (n && n <= NUMBER_LEN_MAX) {
        memcpy(text, r->at, n);
        text[n] = '\0';
        if (strcasecmp(text + sign, "nan") == 0) *v = (double)NAN;
        else if (strlen(text) != n || !parse_real(text, -DBL_MAX, DBL_MAX, v)) n = 0;
    } else n = 0;
    r->at += n;
    return n || fail_word(r, what, "a number");
}

/* After begin_numbers. NaN is left to the caller; others are in range. */
static bool read_number(struct reader *r, const char *what, struct vtk_type t, double *v)
{
    if (r->binary) {
        *v = vtk_decode(r->at, t);
        r->at += t.size;
    } else if (!read_text(r, what, v)) return false;
    if (isnan(*v) || fabs(*v) <= GRID_MAX) return true;
    return fail(r, "%s: %g, expected numbers from %g to %g, and nan for missing ones", what, *v,
        -GRID_MAX, GRID_MAX);
}

/* What VTK appends to an array: lines up to an empty one. */
static void skip_metadata(struct reader *r)
{
    if (!take(r, "METADATA")) return;
    size_t line = 1;
    while (r->at < r->end && line) {
        const unsigned char *nl = memchr(r->at, '\n', (size_t)(r->end - r->at));
        const unsigned char *next = nl ? nl + 1 : r->end, *p = r->at;
        if (p > r->bytes && p[-1] == '\n')
            for (line = 0; p < next; p++) line += !is_blank(*p);
        r->at = next;
    }
}

/* ---- the parts of a file ------------------------------------------------------------------- */

/* The line's end, which is read as well. */
static const unsigned char *read_line(struct reader *r)
{
    const unsigned char *nl = memchr(r->at, '\n', (size_t)(r->end - r->at));
    const unsigned char *end = nl ? nl : r->end;
    r->at = nl ? nl + 1 : end;
    return end;
}

static void read_title(struct reader *r, char title[GRID_TITLE])
{
    size_t n = 0;
    const unsigned char *p = r->at, *end = read_line(r);
    for (; p < end && n < GRID_TITLE - 1; p++) title[n++] = *p < ' ' || *p == 0x7f ? ' ' : (char)*p;
    while (n && title[n - 1] == ' ') n--;
    title[n] = '\0';
}

static bool read_head(struct reader *r, struct grid *g)
{
    static const char magic[] = "# vtk DataFile Version ";
    if ((size_t)(r->end - r->at) < sizeof magic - 1 ||
        strncasecmp((const char *)r->at, magic, sizeof magic - 1) != 0)
        return fail(r, "no VTK legacy file, expected '%s' and a version", magic);
    read_line(r);
    read_title(r, g->title);
    r->binary = take(r, "BINARY");
    if (!r->binary && !take(r, "ASCII")) return fail_word(r, "form", "ASCII or BINARY");
    return expect(r, "third part", "DATASET") && expect(r, "dataset", "RECTILINEAR_GRID");
}

/* FIELD arrays that belong to the file as a whole, such as its time: passed over. */
static bool skip_field(struct reader *r)
{
    char name[VOLUME_NAME];
    struct vtk_type t = vtk_types[0];
    uint64_t arrays = 0, components = 0, tuples = 0;
    double v = 0;
    if (!read_name(r, name) || !read_count(r, "number of arrays", 0, FIELDS_MAX, &arrays))
        return false;
    for (; arrays; arrays--) {
        if (!read_name(r, name) || !read_count(r, "number of components", 0, 1000, &components) ||
            !read_count(r, "number of tuples", 0, UINT32_MAX, &tuples) || !read_type(r, &t) ||
            !begin_numbers(r, "numbers of a field", t, components * tuples))
            return false;
        for (uint64_t i = 0; i < components * tuples; i++)
            if (r->binary) r->at += t.size;
            else if (!read_text(r, "number of a field", &v)) return false;
        skip_metadata(r);
    }
    return true;
}

static bool read_axis(struct reader *r, int axis, struct grid *g)
{
    char keyword[] = "?_COORDINATES";
    keyword[0] = "XYZ"[axis];
    uint64_t n = 0;
    struct vtk_type t = vtk_types[0];
    if (!expect(r, "next part", keyword) ||
        !read_count(r, "number of coordinates", g->n[axis], g->n[axis], &n) || !read_type(r, &t) ||
        !begin_numbers(r, keyword, t, n))
        return false;
    double *at = g->at[axis] = xmalloc(n, sizeof *at);
    for (uint32_t i = 0; i < n; i++) {
        if (!read_number(r, keyword, t, &at[i])) return false;
        if (isnan(at[i])) return fail(r, "%s: number %u is nan, expected a number", keyword, i + 1);
    }
    uint32_t fault = grid_axis_fault(at, (uint32_t)n);
    if (fault)
        return fail(r, "%s: number %u is %.9g after %.9g, expected all to ascend or all to descend",
            keyword, fault + 1, at[fault], at[fault - 1]);
    r->down[axis] = at[1] < at[0];
    for (uint32_t i = 0, j = (uint32_t)n - 1; r->down[axis] && i < j; i++, j--) {
        double swap = at[i];
        at[i] = at[j];
        at[j] = swap;
    }
    skip_metadata(r);
    return true;
}

static bool read_geometry(struct reader *r, struct grid *g, uint64_t *nodes)
{
    static const char *const what[] = {"nodes along x", "nodes along y", "nodes along z"};
    uint64_t n = 2;
    if (take(r, "FIELD") && !skip_field(r)) return false;
    if (!expect(r, "next part", "DIMENSIONS")) return false;
    *nodes = 1;
    for (int a = 0; a < 3; a++) {
        if (!read_count(r, what[a], 2, INT32_MAX, &n)) return false;
        g->n[a] = (uint32_t)n;
        /* A byte a node at the least, so that nothing overflows later. */
        if (*nodes > (uint64_t)(r->end - r->bytes) / n)
            return fail(r, "the file is too short for its DIMENSIONS, expected a number a node");
        *nodes *= n;
    }
    for (int a = 0; a < 3; a++)
        if (!read_axis(r, a, g)) return false;
    return true;
}

/* The header of the one scalar, as SCALARS or as a FIELD of one array. */
static bool read_scalar_head(struct reader *r, uint64_t nodes, struct grid *g, struct vtk_type *t)
{
    char field[VOLUME_NAME];
    uint64_t n = 0;
    if (take(r, "FIELD"))
        return read_name(r, field) && read_count(r, "number of arrays", 1, 1, &n) &&
               read_name(r, g->name) && read_count(r, "number of components", 1, 1, &n) &&
               read_count(r, "number of tuples", nodes, nodes, &n) && read_type(r, t);
    if (!take(r, "SCALARS")) return fail_word(r, "first of the point data", "SCALARS");
    if (!read_name(r, g->name) || !read_type(r, t)) return false;
    if (!next_is(r, "LOOKUP_TABLE") && !read_count(r, "number of components", 1, 1, &n))
        return false;
    return expect(r, "next part", "LOOKUP_TABLE") && read_name(r, field);
}

/* What was read is not needed any more. */
static void give_back(struct reader *r)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t skip = -(uintptr_t)r->kept & (page - 1), n = (size_t)(r->at - r->kept);
    if (n < GIVE_BACK + skip) return;
    unsigned char *from = r->kept + skip, *to = from + ((n - skip) & ~(page - 1));
    r->line += lines(r->kept, to);
    r->kept = to;
    (void)madvise(from, (size_t)(to - from), MADV_DONTNEED); /* refused, it only costs memory */
}

/* In the file's order, to where they are when every axis ascends. */
static bool read_values(struct reader *r, struct vtk_type t, struct grid *g)
{
    const uint32_t *n = g->n;
    const bool *down = r->down;
    double v = 0;
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++) {
            float *row =
                g->value + grid_node(g, 0, down[1] ? n[1] - 1 - j : j, down[2] ? n[2] - 1 - k : k);
            for (uint32_t i = 0; i < n[0]; i++) {
                if (!read_number(r, "values", t, &v)) return false;
                row[down[0] ? n[0] - 1 - i : i] = (float)v;
            }
            if (r->kept) give_back(r);
        }
    return true;
}

static bool read_grid(struct reader *r, struct grid *g)
{
    uint64_t nodes = 0, n = 0;
    struct vtk_type t = vtk_types[0];
    if (!read_head(r, g) || !read_geometry(r, g, &nodes)) return false;
    if (!expect(r, "what follows the coordinates", "POINT_DATA") ||
        !read_count(r, "number of point data", nodes, nodes, &n) ||
        !read_scalar_head(r, nodes, g, &t) || !begin_numbers(r, "values", t, nodes))
        return false;
    g->value = xmalloc(nodes, sizeof *g->value);
    if (!read_values(r, t, g)) return false;
    skip_metadata(r);
    return !peek(r) || fail_word(r, "what follows the values", "one scalar and the file's end");
}

static int read_from(struct reader r, struct grid *g, char err[VOLUME_ERR])
{
    *g = (struct grid){0};
    r.err = err;
    err[0] = '\0';
    if (read_grid(&r, g)) return 0;
    grid_free(g);
    return -1;
}

int grid_read(
    const char *name, const unsigned char *bytes, size_t n, struct grid *g, char err[VOLUME_ERR])
{
    struct reader r = {.bytes = bytes, .at = bytes, .end = bytes + n, .name = name};
    return read_from(r, g, err);
}

int grid_consume(
    const char *name, unsigned char *bytes, size_t n, struct grid *g, char err[VOLUME_ERR])
{
    struct reader r = {.bytes = bytes, .at = bytes, .end = bytes + n, .name = name};
    r.kept = bytes;
    return read_from(r, g, err);
}
