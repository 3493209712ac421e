/* Faults as words of a command line; loads as lines of a file. */
#include "sim/sim.h"

#include <stdlib.h>
#include <string.h>

#define SLOT_MOST 1000000
#define SLOWED .1        /* default share of its power left */
#define SHARE_LEAST 1e-3 /* of a load */

/* Ends the word at the next ':'; the rest, or NULL. */
static char *cut_off(char *word)
{
    char *colon = strchr(word, ':');
    if (!colon) return NULL;
    *colon = '\0';
    return colon + 1;
}

/* WHEN: "2.5s", or a number of committed tasks. */
static bool parse_when(char *when, struct sim_fault *f)
{
    size_t n = strlen(when);
    double s;
    f->at_us = -1;
    if (!n || when[n - 1] != 's') return parse_int(when, 1, INT32_MAX, &f->commits);
    when[n - 1] = '\0';
    if (!parse_real(when, 0, 1e9, &s)) return false;
    f->at_us = (int64_t)fmax(s * 1e6, 1); /* at 0 the slots start */
    return true;
}

/* WHEN[:SLOT[:POWER]]; the hub has no slot, and only a slow-down has a power. */
static bool parse_fault(struct sim_plan *plan, enum sim_fault_kind kind, char *when)
{
    struct sim_fault f = {.kind = kind, .power = kind == SIM_SLOW ? SLOWED : 0};
    char *slot = cut_off(when), *power = slot ? cut_off(slot) : NULL;
    int64_t k = 0;
    if (!parse_when(when, &f) || (kind == SIM_KILL) != !slot || (power && kind != SIM_SLOW))
        return false;
    if (slot && !parse_int(slot, 0, SLOT_MOST, &k)) return false;
    if (power && !parse_real(power, 1e-3, 1, &f.power)) return false;
    f.slot = (int32_t)k;
    plan->faults = xrealloc(plan->faults, plan->n_faults + 1, sizeof *plan->faults);
    plan->faults[plan->n_faults++] = f;
    return true;
}

/* X:Y, a pixel. */
static bool parse_poison(struct sim_plan *plan, char *x)
{
    char *y = cut_off(x);
    int64_t at[2];
    if (!y || !parse_int(x, 0, FRAME_SIDE_MAX - 1, &at[0]) ||
        !parse_int(y, 0, FRAME_SIDE_MAX - 1, &at[1]))
        return false;
    plan->faults = xrealloc(plan->faults, plan->n_faults + 1, sizeof *plan->faults);
    plan->faults[plan->n_faults++] =
        (struct sim_fault){.kind = SIM_POISON, .x = (uint32_t)at[0], .y = (uint32_t)at[1]};
    return true;
}

static bool parse_word(struct sim_plan *p, char *word)
{
    if (strncmp(word, "poison@", 7) == 0) return parse_poison(p, word + 7);

    const struct {
        const char *name;
        double *chance;
        int kind; /* -1: random only */
    } table[] = {
        {"crash", &p->p_crash, SIM_CRASH},
        {"silence", &p->p_silence, SIM_SILENCE},
        {"pause", &p->p_pause, SIM_PAUSE},
        {"slow", &p->p_slow, SIM_SLOW},
        {"hang", &p->p_hang, SIM_HANG},
        {"kill", &p->p_kill, SIM_KILL},
        {"return", &p->p_return, -1},
        {"lose", &p->p_lose, -1},
        {"double", &p->p_double, -1},
        {"late", &p->p_late, -1},
        {"twice", &p->p_twice, -1},
        {"garbage", &p->p_garbage, -1},
        {"jitter", &p->jitter, -1},
    };
    size_t n = strcspn(word, "=@");
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (strlen(table[i].name) != n || strncmp(word, table[i].name, n) != 0) continue;
        if (word[n] == '=') return parse_real(word + n + 1, 0, 1, table[i].chance);
        return word[n] == '@' && table[i].kind >= 0 &&
               parse_fault(p, (enum sim_fault_kind)table[i].kind, word + n + 1);
    }
    return false;
}

bool sim_parse_faults(struct sim_plan *plan, const char *list)
{
    char *copy = xstrdup(list), *rest = copy, *word;
    bool good = true;
    while (good && (word = text_part(&rest, ',')) != NULL) good = parse_word(plan, word);
    free(copy);
    return good;
}

/* ---- loads ----------------------------------------------------------------------------------- */

static int by_slot_and_time(const void *a, const void *b)
{
    const struct sim_load *x = a, *y = b;
    if (x->slot != y->slot) return x->slot < y->slot ? -1 : 1;
    return x->at_us < y->at_us ? -1 : x->at_us > y->at_us;
}

/* SECONDS SLOT SHARE. Returns 1, or 0 for a line without words, or -1. */
static int parse_load(char *line, struct sim_load *l)
{
    char *word[4] = {0}, *rest = NULL;
    int n = 0;
    double s;
    int64_t k;
    line[strcspn(line, "#")] = '\0';
    for (char *at = strtok_r(line, " \t\r", &rest); at; at = strtok_r(NULL, " \t\r", &rest)) {
        if (n == 3) return -1;
        word[n++] = at;
    }
    if (!n) return 0;
    if (n < 3 || !parse_real(word[0], 0, 1e9, &s) || !parse_int(word[1], 0, SLOT_MOST, &k))
        return -1;
    if (!parse_real(word[2], s > 0 ? SHARE_LEAST : 0, 1, &l->share)) return -1;
    if (l->share > 0 && l->share < SHARE_LEAST) return -1;
    l->slot = (int32_t)k;
    l->at_us = llround(s * 1e6);
    return 1;
}

/* Says what is wrong in sorted loads: two of one time, or an absence that never ends. */
static bool in_order(const struct sim_load *l, size_t n, char err[ERR_BYTES])
{
    for (size_t i = 0; i < n; i++) {
        bool more = i + 1 < n && l[i + 1].slot == l[i].slot;
        double s = 1e-6 * (double)l[i].at_us;
        if (more && l[i + 1].at_us == l[i].at_us)
            return err_set(
                err, "slot %d twice at %g s, expected a share for each time", l[i].slot, s);
        if (!more && l[i].share <= 0)
            return err_set(err, "slot %d never joins, expected a later share of it", l[i].slot);
    }
    return true;
}

bool sim_read_loads(struct sim_plan *plan, const char *path, char err[ERR_BYTES])
{
    struct buf b = {0};
    struct sim_load *all = NULL;
    size_t n = 0, number = 1;
    if (!load_file(path, &b, err)) return false;
    if (memchr(buf_data(&b), 0, buf_size(&b))) {
        buf_free(&b);
        return err_set(err, "a byte 0, expected lines of text");
    }
    buf_append(&b, "", 1);
    char *rest = (char *)b.data, *line;
    int found = 0;
    for (; found >= 0 && (line = text_part(&rest, '\n')) != NULL; number += found >= 0) {
        if (!(n & (n + 1))) all = xrealloc(all, 2 * n + 2, sizeof *all);
        found = parse_load(line, &all[n]);
        n += found > 0;
    }
    buf_free(&b);
    if (n) qsort(all, n, sizeof *all, by_slot_and_time);
    plan->loads = all;
    plan->n_loads = n;
    if (found < 0)
        return err_set(err, "line %zu, expected SECONDS SLOT SHARE, such as 2.5 0 .5", number);
    return in_order(all, n, err);
}
