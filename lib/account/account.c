/* The slots of a run and their time: see account.h. */
#include "account/account.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* ---- slots ----------------------------------------------------------------------------------- */

static void add_slot(struct account *a, const char *name)
{
    a->slots = xrealloc(a->slots, a->n_slots + 1, sizeof *a->slots);
    struct account_slot *s = &a->slots[a->n_slots++];
    *s = (struct account_slot){.power = 1};
    snprintf(s->name, sizeof s->name, "%s", name);
}

static int by_name(const void *a, const void *b)
{
    return text_order(
        ((const struct account_slot *)a)->name, ((const struct account_slot *)b)->name);
}

int64_t account_outermost(const char *name)
{
    char text[HISTORY_NAME];
    int64_t k;
    snprintf(text, sizeof text, "%s", name);
    text[strcspn(text, ".")] = '\0';
    return parse_int(text, 0, HISTORY_SLOTS_MAX - 1, &k) ? k : -1;
}

/* Slots counted in a hello but without any record were idle. */
static void add_idle(struct account *a)
{
    int32_t claimed = 0;
    for (size_t i = 0; i < a->log->n_runs; i++)
        if (a->log->runs[i].slots > claimed) claimed = a->log->runs[i].slots;
    bool *known = xcalloc((size_t)claimed + 1, sizeof *known);
    for (size_t i = 0; i < a->log->n_slots; i++) {
        int64_t k = account_outermost(a->log->slots[i].name);
        if (k >= 0 && k < claimed) known[k] = true;
    }
    if (claimed == 1) known[0] = true; /* a lone worker */
    for (int32_t k = 0; k < claimed; k++) {
        char name[HISTORY_NAME];
        snprintf(name, sizeof name, "%" PRId32, k);
        if (!known[k]) add_slot(a, name);
    }
    free(known);
}

/* True if slot i of the log is a worker of several slots, such as 1 of 1.0 and 1.1: only its frames
 * and its loss have its own number. */
static bool is_outer(const struct history *l, const bool *works, size_t i)
{
    const char *name = l->slots[i].name;
    const size_t n = strlen(name);
    for (size_t k = 0; k < l->n_slots && !works[i]; k++)
        if (strncmp(l->slots[k].name, name, n) == 0 && l->slots[k].name[n] == '.') return true;
    return false;
}

static void make_slots(struct account *a)
{
    const struct history *l = a->log;
    bool *works = xcalloc(l->n_slots + 1, sizeof *works), inner = false;
    for (size_t i = 0; i < l->n_dones; i++) works[l->dones[i].slot] = true;
    for (size_t i = 0; i < l->n_slots; i++) inner = inner || strchr(l->slots[i].name, '.');
    for (size_t i = 0; i < l->n_slots; i++)
        if (!inner || !is_outer(l, works, i)) add_slot(a, l->slots[i].name);
    add_idle(a);
    if (a->n_slots) qsort(a->slots, a->n_slots, sizeof *a->slots, by_name);
    a->slot_of = xcalloc(l->n_slots, sizeof *a->slot_of);
    for (size_t i = 0; i < l->n_slots; i++) {
        struct account_slot key = {0};
        memcpy(key.name, l->slots[i].name, sizeof key.name);
        const struct account_slot *s = bsearch(&key, a->slots, a->n_slots, sizeof key, by_name);
        a->slot_of[i] = s ? (uint32_t)(s - a->slots) : ACCOUNT_OUTER;
    }
    free(works);
}

/* ---- times ----------------------------------------------------------------------------------- */

/*
 * The time of a slot on a task is the worker's wall time, but at least the CPU time since the
 * previous task. CPU time includes reading and writing, which the wall time does not.
 */
