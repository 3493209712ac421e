/* The state of a run from its log, and the table of it: see view.h. */
#include "view/view.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define LOSSES_MOST 5 /* lines about losses */
#define HOST_LEAST 16 /* columns of a host's name */
#define OTHER_COLUMNS 65

/* ---- the state ------------------------------------------------------------------------------- */

/* The latest time that a record of the last run states, and the time since the file grew. */
static double now_of(const struct view_log *v)
{
    const struct history *l = &v->log;
    int64_t us = 0;
    double lone_us = 0;
    for (size_t i = l->n_dones; i-- > 0 && l->dones[i].run + 1 == (int32_t)l->n_runs;) {
        if (l->dones[i].recv_us > us) us = l->dones[i].recv_us;
        lone_us += (double)l->dones[i].wall_us;
    }
    for (size_t i = l->n_events; i-- > 0 && l->events[i].run + 1 == (int32_t)l->n_runs;)
        if (l->events[i].recv_us > us) us = l->events[i].recv_us;
    double now_s = (us ? (double)us : lone_us) * 1e-6;
    return l->ended ? now_s : now_s + (double)(now_us() - v->heard_us) * 1e-6;
}

static void add_done(const struct history *l, const struct history_done *d, struct view_state *s)
{
    struct view_slot *slot = &s->slots[d->slot];
    double end_s = d->recv_us < 0 ? -1 : (double)d->recv_us * 1e-6;
    if (d->recv_us >= 0) slot->last_s = end_s;
    slot->busy_s += (double)(d->wall_us > d->cpu_us ? d->wall_us : d->cpu_us) * 1e-6;
    if (d->recv_us < 0) slot->last_s = slot->busy_s;
    slot->tasks++;
    slot->done = d;
    double over_s = fmin(VIEW_RATE_S, s->now_s);
    if (slot->last_s >= s->now_s - over_s && over_s > 0)
        slot->px_per_s += (double)(l->n_frags ? d->pixels : 0) / over_s;
}

void view_state(const struct view_log *v, struct view_state *s)
{
    const struct history *l = &v->log;
    size_t run = l->n_runs;
    *s = (struct view_state){.now_s = now_of(v), .left_s = -1};
    s->slots = xcalloc(l->n_slots + 1, sizeof *s->slots);
    for (size_t i = 0; i < l->n_slots; i++) s->slots[i].last_s = -1;
    for (size_t i = 0; i < l->n_frames; i++) {
        s->done_px += l->frames[i].have.done;
        s->total_px += (uint64_t)l->frames[i].w * l->frames[i].h;
    }
    for (size_t i = 0; i < l->n_dones; i++)
        if ((size_t)l->dones[i].run + 1 == run) add_done(l, &l->dones[i], s);
    for (size_t i = 0; i < l->n_events; i++) {
        const struct history_event *e = &l->events[i];
        if ((size_t)e->run + 1 != run) continue;
        s->slots[e->slot].event = e;
        s->slots[e->slot].losses += e->lost;
    }
    for (size_t i = 0; i < l->n_slots; i++) s->n_up += run && l->slots[i].ready == run;
    if (!l->ended)
        s->left_s = eta_left_s(&v->eta, (double)s->done_px, (double)s->total_px, s->now_s);
}

/* The slot that holds slot i, as 1 holds 1.0; -1: none. */
static ptrdiff_t outer_of(const struct history *l, size_t i)
{
    const char *name = l->slots[i].name;
    size_t n = strlen(name);
    while (n > 0) {
        if (name[--n] != '.') continue;
        for (size_t k = 0; k < l->n_slots; k++)
            if (strncmp(l->slots[k].name, name, n) == 0 && !l->slots[k].name[n])
                return (ptrdiff_t)k;
    }
    return -1;
}

const char *view_host(const struct history *l, size_t i, const char *unknown)
{
    ptrdiff_t k = (ptrdiff_t)i;
    while (k >= 0 && !*l->slots[k].host) k = outer_of(l, (size_t)k);
    if (k < 0) return unknown;
    return strcmp(l->slots[k].host, ":") == 0 ? "localhost" : l->slots[k].host;
}

/* ---- the table ------------------------------------------------------------------------------- */

struct page {
    struct buf *out;
    const char *eol;
    int columns, left; /* lines left; -1: no limit */
    int host;          /* columns of a host */
};

static void PRINTF_LIKE(2, 3) put(struct page *p, const char *fmt, ...)
{
    char line[512];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(line, sizeof line, fmt, ap);
    va_end(ap);
    if (p->left == 0) return;
    if (p->left > 0) p->left--;
    if (p->columns && strlen(line) > (size_t)p->columns) line[p->columns] = '\0';
    buf_printf(p->out, "%s%s", line, p->eol);
}

/* 12.3k, 4.56M */
static const char *short_number(double x, char text[16])
{
    static const char unit[] = " kMGT";
    int k = 0;
    for (; x >= 999.5 && k < 4; k++) x /= 1000;
    snprintf(text, 16, k ? "%.3g%c" : "%.3g", x, unit[k]);
    return text;
}

static void put_head(struct page *p, const struct view_log *v, const struct view_state *s)
{
    char eta[ETA_TEXT], past[ETA_TEXT];
    double percent = s->total_px ? 100 * (double)s->done_px / (double)s->total_px : 0;
    const char *end = v->log.ended && *v->log.bye ? v->log.bye : "ended";
    if (v->log.ended)
        put(p, "%.1f %% of %" PRIu64 " pixels, %s after %s", percent, s->total_px, end,
            eta_text(s->now_s, past));
    else
        put(p, "%.1f %% of %" PRIu64 " pixels, %s, ETA %s, %zu slots up", percent, s->total_px,
            eta_text(s->now_s, past), eta_text(s->left_s, eta), s->n_up);
    if (v->d.bad)
        put(p, "%" PRIu64 " damaged place%s: %s", v->d.bad, v->d.bad == 1 ? "" : "s", v->d.why);
}

