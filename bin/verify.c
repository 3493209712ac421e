/*
 * verify: chooses pieces of a log that another host computes a second time, and reports the result.
 *
 * The pieces are chosen after their pixels have arrived, by a number drawn then. So a worker cannot
 * know, while it computes a piece, that the piece will be checked. lib/verify has the rules.
 */
#include "base/base.h"
#include "hosts/hosts.h"
#include "log/log.h"
#include "verify/verify.h"
#include "wire/wire.h"

#include <inttypes.h>
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

struct program {
    struct verify v;
    struct hosts hosts;
    struct verify_hosts places;
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
    struct task t;
    if (own->tasks_written) return;
    snprintf(job, sizeof job, "job=%s", own->job);
    for (uint32_t from = 0; verify_request(v, f->frame, &from, &t);) {
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

static void report_part(const struct program *p, const struct verify_part *part)
{
    struct buf b = {0};
    verify_describe(part, &p->places, &b);
    warn("%.*s", (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
}

static int report(const struct program *p)
{
    const struct verify *v = &p->v;
    const struct verify_count count = verify_counted(v);
    int lines = 0;
    for (uint32_t i = 0; i < v->n && lines < LINES_MOST; i++) {
        if (verify_judge(&v->part[i]) != VERIFY_DIFFERENT) continue;
        report_part(p, &v->part[i]);
        lines++;
    }
    warn("%" PRIu32 " of %" PRIu32 " pieces were computed again on another %s: %" PRIu32
         " differ, %" PRIu32 " could not be computed",
        v->pieces - count.unchecked, v->seen, p->places.several ? "host" : "slot of the only host",
        count.different, count.unchecked);
    return count.different || count.unchecked ? ST_PARTIAL : ST_OK;
}

/* ---- patience -------------------------------------------------------------------------------- */

static int pass_fragments(const char *log, int64_t seconds)
{
    char why[LOG_WHY];
    int64_t longest_us;
    check_read(log_longest_us(log, INT64_MAX / 2 / PATIENCE_TIMES, &longest_us, why), log, why);
    const int64_t patience_us = seconds * 1000000 + PATIENCE_TIMES * longest_us;
    int ended = log_pass(STDIN_FILENO, patience_us, put_stdout);
    if (ended < 0) die(ST_SYSTEM, "standard input:");
    if (ended) return ST_OK;
    warn("no fragment came for %" PRId64 " s: the missing ones are not waited for",
        patience_us / 1000000);
    return ST_PARTIAL;
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
        case 'j': o.slots = (int)opt_int(opt, optarg, 1, HOSTS_SLOTS_MAX); break;
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
    for (int slot = 0; slot < hosts->slots; slot++)
        name[slot] = hosts->at[hosts_of_slot(hosts, slot)].name;
    return name;
}

static int check_pieces(const struct options *o)
{
    struct program p = {0};
    char why[LOG_WHY];
    const char *name;
    int status = ST_OK;
    const char **names = find_hosts(&p.hosts, o);
    verify_hosts_init(&p.places, names, p.hosts.slots);
    verify_init(&p.v, o->seed, o->fraction, p.places.place_of, p.hosts.slots, p.places.places);
    int failed = verify_read(&p.v, &p.places, o->files, &name, why);
    check_read(failed, name, why);
    if (o->reports) status = report(&p);
    else pass_state(&p.v);
    verify_free(&p.v);
    verify_hosts_free(&p.places);
    free(names);
    hosts_free(&p.hosts);
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
