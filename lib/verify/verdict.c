/* The verdict on a piece from its results, and the slot to ask next. */
#include "verify/verify.h"

#include <inttypes.h>

#define SEED_NEXT 2 /* read.c has the others */
#define DRAWS 64    /* of a slot; then the slots in turn */

bool verify_computed(const struct verify_piece *p, int32_t place)
{
    for (uint32_t i = 0; i < p->n; i++)
        if (p->by[i].place == place) return true;
    return false;
}

enum verify_verdict verify_judge(const struct verify_piece *p)
{
    bool checked = false;
    for (uint32_t i = 1; i < p->n; i++) {
        if (p->by[i].sum != p->by[0].sum) return VERIFY_DIFFERENT;
        checked = checked || p->by[i].place != p->by[0].place;
    }
    return checked ? VERIFY_AGREED : VERIFY_UNCHECKED;
}

/* The number of places with the same result as result i. An unknown slot is no place. */
static uint32_t votes(const struct verify_piece *p, uint32_t i)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < p->n; k++) {
        bool counts = p->by[k].place >= 0 && p->by[k].sum == p->by[i].sum;
        for (uint32_t m = 0; counts && m < k; m++)
            counts = p->by[m].sum != p->by[i].sum || p->by[m].place != p->by[k].place;
        n += counts;
    }
    return n;
}

static uint32_t most_votes(const struct verify_piece *p)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        uint32_t n = votes(p, i);
        if (n > most) most = n;
    }
    return most;
}

bool verify_named(const struct verify_piece *p, uint32_t i, bool *known)
{
    uint32_t most = most_votes(p);
    *known = false;
    for (uint32_t k = 0; k < p->n; k++) *known = *known || (most > 1 && votes(p, k) < most);
    return !*known || votes(p, i) < most;
}

static void name_slot(const struct verify *v, const struct verify_result *got, struct buf *out)
{
    const char *host = v->host[v->several && got->place >= 0 ? got->place : 0];
    if (got->place < 0) buf_printf(out, "a slot of an earlier run");
    else if (got->slot < 0) buf_printf(out, "host %s in an earlier run", host);
    else buf_printf(out, "slot %d (host %s)", got->slot, host);
}

void verify_describe(const struct verify *v, const struct verify_piece *p, struct buf *out)
{
    bool known = false, first = true;
    buf_printf(out, "frame %" PRIu32 " at %" PRIu32 ",%" PRIu32 ": ", p->frame, p->at.x, p->at.y);
    for (uint32_t i = 0; i < p->n; i++) {
        if (!verify_named(p, i, &known)) continue;
        if (!first) buf_printf(out, known ? ", " : " and ");
        name_slot(v, &p->by[i], out);
        first = false;
    }
    buf_printf(
        out, known ? " computed other pixels than two other hosts" : " computed different pixels");
}

/* Two equal results settle a piece: they confirm the first one, or show which one is wrong. */
static bool settled(const struct verify_piece *p)
{
    enum verify_verdict verdict = verify_judge(p);
    return verdict == VERIFY_AGREED || (verdict == VERIFY_DIFFERENT && most_votes(p) > 1);
}

int32_t verify_next(const struct verify *v, const struct verify_piece *p)
{
    const uint64_t first = (uint64_t)(p - v->piece) * DRAWS;
    if (settled(p)) return -1;
    for (int32_t k = 0; k < DRAWS + 2 * v->slots; k++) {
        const uint64_t drawn = rng_u64(v->seed + SEED_NEXT, first + (uint64_t)k);
        int32_t slot = (k < DRAWS ? (int32_t)(drawn % (uint64_t)v->slots) : k - DRAWS) % v->slots;
        if (k < DRAWS / 2) slot = v->piece[drawn % v->n].by[0].slot;
        if (slot < 0 || slot >= v->slots) continue;
        const int32_t place = verify_place(v, slot);
        if (v->place[place].mute || verify_computed(p, place)) continue;
        if (k >= DRAWS + v->slots || place != p->failed) return slot;
    }
    return -1;
}
