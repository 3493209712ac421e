/*
 * fan: what workers elsewhere write to their standard error, shown line by line with the host's
 * name. It is read whenever there is something: no worker has to wait for a reader of messages.
 */
#include "drive/fan_int.h"

#include <errno.h>
#include <string.h>

#define READ_MOST 4096
#define LINE_MOST 1000 /* what is longer comes in pieces */
#define LAST_READS 16  /* when the process has ended */

/*
 * A host that is tried again and again says why it cannot be reached each time: once will do, until
 * it says something else.
 */
static void show(struct fan_slot *s, const char *line, size_t n)
{
    uint64_t hash = hash64(HASH64_INIT, line, n);
    if (n && line[n - 1] == '\r') n--;
    if (s->connected || hash != s->host->told) relay(s->host->host->name, line, n);
    s->host->told = hash;
}

static void show_lines(struct fan_slot *s, bool all)
{
    size_t n;
    while ((n = buf_size(&s->err)) > 0) {
        const char *line = (const char *)buf_data(&s->err);
        const char *newline = memchr(line, '\n', n < LINE_MOST ? n : LINE_MOST);
        if (!newline && n < LINE_MOST && !all) return;
        size_t len = newline ? (size_t)(newline - line) : n < LINE_MOST ? n : LINE_MOST;
        show(s, line, len);
        buf_consume(&s->err, len + (newline != NULL));
    }
}

static bool read_err(struct fan_slot *s)
{
    ptrdiff_t n = read_some(s->child.err, &s->err, READ_MOST);
    show_lines(s, false);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK)) child_close(&s->child.err);
    return n > 0;
}

void slot_show_err(struct fan_slot *s) { read_err(s); }

void slot_end_err(struct fan_slot *s)
{
    for (int i = 0; i < LAST_READS && s->child.err >= 0 && read_err(s); i++)
        ;
    child_close(&s->child.err);
    show_lines(s, true);
    buf_free(&s->err);
}
