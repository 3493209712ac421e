/* The generation of state that a frame belongs to. */
#include "wire/wire.h"

bool generation_ends(const struct generations *g, enum rec_kind kind)
{
    return g->framed && g->has[kind - REC_SCENE];
}

/* Bytes of all state of generations first .. now; shared records count once. */
static size_t bytes_from(const struct generations *g, uint32_t first)
{
    size_t sum = 0;
    for (uint32_t i = first; i != g->now + 1; i++)
        for (int k = 0; k < WIRE_STATE_KINDS; k++)
            if (i == first || g->at[i % GENERATIONS].since[k] == i)
                sum += g->at[i % GENERATIONS].bytes[k];
    return sum;
}

static void age(struct generations *g)
{
    size_t most = (size_t)STATE_BYTES * (g->keeps ? 2 : 1);
    while (g->now - g->oldest > 1 &&
           (g->now - g->oldest >= GENERATIONS || bytes_from(g, g->oldest) > most))
        g->oldest++;
}

void generation_state(struct generations *g, enum rec_kind kind, size_t bytes)
{
    unsigned k = kind - REC_SCENE;
    if (generation_ends(g, kind)) {
        g->at[(g->now + 1) % GENERATIONS] = g->at[g->now % GENERATIONS];
        g->now++;
        g->framed = false;
    }
    g->has[k] = true;
    g->at[g->now % GENERATIONS].since[k] = g->now;
    g->at[g->now % GENERATIONS].bytes[k] = bytes;
    age(g);
}

uint32_t generation_oldest(const struct generations *g, enum rec_kind kind, size_t bytes)
{
    struct generations next = *g;
    generation_state(&next, kind, bytes);
    return next.oldest;
}

void generation_frame(struct generations *g, struct frame_size *f)
{
    f->generation = g->now;
    g->framed = true;
}
