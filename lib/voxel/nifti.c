/*
 * nifti: the header of NIfTI-1. R. W. Cox and others, "A (Sort of) New Image Data Format Standard:
 * NIfTI-1", 2004; its header in C says what each field is. The numbers follow in the same file, or
 * are in another one of the same name with .img. gzip may have packed both.
 */
#include "voxel/voxel_int.h"

#include <string.h>

#define HEAD 348 /* bytes */
#define GZIP(p) ((p)[0] == 0x1f && (p)[1] == 0x8b)

/* Places in the header. */
enum {
    DIM = 40,
    DATATYPE = 70,
    BITPIX = 72,
    PIXDIM = 76,
    VOX_OFFSET = 108,
    SCL_SLOPE = 112,
    SCL_INTER = 116,
    XYZT_UNITS = 123,
    QFORM = 252,
    SFORM = 254,
    QUATERN = 256,
    QOFFSET = 268,
    SROW = 280,
    MAGIC = 344
};

struct header {
    const unsigned char *p;
    bool big;
};

static double number(const struct header *h, int at, uint8_t size, enum voxel_form form)
{
    return voxel_decode(h->p + at, (struct voxel_type){size, (uint8_t)form}, h->big);
}
static int whole(const struct header *h, int at) { return (int)number(h, at, 2, VOXEL_SIGNED); }
static double real(const struct header *h, int at) { return number(h, at, 4, VOXEL_REAL); }

/* ---- space ----------------------------------------------------------------------------------- */

