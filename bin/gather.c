/*
 * gather: fragments in, pictures out; the last stage of every pipeline.
 *
 * Records become calls of image's assembly, which holds the rules of committing; a frame is
 * written as soon as it is whole. What the run could not do is said here, with the command that
 * finishes it: see gather(1).
 */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/base.h"
#include "image/image.h"
#include "wire/wire.h"

#define READ_BYTES (1 << 18)
#define OPEN_BYTES_MAX                                                                             \
    (UINT64_C(5) << 30) /* pixels and bitmaps of the frames that are open at once */
#define FRAMES_LISTED 8 /* incomplete frames described one by one */
#define WARNINGS_MAX 16 /* about refused declarations */

/* A shell takes these for nothing but parts of a word. */
#define WORD_BYTES "-.:,+0123456789abcdefghijklmnopqrstuvwxyz"

struct options {
    const char *out; /* -o: pattern of the pictures' names, NULL: stdout */
    enum image_format format;
    enum image_naming naming;
    int bits;        /* -k */
    const char *log; /* -l */
    bool missing;    /* -m: print tasks instead of pictures */
    bool progress;   /* -P, or stderr is a terminal */
    char **inputs;   /* NULL-ended; none: standard input */
};

struct gather {
    const struct options *o;
    struct assembly parts;
    struct progress progress;
    float *pixels;          /* of one frag */
    int log_fd;             /* -1: none, or it failed */
    struct buf log_pending; /* what was read since the last write to it */
    uint64_t bad, skipped;  /* records and bytes lost */
    char why[160];          /* about the last of them */
    uint64_t unexpected;    /* records that do not belong in a stream of fragments */
    int warnings;
    int status;
    char with[160]; /* the worker and its options, as first announced */
};

static const char usage_text[] = "[-hmP] [-k 8|16] [-l LOG] [-o OUT] [FRAGS ...]";

static void check_out(struct options *o)
{
    o->naming = IMAGE_NAME_SINGLE;
    o->format = IMAGE_PNG;
    if (!o->out) return;
    if (!image_format_of(o->out, &o->format))
        die(ST_USAGE, "%s: unknown suffix, expected .png, .pam or .pfm", o->out);
    o->naming = image_name_check(o->out);
    if (o->naming == IMAGE_NAME_BAD)
        die(ST_USAGE,
            "%s: bad pattern, expected one %%d or %%03d at most, and %%%% for a percent sign",
            o->out);
    /* Better now than after hours of rendering. */
    if (outfile_check(o->out) != 0) die(ST_SYSTEM, "%s:", o->out);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.bits = 8, .progress = isatty(STDERR_FILENO)};
    for (int c; (c = getopt(argc, argv, "hk:l:mo:P")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'k': o.bits = (int)opt_int(c, optarg, 8, 16); break;
        case 'l': o.log = optarg; break;
        case 'm': o.missing = true; break;
        case 'o': o.out = optarg; break;
        case 'P': o.progress = true; break;
        default: usage(ST_USAGE, usage_text);
        }
    if (o.bits != 8 && o.bits != 16) die(ST_USAGE, "-k %d: expected 8 or 16", o.bits);
    if (o.missing && (o.out || o.log)) die(ST_USAGE, "-m: expected neither -o nor -l with it");
    o.inputs = argv + optind;
    check_out(&o);
    return o;
}

/* What errno says about `name`; the run goes on and ends with status 3. */
static void complain(struct gather *g, const char *name)
{
    int err = errno;
    progress_clear(&g->progress);
    errno = err;
    warn("%s:", name);
    g->status = ST_SYSTEM;
}

static void log_flush(struct gather *g)
{
    const struct buf *b = &g->log_pending;
    if (g->log_fd >= 0 && write_full(g->log_fd, buf_data(b), buf_size(b)) != 0) {
        complain(g, g->o->log);
        close(g->log_fd);
        g->log_fd = -1;
    }
    buf_consume(&g->log_pending, buf_size(&g->log_pending));
}

