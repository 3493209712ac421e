/* Pictures that were expected and are missing; fragments that cannot be used. */
#include "log/log.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

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

/* False if r is no frame record with a job, or if its frame was declared with another job or
 * size. */
static bool expect(struct intake *in, const struct record *r)
{
    char job[ASSEMBLY_NAME];
    return r->kind == REC_FRAME && rec_str(r, "job", job, sizeof job) &&
           assembly_declare(&in->parts, r->task.frame, r->frame_w, r->frame_h, job) ==
               ASSEMBLY_TAKEN;
}

int intake_expect(struct intake *in, const char *path, char why[LOG_WHY])
{
    struct buf text = {0};
    struct decoder d = {0};
    struct record r;
    enum wire_result got;
    int odd = read_file(path, &text);
    if (odd) snprintf(why, LOG_WHY, "%s: %s", path, strerror(errno));
    wire_feed(&d, buf_data(&text), buf_size(&text));
    wire_end(&d);
    while (!odd && (got = wire_next(&d, &r)) != WIRE_MORE) {
        odd = got == WIRE_RECORD ? !expect(in, &r) : 1;
        if (odd && got == WIRE_RECORD)
            snprintf(why, LOG_WHY, "%s: `%.*s`, expected `frame F W H job=HASH`, as was rendered",
                path, r.line_len < 80 ? (int)r.line_len : 80, r.line);
        else if (odd) snprintf(why, LOG_WHY, "%s: %s", path, d.why);
    }
    wire_free(&d);
    buf_free(&text);
    return odd;
}
