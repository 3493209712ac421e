/*
 * states: the state of a renderer by generation. The loop (loop.c) counts generations and says
 * when one can be dropped. A part is freed when the last generation that shares it is dropped.
 */
#include "worker/worker_int.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The value of a part, shared by the generations that use it. */
struct shared {
    void *value;
    char hash[SHA256_TEXT]; /* of the record or file */
    char *refusal;          /* why it is not there, as it does not fit in memory; NULL: it is */
    int users;
};

/* The state of one generation. */
struct subject {
    struct shared *part[WORKER_PARTS]; /* NULL: not received yet */
    void *built;                       /* from all parts; NULL: not needed yet */
};

struct worker_states {
    const struct worker_renderer *r;
    const void *options;
    const struct worker_words *words;
    bool filed[WORKER_PARTS];             /* the part is a file */
    struct subject subjects[GENERATIONS]; /* by generation, modulo GENERATIONS */
    uint32_t latest;                      /* latest generation */
    struct subject *at;                   /* subject of the current frame */
    uint32_t w, h;                        /* of the current frame */
};

/* ---- generations ---------------------------------------------------------------------------- */

static void drop_part(const struct worker_states *s, struct subject *of, int k)
{
    struct shared *p = of->part[k];
    if (of->built) s->r->free(of->built);
    of->built = NULL;
    if (p && --p->users == 0) {
        if (p->value) s->r->part[k].free(p->value);
        free(p->value);
        free(p->refusal);
        free(p);
    }
    of->part[k] = NULL;
}

static void drop(void *ctx, uint32_t generation)
{
    struct worker_states *s = ctx;
    for (int k = 0; k < s->r->n_parts; k++) drop_part(s, &s->subjects[generation % GENERATIONS], k);
}

/* The part is not there; the reason takes its place. */
static int refuse_part(const struct worker_states *s, struct subject *of, int k, const char *why)
{
    drop_part(s, of, k);
    of->part[k] = xmalloc(1, sizeof *of->part[k]);
    *of->part[k] = (struct shared){.refusal = xstrdup(why), .users = 1};
    return 0;
}

/* Frees the replaced part first, because grids are large. */
static int take_part(struct worker_states *s, struct subject *of, int k, const char *name,
    unsigned char *bytes, size_t n, char err[WORKER_ERR])
{
    const struct worker_part *part = &s->r->part[k];
    drop_part(s, of, k);
    struct shared *p = xmalloc(1, sizeof *p);
    *p = (struct shared){.value = xcalloc(1, part->size), .users = 1};
    sha256(bytes, n, p->hash);
    if (part->read(s->options, name, bytes, n, p->value, err) == 0) {
        of->part[k] = p;
        return 0;
    }
    free(p->value);
    free(p);
    return -1;
}

/* A new generation starts with the parts of the previous one. */
static struct subject *subject_of(struct worker_states *s, uint32_t generation)
{
    struct subject *of = &s->subjects[generation % GENERATIONS],
                   *before = &s->subjects[(generation - 1) % GENERATIONS];
    if (generation == s->latest) return of;
    s->latest = generation;
    drop(s, generation);
    for (int k = 0; k < s->r->n_parts; k++)
        if ((of->part[k] = before->part[k]) != NULL) of->part[k]->users++;
    return of;
}

/* ---- the operations of the loop ------------------------------------------------------------- */

/* The kinds of records that are taken: "`grid` or `spec`". */
static void print_taken(const struct worker_states *s, char text[WORKER_ERR])
{
    size_t n = 0;
    *text = '\0';
    for (int k = 0; k < s->r->n_parts; k++)
        if (!s->filed[k])
            n += (size_t)snprintf(
                text + n, WORKER_ERR - n, "%s`%s`", n ? " or " : "", rec_name(s->r->part[k].kind));
    if (!n)
        snprintf(text, WORKER_ERR, "no state records, because %s",
            s->r->n_parts ? "all state is in files" : "the renderer has no state");
}

static int take_state(void *ctx, uint32_t generation, enum rec_kind kind, unsigned char *body,
    size_t n, char err[WORKER_ERR])
{
    struct worker_states *s = ctx;
    for (int k = 0; k < s->r->n_parts; k++)
        if (s->r->part[k].kind == kind && !s->filed[k]) {
            struct subject *of = subject_of(s, generation);
            return body || !n ? take_part(s, of, k, rec_name(kind), body, n, err)
                              : refuse_part(s, of, k, err);
        }
    char taken[WORKER_ERR];
    print_taken(s, taken);
    err_set(err, "record `%s`, expected %s", rec_name(kind), taken);
    return -1;
}

static double needs(
    void *ctx, enum rec_kind kind, const unsigned char *start, size_t n, size_t bytes)
{
    const struct worker_renderer *r = ((struct worker_states *)ctx)->r;
    for (int k = 0; k < r->n_parts; k++)
        if (r->part[k].kind == kind && r->part[k].needs) return r->part[k].needs(start, n, bytes);
    return 0;
}