static void log_record(struct gather *g, const struct record *r)
{
    if (g->log_fd < 0) return;
    buf_append(&g->log_pending, r->line, r->line_len);
    buf_append(&g->log_pending, "\n", 1);
    buf_append(&g->log_pending, r->body, r->body_len);
}

/* Reading what is being appended would never end. */
static void check_not_log(const struct gather *g, int fd, const char *name)
{
    struct stat a, b;
    if (g->log_fd < 0 || fstat(fd, &a) != 0 || fstat(g->log_fd, &b) != 0) return;
    if (S_ISREG(a.st_mode) && a.st_dev == b.st_dev && a.st_ino == b.st_ino)
        die(ST_USAGE, "%s: is the log as well, expected another file", name);
}

/* The reader of stdout is gone: what was read is kept, and there is nobody to tell. */
static _Noreturn void reader_gone(struct gather *g)
{
    log_flush(g);
    progress_clear(&g->progress);
    _exit(ST_SYSTEM);
}

static void write_picture(struct gather *g, const struct assembly_frame *f)
{
    const struct options *o = g->o;
    if (o->out) {
        char *name = image_name(o->out, f->number);
        if (image_save(name, &f->picture, o->format, o->bits, f->job) != 0) complain(g, name);
        free(name);
    } else if (image_write(stdout, &f->picture, o->format, o->bits, f->job) != 0 ||
               fflush(stdout)) {
        if (errno == EPIPE) reader_gone(g);
        complain(g, "standard output");
    }
}

/* Where fan says it came from; the one worker of a plain pipeline has no name. */
static void worker_of(const struct record *r, char name[ASSEMBLY_NAME])
{
    if (!rec_str(r, "w", name, ASSEMBLY_NAME)) *name = '\0';
}

/* The program and options that gave these pixels: for the message that tells how to finish them. */
static void note_options(struct gather *g, const struct record *r)
{
    if (*g->with || !rec_str(r, "with", g->with, sizeof g->with)) return;
    if (g->with[strspn(g->with, WORD_BYTES)]) *g->with = '\0';
    for (char *c = g->with; *c; c++)
        if (*c == ',') *c = ' ';
}

static void take_frame(struct gather *g, const struct record *r)
{
    char job[ASSEMBLY_NAME], worker[ASSEMBLY_NAME];
    if (!rec_str(r, "job", job, sizeof job)) {
        g->unexpected++;
        return;
    }
    worker_of(r, worker);
    note_options(g, r);
    uint32_t number = r->task.frame;
    enum assembly_verdict verdict =
        assembly_declare(&g->parts, number, r->frame_w, r->frame_h, job, worker);
    if (g->parts.n_frames > 1 && !g->o->missing && g->o->naming != IMAGE_NAME_NUMBERED) {
        log_flush(g);
        die(ST_USAGE, "frame %u: a second picture for %s, expected -o with %%d in the name", number,
            g->o->out ? g->o->out : "standard output");
    }
    if (verdict == ASSEMBLY_TAKEN || g->warnings++ >= WARNINGS_MAX) return;
    progress_clear(&g->progress);
    const struct assembly_frame *f = assembly_find(&g->parts, number);
    if (verdict == ASSEMBLY_FOREIGN)
        warn("frame %u: worker %s has job %s of %ux%u, expected %s of %ux%u: its fragments are "
             "ignored",
            number, *worker ? worker : "without a name", job, r->frame_w, r->frame_h, f->job,
            f->have.w, f->have.h);
    else
        warn("frame %u: too many, expected at most %d frames and %d workers with other jobs",
            number, ASSEMBLY_FRAMES_MAX, ASSEMBLY_FOREIGN_MAX);
}

/* Ids of new tasks must not be those of old ones. */
static struct assembly_frame *note_id(struct gather *g, const struct task *t)
{
    struct assembly_frame *f = assembly_find(&g->parts, t->frame);
    if (f && t->id >= f->next_id && t->id < UINT32_MAX) f->next_id = t->id + 1;
    return f;
}

