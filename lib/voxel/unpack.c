/* unpack: the numbers of an array, whatever they are packed in. */
#include "voxel/voxel_int.h"

#include <string.h>

/* Sets the line of a place in a source, for a message. */
static void set_line(struct voxel *v, const struct voxel_source *s, size_t at)
{
    if (!s->file) return;
    v->line = 1;
    for (const unsigned char *p = s->file; p < s->p + at; p++) v->line += *p == '\n';
}

void voxel_row_of_doubles(struct voxel_row *row)
{
    const uint16_t one = 1;
    unsigned char low;
    memcpy(&low, &one, 1);
    row->type = (struct voxel_type){sizeof(double), VOXEL_REAL};
    row->big = !low;
    row->p = buf_data(&row->own);
}

/* Text becomes doubles. */
static bool unpack_text(
    struct voxel *v, const struct voxel_source *s, uint64_t count, struct voxel_row *row)
{
    size_t at = 0, k;
    for (uint64_t i = 0; i < count; i++, at += k) {
        double d;
        char shown[ERR_WORD];
        k = voxel_word(s->p, s->n, true, &at);
        if (!k || !voxel_number(s->p + at, k, &d)) set_line(v, s, at);
        if (!k)
            return voxel_fail(
                v, "%llu numbers, expected %llu", (unsigned long long)i, (unsigned long long)count);
        if (!voxel_number(s->p + at, k, &d))
            return voxel_fail(v, "value %llu is %s, expected a number", (unsigned long long)i + 1,
                err_word(shown, s->p + at, k));
        if (s->colours) d = floor(d * 255 + .5);
        buf_append(&row->own, &d, sizeof d);
    }
    if (voxel_word(s->p, s->n, true, &at)) {
        set_line(v, s, at);
        return voxel_fail(v, "more numbers, expected %llu", (unsigned long long)count);
    }
    voxel_row_of_doubles(row);
    return true;
}

/* Appends bytes of two digits each. Returns how many there are. */
static uint64_t unpack_hex(const struct voxel_source *s, uint64_t want, struct buf *out)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    int high = -1;
    for (size_t i = 0; i < s->n && buf_size(out) < want; i++) {
        const char *at = s->p[i] ? strchr(digits, s->p[i]) : NULL;
        if (!at && strchr(" \t\r\n", s->p[i]) && s->p[i]) continue;
        if (!at) break;
        const int low = (int)(at - digits) % 16;
        if (high >= 0) buf_append(out, &(unsigned char){(unsigned char)(high << 4 | low)}, 1);
        high = high < 0 ? low : -1;
    }
    return buf_size(out);
}

static bool unpack(struct voxel *v, const struct voxel_source *s, struct voxel_type t,
    uint64_t count, struct voxel_row *row)
{
    const uint64_t want = count * t.size;
    uint64_t have = want;
    switch ((enum voxel_packing)s->packing) {
    case VOXEL_RAW:
        have = s->n < s->skip ? 0 : s->n - s->skip;
        if (have >= want) row->p = s->p + s->skip;
        break;
    case VOXEL_TEXT:
        if (!unpack_text(v, s, count, row)) return false;
        break;
    case VOXEL_HEX: have = unpack_hex(s, want, &row->own); break;
    case VOXEL_DEFLATE: have = voxel_inflate(s->p, s->n, s->skip, want, &row->own); break;
    case VOXEL_BLOCKS:
        if (!voxel_blocks(v, s, want, &row->own)) return false;
    }
    if (have < want)
        return voxel_fail(v, "%llu bytes of values%s, expected %llu", (unsigned long long)have,
            s->packing == VOXEL_DEFLATE ? " could be unpacked" : "", (unsigned long long)want);
    if (!row->p) row->p = buf_data(&row->own);
    return true;
}

bool voxel_unpack(struct voxel *v, const struct voxel_source *s, struct voxel_type t,
    uint64_t count, struct voxel_row *row)
{
    const char *kept = v->name;
    *row = (struct voxel_row){.type = t, .big = s->big};
    v->line = 0;
    if (s->name) v->name = s->name;
    const bool good = unpack(v, s, t, count, row);
    v->name = kept;
    return good;
}