/* Method 2 of the standard: a rotation as a quaternion, with spacings. */
static void place_by_rotation(struct voxel *v, const struct header *h)
{
    const double b = real(h, QUATERN), c = real(h, QUATERN + 4), d = real(h, QUATERN + 8);
    const double rest = 1 - (b * b + c * c + d * d), a = sqrt(fmax(0, rest));
    const double column[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
        {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
        {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
    for (int i = 0; i < 3; i++) {
        double size = real(h, PIXDIM + 4 * (i + 1));
        if (i == 2 && real(h, PIXDIM) < 0) size = -size; /* qfac: the third axis is mirrored */
        for (int k = 0; k < 3; k++) v->step[i][k] = column[i][k] * size;
        v->origin[i] = real(h, QOFFSET + 4 * i);
    }
}

/* Method 3 of the standard, which counts if it is there: a matrix. */
static void place_by_matrix(struct voxel *v, const struct header *h)
{
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) v->step[i][k] = real(h, SROW + 16 * k + 4 * i);
        v->origin[k] = real(h, SROW + 16 * k + 12);
    }
}

static void place(struct voxel *v, const struct header *h)
{
    static const char *const names[] = {"right", "anterior", "superior"};
    static const char *const units[] = {"", "m", "mm", "um"};
    snprintf(v->length, sizeof v->length, "%s", units[h->p[XYZT_UNITS] & 3]);
    const bool matrix = whole(h, SFORM) > 0, rotation = whole(h, QFORM) > 0;
    for (int i = 0; i < 3 && (matrix || rotation); i++)
        snprintf(v->axis[i], sizeof v->axis[i], "%s", names[i]);
    if (matrix) place_by_matrix(v, h);
    else if (rotation) place_by_rotation(v, h);
    else
        for (int i = 0; i < 3; i++) v->step[i][i] = real(h, PIXDIM + 4 * (i + 1));
    if (v->n[2] == 1) voxel_across(v); /* files of pictures may have 0 there */
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* The type, and how many of it one value has. */
static bool read_type(struct voxel *v, int code, struct voxel_type *t, uint64_t *parts)
{
    static const struct {
        int code;
        struct voxel_type type;
        uint8_t parts;
    } types[] = {{2, {1, VOXEL_UNSIGNED}, 1}, {4, {2, VOXEL_SIGNED}, 1}, {8, {4, VOXEL_SIGNED}, 1},
        {16, {4, VOXEL_REAL}, 1}, {32, {4, VOXEL_REAL}, 2}, {64, {8, VOXEL_REAL}, 1},
        {128, {1, VOXEL_UNSIGNED}, 3}, {256, {1, VOXEL_SIGNED}, 1}, {512, {2, VOXEL_UNSIGNED}, 1},
        {768, {4, VOXEL_UNSIGNED}, 1}, {1024, {8, VOXEL_SIGNED}, 1}, {1280, {8, VOXEL_UNSIGNED}, 1},
        {1792, {8, VOXEL_REAL}, 2}, {2304, {1, VOXEL_UNSIGNED}, 4}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].code == code) {
            *t = types[i].type;
            *parts = types[i].parts;
            return true;
        }
    return voxel_fail(v, "datatype %d, expected integers, float or double", code);
}

/* The file with the numbers of a pair: NAME.img, or NAME.img.gz, beside NAME.hdr or NAME.hdr.gz. */
static bool open_pair(struct voxel *v, struct voxel_array *a)
{
    char name[4096], err[ERR_BYTES], *kept = v->err;
    const char *slash = strrchr(v->name, '/'), *base = slash ? slash + 1 : v->name;
    const char *dot = strstr(base, ".hdr");
    if (!dot) return voxel_fail(v, "values in another file, expected NAME.hdr beside NAME.img");
    snprintf(name, sizeof name, "%.*s.img.gz", (int)(dot - base), base);
    v->err = err;
    bool good = voxel_beside(v, name, &v->data);
    v->err = kept;
    snprintf(name, sizeof name, "%.*s.img", (int)(dot - base), base);
    good = good || voxel_beside(v, name, &v->data);
    a->at.p = buf_data(&v->data);
    a->at.n = buf_size(&v->data);
    return good;
}

static bool find_numbers(struct voxel *v, const struct header *h, struct voxel_array *a)
{
    const double at = real(h, VOX_OFFSET), slope = real(h, SCL_SLOPE), inter = real(h, SCL_INTER);
    const bool pair = memcmp(h->p + MAGIC, "ni1", 4) == 0;
    if (!(at >= 0 && at < 0x1p40)) return voxel_fail(v, "vox_offset %g, expected bytes", at);
    a->at = (struct voxel_source){.p = v->bytes, .n = v->n_bytes, .big = h->big};
    a->at.skip = (uint64_t)at;
    if (pair && !open_pair(v, a)) return false;
    if (!pair && at < HEAD) a->at.skip = 352;
    if (a->at.n > 2 && GZIP(a->at.p)) a->at.packing = VOXEL_DEFLATE;
    if (slope == 0 || !isfinite(slope)) return true;
    v->slope = slope;
    v->offset = inter;
    return isfinite(inter) || voxel_fail(v, "scl_inter %g, expected a number", inter);
}

static bool read_header(struct voxel *v, struct header *h)
{
    struct voxel_type type = {0, 0};
    uint64_t parts = 1, times = 1;
    h->big = h->p[0] == 0;
    if (memcmp(h->p + MAGIC, "n+1", 4) != 0 && memcmp(h->p + MAGIC, "ni1", 4) != 0)
        return voxel_fail(v, "a header of 348 bytes without NIfTI's magic word, perhaps of "
                             "Analyze 7.5, expected n+1 or ni1");
    const int dims = whole(h, DIM);
    if (dims < 2 || dims > 7) return voxel_fail(v, "%d dimensions, expected 2 to 7", dims);
    v->n[2] = 1;
    for (int i = 0; i < 3 && i < dims; i++)
        if (!voxel_set_nodes(v, i, whole(h, DIM + 2 * (i + 1)))) return false;
    for (int i = 4; i <= dims; i++) {
        const int n = whole(h, DIM + 2 * i);
        if (n < 1 || times > VOXEL_NODES_MAX)
            return voxel_fail(v, "dimension %d of %d, expected 1 or more", i, n);
        times *= (uint64_t)n;
    }
    if (!read_type(v, whole(h, DATATYPE), &type, &parts)) return false;
    if (parts > 1 && times > 1)
        return voxel_fail(v, "several times of several numbers, expected one of them");
    place(v, h);
    struct voxel_array *a = voxel_add(v, "", type, parts * times, false);
    if (times > 1) voxel_slowest(v, a);
    return find_numbers(v, h, a);
}

bool voxel_read_nifti(struct voxel *v)
{
    struct header h = {.p = v->bytes};
    struct buf own = {0};
    const bool packed = GZIP(v->bytes);
    bool good = true;
    if (packed) good = voxel_inflate(v->bytes, v->n_bytes, 0, HEAD, &own) == HEAD;
    if (packed && good) h.p = buf_data(&own);
    good = good && (packed || v->n_bytes >= HEAD);
    if (!good && !packed) voxel_fail(v, "%zu bytes, expected a header of %d", v->n_bytes, HEAD);
    else if (!good || (h.p[0] != 92 && h.p[3] != 92))
        good = voxel_fail(v, "packed by gzip, expected NIfTI-1 in it; unpack others by gunzip");
    good = good && read_header(v, &h);
    buf_free(&own);
    return good;
}
