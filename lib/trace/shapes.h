/* shapes: the tests of a block of any kind (lanes.h). Each test is compiled into its caller. */
#ifndef STORMRING_TRACE_SHAPES_H
#define STORMRING_TRACE_SHAPES_H

#include "trace/cone.h"
#include "trace/sphere.h"
#include "trace/triangle.h"

#define BLOCK(name) ((const struct name##4 *)b->blocks[kind] + i)

static ALWAYS_INLINE unsigned hit_block(const struct bvh *b, enum item_kind kind, uint32_t i,
    const struct ray *r, double t_max, double t[LANES], const uint32_t **items, unsigned *twice)
{
#define HIT(KIND, name)                                                                            \
    if (kind == ITEM_##KIND) {                                                                     \
        *items = BLOCK(name)->item;                                                                \
        return hit_##name##4(BLOCK(name), r, t_max, t, twice);                                     \
    }
    TRACE_SHAPES(HIT)
    __builtin_unreachable();
}

static inline bool on_surface(
    const struct bvh *b, enum item_kind kind, uint32_t i, int k, struct vec3 p, double err)
{
#define ON(KIND, name)                                                                             \
    if (kind == ITEM_##KIND) return on_##name##4(BLOCK(name), k, p, err);
    TRACE_SHAPES(ON)
    __builtin_unreachable();
}

static ALWAYS_INLINE unsigned may_hit_block(
    const struct bvh *b, enum item_kind kind, uint32_t i, const struct packet *p)
{
#define MAY_HIT(KIND, name)                                                                        \
    if (kind == ITEM_##KIND) return may_hit_##name##4(BLOCK(name), p);
    TRACE_SHAPES(MAY_HIT)
    __builtin_unreachable();
}

#endif
