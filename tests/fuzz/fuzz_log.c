/*
 * Whatever a log holds: counted pixels are there, missing ones are missing. A run that is appended
 * to the log and renders only the missing pixels completes every picture; so does a run that
 * renders the rows left by partition -r.
 */
#include "log/log.h"
#include "mend.h"

#include <sys/mman.h>
#include <unistd.h>

#define PIXELS_MOST (1 << 16) /* of all frames: larger pictures take time and find nothing */

static uint64_t declared_pixels(const uint8_t *data, size_t size)
{
    struct decoder d = {.upward = true};
    struct record r;
    uint64_t n = 0;
    wire_feed(&d, data, size);
    wire_end(&d);
    for (enum wire_result got; (got = wire_next(&d, &r)) != WIRE_MORE;)
        if (got == WIRE_RECORD && r.kind == REC_FRAME) n += (uint64_t)r.frame_w * r.frame_h;
    wire_free(&d);
    return n;
}

static struct log_file log_of(const void *data, size_t size)
{
    struct log_file l = {.path = "log", .fd = memfd_create("log", MFD_CLOEXEC)};
    MUST(l.fd >= 0 && write_full(l.fd, data, size) == 0);
    return l;
}

static void check_counts(const struct intake *in)
{
    uint64_t all = 0;
    for (uint32_t i = 0; i < in->parts.n_frames; i++) {
        const struct assembly_frame *f = in->parts.frames[i];
        struct coverage c;
        uint64_t n = 0;
        assembly_coverage(f, &c);
        for (uint64_t p = 0; p < (uint64_t)c.w * c.h; p++) n += coverage_has(&c, p);
        MUST(n == c.done && n == f->have.done && f->released == coverage_full(&c));
        all += n;
        coverage_free(&c);
    }
    MUST(all == in->parts.done_px);
}

/* The pixels of t, in pieces that one record can have. */
static void render(struct buf *run, const struct task *t, const struct assembly_frame *f)
{
    static float rgba[4 * WIRE_FRAG_PIXELS_MAX];
    for (uint64_t n0 = 0, n = lattice_count(&t->at); n0 < n;) {
        struct lattice at = lattice_cut(&t->at, f->have.w, n0, WIRE_FRAG_PIXELS_MAX);
        wire_frag(run, t, &at, f->job, rgba);
        n0 += lattice_count(&at);
    }
}

static struct buf missing;
static void lack(const void *p, size_t n) { buf_append(&missing, p, n); }

/* gather -m of f, rendered. */
static void render_missing(struct buf *run, const struct assembly_frame *f)
{
    struct decoder d = {0};
    struct record r;
    uint64_t n = 0;
    intake_missing(f, lack);
    wire_feed(&d, buf_data(&missing), buf_size(&missing));
    while (wire_next(&d, &r) == WIRE_RECORD) {
        if (r.kind != REC_TASK) continue;
        MUST(lattice_valid(&r.task.at, f->have.w, f->have.h));
        n += lattice_count(&r.task.at);
        render(run, &r.task, f);
    }
    MUST(d.bad == 0 && n + f->have.done == (uint64_t)f->have.w * f->have.h);
    wire_free(&d);
    buf_consume(&missing, buf_size(&missing));
}

/* partition -r of f, rendered. */
static void render_rows(struct buf *run, const struct assembly_frame *f)
{
    struct coverage have;
    assembly_coverage(f, &have);
    for (uint32_t y = 0; y < f->have.h; y++) {
        struct task t = {.frame = f->number, .id = y, .at = {0, y, f->have.w, 1, 1, 1}, .to = -1};
        if (coverage_trim(&have, &t.at)) render(run, &t, f);
    }
    coverage_free(&have);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (declared_pixels(data, size) > PIXELS_MOST) return 0;
    struct buf run = {0};
    struct log_file l = log_of(data, size);
    struct intake in;
    int odd = log_survey(&l, &in);
    MUST(odd == 0 || (odd == 1 && strstr(in.why, ", expected ")));
    check_counts(&in);
    if (odd) { /* no run appends to it */
        intake_free(&in);
        log_close(&l);
        return 0;
    }
    buf_append(&run, data, size);
    wire_hello(&run, "fuzzer", "0", 1, 0, 1);
    for (uint32_t i = 0; i < in.parts.n_frames; i++) {
        const struct assembly_frame *f = in.parts.frames[i];
        const struct frame_size said = {.frame = f->number, .w = f->have.w, .h = f->have.h};
        wire_job(&run, &said, f->job, NULL);
        if (size % 2) render_missing(&run, f);
        else render_rows(&run, f);
    }
    bool any = in.parts.n_frames > 0;
    intake_free(&in);
    log_close(&l);
    l = log_of(buf_data(&run), buf_size(&run));
    MUST(log_survey(&l, &in) == 0);
    MUST(!any || assembly_whole(&in.parts));
    intake_free(&in);
    log_close(&l);
    buf_free(&run);
    return 0;
}
