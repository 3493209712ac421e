/* Which state a frame is of. */
#include "wire/wire.h"

bool generation_ends(const struct generations *g, enum rec_kind kind)
{
    return g->framed && g->has[kind - REC_SCENE];
}

void generation_state(struct generations *g, enum rec_kind kind)
{
    if (generation_ends(g, kind)) {
        g->now++;
        g->framed = false;
    }
    g->has[kind - REC_SCENE] = true;
}

void generation_frame(struct generations *g, struct frame_size *f)
{
    f->generation = g->now;
    g->framed = true;
}
