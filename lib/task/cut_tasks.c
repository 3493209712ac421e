/* The tasks of a frame in an order, and the slots they are assigned to. */
#include "task/task.h"

#include <stdlib.h>
#include <string.h>

/* Of a sample: the most tasks of its first and last pass, and the least tasks for each of them. */
#define PASS_FIRST 32
#define PASS_LAST 128
#define FIRST_STEP_LEAST 8
#define SAMPLE_STEP_LEAST 4

bool cut_follows_slots(const struct cut *cut) { return cut->tasks > 0; }

bool cut_in_chunks(const struct cut *cut)
{
    return cut->unit == CUT_GUIDED || cut->unit == CUT_FACTORING;
}

/* ---- random places --------------------------------------------------------------------------- */

static bool are_unequal(const double *power, int slots)
{
    for (int k = 1; power && k < slots; k++)
        if (power[k] < power[0] || power[k] > power[0]) return true;
    return false;
}

static double due(const struct cut_tasks *c, const struct cut_turn *t)
{
    return (t->had + rng_unit((uint64_t)t->slot, t->had)) / c->power[t->slot];
}

/* The turn at this place may be due later than those below it: 2 i + 1 and 2 i + 2 are below i. */
static void sink(struct cut_tasks *c, int at)
{
    struct cut_turn *t = c->turns, moved = t[at];
    for (int below; (below = 2 * at + 1) < c->slots; at = below) {
        if (below + 1 < c->slots && t[below + 1].due < t[below].due) below++;
        if (t[below].due >= moved.due) break;
        t[at] = t[below];
    }
    t[at] = moved;
}

static void begin_turns(struct cut_tasks *c)
{
    c->turns = xcalloc((size_t)c->slots, sizeof *c->turns);
    for (int k = c->slots; k-- > 0;) {
        c->turns[k].slot = k;
        c->turns[k].due = due(c, &c->turns[k]);
        sink(c, k);
    }
}

static int take_turn(struct cut_tasks *c)
{
    struct cut_turn *first = c->turns;
    int slot = first->slot;
    first->had++;
    first->due = due(c, first);
    sink(c, 0);
    return slot;
}

/* ---- a frame --------------------------------------------------------------------------------- */

void cut_tasks_begin(struct cut_tasks *c, const struct cut *cut, uint32_t frame_w, uint32_t frame_h,
    int slots, const double *power)
{
    *c = (struct cut_tasks){.cut = *cut,
        .frame_w = frame_w,
        .frame_h = frame_h,
        .assigned = UINT32_MAX,
        .slots = slots,
        .power = power};
    if (cut_follows_slots(cut)) cut_suit(&c->cut, frame_w, frame_h, slots);
    if (cut_in_chunks(cut)) cut_chunks(&c->cut, frame_w, frame_h, power, slots);
    if (power) c->credit = xcalloc((size_t)slots, sizeof *c->credit);
    if (cut->unit == CUT_FINE && are_unequal(power, slots)) begin_turns(c);
    c->n = cut_count(&c->cut, frame_w, frame_h);
}

void cut_tasks_end(struct cut_tasks *c)
{
    cut_free(&c->cut);
    free(c->credit);
    free(c->turns);
    free(c->order);
    *c = (struct cut_tasks){0};
}

/* ---- the order ------------------------------------------------------------------------------- */

static void ascending(struct cut_tasks *c)
{
    free(c->order);
    c->order = xmalloc((size_t)c->n + 1, sizeof *c->order);
    for (uint32_t i = 0; i < c->n; i++) c->order[i] = i;
}