static void take_frag(struct gather *g, const struct record *r)
{
    char worker[ASSEMBLY_NAME];
    worker_of(r, worker);
    if (!g->o->missing) rec_pixels(r, g->pixels);
    enum assembly_verdict verdict = assembly_commit(
        &g->parts, r->task.frame, worker, &r->task.at, g->o->missing ? NULL : g->pixels);
    if (verdict != ASSEMBLY_TAKEN) return;
    struct assembly_frame *f = note_id(g, &r->task);
    if (f->released || !coverage_full(&f->have)) return;
    if (!g->o->missing) write_picture(g, f);
    assembly_release(&g->parts, f);
}

static void take_record(struct gather *g, const struct record *r)
{
    log_record(g, r);
    switch (r->kind) {
    case REC_FRAME: take_frame(g, r); break;
    case REC_FRAG: take_frag(g, r); break;
    case REC_DONE: note_id(g, &r->task); break;
    default: g->unexpected += r->kind < REC_HELLO; /* what flows down has no place here */
    }
}

static void await(struct gather *g, int fd)
{
    bool to_stdout = !g->o->out && !g->o->missing;
    struct pollfd p[2] = {{fd, POLLIN, 0}, {to_stdout ? STDOUT_FILENO : -1, 0, 0}};
    while (poll(p, 2, -1) < 0)
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
    if (p[1].revents & POLLERR) reader_gone(g);
}

static void read_stream(struct gather *g, int fd, const char *name)
{
    struct decoder d = {.upward = true};
    check_not_log(g, fd, name);
    for (ptrdiff_t n = 1; n > 0;) {
        await(g, fd);
        n = read_some(fd, &d.in, READ_BYTES);
        if (n < 0) die(ST_SYSTEM, "%s:", name);
        if (n == 0) wire_end(&d);
        struct record r;
        for (enum wire_result got; (got = wire_next(&d, &r)) != WIRE_MORE;)
            if (got == WIRE_RECORD) take_record(g, &r);
        log_flush(g);
        progress_show(&g->progress, g->parts.done_px, g->parts.declared_px);
    }
    g->bad += d.bad;
    g->skipped += d.skipped;
    if (d.bad) memcpy(g->why, d.why, sizeof g->why);
    wire_free(&d);
}

static void read_streams(struct gather *g)
{
    if (!*g->o->inputs) read_stream(g, STDIN_FILENO, "standard input");
    for (char **name = g->o->inputs; *name; name++) {
        bool std = strcmp(*name, "-") == 0;
        int fd = std ? STDIN_FILENO : open(*name, O_RDONLY | O_CLOEXEC);
        if (fd < 0) die(ST_USAGE, "%s:", *name);
        read_stream(g, fd, std ? "standard input" : *name);
        if (!std) close(fd);
    }
    progress_clear(&g->progress);
}

static void report_refused(const struct gather *g)
{
    static const char *const what[ASSEMBLY_VERDICTS] = {
        [ASSEMBLY_UNDECLARED] = "of no declared frame, expected `frame` before them",
        [ASSEMBLY_OUTSIDE] = "outside their frame",
        [ASSEMBLY_FOREIGN] = "of another job",
        [ASSEMBLY_NO_ROOM] =
            "beyond the memory for open frames, expected fewer or smaller ones at once",
    };
    if (g->bad)
        warn("%" PRIu64 " damaged record%s (%" PRIu64 " bytes) skipped; the last: %s", g->bad,
            g->bad > 1 ? "s" : "", g->skipped, g->why);
    if (g->unexpected)
        warn("%" PRIu64 " record%s ignored, expected fragments, and frames with job=",
            g->unexpected, g->unexpected > 1 ? "s" : "");
    for (int v = 0; v < ASSEMBLY_VERDICTS; v++)
        if (g->parts.refused[v])
            warn("%" PRIu64 " fragment%s ignored: %s", g->parts.refused[v],
                g->parts.refused[v] > 1 ? "s" : "", what[v]);
}

static void report_twice(const struct gather *g)
{
    uint64_t same, differing;
    const struct assembly_frame *f = assembly_again(&g->parts, &same, &differing);
    if (f)
        warn("%" PRIu64 " pixels came twice and differ, the most in frame %u at %u,%u, by %.3g: "
             "the first were kept",
            differing, f->number, f->worst_x, f->worst_y, f->worst);
    if (same && g->o->progress) warn("%" PRIu64 " pixels came twice", same);
}

