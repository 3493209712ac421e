/*
 * A link of its own: delay MS COMMAND [ARGUMENT ...] runs the command; what goes to it and what
 * comes from it is passed on MS milliseconds later.
 */
#include "base/base.h"
#include "proc/proc.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define READ_MOST 65536

/* Bytes, and when each part of them may go on. */
struct part {
    int64_t due_us;
    size_t n;
};
struct way {
    int in, out;
    bool ended; /* no more comes */
    struct buf bytes, parts;
};

static void take(struct way *w, int64_t delay_us)
{
    struct buf got = {0};
    ptrdiff_t n = read_some(w->in, &got, READ_MOST);
    if (n < 0) die(ST_SYSTEM, "read:");
    if (n == 0) w->ended = true;
    struct part part = {now_us() + delay_us, (size_t)n};
    buf_append(&w->parts, &part, sizeof part); /* of nothing: the end, which is as late */
    buf_append(&w->bytes, buf_data(&got), buf_size(&got));
    buf_free(&got);
}

static struct part *first(const struct way *w)
{
    return buf_size(&w->parts) ? (struct part *)(void *)(w->parts.data + w->parts.off) : NULL;
}

/* Writes the bytes that are due, up to what the pipe takes. False if its reader is gone. */
static bool pass(struct way *w)
{
    for (struct part *p; (p = first(w)) != NULL && p->due_us <= now_us();) {
        ssize_t n = p->n ? write(w->out, buf_data(&w->bytes), p->n) : 0;
        if (n < 0) return errno == EAGAIN || errno == EINTR;
        buf_consume(&w->bytes, (size_t)n);
        p->n -= (size_t)n;
        if (p->n) return true;
        buf_consume(&w->parts, sizeof *p);
    }
    return true;
}

/* Until something comes, goes, or is due. */
static void wait_for(struct way *down, struct way *up, int64_t delay_us)
{
    struct pollfd p[4] = {
        {down->ended ? -1 : down->in, POLLIN, 0},
        {up->ended ? -1 : up->in, POLLIN, 0},
        {-1, POLLOUT, 0},
        {-1, POLLOUT, 0},
    };
    struct way *ways[] = {down, up};
    int64_t now = now_us(), us = 1000000;
    for (int i = 0; i < 2; i++) {
        struct part *next = first(ways[i]);
        if (next && next->due_us <= now) p[2 + i].fd = ways[i]->out; /* its pipe was full */
        else if (next && next->due_us - now < us) us = next->due_us - now;
    }
    struct timespec t = {us / 1000000, us % 1000000 * 1000};
    if (ppoll(p, 4, &t, NULL) < 0 && errno != EINTR) die(ST_SYSTEM, "poll:");
    if (p[0].revents) take(down, delay_us);
    if (p[1].revents) take(up, delay_us);
}

int main(int argc, char **argv)
{
    double ms;
    struct child c;
    prog_init(argv[0]);
    if (argc < 3 || !parse_real(argv[1], 0, 1e6, &ms)) die(ST_USAGE, "expected MS COMMAND");
    int64_t delay_us = (int64_t)(ms * 1e3);
    signals_catch();
    if (child_start(&c, argv + 2) != 0) die(ST_SYSTEM, "%s:", argv[2]);
    struct way down = {.in = STDIN_FILENO, .out = c.to}, up = {.in = c.from, .out = STDOUT_FILENO};
    while ((!up.ended || first(&up)) && !signals_came()) {
        wait_for(&down, &up, delay_us);
        bool closed = down.out >= 0 && (!pass(&down) || (down.ended && !first(&down)));
        if (closed) {
            child_close(&c.to);
            down.out = -1;
            down.ended = true;
        }
        if (!pass(&up)) break;
    }
    child_end(&c, 1000);
    return ST_OK;
}