static void make_span(struct account *a, size_t i)
{
    const struct history_done *d = &a->log->dones[i];
    struct account_slot *slot = &a->slots[a->slot_of[d->slot]];
    struct span *s = &a->spans[i];
    s->run = (uint32_t)d->run;
    s->slot = a->slot_of[d->slot];
    s->end_s = d->recv_us < 0 ? -1 : (double)d->recv_us * 1e-6;
    s->took_s = (double)(d->wall_us > d->cpu_us ? d->wall_us : d->cpu_us) * 1e-6;
    s->wasted = history_wasted(a->log, d);
    slot->tasks++;
    slot->duplicates += s->wasted;
    slot->retries += d->try > 1;
    slot->steals += d->stolen;
    slot->cpu_s += (double)d->cpu_us * 1e-6;
    a->tasks += !s->wasted;
}

void account_make(struct account *a, const struct history *log)
{
    *a = (struct account){.log = log};
    make_slots(a);
    a->spans = xcalloc(log->n_dones, sizeof *a->spans);
    for (size_t i = 0; i < log->n_dones; i++) make_span(a, i);
    a->run_s = xcalloc(log->n_runs, sizeof *a->run_s);
    struct times *of = xcalloc(a->n_slots, sizeof *of);
    stats_timeline(a->spans, log->n_dones, of, a->n_slots, a->run_s, log->n_runs);
    for (size_t k = 0; k < a->n_slots; k++) a->slots[k].times = of[k];
    a->zero_s = xcalloc(log->n_runs, sizeof *a->zero_s);
    for (size_t i = 0; i < log->n_runs; i++) {
        a->zero_s[i] = a->makespan_s;
        a->makespan_s += a->run_s[i];
    }
    free(of);
}

enum account_kind account_kind(const struct account *a, size_t i)
{
    if (a->spans[i].wasted) return ACCOUNT_WASTED;
    return a->log->dones[i].try > 1 ? ACCOUNT_AGAIN : ACCOUNT_TASK;
}

struct account_slot account_total(const struct account *a)
{
    struct account_slot all = {0};
    for (size_t k = 0; k < a->n_slots; k++) {
        const struct account_slot *s = &a->slots[k];
        all.cpu_s += s->cpu_s;
        all.tasks += s->tasks;
        all.duplicates += s->duplicates;
        all.retries += s->retries;
        all.steals += s->steals;
        all.times.busy_s += s->times.busy_s;
        all.times.startup_s += s->times.startup_s;
        all.times.waiting_s += s->times.waiting_s;
        all.times.tail_s += s->times.tail_s;
        all.times.wasted_s += s->times.wasted_s;
    }
    return all;
}

void account_free(struct account *a)
{
    free(a->slots);
    free(a->slot_of);
    free(a->spans);
    free(a->run_s);
    free(a->zero_s);
    *a = (struct account){0};
}

/* ---- the bound ------------------------------------------------------------------------------- */

/* The pixels of one done, at power 1. `power` is that of the slot that did it. */
static struct pieces pieces_of(const struct history *l, const struct history_done *d, double power)
{
    struct pieces p = {0};
    if (history_wasted(l, d)) return p;
    double used = l->n_frags ? (double)d->pixels / (double)d->sent : 1;
    p.n = l->n_frags ? d->pixels : 1;
    p.c = p.n ? (double)d->cpu_us * 1e-6 * power * used / (double)p.n : 0;
    return p;
}

double account_bound(const struct account *a, const struct history *one)
{
    const struct history *l = one ? one : a->log;
    struct pieces *p = xcalloc(l->n_dones, sizeof *p);
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct history_done *d = &l->dones[i];
        p[i] = pieces_of(l, d, one ? 1 : a->slots[a->slot_of[d->slot]].power);
    }
    double *v = xcalloc(a->n_slots, sizeof *v);
    for (size_t k = 0; k < a->n_slots; k++) v[k] = a->slots[k].power;
    double bound_s = stats_lower_bound_pieces(p, l->n_dones, v, a->n_slots);
    free(v);
    free(p);
    return bound_s;
}

double account_efficiency(const struct account *a, double bound_s)
{
    return a->makespan_s > 0 ? bound_s / a->makespan_s : 0;
}
