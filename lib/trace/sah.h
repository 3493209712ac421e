/*
 * sah: splits sets of references by the surface area heuristic. Private to lib/trace.
 *
 * A split depends only on the references and their order, and so does the order that it leaves. The
 * number of threads changes nothing.
 */
#ifndef STORMRING_SAH_H
#define STORMRING_SAH_H

#include "trace/trace_int.h"

/* The fourth number of a bound is unused. */
struct box {
    _Alignas(16) float lo[4];
    float hi[4];
};

/* References [first, first + n). */
struct span {
    struct box box;     /* their bounds */
    struct box centres; /* the bounds of lo + hi of each */
    uint32_t first, n;
    int depth; /* splits above */
};

/* Half the surface area. */
float sah_area(const struct box *b);
/* The span of n > 0 references, all of them. */
struct span sah_all(struct ref *refs, uint32_t n, struct parallel *p);
/*
 * Splits a span in two and permutes its references. False: they stay together as a leaf, and are
 * all of one kind. A large span uses the threads of p, unless p is NULL.
 */
bool sah_split(struct ref *refs, const struct span *s, struct span half[2], struct parallel *p);

#endif
