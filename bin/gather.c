/*
 * gather: turns fragments into pictures; the last stage of every pipeline.
 *
 * Records go through log's intake into image's assembly, which holds the rules of committing. A
 * frame is written as soon as it is whole. Missing parts are reported with the command that
 * finishes the pictures: gather(1).
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
#include "log/log.h"

#define FRAMES_LISTED 8 /* incomplete frames described singly */
#define WARNINGS_MAX 16 /* about refused declarations */

struct options {
    const char *out; /* -o: pattern of the picture names; NULL: stdout */
    enum image_format format;
    enum image_naming naming;
    int bits;             /* -k */
    const char *log;      /* -r */
    const char *expected; /* -e: a file of the expected frames, or NULL */
    bool missing;         /* -m: print tasks instead of pictures */
    bool progress;        /* -P, or stderr is a terminal */
    char **inputs;        /* NULL-ended; none: standard input */
};

struct gather {
    const struct options *o;
    struct intake in;
    struct log_file log;
    struct log_past past;
    bool trusted;   /* the log is empty, or of the same origin as this run */
    bool rereading; /* records come from the log */
    struct progress progress;
    int warnings;
    char why[24]; /* of the stream's bye: it ended early */
    int status;
};

static const char usage_text[] = "[-hP] [-e FRAMES] [-k 8|16] [-o OUT] [-r LOG] [FRAGS ...]\n"
                                 "       gather -m [-P] [FRAGS ...]";

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
    /* Better to fail now than after hours of rendering. */
    if (outfile_check(o->out) != 0) die(ST_SYSTEM, "%s:", o->out);
}

static int opt_bits(const char *s)
{
    if (strcmp(s, "8") == 0) return 8;
    if (strcmp(s, "16") == 0) return 16;
    die(ST_USAGE, "-k %s: expected 8 or 16", s);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.bits = 8, .progress = isatty(STDERR_FILENO)};
    for (int c; (c = prog_getopt(argc, argv, "e:hk:mo:Pr:")) != -1;) switch (c) {
        case 'e': o.expected = opt_text(c, optarg); break;
        case 'h': usage(ST_OK, usage_text);
        case 'k': o.bits = opt_bits(optarg); break;
        case 'm': o.missing = true; break;
        case 'o': o.out = opt_text(c, optarg); break;
        case 'P': o.progress = true; break;
        case 'r': o.log = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (o.missing && (o.out || o.log)) die(ST_USAGE, "-m: expected neither -o nor -r with it");
    o.inputs = argv + optind;
    check_out(&o);
    return o;
}

/* Reports errno for `name`; the run goes on and ends with status 3. */
static void complain(struct gather *g, const char *name)
{
    int err = errno;
    progress_clear(&g->progress);
    errno = err;
    warn("%s:", name);
    g->status = ST_SYSTEM;
}

/* Writes the records read so far to the log, once it is known that they belong there. */
static void flush_log(struct gather *g)
{
    if (g->trusted && log_flush(&g->log) != 0) complain(g, g->o->log);
}

/* Reading a file that is being appended to would never end. A picture would replace its own log. */
static void check_not_log(const struct gather *g, const struct stat *st, const char *name)
{
    struct stat log;
    if (g->log.fd < 0 || fstat(g->log.fd, &log) != 0) return;
    if (S_ISREG(st->st_mode) && st->st_dev == log.st_dev && st->st_ino == log.st_ino)
        die(ST_USAGE, "%s: is the log as well, expected another file", name);
}

static char interrupted_text[4352];

/* Only records since the last read are missing from the log, as after kill -9. */
static void interrupted(int sig)
{
    ssize_t said = write(STDERR_FILENO, interrupted_text, strlen(interrupted_text));
    (void)said;
    signal(sig, SIG_DFL);
    raise(sig);
}

static void open_log(struct gather *g)
{
    static const int ending[] = {SIGHUP, SIGINT, SIGTERM};
    const struct options *o = g->o;
    struct stat st;
    g->log.fd = -1;
    g->trusted = true;
    if (!o->log) return;
    if (log_open(&g->log, o->log) != 0) {
        if (errno == EWOULDBLOCK) die(ST_USAGE, "%s: is in use by another run", o->log);
        die(ST_SYSTEM, "%s:", o->log);
    }
    if (o->out && stat(o->out, &st) == 0) check_not_log(g, &st, o->out);
    g->trusted = !g->log.holds;
    snprintf(interrupted_text, sizeof interrupted_text,
        "%sgather: interrupted; what has come is in %s: the same command finishes the rest\n",
        o->progress ? "\n" : "", o->log);
    for (size_t i = 0; i < sizeof ending / sizeof *ending; i++)
        if (signal(ending[i], interrupted) == SIG_IGN) signal(ending[i], SIG_IGN);
}

