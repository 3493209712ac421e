/* Reading the log and the checks: pieces and their results. */
#include "verify/verify.h"

#include <stdlib.h>
#include <string.h>

enum { SEED_CHOICE = 0, SEED_SUM = 1 }; /* each kind of random number has its own */

struct reading {
    struct verify *v;
    struct log_sources from;
    bool check;     /* or the log */
    bool elsewhere; /* the log's last run has a slot that is not on the first host */
    float *pixels;
};

static int32_t host_named(struct verify *v, const char *name)
{
    for (int32_t i = 0; i < v->hosts; i++)
        if (strcmp(v->host[i], name) == 0) return i;
    v->host = xrealloc(v->host, (size_t)v->hosts + 1, sizeof *v->host);
    v->host[v->hosts] = xstrdup(name);
    return v->hosts++;
}

void verify_init(
    struct verify *v, uint64_t seed, double fraction, const char *const *name, int32_t slots)
{
    *v = (struct verify){.seed = seed, .fraction = fraction, .slots = slots};
    v->host_of = xmalloc((size_t)slots, sizeof *v->host_of);
    v->place = xcalloc((size_t)slots, sizeof *v->place);
    for (int32_t k = 0; k < slots; k++) v->host_of[k] = host_named(v, name[k]);
    v->several = v->hosts > 1;
    frames_init(&v->frames, sizeof(struct verify_frame));
}

void verify_free(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) free(v->piece[i].by);
    for (int32_t i = 0; i < v->hosts; i++) free(v->host[i]);
    free(v->piece);
    free(v->host);
    free(v->host_of);
    free(v->place);
    frames_free(&v->frames);
    *v = (struct verify){0};
}

/* ---- results --------------------------------------------------------------------------------- */

/* Linear in the bits, under secret keys (J. L. Carter, M. N. Wegman, "Universal classes of hash
 * functions", JCSS 18, 1979): other pixels have the same sum with a probability of 2^-32. */
static uint64_t sum_of(uint64_t seed, const float *pixels, uint64_t n)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < 4 * n; i++) {
        uint32_t word;
        memcpy(&word, pixels + i, sizeof word);
        sum += rng_u64(seed + SEED_SUM, i) * word;
    }
    return sum;
}

/* The place is a host for now, or -1 if no frame record says which. */
static struct verify_result result_of(struct reading *in, const struct record *r)
{
    const uint16_t source = log_source_of(&in->from, r);
    const struct log_source *from = &in->from.at[source];
    struct verify_result got = {.slot = rec_slot(r), .run = from->run};
    got.place = *from->host ? host_named(in->v, from->host) : -1;
    rec_pixels(r, in->pixels);
    got.sum = sum_of(in->v->seed, in->pixels, lattice_count(&r->task.at));
    return got;
}

/* Slots of an earlier run may have been on other hosts than now. */
static void find_place(const struct verify *v, struct verify_result *got, bool earlier)
{
    const bool now = !earlier && got->slot >= 0 && got->slot < v->slots;
    if (!v->several) got->place = now ? got->slot : -1;
    else if (got->place < 0) got->place = now ? v->host_of[got->slot] : -1;
    if (earlier || got->place < 0) got->slot = -1;
}

/* A slot that sends the same again adds nothing. */
static void add_result(struct verify_piece *p, const struct verify_result *got)
{
    for (uint32_t i = 0; i < p->n; i++)
        if (p->by[i].slot == got->slot && p->by[i].place == got->place && p->by[i].sum == got->sum)
            return;
    p->by = xrealloc(p->by, (size_t)p->n + 1, sizeof *p->by);
    p->by[p->n++] = *got;
}

/* ---- records --------------------------------------------------------------------------------- */

static void take_frame(struct reading *in, const struct record *r)
{
    struct verify *v = in->v;
    const struct log_source *from;
    uint16_t source = log_source_of(&in->from, r);
    if (in->check) return;
    from = &in->from.at[source];
    in->elsewhere = in->elsewhere || (*from->host && strcmp(from->host, v->host[0]) != 0);
    if (frames_find(&v->frames, r->task.frame)) return;
    struct verify_frame *f =
        frames_extra(&v->frames, frames_set(&v->frames, r->task.frame, r->frame_w, r->frame_h));
    if (!rec_str(r, "job", f->job, sizeof f->job)) *f->job = '\0';
}

