/*
 * nrrd: the header of NRRD. G. Kindlmann, "Definition of NRRD File Format", teem.sourceforge.net.
 *
 * Lines "field: description" up to an empty line, in any order after the first; then the numbers,
 * or they are in another file. Axes are from the fastest to the slowest; those that are not in
 * space, such as components or times, are the numbers of a value.
 */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define AXES 16 /* the format's limit */
#define FLAT (-1)

enum field {
    TYPE,
    DIMENSION,
    SIZES,
    ENCODING,
    ENDIAN,
    SPACINGS,
    MINS,
    MAXS,
    CENTERS,
    KINDS,
    SPACE,
    SPACE_DIMENSION,
    DIRECTIONS,
    ORIGIN,
    UNITS,
    SPACE_UNITS,
    SAMPLE_UNITS,
    CONTENT,
    BYTE_SKIP,
    LINE_SKIP,
    DATA_FILE,
    FIELDS
};
/* Fields have names with and without blanks. */
static const char *const names[FIELDS] = {"type", "dimension", "sizes", "encoding", "endian",
    "spacings", "axismins", "axismaxs", "centerings", "kinds", "space", "spacedimension",
    "spacedirections", "spaceorigin", "units", "spaceunits", "sampleunits", "content", "byteskip",
    "lineskip", "datafile"};

struct header {
    char text[FIELDS][VOXEL_LINE]; /* "": not there */
    size_t end;                    /* of the header */
    int axes, space[3];            /* the axes in space; FLAT: a picture has no third one */
    int64_t size[AXES];
    char kind[AXES][32];
    bool directed, none[AXES]; /* directed: there are directions, and none where an axis has none */
    double direction[AXES][3];
};

/* Dimensions of the space. The fourth one is the time. */
static size_t space_dimensions(const struct header *h)
{
    const char *space = h->text[SPACE];
    const size_t n = strlen(space);
    if (*h->text[SPACE_DIMENSION]) return (size_t)(*h->text[SPACE_DIMENSION] - '0');
    return n > 5 && strcasecmp(space + n - 5, "-time") == 0 ? 4 : n == 4 ? 4 : 3;
}

static const struct {
    const char *name;
    struct voxel_type type;
} types[] = {{"signed char", {1, VOXEL_SIGNED}}, {"int8", {1, VOXEL_SIGNED}},
    {"uchar", {1, VOXEL_UNSIGNED}}, {"unsigned char", {1, VOXEL_UNSIGNED}},
    {"uint8", {1, VOXEL_UNSIGNED}}, {"short", {2, VOXEL_SIGNED}}, {"int16", {2, VOXEL_SIGNED}},
    {"ushort", {2, VOXEL_UNSIGNED}}, {"unsigned short", {2, VOXEL_UNSIGNED}},
    {"uint16", {2, VOXEL_UNSIGNED}}, {"int", {4, VOXEL_SIGNED}}, {"signed int", {4, VOXEL_SIGNED}},
    {"int32", {4, VOXEL_SIGNED}}, {"uint", {4, VOXEL_UNSIGNED}},
    {"unsigned int", {4, VOXEL_UNSIGNED}}, {"uint32", {4, VOXEL_UNSIGNED}},
    {"longlong", {8, VOXEL_SIGNED}}, {"long long", {8, VOXEL_SIGNED}}, {"int64", {8, VOXEL_SIGNED}},
    {"ulonglong", {8, VOXEL_UNSIGNED}}, {"unsigned long long", {8, VOXEL_UNSIGNED}},
    {"uint64", {8, VOXEL_UNSIGNED}}, {"float", {4, VOXEL_REAL}}, {"double", {8, VOXEL_REAL}}};

/* Reads a type; "signed short int" and "int16_t" are names of the same. */
static bool read_type(struct voxel *v, const char *text, struct voxel_type *t)
{
    char word[40], shown[ERR_WORD];
    snprintf(word, sizeof word, "%.39s", text);
    size_t n = strlen(word);
    if (n > 2 && strcmp(word + n - 2, "_t") == 0) word[n -= 2] = '\0';
    if (n > 6 && (strcmp(word + n - 5, "t int") == 0 || strcmp(word + n - 5, "g int") == 0))
        word[n - 4] = '\0';
    const bool is_signed = strncmp(word, "signed ", 7) == 0 && strcmp(word, "signed char") != 0;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcasecmp(word + (is_signed ? 7 : 0), types[i].name) == 0) {
            *t = types[i].type;
            return true;
        }
    return voxel_fail(v, "type: %s, expected an integer type, float or double",
        err_word(shown, text, strlen(text)));
}

/* ---- lines ----------------------------------------------------------------------------------- */

