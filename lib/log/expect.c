/* Pictures that were expected and are missing; fragments that cannot be used, or came twice. */
#include "log/log.h"

#include <inttypes.h>
#include <string.h>

#define FRAMES_LISTED 8 /* incomplete frames described singly */

static const char *plural(uint64_t n) { return n == 1 ? "" : "s"; }

void intake_report(const struct intake *in)
{
    static const char *const what[ASSEMBLY_VERDICTS] = {
        [ASSEMBLY_UNDECLARED] = "of no declared frame, expected `frame` before them",
        [ASSEMBLY_OUTSIDE] = "outside their frame",
        [ASSEMBLY_FOREIGN] = "of another job",
        [ASSEMBLY_NO_ROOM] =
            "beyond the memory for open frames, expected fewer or smaller ones at once",
    };
    if (in->bad)
        warn("%" PRIu64 " damaged record%s (%" PRIu64 " bytes) skipped; the last: %s", in->bad,
            plural(in->bad), in->skipped, in->why);
    if (in->unexpected)
        warn("%" PRIu64 " record%s ignored, expected fragments, and frames with job=",
            in->unexpected, plural(in->unexpected));
    for (int v = 0; v < ASSEMBLY_VERDICTS; v++)
        if (in->parts.refused[v])
            warn("%" PRIu64 " fragment%s ignored: %s", in->parts.refused[v],
                plural(in->parts.refused[v]), what[v]);
}

const char *intake_refused_text(
    struct intake *in, const struct record *r, char out[LOG_DISPUTE_TEXT])
{
    const struct assembly_frame *f = assembly_find(&in->parts, r->task.frame);
    char source[LOG_SOURCE_TEXT], job[ASSEMBLY_NAME];
    log_source_text(&in->sources, log_source_of(&in->sources, r), source);
    if (!rec_str(r, "job", job, sizeof job)) *job = '\0';
    if (f)
        snprintf(out, LOG_DISPUTE_TEXT,
            "frame %" PRIu32 ": %s has job %s of %ux%u, expected %s of %ux%u: its fragments are "
            "ignored",
            r->task.frame, source, job, r->frame_w, r->frame_h, f->job, f->have.w, f->have.h);
    else
        snprintf(out, LOG_DISPUTE_TEXT, "frame %" PRIu32 ": too many frames, expected at most %d",
            r->task.frame, ASSEMBLY_FRAMES_MAX);
    return out;
}

bool intake_report_twice(const struct intake *in, bool all)
{
    const struct assembly *parts = &in->parts;
    uint64_t same = assembly_again(parts), more = parts->differing, late = 0;
    char text[LOG_DISPUTE_TEXT];
    for (uint32_t i = 0; i < parts->n_disputes; i++) {
        warn("%s", log_dispute_text(&in->sources, &parts->disputes[i], text));
        more -= parts->disputes[i].pixels;
    }
    if (more) warn("... and %" PRIu64 " differing pixels more", more);
    for (uint32_t i = 0; i < parts->n_frames; i++) late += parts->frames[i]->late;
    if (same && all) warn("%" PRIu64 " pixels came twice", same);
    if (late && all && in->pixels)
        warn("%" PRIu64 " pixels came again too late to be compared: after the next picture was "
             "complete",
            late);
    return parts->differing;
}

void intake_report_missing(const struct intake *in)
{
    uint32_t incomplete = 0;
    for (uint32_t i = 0; i < in->parts.n_frames; i++) {
        const struct assembly_frame *f = in->parts.frames[i];
        if (coverage_full(&f->have) || ++incomplete > FRAMES_LISTED) continue;
        char text[ASSEMBLY_TEXT];
        assembly_missing_text(f, text);
        warn("frame %u: %s", f->number, text);
    }
    if (incomplete > FRAMES_LISTED) warn("... and %u frames more", incomplete - FRAMES_LISTED);
}

void intake_report_resume(const char *log, char *const *inputs)
{
    if (log) warn("to resume from %s, rerun the command", log);
    else if (intake_piped(inputs) && !inputs[1])
        warn("no log was kept (-r LOG), so only a new run can render them");
    else warn("to resume, rerun the command of a log with -r LOG");
}

bool intake_piped(char *const *inputs)
{
    while (*inputs && strcmp(*inputs, "-") != 0) inputs++;
    return *inputs != NULL;
}

bool intake_report_bye(const struct intake *in, const char *why, bool piped)
{
    const bool none = !in->parts.n_frames;
    bool disputed = !none && piped && strcmp(why, "other-jobs") == 0;
    if (disputed) warn("slots did not agree on a job: the pixels may be of another scene");
    if (none && *why) warn("nothing was rendered: %s", why);
    if (none && !*why)
        warn("no frame was declared, expected `frame F W H job=HASH` and its fragments");
    return disputed;
}

/* False if r is no frame record with a job, or if its frame was declared with another job or
 * size. */
static bool expect(struct intake *in, const struct record *r)
{
    char job[ASSEMBLY_NAME];
    return r->kind == REC_FRAME && rec_str(r, "job", job, sizeof job) &&
           assembly_declare(&in->parts, r->task.frame, r->frame_w, r->frame_h, job) ==
               ASSEMBLY_TAKEN;
}

int intake_expect(struct intake *in, const char *name, const struct buf *frames, char why[LOG_WHY])
{
    struct decoder d = {0};
    struct record r;
    enum wire_result got;
    int odd = 0;
    wire_feed(&d, buf_data(frames), buf_size(frames));
    wire_end(&d);
    while (!odd && (got = wire_next(&d, &r)) != WIRE_MORE) {
        odd = got == WIRE_RECORD ? !expect(in, &r) : 1;
        if (odd && got == WIRE_RECORD)
            snprintf(why, LOG_WHY, "%s: `%.*s`, expected `frame F W H job=HASH` as it was rendered",
                name, r.line_len < 80 ? (int)r.line_len : 80, r.line);
        else if (odd) snprintf(why, LOG_WHY, "%s: %s", name, d.why);
    }
    wire_free(&d);
    return odd;
}