/* The command that finishes the pictures, from the log or from the files that were read. */
static void report_remedy(const struct gather *g)
{
    const struct options *o = g->o;
    const char *one[] = {o->log, NULL}, *last = NULL;
    struct buf b = {0}, logs = {0};
    bool piped = false; /* some of it cannot be read again */
    for (const char *const *log = o->log ? one : (const char *const *)o->inputs; *log; log++) {
        piped = piped || strcmp(*log, "-") == 0;
        last = *log;
        buf_append(&logs, " ", 1);
        buf_quote(&logs, last);
    }
    buf_append(&logs, "", 1);
    const char *all = (const char *)buf_data(&logs);
    buf_printf(&b, "gather -m%s | %s SCENE >> ", all, *g->with ? g->with : "rtworker");
    if (last) buf_quote(&b, last);
    buf_printf(&b, "; gather%s -o ", o->bits == 16 ? " -k 16" : "");
    buf_quote(&b, o->out ? o->out : "PICTURE.png");
    buf_append(&b, all, strlen(all) + 1);
    if (last && !piped) warn("to finish: %s", (const char *)buf_data(&b));
    else warn("no log was kept (-l LOG): only a new run gets them");
    buf_free(&logs);
    buf_free(&b);
}

static void report_missing(const struct gather *g)
{
    uint32_t incomplete = 0;
    for (uint32_t i = 0; i < g->parts.n_frames; i++) {
        const struct assembly_frame *f = g->parts.frames[i];
        if (coverage_full(&f->have) || ++incomplete > FRAMES_LISTED) continue;
        char text[ASSEMBLY_TEXT];
        assembly_missing_text(f, text);
        warn("frame %u: %s", f->number, text);
    }
    if (incomplete > FRAMES_LISTED) warn("... and %u frames more", incomplete - FRAMES_LISTED);
    report_remedy(g);
}

/* -m: a frame and what it lacks, as a worker reads them. */
static void print_tasks(const struct assembly_frame *f)
{
    struct buf b = {0};
    struct coverage taken;
    if (coverage_full(&f->have)) return;
    assembly_coverage(f, &taken);
    struct task t = {.frame = f->number, .id = f->next_id, .to = -1};
    wire_frame(&b, f->number, f->have.w, f->have.h, NULL);
    for (uint64_t p = 0; coverage_missing(&taken, &p, &t.at); t.id++) {
        wire_task(&b, &t);
        fwrite(buf_data(&b), 1, buf_size(&b), stdout);
        buf_consume(&b, buf_size(&b));
    }
    coverage_free(&taken);
    buf_free(&b);
}

static void print_missing(const struct gather *g)
{
    for (uint32_t i = 0; i < g->parts.n_frames; i++) print_tasks(g->parts.frames[i]);
}

static int finish(struct gather *g)
{
    report_refused(g);
    report_twice(g);
    bool declared = g->parts.n_frames > 0;
    if (!declared) warn("no frame was declared, expected `frame F W H job=HASH` and its fragments");
    else if (g->o->missing) print_missing(g);
    else if (!assembly_whole(&g->parts)) report_missing(g);
    if (g->status != ST_OK) return g->status;
    return assembly_whole(&g->parts) || (declared && g->o->missing) ? ST_OK : ST_PARTIAL;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    signal(SIGPIPE, SIG_IGN);
    struct gather g = {.o = &o, .log_fd = -1};
    if (o.log) g.log_fd = open(o.log, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (o.log && g.log_fd < 0) die(ST_SYSTEM, "%s:", o.log);
    assembly_init(&g.parts, !o.missing, OPEN_BYTES_MAX);
    progress_start(&g.progress, o.progress);
    g.pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *g.pixels);
    read_streams(&g);
    int status = finish(&g);
    assembly_free(&g.parts);
    buf_free(&g.log_pending);
    free(g.pixels);
    if (status != ST_SYSTEM) close_stdout(); /* else it has been said */
    return status;
}
