/* unpack: the numbers of an array, whatever they are packed in. */
#include "voxel/voxel_int.h"

#include <string.h>

/* Text becomes doubles. */
static bool unpack_text(
    struct voxel *v, const struct voxel_source *s, uint64_t count, struct voxel_row *row)
{
    size_t at = 0, k;
    for (uint64_t i = 0; i < count; i++, at += k) {
        double d;
        char shown[ERR_WORD];
        k = voxel_word(s->p, s->n, true, &at);
        if (!k)
            return voxel_fail(
                v, "%llu numbers, expected %llu", (unsigned long long)i, (unsigned long long)count);
        if (!voxel_number(s->p + at, k, &d))
            return voxel_fail(v, "value %llu is %s, expected a number", (unsigned long long)i + 1,
                err_word(shown, s->p + at, k));
        if (s->colours) d = floor(d * 255 + .5);
        buf_append(&row->own, &d, sizeof d);
    }
    const uint16_t one = 1;
    unsigned char low;
    memcpy(&low, &one, 1);
    row->type = (struct voxel_type){sizeof(double), VOXEL_REAL};
    row->big = !low;
    return true;
}

bool voxel_unpack(struct voxel *v, const struct voxel_source *s, struct voxel_type t,
    uint64_t count, struct voxel_row *row)
{
    const uint64_t want = count * t.size;
    uint64_t have = want;
    *row = (struct voxel_row){.type = t, .big = s->big};
    v->line = 0;
    switch ((enum voxel_packing)s->packing) {
    case VOXEL_RAW:
        have = s->n < s->skip ? 0 : s->n - s->skip;
        if (have >= want) row->p = s->p + s->skip;
        break;
    case VOXEL_TEXT:
        if (!unpack_text(v, s, count, row)) return false;
        break;
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
