/*
 * verify: chooses pieces of a log that another host computes a second time, and reports the result.
 *
 * The pieces are chosen after their pixels have arrived, by a number drawn then. So a worker cannot
 * know, while it computes a piece, that the piece will be checked. lib/verify has the rules.
 */
#include "base/base.h"
#include "history/history.h"
#include "hosts/hosts.h"
#include "log/log.h"
#include "verify/verify.h"
#include "wire/wire.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#define WRITE_BYTES 65536 /* at once */
#define LINES_MOST 16     /* of the report */
#define PATIENCE_TIMES 10 /* times the log's longest task may pass without a fragment */

struct options {
    const char *hosts; /* -S; NULL: this machine, with */
    int slots;         /* -j */
    bool reports;      /* -r: prints the result; else the tasks of the next check */
    uint64_t seed;     /* -s */
    int64_t seconds;   /* -t: passes fragments on; 0: no */
    double fraction;   /* of the fragments */
    char **files;      /* the log, then checks; NULL ends them */
};

/* After reading a log: result, why and errno as log_read_path leaves them. */
static void check_read(int result, const char *name, const char *why)
{
    if (result == -1) die(ST_USAGE, "%s:", name);
    if (result < 0) die(ST_SYSTEM, "%s:", name);
    if (result) die(ST_USAGE, "%s: %s", name, why);
}

/* ---- tasks ----------------------------------------------------------------------------------- */

/* A frame of which no task has been written yet. */
static void write_tasks(const struct verify *v, const struct frame_size *f)
{
    struct verify_frame *own = frames_extra(&v->frames, f);
    char job[sizeof own->job + 4];
    struct buf b = {0};
    snprintf(job, sizeof job, "job=%s", own->job);
    for (uint32_t i = own->tasks_written ? 0 : own->first; i; i = v->piece[i - 1].next) {
        const struct verify_piece *p = &v->piece[i - 1];
        const struct task t = {f->frame, i - 1, p->at, verify_next(v, p), 0};
        if (t.to < 0) continue;
        if (!own->tasks_written) wire_frame(&b, f->frame, f->w, f->h, *own->job ? job : "");
        own->tasks_written = true;
        wire_task(&b, &t);
        if (buf_size(&b) >= WRITE_BYTES) put_stdout_buf(&b);
    }
    put_stdout_buf(&b);
    buf_free(&b);
}

/* State is passed on unchanged. Each frame's tasks follow it. */
static void pass(void *ctx, const struct record *r)
{
    struct verify *v = ctx;
    const struct frame_size *f = frames_find(&v->frames, r->task.frame);
    struct buf b = {0};
    if (r->kind == REC_FRAME) {
        if (f) write_tasks(v, f);
        return;
    }
    wire_forward(&b, r, NULL, NULL);
    put_stdout_buf(&b);
    buf_free(&b);
}

/* The tasks of frames that are not in the state come at the end. */
static void pass_state(struct verify *v)
{
    char why[WIRE_WHY];
    int bad = wire_read(STDIN_FILENO, pass, v, why);
    if (bad < 0) die(ST_SYSTEM, "standard input:");
    if (bad) die(ST_USAGE, "standard input: %s", why);
    for (size_t i = 0; i < v->frames.n; i++) write_tasks(v, &v->frames.at[i]);
}

/* ---- the report ------------------------------------------------------------------------------ */