static int ready(void *ctx, const struct frame_size *f, char err[WORKER_ERR])
{
    struct worker_states *s = ctx;
    struct subject *at = s->at = &s->subjects[f->generation % GENERATIONS];
    void *value[WORKER_PARTS] = {0};
    for (int k = 0; k < s->r->n_parts; k++) {
        const char *kind = rec_name(s->r->part[k].kind);
        if (!at->part[k] && s->r->part[k].optional) continue;
        if (!at->part[k]) {
            err_set(err, "no %s, expected a `%s` record before the first task", kind, kind);
            return -1;
        }
        if (at->part[k]->refusal) {
            err_set(err, "%s: %s", kind, at->part[k]->refusal);
            return WORKER_REFUSED;
        }
        value[k] = at->part[k]->value;
    }
    if (!at->built && s->r->check && !s->r->check(value, err)) return -1;
    if (!at->built) at->built = s->r->build(s->options, value);
    if (s->r->frame) s->r->frame(at->built, f->w, f->h);
    s->w = f->w;
    s->h = f->h;
    return 0;
}

static void job_of(const struct worker_states *s, const struct subject *of, uint32_t w, uint32_t h,
    char job[WIRE_JOB])
{
    char text[sizeof s->words->job + (SHA256_TEXT + 16) * WORKER_PARTS + 24], hash[SHA256_TEXT];
    int n = snprintf(text, sizeof text, "%s %" PRIu32 "x%" PRIu32, s->words->job, w, h);
    for (int k = 0; k < s->r->n_parts; k++)
        if (of->part[k])
            n += snprintf(text + n, sizeof text - (size_t)n, " %s=%s", rec_name(s->r->part[k].kind),
                of->part[k]->hash);
    sha256(text, (size_t)n, hash);
    snprintf(job, WIRE_JOB, "%.*s", WIRE_JOB - 1, hash);
}

static void job(void *ctx, char text[WIRE_JOB])
{
    const struct worker_states *s = ctx;
    job_of(s, s->at, s->w, s->h, text);
}

static const char *with(void *ctx) { return ((struct worker_states *)ctx)->words->with; }

static bool task(
    void *ctx, const struct frame_size *f, const struct lattice *whole, char err[WORKER_ERR])
{
    const struct worker_states *s = ctx;
    return !s->r->task || s->r->task(s->at->built, f, whole, err);
}

static void render(void *ctx, const struct lattice *at, uint64_t n0, uint32_t n, float *rgba)
{
    const struct worker_states *s = ctx;
    s->r->render(s->at->built, at, n0, n, rgba);
}

static void selftest(void *ctx, float *rgba, uint32_t *n)
{
    ((struct worker_states *)ctx)->r->selftest(rgba, n);
}

struct worker_ops worker_states_ops(const struct worker_states *s)
{
    return (struct worker_ops){
        .program = s->r->program,
        .state = take_state,
        .needs = needs,
        .drop = drop,
        .ready = ready,
        .job = job,
        .with = with,
        .task = task,
        .render = render,
        .selftest = selftest,
        .cpu_us = s->r->cpu_us,
    };
}

int worker_render(struct worker_states *s, const struct worker_options *o)
{
    struct worker_ops ops = worker_states_ops(s);
    return worker_run(&ops, o, s);
}

/* ---- files ---------------------------------------------------------------------------------- */

void worker_states_load(struct worker_states *s, int k, const char *path)
{
    char err[WORKER_ERR];
    struct buf bytes = {0};
    const char *name = strcmp(path, "-") == 0 ? rec_name(s->r->part[k].kind) : path;
    const struct worker_part *part = &s->r->part[k];
    struct stat st;
    const bool known = stat(path, &st) == 0 && S_ISREG(st.st_mode);
    if (known && !worker_fits(0, (size_t)st.st_size, false, err))
        die(ST_SYSTEM, "%s: %s", path, err);
    if (read_file(path, &bytes) != 0) die(ST_USAGE, "%s:", path);
    const size_t n = buf_size(&bytes);
    if (!worker_fits(part->needs ? part->needs(bytes.data, n, n) : 0, n, true, err))
        die(ST_SYSTEM, "%s: %s", name, err);
    if (take_part(s, s->subjects, k, name, bytes.data, buf_size(&bytes), err) != 0)
        die(ST_USAGE, "%s", err);
    s->filed[k] = true;
    buf_free(&bytes);
}

const void *worker_states_value(const struct worker_states *s, int k)
{
    return s->subjects[0].part[k] ? s->subjects[0].part[k]->value : NULL;
}

void *worker_states_built(struct worker_states *s, uint32_t w, uint32_t h)
{
    char err[WORKER_ERR];
    if (ready(s, &(struct frame_size){.w = w, .h = h}, err) != 0) die(ST_USAGE, "%s", err);
    return s->at->built;
}

void worker_states_job(const struct worker_states *s, uint32_t w, uint32_t h, char job[WIRE_JOB])
{
    job_of(s, s->subjects, w, h, job);
}

/* ---- life ----------------------------------------------------------------------------------- */

struct worker_states *worker_states_new(
    const struct worker_renderer *r, const void *options, const struct worker_words *words)
{
    struct worker_states *s = xcalloc(1, sizeof *s);
    s->r = r;
    s->options = options;
    s->words = words;
    return s;
}

void worker_states_free(struct worker_states *s)
{
    for (uint32_t i = 0; i < GENERATIONS; i++) drop(s, i);
    free(s);
}
