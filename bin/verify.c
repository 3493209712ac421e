/*
 * verify: chooses pieces of a log that another host computes a second time, and reports the result.
 *
 * The pieces are chosen after their pixels have arrived, by a number drawn then. So a worker cannot
 * know, while it computes a piece, that the piece will be checked. lib/verify has the rules.
 */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/base.h"
#include "log/log.h"
#include "hosts/hosts.h"
#include "verify/verify.h"
#include "wire/wire.h"

#define READ_BYTES 65536
#define LINES_MOST 16     /* of the report */
#define PATIENCE_TIMES 10 /* times the log's longest task may pass without a fragment */

/* The current purpose of reading a file: lib/verify has the order. */
enum phase { CHOOSE, CUT, FIRST, AGAIN };

struct program {
    struct verify v;
    struct hosts hosts;
    int32_t *place_of; /* by slot */
    enum phase phase;
    uint32_t runs, run; /* of the log: all; begun in phase FIRST */
    float *pixels;
};

/* ---- reading --------------------------------------------------------------------------------- */

static void take_frag(struct program *p, const struct record *r)
{
    int32_t slot = rec_slot(r);
    if (p->phase == FIRST || p->phase == AGAIN) rec_pixels(r, p->pixels);
    switch (p->phase) {
    case CHOOSE: verify_choose(&p->v, &r->task); break;
    case CUT: verify_cut(&p->v, &r->task); break;
    case FIRST: /* slots of an earlier run may have been on other hosts */
        verify_first(&p->v, &r->task, p->run == p->runs ? slot : -1, p->pixels);
        break;
    case AGAIN: verify_again(&p->v, &r->task, slot, p->pixels); break;
    }
}

static void take(void *ctx, const struct record *r)
{
    struct program *p = ctx;
    char job[64];
    if (r->kind == REC_HELLO) {
        p->runs += p->phase == CHOOSE;
        p->run += p->phase == FIRST;
    }
    if (r->kind == REC_FRAME && p->phase == CHOOSE)
        verify_frame(&p->v, r->task.frame, r->frame_w, r->frame_h,
            rec_str(r, "job", job, sizeof job) ? job : NULL);
    if (r->kind == REC_FRAG) take_frag(p, r);
}

static void read_one(const char *name, void (*record)(void *, const struct record *), void *ctx)
{
    struct intake in;
    const struct log_reader reader = {record, NULL, ctx};
    int fd = open(name, O_RDONLY | O_CLOEXEC);
    if (fd < 0) die(ST_USAGE, "%s:", name);
    intake_init(&in, false);
    int failed = log_read(&in, fd, name, &reader);
    if (failed < 0) die(ST_SYSTEM, "%s:", name);
    if (failed) die(ST_USAGE, "%s: %s", name, in.why);
    intake_free(&in);
    close(fd);
}

/* The log, and then the checks; NULL ends them. */
static void read_all(struct program *p, char *const *file)
{
    p->pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *p->pixels);
    p->phase = CHOOSE;
    read_one(file[0], take, p);
    p->phase = CUT;
    for (int i = 1; file[i]; i++) read_one(file[i], take, p);
    verify_split(&p->v);
    p->phase = FIRST;
    read_one(file[0], take, p);
    p->phase = AGAIN;
    for (int i = 1; file[i]; i++) {
        verify_begin(&p->v);
        read_one(file[i], take, p);
        verify_end(&p->v);
    }
    free(p->pixels);
}

/* ---- tasks ----------------------------------------------------------------------------------- */

static void flush(struct buf *b)
{
    put_stdout(buf_data(b), buf_size(b));
    buf_consume(b, buf_size(b));
}

/* A frame of which no task has been written yet. */
static void write_tasks(const struct verify *v, const struct frame_size *f)
{
    struct verify_frame *own = frames_extra(&v->frames, f);
    char job[sizeof own->job + 4];
    struct buf b = {0};
    uint32_t i, end = verify_of_frame(v, f->frame, &i);
    if (own->tasks_written) return;
    snprintf(job, sizeof job, "job=%s", own->job);
    for (; i < end; i++) {
        const struct verify_part *p = &v->part[i];
        struct task t = {.frame = p->frame, .id = i, .at = p->at, .to = verify_next(v, p)};
        if (t.to < 0) continue;
        if (!own->tasks_written) wire_frame(&b, f->frame, f->w, f->h, *own->job ? job : "");
        own->tasks_written = true;
        wire_task(&b, &t);
        if (buf_size(&b) >= READ_BYTES) flush(&b);
    }
    flush(&b);
    buf_free(&b);
}

