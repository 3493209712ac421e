/* Records into an assembly. */
#include "log/log.h"

#include <stdlib.h>
#include <string.h>

#define OPEN_BYTES_MAX                                                                             \
    (UINT64_C(5) << 30) /* pixels and bitmaps of the frames that are open at once */
#define READ_BYTES (1 << 18)

/* A shell takes these for nothing but parts of a word. */
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

/* Where fan says it came from; the one worker of a plain pipeline has no name. */
static void worker_of(const struct record *r, char name[ASSEMBLY_NAME])
{
    if (!rec_str(r, "w", name, ASSEMBLY_NAME)) *name = '\0';
}

enum assembly_verdict intake_frame(
    struct intake *in, const struct record *r, char worker[ASSEMBLY_NAME])
{
    char job[ASSEMBLY_NAME];
    worker_of(r, worker);
    if (!rec_str(r, "job", job, sizeof job)) {
        in->unexpected++;
        return ASSEMBLY_UNDECLARED;
    }
    intake_note(in, r);
    return assembly_declare(&in->parts, r->task.frame, r->frame_w, r->frame_h, job, worker);
}

/* Ids of new tasks must not be those of old ones. */
static struct assembly_frame *note_id(struct intake *in, const struct task *t)
{
    struct assembly_frame *f = assembly_find(&in->parts, t->frame);
    if (f && t->id >= f->next_id && t->id < UINT32_MAX) f->next_id = t->id + 1;
    return f;
}

static struct assembly_frame *take_frag(struct intake *in, const struct record *r)
{
    char worker[ASSEMBLY_NAME];
    worker_of(r, worker);
    if (in->pixels) rec_pixels(r, in->pixels);
    if (assembly_commit(&in->parts, r->task.frame, worker, &r->task.at, in->pixels) !=
        ASSEMBLY_TAKEN)
        return NULL;
    struct assembly_frame *f = note_id(in, &r->task);
    return f->released || !coverage_full(&f->have) ? NULL : f;
}

struct assembly_frame *intake_record(struct intake *in, const struct record *r)
{
    switch (r->kind) {
    case REC_FRAG: return take_frag(in, r);
    case REC_DONE: note_id(in, &r->task); return NULL;
    case REC_HELLO: intake_note(in, r); return NULL;
    default:
        /* What flows down, or between the nodes of a ring, has no place here. */
        in->unexpected += r->kind < REC_HELLO || r->kind > REC_GONE;
        return NULL;
    }
}

void intake_missing(const struct assembly_frame *f, void (*put)(const void *p, size_t n))
{
    struct buf b = {0};
    struct coverage taken;
    if (coverage_full(&f->have)) return;
    assembly_coverage(f, &taken);
    struct task t = {.frame = f->number, .id = f->next_id, .to = -1};
    wire_frame(&b, f->number, f->have.w, f->have.h, NULL);
    for (uint64_t p = 0; coverage_missing(&taken, &p, &t.at); t.id++) {
        wire_task(&b, &t);
        put(buf_data(&b), buf_size(&b));
        buf_consume(&b, buf_size(&b));
    }
    coverage_free(&taken);
    buf_free(&b);
}

int log_read(struct intake *in, int fd, const struct log_reader *reader)
{
    struct decoder d = {.upward = true};
    ptrdiff_t n;
    do {
        if (reader->before) reader->before(reader->ctx, fd);
        n = read_some(fd, &d.in, READ_BYTES);
        if (n <= 0) wire_end(&d);
        struct record r;
        for (enum wire_result got; (got = wire_next(&d, &r)) != WIRE_MORE;)
            if (got == WIRE_RECORD) {
                in->good++;
                reader->record(reader->ctx, &r);
            }
    } while (n > 0);
    in->bad += d.bad;
    in->skipped += d.skipped;
    if (d.bad) memcpy(in->why, d.why, sizeof in->why);
    wire_free(&d);
    return n < 0 ? -1 : 0;
}
