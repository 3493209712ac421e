/* A page of HTML that shows a run: see view.h. */
#include "view/view.h"

#include "html/html.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 1000    /* units of a lane */
#define GAP_LEAST 0.5 /* units: bars that are nearer are drawn as one */
#define LANES_MOST 512
#define MARK 3 /* units: the width of the mark of a loss */

static const char *const class_of[ACCOUNT_KINDS] = {"t", "a", "w"};

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
    "style-src 'unsafe-inline'\">\n";
static const char style[] =
    "<style>\nbody{font:15px/1.4 system-ui,sans-serif;margin:1rem auto;padding:0 1rem;"
    "max-width:64rem;color:#222}\nh1{font-size:1.25rem;overflow-wrap:anywhere}\n"
    "h2{font-size:1.05rem;margin:1.4rem 0 .4rem}\n"
    "img{max-width:100%;height:auto;border:1px solid #999;"
    "background:repeating-conic-gradient(#ddd 0 25%,#fff 0 50%) 0 0/16px 16px}\n"
    "progress{width:100%;height:1rem}\n"
    ".lane{display:grid;grid-template-columns:9rem 1fr;gap:.5rem;align-items:center;margin:2px 0}\n"
    ".lane span{overflow:hidden;text-overflow:ellipsis;white-space:nowrap;font-size:.85rem}\n"
    ".lane svg{width:100%;height:18px;background:#eee;display:block}\n"
    ".t{fill:#3a7ca5}.a{fill:#d98e04}.w{fill:#b9b9b9}.l{fill:#c1121f}\n"
    ".key i{display:inline-block;width:.8em;height:.8em;margin:0 .3em 0 1em}\n"
    ".key span{white-space:nowrap}\n"
    ".scroll{overflow-x:auto}\npre{font-size:.85rem;margin:0}\n"
    "@media(max-width:40rem){.lane{grid-template-columns:5rem 1fr}}\n</style>\n";

/* ---- the timeline ---------------------------------------------------------------------------- */

struct lane {
    double from[ACCOUNT_KINDS], to[ACCOUNT_KINDS]; /* the open bars, in units; to 0: none */
    struct buf path[ACCOUNT_KINDS];
    struct buf marks;
};

struct timeline {
    const struct account *a;
    struct lane *lanes; /* by line of the account */
};

static void close_bar(struct lane *lane, size_t k)
{
    if (lane->to[k] <= 0) return;
    double w = fmax(lane->to[k] - lane->from[k], GAP_LEAST);
    buf_printf(&lane->path[k], "M%.1f 0h%.1fv18h-%.1fz", lane->from[k], w, w);
    lane->to[k] = 0;
}

static double unit_of(const struct timeline *t, size_t run, double s)
{
    double all_s = t->a->makespan_s;
    return all_s > 0 ? fmin((t->a->zero_s[run] + s) / all_s, 1) * WIDTH : 0;
}

/* The spans of a slot come in order of time. */
static void add_bar(struct timeline *t, size_t i)
{
    const struct span *s = &t->a->spans[i];
    if (s->slot >= LANES_MOST) return;
    struct lane *lane = &t->lanes[s->slot];
    size_t k = account_kind(t->a, i);
    double from = unit_of(t, s->run, s->begin_s), to = unit_of(t, s->run, s->end_s);
    if (lane->to[k] > 0 && from - lane->to[k] > GAP_LEAST) close_bar(lane, k);
    if (lane->to[k] <= 0) lane->from[k] = from;
    lane->to[k] = fmax(fmax(lane->to[k], to), 1e-3);
}

/* True if line i is that of slot k of the log, or of a slot within it, as 1.0 is within 1. */
static bool is_within(const struct account *a, uint32_t i, int32_t k)
{
    const char *outer = a->log->slots[k].name, *name = a->slots[i].name;
    const size_t n = strlen(outer);
    if (a->slot_of[k] != ACCOUNT_OUTER) return a->slot_of[k] == i;
    return strncmp(name, outer, n) == 0 && name[n] == '.';
}

static void put_mark(struct timeline *t, const struct history_event *e, uint32_t line)
{
    double at_s = fmin(e->recv_us < 0 ? 0 : (double)e->recv_us * 1e-6, t->a->run_s[e->run]);
    double at = fmin(unit_of(t, (size_t)e->run, at_s), WIDTH - MARK);
    struct buf *b = &t->lanes[line].marks;
    buf_printf(
        b, "<rect class=\"l\" x=\"%.1f\" width=\"%d\" height=\"18\"><title>lost: ", at, MARK);
    html_word(b, e->why);
    buf_printf(b, ", %" PRId64 " tasks</title></rect>", e->tasks);
}

