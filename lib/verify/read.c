/* Reading the log and the checks, in the order that verify.h states. */
#include "verify/verify.h"
#include "wire/wire.h"

#include <stdlib.h>
#include <string.h>

/* The current purpose of reading a file. */
enum phase { CHOOSE, CUT, FIRST, AGAIN };

struct reading {
    struct verify *v;
    struct verify_hosts *hosts;
    int32_t *place; /* by slot, as frame records of the run say; -1: not said */
    size_t slots;
    bool elsewhere; /* this run has a slot that is not on the only host */
    enum phase phase;
    uint32_t runs, run; /* of the log: all; begun in phase FIRST */
    float *pixels;
    const char **name; /* of the current file, for the caller */
};

/* ---- the place of a slot --------------------------------------------------------------------- */

static void begin_run(struct reading *p)
{
    p->slots = 0;
    p->elsewhere = false;
}

/* Slot numbers go up to WIRE_SLOTS_MAX. */
static int32_t *place_of(struct reading *p, int32_t slot)
{
    size_t n = (size_t)slot + 1;
    if (n > p->slots) {
        p->place = xrealloc(p->place, n, sizeof *p->place);
        memset(p->place + p->slots, -1, (n - p->slots) * sizeof *p->place);
        p->slots = n;
    }
    return &p->place[slot];
}

/* A slot announces a frame, and fan says on which host the slot is. */
static void take_host(struct reading *p, const struct record *r)
{
    char host[256];
    int32_t slot = rec_slot(r);
    if (slot < 0 || !rec_str(r, "host", host, sizeof host)) return;
    if (p->hosts->several) {
        int32_t *place = place_of(p, slot);
        if (*place < 0) *place = verify_hosts_place(p->hosts, host);
    } else if (strcmp(host, p->hosts->name[0]) != 0) p->elsewhere = true;
}

static int32_t find_place(struct reading *p, int32_t slot)
{
    if (slot < 0) return -1;
    if (p->hosts->several && (size_t)slot < p->slots && p->place[slot] >= 0) return p->place[slot];
    /* Slots of an earlier run may have been on other hosts. */
    if (p->phase == FIRST && p->run != p->runs) return -1;
    return slot < p->hosts->slots ? p->hosts->place_of[slot] : -1;
}

/* ---------------------------------------------------------------------------------------------- */

static void take_frag(struct reading *p, const struct record *r)
{
    int32_t slot = rec_slot(r), place = find_place(p, slot);
    if (p->phase == FIRST || p->phase == AGAIN) rec_pixels(r, p->pixels);
    switch (p->phase) {
    case CHOOSE: verify_choose(p->v, &r->task); break;
    case CUT: verify_cut(p->v, &r->task); break;
    case FIRST:
        if (p->run != p->runs || place < 0) slot = -1;
        verify_first(p->v, &r->task, slot, place, p->pixels);
        break;
    case AGAIN: verify_again(p->v, &r->task, slot, place, p->pixels); break;
    }
}

static void take(void *ctx, const struct record *r)
{
    struct reading *p = ctx;
    char job[WIRE_JOB];
    if (r->kind == REC_HELLO) {
        p->runs += p->phase == CHOOSE;
        p->run += p->phase == FIRST;
        begin_run(p);
    }
    if (r->kind == REC_FRAME) take_host(p, r);
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
    begin_run(p);
    return log_read_path(name, &reader, why);
}

static int read_again(struct reading *p, const char *name, char why[LOG_WHY])
{
    verify_begin(p->v);
    int failed = read_one(p, AGAIN, name, why);
    verify_end(p->v);
    return failed;
}

int verify_read(struct verify *v, struct verify_hosts *h, char *const *files, const char **name,
    char why[LOG_WHY])
{
    struct reading p = {.v = v, .hosts = h, .name = name};
    p.pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *p.pixels);
    int failed = read_one(&p, CHOOSE, files[0], why);
    if (p.elsewhere && !h->several) verify_hosts_several(h);
    for (int i = 1; files[i] && !failed; i++) failed = read_one(&p, CUT, files[i], why);
    if (!failed) verify_split(v);
    if (!failed) failed = read_one(&p, FIRST, files[0], why);
    for (int i = 1; files[i] && !failed; i++) failed = read_again(&p, files[i], why);
    free(p.pixels);
    free(p.place);
    return failed;
}
