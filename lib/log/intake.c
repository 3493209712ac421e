/* Records into an assembly. */
#include "log/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define OPEN_BYTES_MAX                                                                             \
    (UINT64_C(5) << 30) /* pixels and bitmaps of the frames that are open at once */
#define READ_BYTES (1 << 18)
#define LOG_ORPHANS_MOST 1024 /* frames */

/* Bytes that a shell takes only as parts of a word. */
#define WORD_BYTES "-.:,+0123456789abcdefghijklmnopqrstuvwxyz"

void intake_init(struct intake *in, bool keep_pixels)
{
    *in = (struct intake){0};
    assembly_init(&in->parts, keep_pixels, OPEN_BYTES_MAX);
    if (keep_pixels) in->pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *in->pixels);
}

void intake_free(struct intake *in)
{
    assembly_free(&in->parts);
    log_sources_free(&in->sources);
    frames_free(&in->orphans);
    free(in->pixels);
    *in = (struct intake){0};
}

/* hello PROGRAM VERSION ... */
static void note_hello(struct log_origin *o, const struct record *r)
{
    const char *end = r->line + r->line_len, *at = r->line + strlen("hello ");
    at = memchr(at, ' ', (size_t)(end - at));
    if (*o->version || !at) return;
    at++;
    const char *stop = memchr(at, ' ', (size_t)(end - at));
    snprintf(o->version, sizeof o->version, "%.*s", (int)((stop ? stop : end) - at), at);
    if (!rec_str(r, "selftest", o->selftest, sizeof o->selftest)) *o->selftest = '\0';
}

static void note_options(struct log_origin *o, const struct record *r)
{
    if (*o->with || !rec_str(r, "with", o->with, sizeof o->with)) return;
    if (o->with[strspn(o->with, WORD_BYTES)]) *o->with = '\0';
    for (char *c = o->with; *c; c++)
        if (*c == ',') *c = ' ';
}

void intake_note(struct intake *in, const struct record *r)
{
    if (r->kind == REC_HELLO) note_hello(&in->origin, r);
    if (r->kind == REC_FRAME) note_options(&in->origin, r);
}

enum assembly_verdict intake_frame(struct intake *in, const struct record *r)
{
    char job[ASSEMBLY_NAME];
    if (!rec_str(r, "job", job, sizeof job)) {
        in->unexpected++;
        return ASSEMBLY_UNDECLARED;
    }
    intake_note(in, r);
    log_source_of(&in->sources, r);
    return assembly_declare(&in->parts, r->task.frame, r->frame_w, r->frame_h, job);
}

/* Ids of new tasks must differ from those of old ones. */
static struct assembly_frame *note_id(struct intake *in, const struct task *t)
{
    struct assembly_frame *f = assembly_find(&in->parts, t->frame);
    if (f && t->id >= f->next_id && t->id < UINT32_MAX) f->next_id = t->id + 1;
    return f;
}

static struct assembly_frame *take_frag(struct intake *in, const struct record *r)
{
    char job[ASSEMBLY_NAME];
    uint32_t number = r->task.frame;
    uint16_t source = in->pixels ? log_source_of(&in->sources, r) : 0;
    if (!rec_str(r, "job", job, sizeof job)) *job = '\0';
    if (in->pixels) rec_pixels(r, in->pixels);
    enum assembly_verdict verdict =
        assembly_commit(&in->parts, number, job, source, &r->task.at, in->pixels);
    if (verdict == ASSEMBLY_UNDECLARED && !frames_find(&in->orphans, number)) {
        if (in->orphans.n < LOG_ORPHANS_MOST) frames_set(&in->orphans, number, 0, 0);
        else in->more_orphans = true;
    }
    if (verdict != ASSEMBLY_TAKEN) return NULL;
    struct assembly_frame *f = note_id(in, &r->task);
    return f->released || !coverage_full(&f->have) ? NULL : f;
}

bool intake_orphaned(const struct intake *in)
{
    for (size_t i = 0; i < in->orphans.n; i++)
        if (!assembly_find(&in->parts, in->orphans.at[i].frame)) return true;
    return in->more_orphans;
}

struct assembly_frame *intake_record(struct intake *in, const struct record *r)
{
    switch (r->kind) {
    case REC_FRAG: return take_frag(in, r);
    case REC_DONE: note_id(in, &r->task); return NULL;
    case REC_HELLO:
        intake_note(in, r);
        log_sources_begin(&in->sources, in->sources.input);
        return NULL;
    default:
        /* Records that go down, or between the nodes of a ring, do not belong here. */
        in->unexpected += r->kind < REC_HELLO || r->kind > REC_GONE;
        return NULL;
    }
}

void intake_missing(const struct assembly_frame *f, void (*put)(const void *p, size_t n))
{
    struct buf b = {0};
    struct coverage taken;
    char job[ASSEMBLY_NAME + 8];
    if (coverage_full(&f->have)) return;
    assembly_coverage(f, &taken);
    struct task t = {.frame = f->number, .id = f->next_id, .to = -1};
    snprintf(job, sizeof job, "job=%s", f->job);
    wire_frame(&b, f->number, f->have.w, f->have.h, job);
    for (uint64_t p = 0; coverage_missing(&taken, &p, &t.at); t.id++) {
        wire_task(&b, &t);
        put(buf_data(&b), buf_size(&b));
        buf_consume(&b, buf_size(&b));
    }
    coverage_free(&taken);
    buf_free(&b);
}

/* Handles all complete records, up to a hello of another format. */
static bool take_records(struct intake *in, struct decoder *d, const struct log_reader *reader)
{
    struct record r;
    for (enum wire_result got; (got = wire_next(d, &r)) != WIRE_MORE;) {
        if (got != WIRE_RECORD) continue;
        if (!rec_ours(&r, in->why)) return false;
        in->good++;
        reader->record(reader->ctx, &r);
    }
    return true;
}

int log_read(struct intake *in, int fd, const char *name, const struct log_reader *reader)
{
    struct decoder d = {.upward = true};
    ptrdiff_t n;
    bool ours = true;
    log_sources_begin(&in->sources, name);
    do {
        if (reader->before) reader->before(reader->ctx, fd);
        n = read_some(fd, &d.in, READ_BYTES);
        if (n <= 0) wire_end(&d);
        ours = take_records(in, &d, reader);
    } while (n > 0 && ours);
    in->bad += d.bad;
    in->skipped += d.skipped;
    if (d.bad && ours) memcpy(in->why, d.why, sizeof in->why);
    int err = errno;
    wire_free(&d);
    errno = err;
    return !ours ? 1 : n < 0 ? -1 : 0;
}

int log_read_path(const char *path, const struct log_reader *reader, char why[LOG_WHY])
{
    struct intake in = {0};
    int fd = input_open(path);
    if (fd < 0) return -1;
    int result = log_read(&in, fd, path, reader);
    int err = errno;
    if (result > 0) snprintf(why, LOG_WHY, "%s", in.why);
    intake_free(&in);
    close(fd);
    errno = err;
    return result < 0 ? -2 : result;
}
