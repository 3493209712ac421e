/*
 * meta: the header of MetaImage. "MetaIO Documentation", Kitware; the sizes of types are those of
 * MetaIO, where MET_LONG has four bytes.
 *
 * Lines "Word = value", of which ElementDataFile is the last.
 */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const struct {
    const char *name;
    struct voxel_type type;
} types[] = {{"MET_CHAR", {1, VOXEL_SIGNED}}, {"MET_UCHAR", {1, VOXEL_UNSIGNED}},
    {"MET_SHORT", {2, VOXEL_SIGNED}}, {"MET_USHORT", {2, VOXEL_UNSIGNED}},
    {"MET_INT", {4, VOXEL_SIGNED}}, {"MET_UINT", {4, VOXEL_UNSIGNED}},
    {"MET_LONG", {4, VOXEL_SIGNED}}, {"MET_ULONG", {4, VOXEL_UNSIGNED}},
    {"MET_LONG_LONG", {8, VOXEL_SIGNED}}, {"MET_ULONG_LONG", {8, VOXEL_UNSIGNED}},
    {"MET_FLOAT", {4, VOXEL_REAL}}, {"MET_DOUBLE", {8, VOXEL_REAL}}};

enum field {
    DIMS,
    SIZES,
    TYPE,
    CHANNELS,
    SPACING,
    ELEMENT_SIZE,
    ORIGIN,
    MATRIX,
    BINARY,
    MSB,
    PACKED,
    HEAD,
    MODALITY,
    DATA,
    FIELDS
};
/* A field may have several names. */
static const struct {
    const char *name;
    enum field field;
} names[] = {{"NDims", DIMS}, {"DimSize", SIZES}, {"ElementType", TYPE},
    {"ElementNumberOfChannels", CHANNELS}, {"ElementSpacing", SPACING},
    {"ElementSize", ELEMENT_SIZE}, {"Offset", ORIGIN}, {"Position", ORIGIN}, {"Origin", ORIGIN},
    {"TransformMatrix", MATRIX}, {"Rotation", MATRIX}, {"Orientation", MATRIX},
    {"BinaryData", BINARY}, {"BinaryDataByteOrderMSB", MSB}, {"ElementByteOrderMSB", MSB},
    {"CompressedData", PACKED}, {"HeaderSize", HEAD}, {"Modality", MODALITY},
    {"ElementDataFile", DATA}};

struct header {
    char text[FIELDS][VOXEL_LINE];
    size_t end;
};

static bool read_lines(struct voxel *v, struct header *h)
{
    char text[VOXEL_LINE], *line;
    *v->err = '\0';
    while (!*h->text[DATA] && (line = voxel_line(v, &h->end, text)) != NULL) {
        char *equals = strchr(line, '=');
        if (!equals) continue;
        *equals = '\0';
        const char *name = voxel_trim(line), *value = voxel_trim(equals + 1);
        for (size_t i = 0; i < sizeof names / sizeof *names; i++)
            if (strcasecmp(name, names[i].name) == 0)
                snprintf(h->text[names[i].field], VOXEL_LINE, "%s", value);
    }
    return *h->text[DATA] || (!*v->err && voxel_fail(v, "the file ends before ElementDataFile, "
                                                        "expected where the values are"));
}

static bool is_true(const char *text) { return *text == 'T' || *text == 't' || *text == '1'; }

/* MET_SHORT_ARRAY is MET_SHORT with several channels. */
static bool read_type(struct voxel *v, const char *text, struct voxel_type *t)
{
    char shown[ERR_WORD];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        const size_t n = strlen(types[i].name);
        if (strncasecmp(text, types[i].name, n) != 0) continue;
        if (text[n] && strcasecmp(text + n, "_ARRAY") != 0) continue;
        *t = types[i].type;
        return true;
    }
    return voxel_fail(v, "ElementType: %s, expected a type of one number, such as MET_SHORT",
        err_word(shown, text, strlen(text)));
}

/* Space. A row of the matrix is the direction of an axis. */
static bool place(struct voxel *v, const struct header *h, size_t dims)
{
    double spacing[4] = {1, 1, 1, 1}, origin[4] = {0}, matrix[16] = {0};
    const enum field size = *h->text[SPACING] ? SPACING : ELEMENT_SIZE;
    for (size_t i = 0; i < dims; i++) matrix[dims * i + i] = 1;
    if ((*h->text[size] && !voxel_reals(v, "ElementSpacing", h->text[size], dims, spacing)) ||
        (*h->text[ORIGIN] && !voxel_reals(v, "Offset", h->text[ORIGIN], dims, origin)) ||
        (*h->text[MATRIX] &&
            !voxel_reals(v, "TransformMatrix", h->text[MATRIX], dims * dims, matrix)))
        return false;
    for (size_t i = 0; i < 3 && i < dims; i++) {
        v->origin[i] = origin[i];
        for (size_t k = 0; k < 3 && k < dims; k++)
            v->step[i][k] = matrix[dims * i + k] * spacing[i];
    }
    if (strcasecmp(h->text[MODALITY], "MET_MOD_CT") == 0) snprintf(v->unit, sizeof v->unit, "HU");
    return true;
}

