/* The verdict on a part from its opinions, and the slot to ask next. */
#include "verify/verify.h"

#include <inttypes.h>
#include <stdlib.h>

static bool computed(const struct verify_part *p, int32_t place)
{
    for (uint32_t i = 0; i < p->n; i++)
        if (verify_opinion(p, i)->place == place) return true;
    return false;
}

/* ---- the verdict ----------------------------------------------------------------------------- */

enum verify_verdict verify_judge(const struct verify_part *p)
{
    bool checked = false;
    for (uint32_t i = 1; i < p->n; i++) {
        const struct verify_opinion *o = verify_opinion(p, i);
        if (!verify_same(o, &p->by[0])) return VERIFY_DIFFERENT;
        checked = checked || o->place != p->by[0].place;
    }
    return checked ? VERIFY_AGREED : VERIFY_UNCHECKED;
}

uint32_t verify_votes(const struct verify_part *p, uint32_t i)
{
    const struct verify_opinion *o = verify_opinion(p, i);
    uint32_t n = 0;
    for (uint32_t k = 0; k < p->n; k++) {
        const struct verify_opinion *other = verify_opinion(p, k);
        int32_t place = other->place;
        bool counts = place >= 0 && verify_same(other, o);
        for (uint32_t m = 0; counts && m < k; m++) {
            const struct verify_opinion *before = verify_opinion(p, m);
            counts = !verify_same(before, o) || before->place != place;
        }
        n += counts;
    }
    return n;
}

static uint32_t most_votes(const struct verify_part *p)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        uint32_t n = verify_votes(p, i);
        if (n > most) most = n;
    }
    return most;
}

bool verify_named(const struct verify_part *p, uint32_t i, bool *known)
{
    uint32_t most = most_votes(p);
    *known = false;
    for (uint32_t k = 0; k < p->n; k++) *known = *known || (most > 1 && verify_votes(p, k) < most);
    return !*known || verify_votes(p, i) < most;
}

struct verify_count verify_counted(const struct verify *v)
{
    struct verify_count count = {0};
    unsigned char *worst = xcalloc((size_t)v->seen + 1, 1); /* by piece */
    for (uint32_t i = 0; i < v->n; i++) {
        enum verify_verdict verdict = verify_judge(&v->part[i]);
        unsigned char *w = &worst[v->part[i].piece];
        if (verdict > *w) *w = (unsigned char)verdict;
    }
    for (uint32_t k = 0; k < v->seen; k++) {
        count.different += worst[k] == VERIFY_DIFFERENT;
        count.unchecked += worst[k] == VERIFY_UNCHECKED;
    }
    free(worst);
    return count;
}

static void name_slot(const struct verify_opinion *o, const struct verify_hosts *h, struct buf *out)
{
    if (o->place < 0) buf_printf(out, "a slot of an earlier run");
    else if (o->slot < 0)
        buf_printf(out, "host %s in an earlier run", verify_hosts_name(h, o->place));
    else buf_printf(out, "slot %d (host %s)", o->slot, verify_hosts_name(h, o->place));
}

void verify_describe(const struct verify_part *p, const struct verify_hosts *h, struct buf *out)
{
    bool known = false, first = true;
    buf_printf(out, "frame %" PRIu32 " at %" PRIu32 ",%" PRIu32 ": ", p->frame, p->at.x, p->at.y);
    for (uint32_t i = 0; i < p->n; i++) {
        if (!verify_named(p, i, &known)) continue;
        if (!first) buf_printf(out, known ? ", " : " and ");
        name_slot(verify_opinion(p, i), h, out);
        first = false;
    }
    buf_printf(
        out, known ? " computed other pixels than two other hosts" : " computed different pixels");
}

/* ---- the next round -------------------------------------------------------------------------- */

/* Two equal results settle a part: they confirm the first opinion, or show which one is wrong. */
static bool settled(const struct verify_part *p)
{
    enum verify_verdict verdict = verify_judge(p);
    return !p->n || verdict == VERIFY_AGREED || (verdict == VERIFY_DIFFERENT && most_votes(p) > 1);
}

/* Reasons against asking a place for the part again; GIVEN_UP: it failed twice. One failure in
 * the first round counts less: another slot may just have been faster. */
#define GIVEN_UP 3
static int failures(const struct verify_part *p, int32_t place)
{
    return (p->failed[0] == place) + 2 * (p->failed[1] == place);
}

/* A place that delivered nothing probably hangs. A place that delivered less than half may just
 * be slow: deal -e gave its tasks to others. */
static int behind(const struct verify_place *p)
{
    if (p->asked_px && !p->made_px) return 2;
    return p->made_px < p->asked_px / 2;
}

int32_t verify_next(const struct verify *v, const struct verify_part *p)
{
    int32_t best = -1;
    int least = INT32_MAX; /* reasons against it */
    if (settled(p)) return -1;
    int32_t from = (int32_t)(rng_unit(v->seed + VERIFY_SEED_NEXT + v->rounds, p->piece) * v->slots);
    for (int32_t i = 0; i < v->slots && least; i++) {
        int32_t slot = (from + i) % v->slots, place = v->place_of[slot];
        int failed = failures(p, place), against = failed + 4 * behind(&v->place[place]);
        if (against >= least || failed == GIVEN_UP || computed(p, place)) continue;
        best = slot;
        least = against;
    }
    return best;
}

bool verify_request(const struct verify *v, uint32_t frame, uint32_t *from, struct task *t)
{
    uint32_t i, end = verify_of_frame(v, frame, &i);
    for (i = *from > i ? *from : i; i < end; i++) {
        const struct verify_part *p = &v->part[i];
        *t = (struct task){.frame = p->frame, .id = i, .at = p->at, .to = verify_next(v, p)};
        *from = i + 1;
        if (t->to >= 0) return true;
    }
    return false;
}

void verify_begin(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) v->part[i].asked = verify_next(v, &v->part[i]);
    v->rounds++;
}

void verify_end(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) {
        struct verify_part *p = &v->part[i];
        if (p->asked < 0) continue;
        int32_t place = v->place_of[p->asked];
        uint64_t px = lattice_count(&p->at);
        v->place[place].asked_px += px;
        if (computed(p, place)) v->place[place].made_px += px;
        else p->failed[p->failed[0] >= 0] = place;
    }
}