static int field_of(const char *name)
{
    char joined[32];
    size_t n = 0;
    for (; *name && n + 1 < sizeof joined; name++)
        if (*name != ' ') joined[n++] = *name;
    joined[n] = '\0';
    if (strcasecmp(joined, "centers") == 0) return CENTERS;
    for (int i = 0; i < FIELDS; i++)
        if (strcasecmp(joined, names[i]) == 0) return i;
    return -1;
}

static bool read_lines(struct voxel *v, struct header *h)
{
    char text[VOXEL_LINE], *line;
    size_t at = 0;
    voxel_line(v, &at, text); /* the magic word */
    *v->err = '\0';
    while ((line = voxel_line(v, &at, text)) != NULL && *line) {
        char *colon = *line == '#' ? NULL : strstr(line, ": ");
        const size_t n = strlen(line);
        if (!colon && n && line[n - 1] == ':') colon = line + n - 1;
        char *key = strstr(line, ":=");
        if (!colon || (key && key < colon)) continue; /* a key that the format does not define */
        *colon = '\0';
        const int field = field_of(line);
        if (field >= 0) snprintf(h->text[field], VOXEL_LINE, "%s", voxel_trim(colon + 1));
    }
    h->end = at;
    return !*v->err;
}

static bool read_int(
    struct voxel *v, const char *what, const char *text, int64_t min, int64_t max, int64_t *out)
{
    char shown[ERR_WORD];
    return parse_int(text, min, max, out) ||
           voxel_fail(v, "%s: %s, expected an integer from %lld to %lld", what,
               err_word(shown, text, strlen(text)), (long long)min, (long long)max);
}

/* ---- axes ------------------------------------------------------------------------------------ */

/* Directions: "(x,y,z)" for each axis, or none. */
static bool read_directions(struct voxel *v, struct header *h)
{
    char *rest = h->text[DIRECTIONS];
    const size_t dims = space_dimensions(h);
    double part[4] = {0};
    h->directed = *rest != '\0';
    if (h->directed && (dims < 2 || dims > 4))
        return voxel_fail(v, "a space of %s dimensions, expected 2 to 4", h->text[SPACE_DIMENSION]);
    for (int i = 0; h->directed && i < h->axes; i++) {
        while (*rest == ' ') rest++;
        if (strncasecmp(rest, "none", 4) == 0) h->none[i] = true, rest += 4;
        else {
            char *end = strchr(rest, ')');
            if (*rest != '(' || !end)
                return voxel_fail(v, "space directions: axis %d, expected (x,y,z) or none", i + 1);
            *end = '\0';
            if (!voxel_reals(v, "space directions", rest + 1, dims, part)) return false;
            memcpy(h->direction[i], part, sizeof h->direction[i]);
            for (size_t k = 0; k < dims; k++) h->none[i] = h->none[i] || isnan(part[k]);
            const bool time = dims == 4 && fabs(part[3]) > 0;
            if (time && (fabs(part[0]) > 0 || fabs(part[1]) > 0 || fabs(part[2]) > 0))
                return voxel_fail(v,
                    "space directions: axis %d is in space and time, expected "
                    "one of them",
                    i + 1);
            h->none[i] = h->none[i] || time;
            rest = end + 1;
        }
    }
    return true;
}

/* Axes of more than one number. Microscopes' pictures have a channel and a time of one. */
static int longer_axes(const struct header *h)
{
    int n = 0;
    for (int i = 0; i < h->axes; i++) n += h->size[i] > 1;
    return n;
}

static bool is_in_space(const struct header *h, int i)
{
    const char *kind = h->kind[i];
    if (h->directed) return !h->none[i];
    if (*kind && strcmp(kind, "???") != 0)
        return strcasecmp(kind, "domain") == 0 || strcasecmp(kind, "space") == 0;
    const int longer = longer_axes(h);
    return h->axes <= 3 || (h->size[i] > 1 && (longer == 2 || longer == 3));
}