/* Without BinaryData an image is binary, as MetaIO reads it, unless it looks like text and has
 * another number of bytes. */
static bool is_binary(const struct header *h, const struct voxel_array *a, uint64_t bytes)
{
    double d;
    size_t at = 0;
    if (*h->text[BINARY]) return is_true(h->text[BINARY]);
    const size_t n = voxel_word(a->at.p, a->at.n, true, &at);
    return a->at.n == bytes || !voxel_number(a->at.p + at, n, &d);
}

static bool find_numbers(struct voxel *v, const struct header *h, struct voxel_array *a)
{
    const char *file = h->text[DATA];
    double skip = 0;
    if (strncasecmp(file, "LIST", 4) == 0 || strchr(file, '%'))
        return voxel_fail(
            v, "ElementDataFile: several files, expected one; cat joins raw ones, in their order");
    const bool local = strcasecmp(file, "LOCAL") == 0;
    if (!local && !voxel_beside(v, file, &v->data)) return false;
    a->at.p = local ? v->bytes + h->end : buf_data(&v->data);
    a->at.n = local ? v->n_bytes - h->end : buf_size(&v->data);
    a->at.file = local ? v->bytes : NULL;
    a->at.big = is_true(h->text[MSB]);
    a->at.packing = is_true(h->text[PACKED])                              ? VOXEL_DEFLATE
                    : is_binary(h, a, voxel_numbers(v, a) * a->type.size) ? VOXEL_RAW
                                                                          : VOXEL_TEXT;
    if (*h->text[HEAD] && !voxel_reals(v, "HeaderSize", h->text[HEAD], 1, &skip)) return false;
    const uint64_t bytes = voxel_numbers(v, a) * a->type.size;
    if (skip == -1) skip = a->at.n > bytes ? (double)(a->at.n - bytes) : 0;
    if (!(skip >= 0 && skip <= (double)a->at.n))
        return voxel_fail(v, "HeaderSize: %g, expected -1, or bytes of the file", skip);
    a->at.p += (size_t)skip;
    a->at.n -= (size_t)skip;
    return true;
}

static bool read_header(struct voxel *v, struct header *h)
{
    double dims = 0, size[4] = {1, 1, 1, 1}, channels = 1;
    struct voxel_type type = {0, 0};
    if (!read_lines(v, h) || !voxel_reals(v, "NDims", h->text[DIMS], 1, &dims)) return false;
    if (dims != 2 && dims != 3 && dims != 4)
        return voxel_fail(v, "NDims: %g, expected 2 to 4", dims);
    if (!voxel_reals(v, "DimSize", h->text[SIZES], (size_t)dims, size) ||
        (*h->text[CHANNELS] &&
            !voxel_reals(v, "ElementNumberOfChannels", h->text[CHANNELS], 1, &channels)) ||
        !read_type(v, h->text[TYPE], &type) || !place(v, h, (size_t)dims))
        return false;
    const double times = size[3];
    if (!(channels >= 1 && channels <= VOXEL_NODES_MAX) || channels != floor(channels))
        return voxel_fail(v, "ElementNumberOfChannels: %g, expected 1 or more", channels);
    if (!(times >= 1 && times <= VOXEL_NODES_MAX) || times != floor(times))
        return voxel_fail(v, "DimSize: %g times, expected 1 or more", times);
    if (channels > 1 && times > 1)
        return voxel_fail(v, "several times of several numbers, expected one of them");
    for (int i = 0; i < 3; i++) {
        const bool whole = size[i] >= 1 && size[i] <= 1e9 && size[i] == floor(size[i]);
        if (!voxel_set_nodes(v, i, whole ? (int64_t)size[i] : 0)) return false;
    }
    struct voxel_array *a = voxel_add(v, "", type, (uint64_t)(channels * times), false);
    if (times > 1) voxel_slowest(v, a);
    return voxel_numbers(v, a) ? find_numbers(v, h, a) : true; /* too many: the caller says so */
}

bool voxel_read_meta(struct voxel *v)
{
    struct header *h = xcalloc(1, sizeof *h);
    const bool good = read_header(v, h);
    free(h);
    return good;
}