static void add_mark(struct timeline *t, const struct history_event *e)
{
    for (uint32_t i = 0; e->lost && i < t->a->n_slots && i < LANES_MOST; i++)
        if (is_within(t->a, i, e->slot)) put_mark(t, e, i);
}

static void put_lane(const struct timeline *t, size_t line, const char *host, struct buf *out)
{
    struct lane *lane = &t->lanes[line];
    buf_printf(out, "<div class=\"lane\"><span>");
    html_word(out, t->a->slots[line].name);
    buf_printf(out, " ");
    html_word(out, host);
    buf_printf(out, "</span><svg viewBox=\"0 0 %d 18\" preserveAspectRatio=\"none\">", WIDTH);
    for (size_t k = 0; k < ACCOUNT_KINDS; k++) {
        close_bar(lane, k);
        if (buf_size(&lane->path[k])) {
            buf_printf(out, "<path class=\"%s\" d=\"", class_of[k]);
            buf_append(out, buf_data(&lane->path[k]), buf_size(&lane->path[k]));
            buf_printf(out, "\"/>");
        }
        buf_free(&lane->path[k]);
    }
    buf_append(out, buf_data(&lane->marks), buf_size(&lane->marks));
    buf_printf(out, "</svg></div>\n");
    buf_free(&lane->marks);
}

static void put_timeline(const struct account *a, struct buf *out)
{
    const struct history *l = a->log;
    struct timeline t = {.a = a};
    size_t n = a->n_slots < LANES_MOST ? a->n_slots : LANES_MOST;
    const char **host = xcalloc(a->n_slots + 1, sizeof *host);
    t.lanes = xcalloc(n + 1, sizeof *t.lanes);
    for (size_t i = 0; i < l->n_dones; i++) add_bar(&t, i);
    for (size_t i = 0; i < l->n_events; i++) add_mark(&t, &l->events[i]);
    for (size_t i = 0; i < l->n_slots; i++) {
        const uint32_t line = a->slot_of[i];
        if (line != ACCOUNT_OUTER) host[line] = view_host(l, i, "");
    }
    buf_printf(out,
        "<h2>Timeline</h2>\n<p class=\"key\">%.3g s%s: <span><i "
        "style=\"background:#3a7ca5\"></i>task"
        "</span> <span><i style=\"background:#d98e04\"></i>task given again</span> <span><i "
        "style=\"background:#b9b9b9\"></i>wasted</span> <span><i "
        "style=\"background:#c1121f\"></i>slot lost</span></p>\n",
        a->makespan_s, l->n_runs > 1 ? ", all runs together" : "");
    for (size_t i = 0; i < n; i++) put_lane(&t, i, host[i] ? host[i] : "", out);
    if (n < a->n_slots) buf_printf(out, "<p>... and %zu more slots</p>\n", a->n_slots - n);
    free(t.lanes);
    free(host);
}

/* ---- the page -------------------------------------------------------------------------------- */

void view_page(const struct view_log *v, const struct account *a, const struct buf *png,
    double reload_s, struct buf *out)
{
    struct view_state s;
    struct buf table = {0};
    view_state(v, &s);
    view_table(v, &s, 0, 0, "\n", &table);
    const char *text = (const char *)buf_data(&table);
    size_t n = buf_size(&table), first = (size_t)((const char *)memchr(text, '\n', n) - text);
    buf_append(out, head, sizeof head - 1);
    if (reload_s > 0)
        buf_printf(out, "<meta http-equiv=\"refresh\" content=\"%.0f\">\n", ceil(reload_s));
    buf_printf(out, "<title>");
    html_word(out, v->path);
    buf_printf(out, "</title>\n");
    buf_append(out, style, sizeof style - 1);
    buf_printf(out, "</head><body>\n<h1>");
    html_word(out, v->path);
    buf_printf(out, "</h1>\n<p>");
    html_text(out, text, first);
    buf_printf(out, "</p>\n<progress max=\"%" PRIu64 "\" value=\"%" PRIu64 "\"></progress>\n",
        s.total_px ? s.total_px : 1, s.done_px);
    if (buf_size(png)) {
        buf_printf(out, "<p><img alt=\"The picture so far\" src=\"data:image/png;base64,");
        html_base64(out, buf_data(png), buf_size(png));
        buf_printf(out, "\"></p>\n");
    }
    put_timeline(a, out);
    buf_printf(out, "<h2>Slots</h2>\n<div class=\"scroll\"><pre>");
    html_text(out, text + first + 1, n - first - 1);
    buf_printf(out, "</pre></div>\n</body></html>\n");
    buf_free(&table);
    free(s.slots);
}
