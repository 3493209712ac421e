/* shapes: the table of item kinds. */
#include "trace/trace_int.h"

#define ROW(KIND, name) [ITEM_##KIND] = &trace_##name,
const struct shape *const trace_shapes[ITEM_KINDS] = {TRACE_SHAPES(ROW)};

enum item_kind trace_kind_of(const struct prim *p)
{
    uint32_t kind = 0;
    if (prim_is_poly(p)) return ITEM_TRIANGLE;
    while (kind < ITEM_KINDS - 1 && trace_shapes[kind]->prim != p->kind) kind++;
    return (enum item_kind)kind;
}
