/*
 * A log as a trace: JSON of the Trace Event Format (Google, "Trace Event Format", 2016), which
 * Perfetto and chrome://tracing show. Times are in microseconds; runs follow each other.
 */
#include "view/view.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define COUNTS_MOST 1000 /* points of the curve of pixels */

struct trace {
    const struct account *a;
    struct buf *out;
    size_t *pid; /* of each slot of the log */
    bool more;
};

static void put_string(struct buf *out, const char *s)
{
    buf_append(out, "\"", 1);
    for (; *s; s++) {
        if ((unsigned char)*s < ' ' || (unsigned char)*s > '~') buf_append(out, "?", 1);
        else buf_printf(out, *s == '"' || *s == '\\' ? "\\%c" : "%c", *s);
    }
    buf_append(out, "\"", 1);
}

static void begin(struct trace *t)
{
    buf_printf(t->out, "%s{", t->more ? ",\n" : "");
    t->more = true;
}

/* {"name":"process_name","ph":"M","pid":1,"args":{"name":"render1"}} */
static void put_name(struct trace *t, const char *what, size_t pid, size_t tid, const char *name)
{
    begin(t);
    buf_printf(t->out,
        "\"name\":\"%s\",\"ph\":\"M\",\"pid\":%zu,\"tid\":%zu,\"args\":{\"name\":", what, pid, tid);
    put_string(t->out, name);
    buf_printf(t->out, "}}");
}

static const char *host_of(const struct history *l, size_t i)
{
    return view_host(l, i, "unknown host");
}

static const struct history *of; /* whose slots are sorted */

static int by_host(const void *a, const void *b)
{
    size_t i = *(const size_t *)a, j = *(const size_t *)b;
    int order = strcmp(host_of(of, i), host_of(of, j));
    return order ? order : (i > j) - (i < j);
}

/* A slot without tasks of its own has a line of its own, after the others. */
static uint32_t tid_of(const struct trace *t, int32_t k)
{
    const uint32_t line = t->a->slot_of[k];
    return line == ACCOUNT_OUTER ? (uint32_t)t->a->n_slots + (uint32_t)k + 1 : line + 1;
}

/* A process for each host, from 1 on; a thread for each slot, by its line in the table. */
static void put_names(struct trace *t)
{
    const struct history *l = t->a->log;
    size_t *order = xmalloc(l->n_slots + 1, sizeof *order), pid = 0;
    for (size_t i = 0; i < l->n_slots; i++) order[i] = i;
    of = l;
    qsort(order, l->n_slots, sizeof *order, by_host);
    for (size_t i = 0; i < l->n_slots; i++) {
        size_t k = order[i];
        char name[HISTORY_NAME + 8];
        const char *host = host_of(l, k);
        if (!i || strcmp(host, host_of(l, order[i - 1])) != 0)
            put_name(t, "process_name", ++pid, 0, host);
        t->pid[k] = pid;
        snprintf(name, sizeof name, "slot %s", l->slots[k].name);
        put_name(t, "thread_name", pid, tid_of(t, (int32_t)k), name);
    }
    free(order);
}

static void put_task(struct trace *t, size_t i)
{
    static const char *const word[ACCOUNT_KINDS] = {"task", "given again", "wasted"};
    const struct history_done *d = &t->a->log->dones[i];
    const struct span *s = &t->a->spans[i];
    const char *kind = word[account_kind(t->a, i)];
    double zero_s = t->a->zero_s[s->run];
    begin(t);
    buf_printf(t->out,
        "\"name\":\"task %" PRIu32 " %" PRIu32 "\",\"cat\":\"%s\",\"ph\":\"X\",\"ts\":%.0f,"
        "\"dur\":%.0f,\"pid\":%zu,\"tid\":%" PRIu32 ",\"args\":{\"pixels\":%" PRIu64
        ",\"cpu_us\":%" PRId64 ",\"try\":%" PRId64 ",\"kind\":\"%s\"}}",
        d->frame, d->id, kind, (zero_s + s->begin_s) * 1e6, (s->end_s - s->begin_s) * 1e6,
        t->pid[d->slot], s->slot + 1, d->pixels, d->cpu_us, d->try, kind);
}

static void put_event(struct trace *t, const struct history_event *e)
{
    double at_s = e->recv_us < 0 ? 0 : (double)e->recv_us * 1e-6;
    if ((size_t)e->run + 1 < t->a->log->n_runs) at_s = fmin(at_s, t->a->run_s[e->run]);
    double at_us = (t->a->zero_s[e->run] + at_s) * 1e6;
    begin(t);
    buf_printf(t->out, "\"name\":");
    if (*e->why) {
        char name[HISTORY_WORD + 8];
        snprintf(name, sizeof name, "%s: %s", e->lost ? "lost" : "gone", e->why);
        put_string(t->out, name);
    } else {
        put_string(t->out, "ready");
    }
    buf_printf(t->out,
        ",\"cat\":\"slot\",\"ph\":\"i\",\"s\":\"t\",\"ts\":%.0f,\"pid\":%zu,\"tid\":%" PRIu32
        ",\"args\":{\"tasks_lost\":%" PRId64 "}}",
        at_us, t->pid[e->slot], tid_of(t, e->slot), e->tasks);
}

struct count {
    double end_s;
    uint64_t pixels;
};

static int by_end(const void *a, const void *b)
{
    const struct count *x = a, *y = b;
    return (x->end_s > y->end_s) - (x->end_s < y->end_s);
}

/* The pixels so far, in at most COUNTS_MOST points. */
static void put_counts(struct trace *t)
{
    const struct history *l = t->a->log;
    size_t step = l->n_dones / COUNTS_MOST + 1;
    struct count *c = xmalloc(l->n_dones + 1, sizeof *c);
    uint64_t px = 0;
    for (size_t i = 0; i < l->n_dones; i++) {
        const struct span *s = &t->a->spans[i];
        c[i] = (struct count){t->a->zero_s[s->run] + s->end_s, l->dones[i].pixels};
    }
    if (l->n_dones) qsort(c, l->n_dones, sizeof *c, by_end);
    for (size_t i = 0; i < l->n_dones; i++) {
        px += c[i].pixels;
        if (i % step && i + 1 < l->n_dones) continue;
        begin(t);
        buf_printf(t->out,
            "\"name\":\"pixels\",\"ph\":\"C\",\"ts\":%.0f,\"pid\":0,\"args\":{\"done\":%" PRIu64
            "}}",
            c[i].end_s * 1e6, px);
    }
    free(c);
}

void view_trace(const struct account *a, struct buf *out)
{
    const struct history *l = a->log;
    struct trace t = {.a = a, .out = out};
    t.pid = xcalloc(l->n_slots + 1, sizeof *t.pid);
    buf_printf(out, "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n");
    put_name(&t, "process_name", 0, 0, "the run");
    put_names(&t);
    for (size_t i = 0; i < l->n_dones; i++) put_task(&t, i);
    for (size_t i = 0; i < l->n_events; i++) put_event(&t, &l->events[i]);
    put_counts(&t);
    buf_printf(out, "\n]}\n");
    free(t.pid);
}