/* Chooses a fragment of the log, or not. */
static void choose(struct reading *in, const struct record *r)
{
    struct verify *v = in->v;
    const struct frame_size *size = frames_find(&v->frames, r->task.frame);
    if (rng_unit(v->seed + SEED_CHOICE, v->seen++) >= v->fraction) return;
    if (!size || !lattice_valid(&r->task.at, size->w, size->h)) return;
    if (v->n == UINT32_MAX / 2) die(ST_SYSTEM, "more than %u pieces", v->n);
    if (v->n == v->cap) {
        v->cap = v->cap ? v->cap * 2 : 64;
        v->piece = xrealloc(v->piece, v->cap, sizeof *v->piece);
    }
    struct verify_piece *p = &v->piece[v->n++];
    *p = (struct verify_piece){.at = r->task.at, .frame = r->task.frame, .asked = -1, .failed = -1};
    const struct verify_result got = result_of(in, r);
    add_result(p, &got);
    struct verify_frame *f = frames_extra(&v->frames, size);
    *(f->last ? &v->piece[f->last - 1].next : &f->first) = v->n;
    f->last = v->n;
}

static void take_check(struct reading *in, const struct record *r)
{
    struct verify_piece *p = r->task.id < in->v->n ? &in->v->piece[r->task.id] : NULL;
    if (!p || p->frame != r->task.frame || memcmp(&p->at, &r->task.at, sizeof p->at) != 0) return;
    struct verify_result got = result_of(in, r);
    find_place(in->v, &got, false);
    if (got.place >= 0) add_result(p, &got);
}

static void take(void *ctx, const struct record *r)
{
    struct reading *in = ctx;
    if (r->kind == REC_HELLO) {
        log_sources_begin(&in->from, NULL);
        in->elsewhere = false;
    }
    if (r->kind == REC_FRAME) take_frame(in, r);
    if (r->kind == REC_FRAG) (in->check ? take_check : choose)(in, r);
}

/* ---- files ----------------------------------------------------------------------------------- */

static void end_log(struct reading *in)
{
    struct verify *v = in->v;
    v->several = v->several || in->elsewhere;
    for (uint32_t i = 0; i < v->n; i++)
        find_place(v, v->piece[i].by, v->piece[i].by->run != in->from.run);
    in->check = true;
}

static void begin_check(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) v->piece[i].asked = verify_next(v, &v->piece[i]);
}

static void end_check(struct verify *v)
{
    for (uint32_t i = 0; i < v->n; i++) {
        struct verify_piece *p = &v->piece[i];
        if (p->asked < 0) continue;
        const int32_t at = verify_place(v, p->asked);
        p->failed = verify_computed(p, at) ? -1 : at;
        v->place[at].asked++;
        v->place[at].made += p->failed < 0;
    }
    for (int32_t k = 0; k < v->slots; k++) {
        struct verify_place *place = &v->place[k];
        place->mute = place->mute || (place->asked && !place->made);
        place->asked = place->made = 0;
    }
}

int verify_read(struct verify *v, char *const *files, const char **name, char why[LOG_WHY])
{
    struct reading in = {.v = v};
    const struct log_reader reader = {.record = take, .ctx = &in};
    in.pixels = xmalloc((size_t)WIRE_FRAG_PIXELS_MAX * 4, sizeof *in.pixels);
    int failed = 0;
    for (int i = 0; files[i] && !failed; i++) {
        *name = files[i];
        log_sources_begin(&in.from, NULL);
        if (in.check) begin_check(v);
        failed = log_read_path(files[i], &reader, why);
        if (in.check) end_check(v);
        else end_log(&in);
    }
    log_sources_free(&in.from);
    free(in.pixels);
    return failed;
}