/* Each pass fills the gaps of those before it. */
void cut_tasks_sample(struct cut_tasks *c)
{
    bool *chosen = xcalloc((size_t)c->n + 1, sizeof *chosen);
    uint32_t parts = c->n / FIRST_STEP_LEAST < PASS_FIRST ? c->n / FIRST_STEP_LEAST : PASS_FIRST;
    uint32_t at = 0;
    ascending(c);
    while (parts > 0 && parts <= PASS_LAST && (at == 0 || at + parts <= c->n / SAMPLE_STEP_LEAST)) {
        for (uint32_t k = 0; k < parts; k++) { /* the middle of each of these equal parts */
            uint32_t i = (uint32_t)(((uint64_t)2 * k + 1) * c->n / ((uint64_t)2 * parts));
            chosen[c->order[at++] = i] = true;
        }
        parts *= 2;
    }
    for (uint32_t i = 0; i < c->n; i++)
        if (!chosen[i]) c->order[at++] = i;
    free(chosen);
}

static const double *cost_of; /* of the tasks that are sorted */

static int dearest_first(const void *a, const void *b)
{
    const double *cost = cost_of;
    uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
    if (cost[i] != cost[j]) return cost[i] > cost[j] ? -1 : 1;
    return i < j ? -1 : 1;
}

/* Longest processing time first (R. L. Graham, "Bounds on multiprocessing timing anomalies", SIAM
 * J. Appl. Math. 17, 1969). */
void cut_tasks_sort(struct cut_tasks *c, const double *cost)
{
    ascending(c);
    cost_of = cost;
    qsort(c->order, c->n, sizeof *c->order, dearest_first);
}

/* ---- the slots ------------------------------------------------------------------------------- */

/* Slightly less than 1 is enough: powers such as .1 are not exact, and ten of them should be 1. */
#define PRICE (1 - 1e-9)

/* Powers 1, 2, 1 give 0 1 2 1. */
static int interleave(struct cut_tasks *c)
{
    for (;;) {
        for (; c->turn < c->slots; c->turn++) {
            if (c->credit[c->turn] < PRICE) continue;
            c->credit[c->turn] -= 1;
            return c->turn++;
        }
        c->turn = 0;
        /* The number of rounds until a slot has enough credit; small powers need many. */
        double rounds = HUGE_VAL;
        for (int k = 0; k < c->slots; k++)
            rounds = fmin(rounds, ceil((PRICE - c->credit[k]) / c->power[k]));
        for (int k = 0; rounds > 0 && k < c->slots; k++) c->credit[k] += rounds * c->power[k];
    }
}

/* The slot of the task at this place of the order. */
static int32_t slot_of(struct cut_tasks *c, uint32_t place)
{
    uint32_t given = c->given++;
    if (cut_in_chunks(&c->cut)) return c->power && place < (uint32_t)c->slots ? (int32_t)place : -1;
    if (c->turns) return take_turn(c);
    if (c->power) return interleave(c);
    return c->slots ? (int32_t)(given % (uint32_t)c->slots) : -1;
}

bool cut_share_parse(const char *s, struct cut_share *share)
{
    char count[24];
    struct cut_share v = {0};
    size_t n = strcspn(s, "/");
    if (n >= sizeof count) return false;
    memcpy(count, s, n);
    count[n] = '\0';
    if (!parse_int(count, 0, UINT32_MAX, &v.count)) return false;
    if (s[n] && (!parse_int(s + n + 1, 1, UINT32_MAX, &v.of) || v.count > v.of)) return false;
    *share = v;
    return true;
}

uint32_t cut_share_of(const struct cut_share *share, uint32_t n)
{
    if (!share->of) return (uint32_t)share->count;
    return (uint32_t)((uint64_t)n * (uint64_t)share->count / (uint64_t)share->of);
}

bool cut_tasks_next(struct cut_tasks *c, struct task *t)
{
    while (c->at < c->n) {
        uint32_t place = c->at++;
        *t = cut_task(&c->cut, c->frame_w, c->frame_h, c->order ? c->order[place] : place);
        if (c->have && !coverage_trim(c->have, &t->at)) continue;
        if (place < c->assigned) t->to = slot_of(c, place);
        return true;
    }
    return false;
}