/* State is passed on unchanged. Each frame's tasks follow it; at the end come those of all other
 * frames. */
static void pass_state(struct verify *v)
{
    struct decoder in = {0};
    struct record r;
    enum wire_result result;
    struct buf b = {0};
    ptrdiff_t n = 1;
    while (n > 0) {
        n = read_some(STDIN_FILENO, &in.in, READ_BYTES);
        if (n < 0) die(ST_SYSTEM, "standard input:");
        if (!n) wire_end(&in);
        while ((result = wire_next(&in, &r)) == WIRE_RECORD) {
            const struct frame_size *f = frames_find(&v->frames, r.task.frame);
            if (r.kind == REC_FRAME) {
                if (f) write_tasks(v, f);
                continue;
            }
            wire_forward(&b, &r, NULL, NULL);
            flush(&b);
        }
        if (result == WIRE_BAD) die(ST_USAGE, "standard input: %s", in.why);
    }
    for (size_t i = 0; i < v->frames.n; i++) write_tasks(v, &v->frames.at[i]);
    buf_free(&b);
    wire_free(&in);
}

/* ---- the report ------------------------------------------------------------------------------ */

static void name_of(const struct program *p, int32_t slot, struct buf *b)
{
    if (slot < 0) buf_printf(b, "a slot of an earlier run");
    else {
        size_t h = 0;
        for (int at = slot; at >= p->hosts.at[h].slots; h++) at -= p->hosts.at[h].slots;
        buf_printf(b, "slot %d (host %s)", slot, p->hosts.at[h].name);
    }
}

static void report_part(const struct program *p, const struct verify_part *part)
{
    struct buf b = {0};
    bool known = false;
    for (uint32_t i = 0; i < part->n; i++) {
        if (!verify_named(&p->v, part, i, &known)) continue;
        if (buf_size(&b)) buf_printf(&b, known ? ", " : " and ");
        name_of(p, verify_opinion(part, i)->slot, &b);
    }
    warn("frame %" PRIu32 " at %" PRIu32 ",%" PRIu32 ": %.*s %s", part->frame, part->at.x,
        part->at.y, (int)buf_size(&b), (const char *)buf_data(&b),
        known ? "computed other pixels than two other hosts" : "computed different pixels");
    buf_free(&b);
}

static int report(const struct program *p)
{
    const struct verify *v = &p->v;
    const struct verify_count count = verify_counted(v);
    int lines = 0;
    for (uint32_t i = 0; i < v->n && lines < LINES_MOST; i++) {
        if (verify_judge(v, &v->part[i]) != VERIFY_DIFFERENT) continue;
        report_part(p, &v->part[i]);
        lines++;
    }
    warn("%" PRIu32 " of %" PRIu32 " pieces were computed again on another %s: %" PRIu32
         " differ, %" PRIu32 " could not be computed",
        v->pieces, v->seen, p->hosts.n > 1 ? "host" : "slot of the only host", count.different,
        count.unchecked);
    return count.different || count.unchecked ? ST_PARTIAL : ST_OK;
}

/* ---- patience -------------------------------------------------------------------------------- */

struct longest {
    int64_t us; /* from a run's begin to its first done, or of any task */
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
    if (rec_int(r, key, 0, INT64_MAX / 2 / PATIENCE_TIMES, &us) && us > l->us) l->us = us;
}

/* True if there is input before the deadline. */
static bool readable(int64_t until_us)
{
    for (int64_t left_us; (left_us = until_us - now_us()) > 0;) {
        struct pollfd p = {STDIN_FILENO, POLLIN, 0};
        int ms = left_us / 1000 < INT32_MAX ? (int)(left_us / 1000) + 1 : INT32_MAX;
        int n = poll(&p, 1, ms);
        if (n > 0) return true;
        if (n < 0 && errno != EINTR) die(ST_SYSTEM, "poll:");
    }
    return false;
}

