/*
 * fan: programs for hosts that have none. Before its hello such a host prints requests, which
 * hosts/send.c describes. Each program is sent once in a connection, and nothing else is sent until
 * the hello, so the script there may read ahead.
 */
#include "fan/fan_int.h"

#include <string.h>

#define LINK_LEAST 16384.0 /* bytes a second: a slower link is taken for a silent one */

static const char prefix[] = "stormring-send ";

/* It has a process, and its hello has not come. */
static bool awaits_hello(const struct fan_slot *s)
{
    return fan_slot_has_stream(s) && s->state != FAN_UP;
}

bool fan_slot_is_sent(const struct fan_slot *s)
{
    return awaits_hello(s) && down_size(&s->conn.sending.queue);
}

bool fan_slot_has_asked(const struct fan_slot *s)
{
    return awaits_hello(s) && s->conn.sending.asked;
}

double fan_send_time_s(const struct fan_slot *s)
{
    return (double)s->conn.sending.bytes / LINK_LEAST;
}

void fan_slot_send_more(struct fan_slot *s, const struct pollfd *p)
{
    struct down_queue *q = &s->conn.sending.queue;
    size_t before = down_size(q);
    bool full = p->events & POLLOUT && !(p->revents & POLLOUT);
    if (p->revents & POLLERR || (!full && down_write(q, s->conn.child.to) != 0)) {
        /* It reads no more; its output or its exit status tells why. */
        child_close(&s->conn.child.to);
        down_free(q);
        return;
    }
    if (down_size(q) != before) s->conn.heard_us = now_us();
}

/* Queues the program with this hash. */
static const char *begin(struct fan_slot *s, const char *hash)
{
    const struct hosts_program *p = hosts_program(s->host->host->sent, hash);
    if (!p || s->conn.child.to < 0) return "wrong-request";
    unsigned bit = 1U << (p - s->host->host->sent->at);
    if (s->conn.sending.asked & bit) return "wrong-request";
    s->conn.sending.asked |= bit;
    s->conn.sending.bytes += buf_size(&p->bytes);
    s->conn.heard_us = now_us();
    down_append(&s->conn.sending.queue, buf_data(&p->bytes), buf_size(&p->bytes));
    warn("%s: %s is sent, %zu bytes", s->host->host->name, p->name, buf_size(&p->bytes));
    return NULL;
}

static const char *take_line(struct fan_slot *s)
{
    const char *line = s->conn.sending.line;
    size_t n = sizeof prefix - 1;
    if (strncmp(line, prefix, n) != 0) return NULL;
    if (strncmp(line + n, "need ", 5) == 0) return begin(s, line + n + 5);
    if (strncmp(line + n, "no ", 3) != 0) return "wrong-request";
    fan_printable(s->conn.detail, sizeof s->conn.detail, line + n + 3, strlen(line + n + 3));
    return "not-sent";
}

const char *fan_take_requests(struct fan_slot *s, const unsigned char *said, size_t n)
{
    struct sending *to = &s->conn.sending;
    const char *why = NULL;
    if (!s->host->host->sent || !awaits_hello(s)) return NULL;
    for (size_t i = 0; i < n && !why; i++) {
        if (said[i] != '\n') {
            if (to->length < sizeof to->line - 1) to->line[to->length++] = (char)said[i];
            continue;
        }
        to->line[to->length] = '\0';
        to->length = 0;
        why = take_line(s);
    }
    return why;
}