/* The reader of stdout is gone: keeps the records read so far, and ends. */
static _Noreturn void reader_gone(struct gather *g)
{
    flush_log(g);
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

static void warn_refused(struct gather *g, const struct record *r, const char *job)
{
    const struct assembly_frame *f = assembly_find(&g->in.parts, r->task.frame);
    char source[LOG_SOURCE_TEXT];
    if (g->warnings++ >= WARNINGS_MAX) return;
    progress_clear(&g->progress);
    log_source_text(&g->in.sources, log_source_of(&g->in.sources, r), source);
    if (f)
        warn("frame %u: %s has job %s of %ux%u, expected %s of %ux%u: its fragments are ignored",
            r->task.frame, source, job, r->frame_w, r->frame_h, f->job, f->have.w, f->have.h);
    else warn("frame %u: too many, expected at most %d", r->task.frame, ASSEMBLY_FRAMES_MAX);
}

static void confirm(struct gather *g, const struct record *r);

static void take_frame(struct gather *g, const struct record *r)
{
    char job[ASSEMBLY_NAME];
    const struct assembly *parts = &g->in.parts;
    uint32_t number = r->task.frame;
    bool said = rec_str(r, "job", job, sizeof job);
    if (said && g->log.holds && !g->rereading) confirm(g, r);
    if (said && !g->o->missing && (uint64_t)r->frame_w * r->frame_h > IMAGE_PIXELS_MAX &&
        !assembly_find(parts, number)) {
        flush_log(g);
        die(ST_USAGE, "frame %u: %ux%u pixels, expected at most %" PRIu64 " in a picture", number,
            r->frame_w, r->frame_h, IMAGE_PIXELS_MAX);
    }
    enum assembly_verdict verdict = intake_frame(&g->in, r);
    if (parts->n_frames > 1 && !g->o->missing && g->o->naming != IMAGE_NAME_NUMBERED) {
        flush_log(g);
        die(ST_USAGE, "frame %u: a second picture for %s, expected -o with %%d in the name", number,
            g->o->out ? g->o->out : "standard output");
    }
    if (verdict == ASSEMBLY_FOREIGN || verdict == ASSEMBLY_NO_ROOM) warn_refused(g, r, job);
}

static void take_record(void *ctx, const struct record *r)
{
    struct gather *g = ctx;
    /* Before the log is trusted, only the origin and the frames of the workers count. */
    if (!g->trusted && !g->rereading && (r->kind == REC_FRAG || r->kind == REC_BEAT)) return;
    if (r->kind == REC_FRAME) take_frame(g, r);
    if (r->kind == REC_BYE && !g->rereading && !rec_str(r, "why", g->why, sizeof g->why))
        *g->why = '\0';
    if (!g->rereading && r->kind != REC_BEAT) log_append(&g->log, r);
    struct assembly_frame *whole = r->kind == REC_FRAME ? NULL : intake_record(&g->in, r);
    if (!whole) return;
    if (!g->o->missing) write_picture(g, whole);
    assembly_release(&g->in.parts, whole);
}

/* Before a read that may block: keeps the records read so far, and checks the reader of stdout. */
static void before_read(void *ctx, int fd)
{
    struct gather *g = ctx;
    bool to_stdout = !g->o->out && !g->o->missing;
    struct pollfd p[2] = {{fd, POLLIN, 0}, {to_stdout ? STDOUT_FILENO : -1, 0, 0}};
    flush_log(g);
    progress_show(&g->progress, g->in.parts.done_px, g->in.parts.declared_px);
    while (poll(p, 2, -1) < 0)
        if (errno != EINTR) die(ST_SYSTEM, "poll:");
    if (p[1].revents & POLLERR) reader_gone(g);
}

static struct log_reader reader_of(struct gather *g)
{
    return (struct log_reader){take_record, before_read, g};
}

/*
 * The first record of this run's workers about a picture, when the log was not empty: the picture
 * must belong to the log. At the first record of all, the log's content is counted before this
 * run's.
 */
static void confirm(struct gather *g, const struct record *r)
{
    const struct log_reader reader = reader_of(g);
    char why[LOG_WHY];
    intake_note(&g->in, r);
    int refused = log_confirm(&g->past, &g->log, &g->in.origin, r, why);
    if (refused > 0) flush_log(g);
    if (refused > 0) die(ST_USAGE, "%s: %s", g->o->log, why);
    if (g->trusted) return;
    const char *input = g->in.sources.input;
    g->rereading = true;
    if (refused < 0 || log_reread(&g->log, &g->in, &reader) != 0) die(ST_SYSTEM, "%s:", g->o->log);
    g->rereading = false;
    log_sources_begin(&g->in.sources, input);
    g->trusted = true;
    progress_resume(&g->progress, g->in.parts.done_px);
}

static void read_stream(struct gather *g, int fd, const char *name)
{
    const struct log_reader reader = reader_of(g);
    struct stat st;
    if (fstat(fd, &st) == 0) check_not_log(g, &st, name);
    int failed = log_read(&g->in, fd, name, &reader);
    if (failed < 0) die(ST_SYSTEM, "%s:", name);
    flush_log(g);
    if (failed) die(ST_USAGE, "%s: %s", name, g->in.why);
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
}

static void report_twice(const struct gather *g)
{
    const struct assembly *parts = &g->in.parts;
    uint64_t same = assembly_again(parts);
    char text[LOG_DISPUTE_TEXT];
    for (uint32_t i = 0; i < parts->n_disputes; i++)
        warn("%s", log_dispute_text(&g->in.sources, &parts->disputes[i], text));
    if (same && g->o->progress) warn("%" PRIu64 " pixels came twice", same);
}

/* The command that finishes the pictures, from the log or from the input files. */
static void report_remedy(const struct gather *g)
{
    const struct options *o = g->o;
    const char *const one[] = {o->log, NULL};
    struct buf options = {0}, remedy = {0};
    buf_printf(&options, "%s -o ", o->bits == 16 ? " -k 16" : "");
    buf_quote(&options, o->out ? o->out : "PICTURE.png");
    buf_append(&options, "", 1);
    bool again = log_remedy(o->log ? one : (const char *const *)o->inputs, &g->in.origin,
        (const char *)buf_data(&options), &remedy);
    if (o->log) warn("the same command again finishes it, with what is in %s; or these do", o->log);
    if (again) warn("to finish: %.*s", (int)buf_size(&remedy), (const char *)buf_data(&remedy));
    else warn("no log was kept (-r LOG): only a new run gets them");
    buf_free(&options);
    buf_free(&remedy);
}

static void report_missing(const struct gather *g)
{
    uint32_t incomplete = 0;
    for (uint32_t i = 0; i < g->in.parts.n_frames; i++) {
        const struct assembly_frame *f = g->in.parts.frames[i];
        if (coverage_full(&f->have) || ++incomplete > FRAMES_LISTED) continue;
        char text[ASSEMBLY_TEXT];
        assembly_missing_text(f, text);
        warn("frame %u: %s", f->number, text);
    }
    if (incomplete > FRAMES_LISTED) warn("... and %u frames more", incomplete - FRAMES_LISTED);
    report_remedy(g);
}

static void put(const void *p, size_t n) { fwrite(p, 1, n, stdout); }

/* Status 3; or 2 if the stream itself announced its early end. */
static int unfinished(const struct gather *g)
{
    if (!*g->why || *g->o->inputs) return ST_PARTIAL;
    return strcmp(g->why, "method-failed") == 0 ? ST_USAGE : ST_SYSTEM;
}

/* Frames without any record are missing too; reports it if there is no frame at all. */
static void add_expected(struct gather *g)
{
    char why[LOG_WHY];
    if (!g->o->expected || !g->in.parts.n_frames) return;
    if (intake_expect(&g->in, g->o->expected, why) != 0) die(ST_USAGE, "%s", why);
}

static int finish(struct gather *g)
{
    const struct assembly *parts = &g->in.parts;
    progress_clear(&g->progress);
    if (!g->trusted) {
        warn("%s: no worker has announced a frame, expected one that belongs there", g->o->log);
        return unfinished(g);
    }
    add_expected(g);
    intake_report(&g->in);
    report_twice(g);
    bool disputed = parts->n_frames && !*g->o->inputs && strcmp(g->why, "other-jobs") == 0;
    if (disputed) warn("slots did not agree on a job: what is there may be of another scene");
    if (!parts->n_frames && *g->why) warn("nothing was rendered: %s", g->why);
    if (!parts->n_frames && !*g->why)
        warn("no frame was declared, expected `frame F W H job=HASH` and its fragments");
    for (uint32_t i = 0; i < parts->n_frames && g->o->missing; i++)
        intake_missing(parts->frames[i], put);
    if (parts->n_frames && !g->o->missing && !assembly_whole(parts)) report_missing(g);
    if (g->status != ST_OK || disputed) return ST_SYSTEM;
    if (!assembly_whole(parts) && !(parts->n_frames && g->o->missing)) return unfinished(g);
    return parts->differing || intake_orphaned(&g->in) ? ST_PARTIAL : ST_OK;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    signal(SIGPIPE, SIG_IGN);
    struct gather g = {.o = &o};
    open_log(&g);
    intake_init(&g.in, !o.missing);
    progress_start(&g.progress, o.progress);
    read_streams(&g);
    int status = finish(&g);
    intake_free(&g.in);
    log_past_free(&g.past);
    log_close(&g.log);
    if (status != ST_SYSTEM) close_stdout(); /* else the error was reported */
    return status;
}
