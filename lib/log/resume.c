/* Conditions for resuming a log. */
#include "log/log.h"

#include <inttypes.h>
#include <string.h>

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

int log_confirm(struct log_past *past, const struct log_file *l, const struct log_origin *now,
    const struct record *r, char why[LOG_WHY])
{
    int refused = past->known ? 0 : log_survey(l, &past->held);
    past->known = true;
    if (refused > 0) snprintf(why, LOG_WHY, "%s", past->held.why);
    if (refused || frames_find(&past->confirmed, r->task.frame)) return refused;
    if (!continues(&past->held, now, r, why)) return 1;
    frames_set(&past->confirmed, r->task.frame, r->frame_w, r->frame_h);
    return 0;
}

void log_past_free(struct log_past *past)
{
    intake_free(&past->held);
    frames_free(&past->confirmed);
}
