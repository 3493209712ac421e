/* spec_int: the reader of a specification, which spec.c and field.c share. Private to lib/spec. */
#ifndef STORMRING_SPEC_SPEC_INT_H
#define STORMRING_SPEC_SPEC_INT_H

#include "spec/spec.h"

#include <string.h>

/* Knots of the map, of the colours of the second field, of the ground. */
enum { SPEC_MAP, SPEC_COLOURS, SPEC_GROUND, SPEC_LISTS };
struct spec_list {
    struct spec_knot *knot;
    size_t n;
    double place; /* in the palette, of the last knot; negative: it has its own colour */
};

struct spec_reader {
    const char *at, *end; /* the unread part of the line */
    const char *name;     /* for messages */
    char *err;            /* ERR_BYTES bytes */
    size_t line;          /* from 1 */
    unsigned seen;        /* one bit per word */
    struct spec *s;
    struct spec_list list[SPEC_LISTS];
    double palette[SPEC_PALETTE_POINTS][3]; /* if seen */
};

bool spec_fail(struct spec_reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
static inline void spec_copy(double to[3], const double from[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

/* ---- what is seen of the field (field.c) ---------------------------------------------------- */

/* v: value, colour, extinction. place: in the palette; negative: v has the colour. */
bool spec_add_knot(struct spec_reader *r, int list, const double v[5], double place);
bool spec_add_iso(struct spec_reader *r, const double v[5]);
bool spec_add_slice(struct spec_reader *r, int axis, const double v[2]);
bool spec_add_level(struct spec_reader *r, const double v[2]); /* profile.c */
bool spec_take_clip(struct spec_reader *r, const double v[6]);
/* What these lines must be together. Moves lists to the specification; sorts surfaces and
 * slices. */
bool spec_check_field(struct spec_reader *r);

#endif
