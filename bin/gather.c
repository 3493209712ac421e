/*
 * gather: turns fragments into pictures; the last stage of every pipeline.
 *
 * Records go through log's intake into image's assembly, which holds the rules of committing. A
 * frame is written as soon as it is whole, and missing parts are reported: gather(1).
 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/base.h"
#include "eta/eta.h"
#include "log/log.h"
#include "proc/proc.h"

#define WARNINGS_MAX 16 /* about refused declarations */

struct options {
    struct image_out out; /* -o, -k */
    const char *log;      /* -r */
    const char *expected; /* -e: a file of the expected frames, or NULL */
    bool missing;         /* -m: print tasks instead of pictures */
    bool progress;        /* -P, or stderr is a terminal */
    double preview_s;     /* -w: seconds between previews; 0: none */
    char **inputs;        /* NULL-ended; "-": standard input */
};

struct gather {
    const struct options *o;
    struct intake in;
    struct log_run log;
    struct log_reader reader;
    struct eta_progress progress;
    struct image_preview preview;
    struct buf expected; /* -e: frames */
    char *spill;         /* directory for the pixels of large frames */
    int warnings;
    int status;
};

static const char usage_text[] =
    "[-hP] [-b BACKDROP] [-e FRAMES] [-f FRONT] [-i INPUTS] [-k 8|16]\n"
    "              [-o OUT] [-r LOG] [-w SECONDS] [FRAGS ...]\n"
    "       gather -m [-P] [FRAGS ...]";

/* A file of names, a line each. */
static void add_inputs(const char *list)
{
    char err[ERR_BYTES];
    struct buf names;
    if (!load_file(list, &names, err)) die(ST_USAGE, "%s", err);
    buf_append(&names, "", 1);
    for (char *at = (char *)names.data, *end; (end = strchr(at, '\n')) != NULL; at = end + 1) {
        *end = '\0';
        input_add(at, "an input");
    }
    buf_free(&names);
}

