/* Reading the log and the checks, in the order that verify.h states. */
#include "verify/verify.h"
#include "wire/wire.h"

#include <stdlib.h>

/* The current purpose of reading a file. */
enum phase { CHOOSE, CUT, FIRST, AGAIN };

struct reading {
    struct verify *v;
    enum phase phase;
    uint32_t runs, run; /* of the log: all; begun in phase FIRST */
    float *pixels;
    const char **name; /* of the current file, for the caller */
};

static void take_frag(struct reading *p, const struct record *r)
{
    int32_t slot = rec_slot(r);
    if (p->phase == FIRST || p->phase == AGAIN) rec_pixels(r, p->pixels);
    switch (p->phase) {
    case CHOOSE: verify_choose(p->v, &r->task); break;
    case CUT: verify_cut(p->v, &r->task); break;
    case FIRST: /* slots of an earlier run may have been on other hosts */
        verify_first(p->v, &r->task, p->run == p->runs ? slot : -1, p->pixels);
        break;
    case AGAIN: verify_again(p->v, &r->task, slot, p->pixels); break;
    }
}

static void take(void *ctx, const struct record *r)
{
    struct reading *p = ctx;
    char job[64];
    if (r->kind == REC_HELLO) {
        p->runs += p->phase == CHOOSE;
        p->run += p->phase == FIRST;
    }
    if (r->kind == REC_FRAME && p->phase == CHOOSE)
        verify_frame(p->v, r->task.frame, r->frame_w, r->frame_h,
            rec_str(r, "job", job, sizeof job) ? job : NULL);
    if (r->kind == REC_FRAG) take_frag(p, r);
}

static int read_one(struct reading *p, enum phase phase, const char *name, char why[LOG_WHY])
{
    const struct log_reader reader = {.record = take, .ctx = p};
    p->phase = phase;
    *p->name = name;
    return log_read_path(name, &reader, why);
}

static int read_again(struct reading *p, const char *name, char why[LOG_WHY])
{
    verify_begin(p->v);
    int failed = read_one(p, AGAIN, name, why);
    verify_end(p->v);
    return failed;
}

int verify_read(struct verify *v, char *const *files, const char **name, char why[LOG_WHY])
{
    struct reading p = {.v = v, .name = name};
    p.pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *p.pixels);
    int failed = read_one(&p, CHOOSE, files[0], why);
    for (int i = 1; files[i] && !failed; i++) failed = read_one(&p, CUT, files[i], why);
    if (!failed) verify_split(v);
    if (!failed) failed = read_one(&p, FIRST, files[0], why);
    for (int i = 1; files[i] && !failed; i++) failed = read_again(&p, files[i], why);
    free(p.pixels);
    return failed;
}
