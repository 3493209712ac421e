/*
 * fan: standard error of workers on other machines, shown line by line with the host's name. It is
 * always read, so no worker blocks on its messages. A host that prints too much is not shown in
 * full.
 */
#include "fan/fan_int.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#define READ_MOST 4096
#define LINE_MOST 1000     /* longer lines are split */
#define LAST_READS 16      /* reads after the process has ended */
#define LINES_MOST 100     /* lines of a host shown */
#define WINDOW_US 10000000 /* in this time */

static void say_dropped(struct fan_host *h)
{
    if (h->dropped)
        warn("%s: %" PRId64 " more lines of messages dropped", h->host->name, h->dropped);
    h->dropped = 0;
}

static void show_line(struct fan_host *h, const char *line, size_t n)
{
    int64_t now = now_us();
    if (!h->window_us || now - h->window_us > WINDOW_US) {
        say_dropped(h);
        h->window_us = now;
        h->shown = 0;
    }
    if (h->shown++ < LINES_MOST) relay(h->host->name, line, n);
    else h->dropped++;
}

/* A host prints the same reason at each failed try, in one line or several: each is shown once. */
static void show_once(struct fan_host *h, const char *line, size_t n)
{
    uint64_t hash = hash64(HASH64_INIT, line, n);
    for (int i = 0; i < FAN_TOLD; i++)
        if (h->told[i] == hash) return;
    h->told[h->n_told++ % FAN_TOLD] = hash;
    show_line(h, line, n);
}

/* Lines that one message may sum up are held until the connection has failed. */
static void show(const struct fan *f, struct fan_slot *s, const char *line, size_t n)
{
    if (n && line[n - 1] == '\r') n--;
    if (!s->conn.connected && fan_refusal_holds(f, s, line, n)) return;
    if (s->conn.connected && n) snprintf(s->conn.said, sizeof s->conn.said, "%.*s", (int)n, line);
    fan_slot_show_held(s);
    s->conn.told_end |= s->conn.connected && fan_refusal_ends(line, n);
    if (s->conn.connected && !s->repeats) show_line(s->host, line, n);
    else show_once(s->host, line, n);
}

static void show_lines(const struct fan *f, struct fan_slot *s, bool all)
{
    size_t n;
    while ((n = buf_size(&s->conn.err)) > 0) {
        const char *line = (const char *)buf_data(&s->conn.err);
        const char *newline = memchr(line, '\n', n < LINE_MOST ? n : LINE_MOST);
        if (!newline && n < LINE_MOST && !all) return;
        size_t len = newline ? (size_t)(newline - line) : n < LINE_MOST ? n : LINE_MOST;
        show(f, s, line, len);
        buf_consume(&s->conn.err, len + (newline != NULL));
    }
}

static bool read_err(const struct fan *f, struct fan_slot *s)
{
    ptrdiff_t n = read_some(s->conn.child.err, &s->conn.err, READ_MOST);
    show_lines(f, s, false);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK))
        child_close(&s->conn.child.err);
    return n > 0;
}

void fan_slot_show_err(const struct fan *f, struct fan_slot *s) { read_err(f, s); }

void fan_slot_end_err(const struct fan *f, struct fan_slot *s)
{
    for (int i = 0; i < LAST_READS && s->conn.child.err >= 0 && read_err(f, s); i++)
        ;
    child_close(&s->conn.child.err);
    show_lines(f, s, true);
    buf_free(&s->conn.err);
}

void fan_slot_show_held(struct fan_slot *s)
{
    size_t n;
    while ((n = buf_size(&s->conn.held)) > 0) {
        const char *line = (const char *)buf_data(&s->conn.held), *newline = memchr(line, '\n', n);
        size_t len = newline ? (size_t)(newline - line) : n;
        show_once(s->host, line, len);
        buf_consume(&s->conn.held, len + (newline != NULL));
    }
}

void fan_end_err(struct fan *f)
{
    for (int i = 0; i < f->n_hosts; i++) {
        say_dropped(&f->hosts[i]);
        fan_say_repeats(&f->hosts[i]);
    }
}