static struct options parse(int argc, char **argv, struct image_backs *backs)
{
    struct options o = {.out.backs = backs, .out.bits = 8, .progress = isatty(STDERR_FILENO)};
    for (int c; (c = prog_getopt(argc, argv, "b:e:f:hi:k:mo:Pr:w:")) != -1;) switch (c) {
        case 'b': image_opt_back(c, opt_text(c, optarg), false, backs); break;
        case 'e': o.expected = opt_text(c, optarg); break;
        case 'f': image_opt_back(c, opt_text(c, optarg), true, backs); break;
        case 'h': usage(ST_OK, usage_text);
        case 'i': add_inputs(opt_text(c, optarg)); break;
        case 'k': o.out.bits = image_opt_bits(c, optarg); break;
        case 'm': o.missing = true; break;
        case 'o': o.out.pattern = opt_text(c, optarg); break;
        case 'P': o.progress = true; break;
        case 'r': o.log = opt_text(c, optarg); break;
        case 'w': o.preview_s = opt_real(c, optarg, 0.1, 86400); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (o.missing && (o.out.pattern || o.log))
        die(ST_USAGE, "-m: expected neither -o nor -r with it");
    if (o.missing && backs->n) die(ST_USAGE, "-m: expected neither -b nor -f with it");
    if (o.preview_s > 0 && !o.out.pattern) die(ST_USAGE, "-w: expected -o OUT with it");
    static char dash[] = "-", *standard[] = {dash, NULL};
    o.inputs = argv[optind] ? argv + optind : standard;
    image_out_check(&o.out);
    return o;
}

/* Reports errno for `name`; the run goes on and ends with status 3. */
static void complain(struct gather *g, const char *name)
{
    int err = errno;
    progress_clear(&g->progress.line);
    errno = err;
    warn("%s:", name);
    g->status = ST_SYSTEM;
}

/* What a signal that ends this process prints about the log. */
static void say_last(const struct gather *g, const char *what)
{
    static char words[4352];
    char log[4096];
    text_shown(log, sizeof log, g->o->log);
    snprintf(words, sizeof words, "%sgather: interrupted; %s %s\n", g->o->progress ? "\n" : "", log,
        what);
    signals_say(words, g->o->log);
}

/* Writes the records read so far to the log, once it is known that they belong there. */
static void flush_log(struct gather *g)
{
    if (log_run_flush(&g->log) == 0) return;
    complain(g, g->o->log);
    say_last(g, "lacks pixels");
}

/* No log, picture or preview may replace a file that the run reads. Reading a log that is being
 * appended to would never end. */
static void check_files(const struct options *o)
{
    if (o->log) input_add(o->log, "the log");
    for (char **from = o->inputs; *from; from++) {
        const char *what = input_is(*from);
        if (what && strcmp(what, "an input") != 0)
            die(ST_USAGE, "%s: is also %s, expected another file", *from, what);
        input_add(*from, "an input");
    }
}

/* The same for the picture and the preview of this frame. */
static void check_output(const struct options *o, uint32_t frame)
{
    if (!o->out.pattern) return;
    char *name = image_out_name(&o->out, frame), *partial = image_preview_name(name);
    input_keep(name);
    if (o->preview_s > 0) input_keep(partial);
    free(name);
    free(partial);
}

/* For all that are expected, before anything is read: workers need not begin. */
static void check_expected(const struct options *o, const struct buf *frames)
{
    struct decoder d = {0};
    struct record r;
    enum wire_result got;
    wire_feed(&d, buf_data(frames), buf_size(frames));
    while ((got = wire_next(&d, &r)) != WIRE_MORE)
        if (got == WIRE_RECORD && r.kind == REC_FRAME) check_output(o, r.task.frame);
    wire_free(&d);
    if (o->out.naming != IMAGE_NAME_NUMBERED) check_output(o, 0);
}

static void open_log(struct gather *g)
{
    const struct options *o = g->o;
    if (o->log) input_keep(o->log);
    if (log_run_open(&g->log, o->log) != 0) {
        if (errno == EWOULDBLOCK) die(ST_USAGE, "%s: is in use by another run", o->log);
        die(ST_SYSTEM, "%s:", o->log);
    }
    check_files(o);
    check_expected(o, &g->expected);
    if (!o->log) return;
    /* Only records since the last read are missing from the log, as after kill -9. */
    say_last(g, "has the pixels so far: rerun the command to resume");
}

/* The reader of stdout is gone: keeps the records read so far, and ends. */
static _Noreturn void reader_gone(struct gather *g)
{
    flush_log(g);
    progress_clear(&g->progress.line);
    _exit(ST_SYSTEM);
}

static void write_picture(struct gather *g, const struct assembly_frame *f)
{
    const struct image_out *out = &g->o->out;
    char *name = image_out_name(out, f->number);
    const struct image_rows rows = assembly_rows(f);
    flush_log(g); /* a bad backdrop ends the program, and so does a name that became an input's */
    if (image_out_put(out, f->number, name, &rows, f->job) != 0) {
        if (!out->pattern && errno == EPIPE) reader_gone(g);
        complain(g, name);
    } else if (g->o->preview_s > 0) image_preview_remove(&g->preview, f);
    free(name);
}

static void write_previews(struct gather *g)
{
    char *failed = image_preview_put(&g->preview, &g->in.parts);
    if (failed) complain(g, failed);
    free(failed);
}

static void warn_refused(struct gather *g, const struct record *r)
{
    char text[LOG_DISPUTE_TEXT];
    if (g->warnings++ >= WARNINGS_MAX) return;
    progress_clear(&g->progress.line);
    warn("%s", intake_refused_text(&g->in, r, text));
}

/* What the run announces must belong to its log, whose content counts before the run's. */
static void confirm(struct gather *g, const struct record *r)
{
    char why[LOG_WHY];
    int refused = log_run_confirm(&g->log, &g->in, r, &g->reader, why);
    if (refused < 0) die(ST_SYSTEM, "%s:", g->o->log);
    if (refused) flush_log(g);
    if (refused) die(ST_USAGE, "%s: %s", g->o->log, why);
}

/* Pixels of a large frame that cannot be kept end the run; the log has them. */
static void check_kept(struct gather *g, const struct record *r)
{
    const struct assembly *parts = &g->in.parts;
    if (!parts->error) return;
    const struct assembly_frame *f = assembly_find(parts, r->task.frame);
    flush_log(g);
    progress_clear(&g->progress.line);
    errno = parts->error;
    die(ST_SYSTEM,
        "%s: cannot keep the pixels of frame %u, expected TMPDIR to name a directory with %.1f GB:",
        parts->spill.dir, r->task.frame, (double)assembly_disk(f->have.w, f->have.h) / 1e9);
}

static void take_frame(struct gather *g, const struct record *r)
{
    const struct image_out *out = &g->o->out;
    char job[ASSEMBLY_NAME];
    bool announced = rec_str(r, "job", job, sizeof job);
    const uint32_t known = g->in.parts.n_frames;
    if (announced) confirm(g, r);
    if (!g->spill) g->in.parts.spill.dir = g->spill = image_out_spill(out, r->task.frame);
    enum assembly_verdict verdict = intake_frame(&g->in, r);
    if (g->in.parts.n_frames > 1 && !g->o->missing && out->naming != IMAGE_NAME_NUMBERED) {
        flush_log(g);
        die(ST_USAGE, "frame %u: a second picture for %s, expected -o with %%d in the name",
            r->task.frame, out->pattern ? out->pattern : "standard output");
    }
    if (g->in.parts.n_frames > known) flush_log(g), check_output(g->o, r->task.frame);
    if (verdict == ASSEMBLY_FOREIGN || verdict == ASSEMBLY_NO_ROOM) warn_refused(g, r);
}

static void take_record(void *ctx, const struct record *r)
{
    struct gather *g = ctx;
    if (log_run_ignores(&g->log, r)) return;
    if (r->kind == REC_FRAME) take_frame(g, r);
    log_run_append(&g->log, r);
    eta_progress_note(&g->progress, &g->in.parts, r, g->log.rereading);
    struct assembly_frame *whole = r->kind == REC_FRAME ? NULL : intake_record(&g->in, r);
    check_kept(g, r);
    if (!whole) return;
    if (!g->o->missing) write_picture(g, whole);
    assembly_release(&g->in.parts, whole);
}

/* Before a read that may block: keeps the records read so far, writes previews that are due, and
 * checks the reader of stdout. */
static void before_read(void *ctx, int fd)
{
    struct gather *g = ctx;
    bool to_stdout = !g->o->out.pattern && !g->o->missing;
    struct pollfd p[2] = {{fd, POLLIN, 0}, {to_stdout ? STDOUT_FILENO : -1, 0, 0}};
    flush_log(g);
    eta_progress_show(&g->progress, &g->in.parts);
    for (int n = 0; n <= 0;) {
        int wait_ms = image_preview_wait_ms(&g->preview, &g->in.parts);
        if (wait_ms == 0) write_previews(g), wait_ms = -1;
        n = poll(p, 2, wait_ms);
        if (n < 0 && errno != EINTR) die(ST_SYSTEM, "poll:");
    }
    if (p[1].revents & POLLERR) reader_gone(g);
}

static void read_stream(struct gather *g, const char *name)
{
    int fd = read_open(&name);
    char why[sizeof g->log.why];
    memcpy(why, g->log.why, sizeof why);
    int failed = log_read(&g->in, fd, name, &g->reader);
    if (fd != STDIN_FILENO) memcpy(g->log.why, why, sizeof why); /* the end of another run */
    if (failed < 0) die(ST_SYSTEM, "%s:", name);
    flush_log(g);
    if (failed) die(ST_USAGE, "%s: %s", name, g->in.why);
    if (fd != STDIN_FILENO) close(fd);
}

/* Status 1 or 3; or 2 if the stream itself announced its early end. */
static int unfinished(const struct gather *g)
{
    if (!*g->log.why || !intake_piped(g->o->inputs)) return ST_PARTIAL;
    return strcmp(g->log.why, "method-failed") == 0 ? ST_USAGE : ST_SYSTEM;
}

static int finish(struct gather *g)
{
    const struct assembly *parts = &g->in.parts;
    char why[LOG_WHY];
    progress_clear(&g->progress.line);
    if (!g->log.trusted) {
        warn("%s: no worker announced a frame, expected a frame of this log", g->o->log);
        return unfinished(g);
    }
    /* Frames without any record are missing too; if there is no frame at all, that is reported. */
    if (g->o->expected && parts->n_frames &&
        intake_expect(&g->in, g->o->expected, &g->expected, why) != 0)
        die(ST_USAGE, "%s", why);
    intake_report(&g->in);
    bool differ = intake_report_twice(&g->in, g->o->progress);
    bool disputed = intake_report_bye(&g->in, g->log.why, intake_piped(g->o->inputs));
    for (uint32_t i = 0; i < parts->n_frames && g->o->missing; i++)
        intake_missing(parts->frames[i], put_stdout);
    if (g->preview.every_us) write_previews(g);
    if (parts->n_frames && !g->o->missing && !assembly_whole(parts)) {
        intake_report_missing(&g->in);
        intake_report_resume(g->o->log, g->o->inputs);
    }
    if (g->status != ST_OK || disputed) return ST_SYSTEM;
    if (!assembly_whole(parts) && !(parts->n_frames && g->o->missing)) return unfinished(g);
    return differ || intake_orphaned(&g->in) ? ST_PARTIAL : ST_OK;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct image_backs backs = {.n = 0};
    struct options o = parse(argc, argv, &backs);
    signal(SIGPIPE, SIG_IGN);
    static struct gather g; /* 60 KB, and a stack may be small */
    g.o = &o;
    g.reader = (struct log_reader){take_record, before_read, &g};
    char err[ERR_BYTES];
    if (o.expected && !load_file(o.expected, &g.expected, err)) die(ST_USAGE, "%s", err);
    open_log(&g);
    intake_init(&g.in, !o.missing);
    progress_start(&g.progress.line, o.progress);
    if (o.preview_s > 0) image_preview_start(&g.preview, &o.out, o.preview_s);
    for (char **name = o.inputs; *name; name++) read_stream(&g, *name);
    int status = finish(&g);
    intake_free(&g.in);
    buf_free(&g.expected);
    free(g.spill);
    log_run_close(&g.log);
    image_backs_free(&backs);
    if (status != ST_SYSTEM) close_stdout(); /* else the error was reported */
    return status;
}
