/* shapes: the table of item kinds. */
#include "trace/trace_int.h"

const struct shape *const trace_shapes[] = {
    [ITEM_TRIANGLE] = &triangle_shape,
    [ITEM_SPHERE] = &sphere_shape,
    [ITEM_CONE] = &cone_shape,
};
_Static_assert(sizeof trace_shapes / sizeof *trace_shapes == ITEM_KINDS, "a row for each kind");