/* Passes standard input on until no fragment comes for too long: a hanging host may still send
 * beats, or a byte now and then. */
static int pass_fragments(const char *log, int64_t seconds)
{
    struct longest longest = {0};
    struct decoder in = {.upward = true};
    struct record r;
    struct buf b = {0};
    ptrdiff_t n = 1;
    read_one(log, measure, &longest);
    const int64_t patience_us = seconds * 1000000 + PATIENCE_TIMES * longest.us;
    int64_t until_us = now_us() + patience_us;
    while (n > 0 && readable(until_us)) {
        n = read_some(STDIN_FILENO, &in.in, READ_BYTES);
        if (n < 0) die(ST_SYSTEM, "standard input:");
        if (!n) wire_end(&in);
        for (enum wire_result result; (result = wire_next(&in, &r)) != WIRE_MORE;) {
            if (result == WIRE_BAD) continue;
            if (r.kind == REC_FRAG) until_us = now_us() + patience_us;
            wire_forward(&b, &r, NULL, NULL);
        }
        flush(&b);
    }
    buf_free(&b);
    wire_free(&in);
    if (!n) return ST_OK;
    warn("no fragment came for %" PRId64 " s: the missing ones are not waited for",
        patience_us / 1000000);
    return ST_PARTIAL;
}

/* ---------------------------------------------------------------------------------------------- */

/* A place is a host; if there is only one host, a slot. */
static int32_t find_places(struct program *p, const char *list, int slots)
{
    char err[HOSTS_ERR];
    if (!list == !slots) die(ST_USAGE, "expected either -S or -j");
    if (!list) hosts_here(&p->hosts, slots);
    else if (!hosts_read(&p->hosts, list, err)) die(ST_USAGE, "%s", err);
    p->place_of = xmalloc((size_t)p->hosts.slots, sizeof *p->place_of);
    int32_t slot = 0;
    for (size_t h = 0; h < p->hosts.n; h++)
        for (int i = 0; i < p->hosts.at[h].slots; i++, slot++)
            p->place_of[slot] = p->hosts.n > 1 ? (int32_t)h : slot;
    return p->hosts.n > 1 ? (int32_t)p->hosts.n : slot;
}

int main(int argc, char **argv)
{
    static const char text[] = "[-hr] [-s SEED] { -j SLOTS | -S HOSTS } FRACTION LOG [CHECK ...]\n"
                               "       verify -t SECONDS LOG <FRAGMENTS";
    struct program p = {0};
    const char *list = NULL;
    uint64_t seed = 0;
    bool reports = false;
    double fraction;
    int opt, slots = 0, seconds = 0;
    prog_init(argv[0]);
    while ((opt = prog_getopt(argc, argv, "+hj:rs:S:t:")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'j': slots = (int)opt_int(opt, optarg, 1, HOSTS_SLOTS_MAX); break;
        case 'r': reports = true; break;
        case 's': seed = (uint64_t)opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'S': list = opt_text(opt, optarg); break;
        case 't': seconds = (int)opt_int(opt, optarg, 1, 1000000); break;
        default: usage(ST_USAGE, text);
        }
    }
    argv += optind;
    argc -= optind;
    int status = ST_OK;
    if (seconds) {
        if (argc != 1 || list || slots || reports) usage(ST_USAGE, text);
        status = pass_fragments(argv[0], seconds);
        close_stdout();
        return status;
    }
    if (argc < 2) usage(ST_USAGE, text);
    if (!parse_real(argv[0], 0, 1, &fraction) || fraction <= 0)
        die(ST_USAGE, "%s: expected a fraction above 0, up to 1", argv[0]);
    int32_t places = find_places(&p, list, slots);
    verify_init(&p.v, seed, fraction, p.place_of, p.hosts.slots, places);
    read_all(&p, argv + 1);
    if (reports) status = report(&p);
    else pass_state(&p.v);
    verify_free(&p.v);
    free(p.place_of);
    hosts_free(&p.hosts);
    close_stdout();
    return status;
}
