/* A stream of fragments that may stall. */
#include "log/log.h"

#include <errno.h>
#include <poll.h>

#define READ_BYTES 65536

/* ---- how long a log's tasks took ------------------------------------------------------------- */

struct longest {
    int64_t us, most_us;
    bool began; /* the run's first task is done */
};

static void measure(void *ctx, const struct record *r)
{
    struct longest *l = ctx;
    int64_t us = 0;
    if (r->kind == REC_HELLO) l->began = false;
    if (r->kind != REC_DONE) return;
    const char *key = l->began ? "wall_us" : "recv_us";
    l->began = true;
    if (rec_int(r, key, 0, l->most_us, &us) && us > l->us) l->us = us;
}

int log_longest_us(const char *path, int64_t most_us, int64_t *us, char why[LOG_WHY])
{
    struct longest l = {.most_us = most_us};
    const struct log_reader reader = {.record = measure, .ctx = &l};
    int failed = log_read_path(path, &reader, why);
    *us = l.us;
    return failed;
}

/* ---- passing on ------------------------------------------------------------------------------ */

/* 1: there is input before the deadline; 0: none; -1 with errno. */
static int readable(int fd, int64_t until_us)
{
    for (int64_t left_us; (left_us = until_us - now_us()) > 0;) {
        struct pollfd p = {fd, POLLIN, 0};
        int ms = left_us / 1000 < INT32_MAX ? (int)(left_us / 1000) + 1 : INT32_MAX;
        int n = poll(&p, 1, ms);
        if (n > 0) return 1;
        if (n < 0 && errno != EINTR) return -1;
    }
    return 0;
}

/* Queues all complete records. True: a fragment is among them. */
static bool take_records(struct decoder *d, struct buf *out)
{
    struct record r;
    bool frag = false;
    for (enum wire_result got; (got = wire_next(d, &r)) != WIRE_MORE;) {
        if (got == WIRE_BAD) continue;
        frag = frag || r.kind == REC_FRAG;
        wire_forward(out, &r, NULL, NULL);
    }
    return frag;
}

int log_pass(int fd, int64_t patience_us, void (*put)(const void *p, size_t n))
{
    struct decoder d = {.upward = true};
    struct buf out = {0};
    ptrdiff_t n = 1;
    int more = 1;
    int64_t until_us = now_us() + patience_us;
    while (n > 0 && (more = readable(fd, until_us)) > 0) {
        n = read_some(fd, &d.in, READ_BYTES);
        if (n < 0) break;
        if (n == 0) wire_end(&d);
        if (take_records(&d, &out)) until_us = now_us() + patience_us;
        put(buf_data(&out), buf_size(&out));
        buf_consume(&out, buf_size(&out));
    }
    int err = errno;
    wire_free(&d);
    buf_free(&out);
    errno = err;
    return n < 0 || more < 0 ? -1 : n == 0;
}
