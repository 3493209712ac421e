/*
 * classic: is a classic NetCDF file whole? libnetcdf takes what lies beyond its end for zeros, and
 * some damaged headers end the process. Follows "NetCDF File Format Specifications" of the NetCDF
 * Users' Guide (Unidata): the classic format, its 64-bit offsets (2) and 64-bit data (5).
 */
#include "cf/cf_int.h"

#include <inttypes.h>
#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

enum { TAG_NONE = 0, TAG_DIMENSION = 10, TAG_VARIABLE = 11, TAG_ATTRIBUTE = 12 };

struct header {
    FILE *f;
    uint64_t at, size; /* bytes */
    int version;
    bool bad;
    uint64_t *length, n_dims;       /* a length of 0: the dimension of records */
    uint64_t end;                   /* of the data of variables without records */
    uint64_t n_recorded, last;      /* variables with records; the end of their first record */
    uint64_t record, padded_record; /* bytes of a record: of a single variable; of several */
};

static uint64_t damaged(struct header *h)
{
    h->bad = true;
    return 0;
}

/* A number of n bytes; 0 after damage. */
static uint64_t number(struct header *h, int n)
{
    uint64_t value = 0;
    for (int i = 0, c; i < n && !h->bad; i++, h->at++) {
        if ((c = getc(h->f)) == EOF) return damaged(h);
        value = value << 8 | (unsigned)c;
    }
    return value;
}
static uint64_t count(struct header *h) { return number(h, h->version == 5 ? 8 : 4); }

static uint64_t padded(uint64_t n) { return (n + 3) & ~UINT64_C(3); }

static void skip(struct header *h, uint64_t n)
{
    if (h->bad || n > h->size - h->at || fseeko(h->f, (off_t)n, SEEK_CUR) != 0) damaged(h);
    else h->at += n;
}

static void name(struct header *h)
{
    uint64_t n = count(h);
    if (n > NC_MAX_NAME) damaged(h);
    skip(h, padded(n));
}

/* The number of elements of a list, each of which takes some bytes. */
static uint64_t list(struct header *h, uint64_t tag)
{
    uint64_t is = number(h, 4), n = count(h);
    if ((is != tag && is != TAG_NONE) || (is == TAG_NONE && n > 0) || n > h->size - h->at)
        return damaged(h);
    return h->bad ? 0 : n;
}

static uint64_t type_size(struct header *h)
{
    static const unsigned char sizes[] = {[NC_BYTE] = 1,
        [NC_CHAR] = 1,
        [NC_SHORT] = 2,
        [NC_INT] = 4,
        [NC_FLOAT] = 4,
        [NC_DOUBLE] = 8,
        [NC_UBYTE] = 1,
        [NC_USHORT] = 2,
        [NC_UINT] = 4,
        [NC_INT64] = 8,
        [NC_UINT64] = 8};
    uint64_t type = number(h, 4);
    return type < sizeof sizes && sizes[type] ? sizes[type] : damaged(h);
}

static void attributes(struct header *h)
{
    for (uint64_t n = list(h, TAG_ATTRIBUTE); n > 0 && !h->bad; n--) {
        name(h);
        uint64_t size = type_size(h), values = count(h);
        if (values > h->size) damaged(h);
        skip(h, padded(size * values));
    }
}

static void dimensions(struct header *h)
{
    h->n_dims = list(h, TAG_DIMENSION);
    h->length = xcalloc(h->n_dims + 1, sizeof *h->length);
    for (uint64_t i = 0; i < h->n_dims && !h->bad; i++) {
        name(h);
        h->length[i] = count(h);
    }
}

/* a * b; more than any file has if that is too much */
static uint64_t product(uint64_t a, uint64_t b)
{
    return b && a > INT64_MAX / b ? INT64_MAX : a * b;
}
static uint64_t sum(uint64_t a, uint64_t b) { return a > INT64_MAX - b ? INT64_MAX : a + b; }

static void variable(struct header *h)
{
    name(h);
    const uint64_t n = count(h);
    uint64_t values = 1;
    bool recorded = false;
    if (n > NC_MAX_VAR_DIMS) damaged(h);
    for (uint64_t i = 0; i < n && !h->bad; i++) {
        uint64_t dim = count(h);
        if (dim >= h->n_dims) damaged(h);
        else if (i == 0 && h->length[dim] == 0) recorded = true;
        else values = product(values, h->length[dim]);
    }
    attributes(h);
    const uint64_t bytes = product(values, type_size(h));
    count(h); /* the same, padded; meaningless where it has no room */
    const uint64_t begin = number(h, h->version == 1 ? 4 : 8), end = sum(begin & INT64_MAX, bytes);
    if (!recorded) h->end = end > h->end ? end : h->end;
    else {
        h->n_recorded++;
        h->record = bytes;
        h->padded_record = sum(h->padded_record, padded(bytes));
        h->last = end > h->last ? end : h->last;
    }
}

/* Reads the header. Returns the least size of such a file. */
static uint64_t needed(struct header *h)
{
    uint64_t records = count(h);
    if (records == (h->version == 5 ? UINT64_MAX : UINT32_MAX)) records = 0; /* as the file holds */
    dimensions(h);
    attributes(h);
    for (uint64_t n = list(h, TAG_VARIABLE); n > 0 && !h->bad; n--) variable(h);
    if (h->n_recorded > 0 && records > 0) {
        uint64_t record = h->n_recorded == 1 ? h->record : h->padded_record;
        uint64_t end = sum(h->last, product(record, records - 1));
        if (end > h->end) h->end = end;
    }
    return h->end;
}

bool cf_is_whole(const char *path, char err[ERR_BYTES])
{
    unsigned char magic[4];
    struct header h = {.f = fopen(path, "rb")};
    if (!h.f) return true; /* libnetcdf says why */
    bool good = true;
    if (fread(magic, 1, sizeof magic, h.f) == sizeof magic && memcmp(magic, "CDF", 3) == 0 &&
        (magic[3] == 1 || magic[3] == 2 || magic[3] == 5) && fseeko(h.f, 0, SEEK_END) == 0) {
        h.size = (uint64_t)ftello(h.f);
        h.version = magic[3];
        h.at = sizeof magic;
        fseeko(h.f, (off_t)h.at, SEEK_SET);
        uint64_t size = needed(&h);
        if (h.bad)
            good = err_set(
                err, "byte %" PRIu64 ": damaged, expected the header of a NetCDF file", h.at);
        else if (size > h.size)
            good = err_set(err, "ends after %" PRIu64 " bytes, expected %" PRIu64, h.size, size);
        free(h.length);
    }
    fclose(h.f);
    return good;
}