static void report_piece(const struct verify *v, const struct verify_piece *p)
{
    struct buf b = {0};
    verify_describe(v, p, &b);
    warn("%.*s", (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
}

static int report(const struct verify *v)
{
    uint32_t count[VERIFY_DIFFERENT + 1] = {0};
    for (uint32_t i = 0; i < v->n; i++) {
        enum verify_verdict verdict = verify_judge(&v->piece[i]);
        if (verdict == VERIFY_DIFFERENT && count[verdict] < LINES_MOST)
            report_piece(v, &v->piece[i]);
        count[verdict]++;
    }
    warn("%" PRIu32 " of %" PRIu64 " pieces were computed again on another %s: %" PRIu32
         " differ, %" PRIu32 " could not be computed",
        v->n - count[VERIFY_UNCHECKED], v->seen, v->several ? "host" : "slot of the only host",
        count[VERIFY_DIFFERENT], count[VERIFY_UNCHECKED]);
    return v->n > count[VERIFY_AGREED] ? ST_PARTIAL : ST_OK;
}

/* ---- the stream of a check, which may stall -------------------------------------------------- */

struct passing {
    int64_t patience_us, until_us; /* a fragment must come until then */
};

static void pass_record(void *ctx, const struct record *r)
{
    struct passing *p = ctx;
    struct buf b = {0};
    if (r->kind == REC_FRAG) p->until_us = now_us() + p->patience_us;
    wire_forward(&b, r, NULL, NULL);
    put_stdout_buf(&b);
    buf_free(&b);
}

/* Before each read. A sender that hangs may still send beats, or a byte now and then. */
static void await(void *ctx, int fd)
{
    const struct passing *p = ctx;
    for (int n = 0; n <= 0;) {
        int64_t left_ms = (p->until_us - now_us() + 999) / 1000;
        if (left_ms <= 0) {
            warn("no fragment came for %" PRId64 " s: the missing ones are not waited for",
                p->patience_us / 1000000);
            close_stdout();
            exit(ST_PARTIAL);
        }
        n = poll(
            &(struct pollfd){fd, POLLIN, 0}, 1, left_ms < INT32_MAX ? (int)left_ms : INT32_MAX);
        if (n < 0 && errno != EINTR) die(ST_SYSTEM, "poll:");
    }
}

/* The longest task of the log. */
static int64_t longest_us(const char *log)
{
    struct history l = {0};
    const int fd = input_open(log);
    int failed = fd < 0 ? -1 : history_read(&l, fd) != 0 ? -2 : l.refused;
    check_read(failed, log, l.why);
    const int64_t us = history_longest_us(&l, INT64_MAX / 2 / PATIENCE_TIMES);
    history_free(&l);
    close(fd);
    return us;
}

static int pass_fragments(const char *log, int64_t seconds)
{
    struct passing p = {.patience_us = seconds * 1000000 + PATIENCE_TIMES * longest_us(log)};
    const struct log_reader reader = {pass_record, await, &p};
    struct intake in = {0};
    p.until_us = now_us() + p.patience_us;
    int failed = log_read(&in, STDIN_FILENO, "standard input", &reader);
    check_read(failed < 0 ? -2 : failed, "standard input", in.why);
    intake_free(&in);
    return ST_OK;
}

/* ---------------------------------------------------------------------------------------------- */

static struct options parse(int argc, char **argv)
{
    static const char text[] = "[-hr] [-s SEED] { -j SLOTS | -S HOSTS } FRACTION LOG [CHECK ...]\n"
                               "       verify -t SECONDS LOG <FRAGMENTS";
    struct options o = {0};
    int opt;
    while ((opt = prog_getopt(argc, argv, "+hj:rs:S:t:")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'j': o.slots = (int)opt_int(opt, optarg, 1, HOST_SLOTS_MAX); break;
        case 'r': o.reports = true; break;
        case 's': o.seed = (uint64_t)opt_int(opt, optarg, 0, INT64_MAX); break;
        case 'S': o.hosts = opt_text(opt, optarg); break;
        case 't': o.seconds = opt_int(opt, optarg, 1, 1000000); break;
        default: usage(ST_USAGE, text);
        }
    }
    argv += optind;
    argc -= optind;
    o.files = argv;
    if (o.seconds) {
        if (argc != 1 || o.hosts || o.slots || o.reports) usage(ST_USAGE, text);
        return o;
    }
    if (argc < 2) usage(ST_USAGE, text);
    if (!parse_real(argv[0], 0, 1, &o.fraction) || o.fraction <= 0)
        die(ST_USAGE, "%s: expected a fraction above 0, up to 1", argv[0]);
    if (!o.hosts == !o.slots) die(ST_USAGE, "expected either -S or -j");
    o.files++;
    return o;
}

/* The name of each slot's host; the caller frees the array only. */
static const char **find_hosts(struct hosts *hosts, const struct options *o)
{
    char err[HOSTS_ERR];
    if (!o->hosts) hosts_here(hosts, o->slots);
    else if (!hosts_read(hosts, o->hosts, err)) die(ST_USAGE, "%s", err);
    const char **name = xmalloc((size_t)hosts->slots, sizeof *name);
    for (size_t i = 0, slot = 0; i < hosts->n; i++)
        for (int k = 0; k < hosts->at[i].slots; k++) name[slot++] = hosts->at[i].name;
    return name;
}

static int check_pieces(const struct options *o)
{
    struct verify v;
    struct hosts hosts = {0};
    char why[LOG_WHY];
    const char *name;
    int status = ST_OK;
    const char **names = find_hosts(&hosts, o);
    verify_init(&v, o->seed, o->fraction, names, hosts.slots);
    free(names);
    hosts_free(&hosts);
    int failed = verify_read(&v, o->files, &name, why);
    check_read(failed, name, why);
    if (o->reports) status = report(&v);
    else pass_state(&v);
    verify_free(&v);
    return status;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    int status = o.seconds ? pass_fragments(o.files[0], o.seconds) : check_pieces(&o);
    close_stdout();
    return status;
}