static bool read_axes(struct voxel *v, struct header *h)
{
    int64_t axes = 0;
    double sizes[AXES];
    if (!read_int(v, "dimension", h->text[DIMENSION], 1, AXES, &axes)) return false;
    h->axes = (int)axes;
    if (!voxel_reals(v, "sizes", h->text[SIZES], (size_t)axes, sizes)) return false;
    for (int i = 0; i < h->axes; i++) {
        if (!(sizes[i] >= 1 && sizes[i] <= VOXEL_NODES_MAX) || sizes[i] != floor(sizes[i]))
            return voxel_fail(
                v, "sizes: %g, expected integers from 1 to %u", sizes[i], VOXEL_NODES_MAX);
        h->size[i] = (int64_t)sizes[i];
    }
    char *rest = h->text[KINDS];
    for (int i = 0; i < h->axes; i++) {
        while (rest && *rest == ' ') rest++;
        const char *word = text_part(&rest, ' ');
        if (word) snprintf(h->kind[i], sizeof h->kind[i], "%s", word);
    }
    int n = 0, more = 0;
    if (!read_directions(v, h)) return false;
    for (int i = 0; i < h->axes; i++)
        if (!is_in_space(h, i)) more += h->size[i] > 1;
        else if (n++ < 3) h->space[n - 1] = i;
    if ((n != 3 && n != 2) || more > 1)
        return voxel_fail(v,
            "%d axes in space and %d others, expected 2 or 3 and at most 1: kinds and "
            "space directions say what an axis is",
            n, more);
    if (n == 2) h->space[2] = FLAT;
    for (int i = 0; i < n; i++)
        if (!voxel_set_nodes(v, i, h->size[h->space[i]])) return false;
    if (n == 2) v->n[2] = 1;
    return true;
}

/* Reads a number for each axis, NaN where there is none. */
static bool read_per_axis(struct voxel *v, const struct header *h, enum field f, double out[AXES])
{
    for (int i = 0; i < AXES; i++) out[i] = (double)NAN;
    return !*h->text[f] || voxel_reals(v, names[f], h->text[f], (size_t)h->axes, out);
}

/* Without a space there are spacings, and where axes begin and end. As in teem, an axis has cells
 * unless the file says that it has nodes. */
static bool place_plain(struct voxel *v, struct header *h)
{
    double spacing[AXES], min[AXES], max[AXES];
    if (!read_per_axis(v, h, SPACINGS, spacing) || !read_per_axis(v, h, MINS, min) ||
        !read_per_axis(v, h, MAXS, max))
        return false;
    for (int i = 0; i < 3; i++) {
        const int from = h->space[i];
        const char *centers = h->text[CENTERS];
        if (from == FLAT) continue;
        size_t at = 0, k = 0;
        for (int word = 0; word <= from; word++) {
            at += k;
            k = voxel_word((const unsigned char *)centers, strlen(centers), false, &at);
        }
        const bool nodes = k == 4 && strncasecmp(centers + at, "node", 4) == 0;
        double step = spacing[from];
        if (isnan(step) && v->n[i] > nodes) step = (max[from] - min[from]) / (v->n[i] - nodes);
        v->step[i][i] = isnan(step) ? 1 : step;
        if (!isnan(min[from])) v->origin[i] = min[from] + (nodes ? 0 : v->step[i][i] / 2);
    }
    return true;
}

/* The names of a space are its three words, such as left-posterior-superior. */
static void name_axes(struct voxel *v, struct header *h)
{
    static const char *const letters[] = {
        "Rright", "Lleft", "Aanterior", "Pposterior", "Ssuperior", "Iinferior"};
    char *rest = h->text[SPACE], part[3][GRID_NAME / 4] = {{0}};
    if (strlen(rest) == 3)
        for (int i = 0; i < 3; i++)
            for (size_t k = 0; k < sizeof letters / sizeof *letters; k++)
                if (rest[i] == *letters[k]) snprintf(part[i], sizeof *part, "%s", letters[k] + 1);
    for (int i = 0; i < 3 && strlen(h->text[SPACE]) > 3; i++) {
        const char *word = text_part(&rest, '-');
        for (size_t k = 0; word && k < sizeof letters / sizeof *letters; k++)
            if (strcasecmp(word, letters[k] + 1) == 0)
                snprintf(part[i], sizeof *part, "%s", letters[k] + 1);
    }
    if (*part[0] && *part[1] && *part[2]) memcpy(v->axis, part, sizeof part);
}

/* The unit of all axes: the first one in quotes. */
static void name_units(struct voxel *v, const char *text)
{
    const char *open = strchr(text, '"'), *close = open ? strchr(open + 1, '"') : NULL;
    if (close) snprintf(v->length, sizeof v->length, "%.*s", (int)(close - open - 1), open + 1);
}

