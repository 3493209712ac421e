/* A run that is appended to a log: see log.h. */
#include "log/log.h"

#include <inttypes.h>
#include <string.h>

int log_run_open(struct log_run *run, const char *path)
{
    *run = (struct log_run){.file = {.fd = -1}, .trusted = true};
    if (!path) return 0;
    int failed = log_open(&run->file, path);
    run->trusted = !run->file.holds;
    return failed;
}

void log_run_close(struct log_run *run)
{
    intake_free(&run->held);
    frames_free(&run->confirmed);
    log_close(&run->file);
}

/* ---- does the run belong to the log? --------------------------------------------------------- */

/* True if both are known and differ. */
static bool differ(const char *a, const char *b) { return *a && *b && strcmp(a, b) != 0; }

/* May r follow past? If not, why names the difference. */
static bool continues(const struct intake *past, const struct log_origin *now,
    const struct record *r, char why[LOG_WHY])
{
    const struct log_origin *then = &past->origin;
    const struct assembly_frame *f = assembly_find(&past->parts, r->task.frame);
    char job[ASSEMBLY_NAME] = "";
    bool same = f && rec_str(r, "job", job, sizeof job) && strcmp(job, f->job) == 0;
    if (!f || (same && !differ(then->selftest, now->selftest))) return true;
    if (f->have.w != r->frame_w || f->have.h != r->frame_h)
        snprintf(why, LOG_WHY,
            "has another size: frame %" PRIu32 " of %" PRIu32 "x%" PRIu32
            " pixels, expected %" PRIu32 "x%" PRIu32,
            r->task.frame, f->have.w, f->have.h, r->frame_w, r->frame_h);
    else if (differ(then->with, now->with))
        snprintf(why, LOG_WHY, "was rendered with other options: `%s`, expected `%s`", then->with,
            now->with);
    else if (differ(then->version, now->version))
        snprintf(why, LOG_WHY, "was rendered by another version: %s, expected %s", then->version,
            now->version);
    else if (differ(then->selftest, now->selftest))
        snprintf(why, LOG_WHY, "was rendered by other arithmetic: self-test %s, expected %s",
            then->selftest, now->selftest);
    else
        snprintf(why, LOG_WHY, "is of another scene: frame %" PRIu32 " has job %s, expected %s",
            r->task.frame, f->job, job);
    return false;
}

/* A frame once confirmed is not checked again. The log is read before anything is appended. */
static int check(
    struct log_run *run, const struct log_origin *now, const struct record *r, char why[LOG_WHY])
{
    int refused = run->known ? 0 : log_survey(&run->file, &run->held);
    run->known = true;
    if (refused > 0) snprintf(why, LOG_WHY, "%s", run->held.why);
    if (refused || frames_find(&run->confirmed, r->task.frame)) return refused;
    if (!continues(&run->held, now, r, why)) return 1;
    frames_set(&run->confirmed, r->task.frame, r->frame_w, r->frame_h);
    return 0;
}

int log_run_confirm(struct log_run *run, struct intake *in, const struct record *r,
    const struct log_reader *reader, char why[LOG_WHY])
{
    if (!run->file.holds || run->rereading) return 0;
    intake_note(in, r);
    int refused = check(run, &in->origin, r, why);
    if (refused || run->trusted) return refused;
    const char *input = in->sources.input;
    run->rereading = true;
    int failed = log_reread(&run->file, in, reader);
    run->rereading = false;
    if (failed) return -1;
    log_sources_begin(&in->sources, input);
    run->trusted = true;
    return 0;
}

/* ---- its records ----------------------------------------------------------------------------- */

bool log_run_ignores(const struct log_run *run, const struct record *r)
{
    return !run->trusted && !run->rereading && (r->kind == REC_FRAG || r->kind == REC_BEAT);
}

void log_run_append(struct log_run *run, const struct record *r)
{
    if (run->rereading) return;
    if (r->kind == REC_BYE && !rec_str(r, "why", run->why, sizeof run->why)) *run->why = '\0';
    if (r->kind != REC_BEAT) log_append(&run->file, r);
}

int log_run_flush(struct log_run *run) { return run->trusted ? log_flush(&run->file) : 0; }