/* Of slot i; or of a slot that holds it, and is lost since. */
static const struct history_event *last_event(
    const struct view_log *v, const struct view_state *s, size_t i)
{
    const struct history_event *e = s->slots[i].event;
    for (ptrdiff_t k = outer_of(&v->log, i); k >= 0; k = outer_of(&v->log, (size_t)k)) {
        const struct history_event *outer = s->slots[k].event;
        if (outer && *outer->why && (!e || outer > e)) e = outer;
    }
    return e;
}

static void put_slot(struct page *p, const struct view_log *v, const struct view_state *s, size_t i)
{
    const struct history_slot *slot = &v->log.slots[i];
    const struct view_slot *own = &s->slots[i];
    char task[32] = "-", rate[16] = "-", idle[16] = "-";
    const char *state = "up";
    if (own->done)
        snprintf(task, sizeof task, "%" PRIu32 " %" PRIu32, own->done->frame, own->done->id);
    if (own->done) short_number(own->px_per_s, rate);
    if (own->last_s > 0)
        snprintf(idle, sizeof idle, "%.1f %%", 100 * fmax(0, 1 - own->busy_s / own->last_s));
    const struct history_event *event = last_event(v, s, i);
    if (event && *event->why) state = event->why;
    else if (!own->done) state = "no task yet";
    put(p, "%-6s %-*.*s %9zu %12s %8s %8s  %s", slot->name, p->host, p->host,
        view_host(&v->log, i, "-"), own->tasks, task, rate, idle, state);
}

static bool is_loss(const struct history *l, size_t i)
{
    return l->events[i].lost && (size_t)l->events[i].run + 1 == l->n_runs;
}

static void put_losses(struct page *p, const struct view_log *v, size_t n)
{
    const struct history *l = &v->log;
    size_t from = l->n_events;
    while (n && from > 0) n -= is_loss(l, --from);
    for (size_t i = from; i < l->n_events; i++) {
        const struct history_event *e = &l->events[i];
        char at[ETA_TEXT] = "?";
        if (!is_loss(l, i)) continue;
        if (e->recv_us >= 0) eta_text((double)e->recv_us * 1e-6, at);
        put(p, "lost at %s: slot %s on %s (%s) with %" PRId64 " task%s", at, l->slots[e->slot].name,
            view_host(l, (size_t)e->slot, "-"), e->why, e->tasks, e->tasks == 1 ? "" : "s");
    }
}

static const struct history_slot *all; /* while they are sorted */

static int by_name(const void *a, const void *b)
{
    return text_order(all[*(const size_t *)a].name, all[*(const size_t *)b].name);
}

/* The slots of the last run, by name, without those whose tasks are done by slots that they hold.
 * Returns their number. */
static size_t order_slots(const struct history *l, const struct view_state *s, size_t *order)
{
    bool *holds = xcalloc(l->n_slots + 1, sizeof *holds);
    size_t n = 0;
    for (size_t i = 0; i < l->n_slots; i++)
        for (ptrdiff_t k = s->slots[i].done ? outer_of(l, i) : -1; k >= 0 && !holds[k];
             k = outer_of(l, (size_t)k))
            holds[k] = true;
    for (size_t i = 0; i < l->n_slots; i++)
        if (s->slots[i].done || (s->slots[i].event && !holds[i])) order[n++] = i;
    all = l->slots;
    qsort(order, n, sizeof *order, by_name);
    free(holds);
    return n;
}

/* As wide as the longest name, if the terminal is. */
static int host_columns(const struct history *l, const size_t *order, size_t n, int columns)
{
    int most = HOST_LEAST;
    for (size_t i = 0; i < n; i++) {
        int length = (int)strlen(view_host(l, order[i], "-"));
        if (length > most) most = length;
    }
    int room = columns - OTHER_COLUMNS > HOST_LEAST ? columns - OTHER_COLUMNS : HOST_LEAST;
    return columns && most > room ? room : most;
}

void view_table(const struct view_log *v, const struct view_state *s, int columns, int lines,
    const char *eol, struct buf *out)
{
    const struct history *l = &v->log;
    struct page p = {out, eol, columns, lines ? lines : -1, 0};
    size_t losses = 0, *order = xmalloc(l->n_slots + 1, sizeof *order);
    for (size_t i = 0; i < l->n_events; i++) losses += is_loss(l, i);
    size_t told = losses < LOSSES_MOST ? losses : LOSSES_MOST, n = order_slots(l, s, order);
    p.host = host_columns(l, order, n, columns);
    put_head(&p, v, s);
    put(&p, "%-6s %-*s %9s %12s %8s %8s", "slot", p.host, "host", "tasks", "last task", "px/s",
        "idle");
    size_t below = told + (losses > told), room = n;
    if (p.left >= 0 && n + below > (size_t)p.left)
        room = (size_t)p.left > below + 1 ? (size_t)p.left - below - 1 : 0;
    for (size_t i = 0; i < room; i++) put_slot(&p, v, s, order[i]);
    if (room < n) put(&p, "... and %zu more slots", n - room);
    put_losses(&p, v, told);
    if (losses > told) put(&p, "%zu losses in all", losses);
    free(order);
}