static bool place(struct voxel *v, struct header *h)
{
    name_units(v, *h->text[SPACE_UNITS] ? h->text[SPACE_UNITS] : h->text[UNITS]);
    snprintf(v->unit, sizeof v->unit, "%.60s", h->text[SAMPLE_UNITS]);
    if (!h->directed) return place_plain(v, h);
    char *origin = h->text[ORIGIN], *close = strchr(origin, ')');
    const size_t dims = space_dimensions(h);
    double first[4] = {0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3 && h->space[i] != FLAT; k++)
            v->step[i][k] = h->direction[h->space[i]][k];
    if (h->space[2] == FLAT) voxel_across(v);
    if (close) *close = '\0';
    if (*origin && !voxel_reals(v, "space origin", origin + (*origin == '('), dims, first))
        return false;
    memcpy(v->origin, first, sizeof v->origin);
    name_axes(v, h);
    return true;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* Where they are, and how. */
static bool find_numbers(struct voxel *v, struct header *h, struct voxel_array *a)
{
    const char *encoding = h->text[ENCODING], *file = h->text[DATA_FILE];
    char shown[ERR_WORD];
    int64_t lines = 0, skip = 0;
    const bool raw = strcasecmp(encoding, "raw") == 0;
    if ((*h->text[LINE_SKIP] &&
            !read_int(v, "line skip", h->text[LINE_SKIP], 0, INT32_MAX, &lines)) ||
        (*h->text[BYTE_SKIP] &&
            !read_int(v, "byte skip", h->text[BYTE_SKIP], raw ? -1 : 0, INT64_MAX, &skip)))
        return false;
    if (strcasecmp(encoding, "gz") == 0 || strcasecmp(encoding, "gzip") == 0)
        a->at.packing = VOXEL_DEFLATE;
    else if (strcasecmp(encoding, "txt") == 0 || strcasecmp(encoding, "text") == 0 ||
             strcasecmp(encoding, "ascii") == 0)
        a->at.packing = VOXEL_TEXT;
    else if (strcasecmp(encoding, "hex") == 0) a->at.packing = VOXEL_HEX;
    else if (strncasecmp(encoding, "bz", 2) == 0)
        return voxel_fail(v, "encoding: bzip2, expected raw, ascii, hex or gzip; teem converts "
                             "it: unu save -f nrrd -e gzip -i FILE -o NEW");
    else if (!raw)
        return voxel_fail(v, "encoding: %s, expected raw, ascii, hex or gzip",
            err_word(shown, encoding, strlen(encoding)));
    if (strncmp(file, "LIST", 4) == 0 || strchr(file, '%'))
        return voxel_fail(
            v, "data file: several files, expected one; cat joins raw ones, in their order");
    if (*file && !voxel_beside(v, file, &v->data)) return false;
    a->at.p = *file ? buf_data(&v->data) : v->bytes + h->end;
    a->at.n = *file ? buf_size(&v->data) : v->n_bytes - h->end;
    a->at.file = *file ? NULL : v->bytes;
    for (const unsigned char *nl; lines; lines--) {
        if (!(nl = memchr(a->at.p, '\n', a->at.n)))
            return voxel_fail(v, "line skip: fewer lines in the data, expected all");
        a->at.n -= (size_t)(nl + 1 - a->at.p);
        a->at.p = nl + 1;
    }
    const uint64_t bytes = voxel_numbers(v, a) * a->type.size;
    if (skip == -1) skip = a->at.n > bytes ? (int64_t)(a->at.n - bytes) : 0;
    a->at.skip = (uint64_t)skip;
    if (strcasecmp(h->text[ENDIAN], "big") == 0) a->at.big = true;
    else if (a->type.size > 1 && a->at.packing != VOXEL_TEXT &&
             strcasecmp(h->text[ENDIAN], "little") != 0)
        return voxel_fail(v, "endian: %s, expected big or little",
            err_word(shown, h->text[ENDIAN], strlen(h->text[ENDIAN])));
    return true;
}

static bool read_header(struct voxel *v, struct header *h)
{
    struct voxel_type type = {0, 0};
    if (!read_lines(v, h) || !read_axes(v, h) || !read_type(v, h->text[TYPE], &type) ||
        !place(v, h))
        return false;
    uint64_t strides[AXES], stride = 1, components = 1;
    int other = -1;
    for (int i = 0; i < h->axes; i++) {
        strides[i] = stride;
        stride *= (uint64_t)h->size[i];
        if (h->size[i] > 1 && i != h->space[0] && i != h->space[1] && i != h->space[2]) other = i;
    }
    if (other >= 0) components = (uint64_t)h->size[other];
    struct voxel_array *a = voxel_add(v, h->text[CONTENT], type, components, false);
    for (int i = 0; i < 3; i++) a->stride[i] = h->space[i] == FLAT ? 0 : strides[h->space[i]];
    a->component_stride = other >= 0 ? strides[other] : 0;
    return voxel_numbers(v, a) ? find_numbers(v, h, a) : true; /* too many: the caller says so */
}

bool voxel_read_nrrd(struct voxel *v)
{
    struct header *h = xcalloc(1, sizeof *h);
    const bool good = read_header(v, h);
    free(h);
    return good;
}
