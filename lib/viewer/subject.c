/* What is looked at: a grid of several, and the specification that the user changes. */
#include "viewer/viewer_int.h"
#include "volume/volume.h"

#include <stdlib.h>
#include <string.h>

/* ---- files ----------------------------------------------------------------------------------- */

static void find_range(struct subject *s)
{
    const size_t n = (size_t)s->grid.n[0] * s->grid.n[1] * s->grid.n[2];
    s->least = HUGE_VAL, s->most = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        const double v = (double)s->grid.value[i];
        if (v < s->least) s->least = v;
        if (v > s->most) s->most = v;
    }
}

bool subject_step(struct subject *s, size_t at, char err[ERR_BYTES])
{
    struct grid g;
    char shown[ERR_PATH], why[ERR_BYTES];
    if (grid_load(s->job.path[at], &g, err) != 0) return false;
    if (!volume_check(&g, &s->spec, why)) {
        grid_free(&g);
        return err_set(err, "%s: %s", err_path(shown, s->job.path[at]), why);
    }
    grid_free(&s->grid);
    s->grid = g;
    s->at = at;
    s->new_grid = true;
    find_range(s);
    return true;
}

static bool load_spec(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES])
{
    struct buf b = {0};
    if (!s->job.starter) return spec_load(s->job.path[s->job.grids], &s->spec, err) == 0;
    bool good =
        job_starter(*s->job.path, o->w, o->h, false, &b, err) &&
        spec_read(*s->job.path, (const char *)buf_data(&b), buf_size(&b), &s->spec, err) == 0;
    buf_free(&b);
    return good;
}

bool subject_open(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES])
{
    if (!job_of(&s->job, o->files, o->n_files, err)) return false;
    char shown[ERR_PATH];
    if (s->job.what != JOB_GRIDS)
        return err_set(err, "%s: is no grid, expected one", err_path(shown, o->files[0]));
    if (!s->job.starter && s->job.n > s->job.grids + 1)
        return err_set(err, "%s: is a second specification, expected one",
            err_path(shown, s->job.path[s->job.grids + 1]));
    if (!load_spec(s, o, err) || !subject_step(s, 0, err)) return false;
    if (o->w) s->spec.w = o->w, s->spec.h = o->h;
    s->home = subject_camera(s);
    s->backed = s->spec.backed;
    memcpy(s->background, s->spec.background, sizeof s->background);
    memcpy(s->light, s->spec.light, sizeof s->light);
    if (!s->spec.lit) memcpy(s->light, s->spec.from, sizeof s->light);
    return true;
}

void subject_free(struct subject *s)
{
    grid_free(&s->grid);
    spec_free(&s->spec);
}

void subject_text(const struct subject *s, struct buf *out) { spec_write(&s->spec, out); }

static void put_state(struct down_queue *to, enum rec_kind kind, const struct buf *body)
{
    struct buf record = {0};
    wire_state(&record, kind, buf_data(body), buf_size(body));
    struct blob *b = blob_new(&record);
    down_share(to, b);
    blob_drop(b);
}

void subject_state(struct subject *s, struct down_queue *to)
{
    struct buf body = {0};
    if (s->new_grid) {
        if (read_file(s->job.path[s->at], &body) != 0) die(ST_USAGE, "%s:", s->job.path[s->at]);
        put_state(to, REC_GRID, &body);
        buf_consume(&body, buf_size(&body));
        s->new_grid = false;
    }
    subject_text(s, &body);
    wire_state(&to->bytes, REC_SPEC, buf_data(&body), buf_size(&body));
    buf_free(&body);
}

/* ---- changes --------------------------------------------------------------------------------- */

/* Takes the specification in b, if it is one, and frees b. */
static bool adopt(struct subject *s, struct buf *b, char err[ERR_BYTES])
{
    struct spec next;
    bool good = spec_read("view", (const char *)buf_data(b), buf_size(b), &next, err) == 0;
    buf_free(b);
    if (!good) return false;
    spec_free(&s->spec);
    s->spec = next;
    return true;
}

/* Takes `next`, which has the lists of the present one. */
static bool try(struct subject *s, const struct spec *next, char err[ERR_BYTES])
{
    struct buf b = {0};
    spec_write(next, &b);
    return adopt(s, &b, err);
}

struct look_camera subject_camera(const struct subject *s)
{
    const struct spec *p = &s->spec;
    return (struct look_camera){v3_of(p->from), v3_of(p->at), v3_of(p->up), p->angle};
}

static void put_vec(double to[3], struct vec3 v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

bool subject_aim(struct subject *s, const struct look_camera *c, char err[ERR_BYTES])
{
    struct spec next = s->spec;
    put_vec(next.from, c->from);
    put_vec(next.at, c->at);
    put_vec(next.up, c->up);
    next.angle = c->angle_deg;
    return try(s, &next, err);
}

bool subject_recolour(struct subject *s, const char *palette, char err[ERR_BYTES])
{
    struct buf b = {0};
    spec_write_in(&s->spec, palette, &b);
    return adopt(s, &b, err);
}

bool subject_light(struct subject *s, char err[ERR_BYTES])
{
    struct spec next = s->spec;
    next.lit = !next.lit;
    memcpy(next.light, s->light, sizeof next.light);
    return try(s, &next, err);
}

/* ---- surfaces -------------------------------------------------------------------------------- */

static size_t surfaces(const struct spec *p)
{
    return p->n_isos + p->n_slices + (p->clipped ? 6 : 0);
}

/* The surface of this number: its kind, and its number among those. */
static enum surface surface_of(const struct spec *p, size_t i, size_t *k)
{
    *k = i;
    if (i < p->n_isos) return SURFACE_ISO;
    *k = i - p->n_isos;
    if (*k < p->n_slices) return SURFACE_SLICE;
    *k -= p->n_slices;
    return SURFACE_CLIP;
}

static void name_surface(const struct subject *s, char said[ERR_BYTES])
{
    static const char *const ends[] = {"from", "to"};
    const struct spec *p = &s->spec;
    size_t k;
    switch (surface_of(p, s->surface, &k)) {
    case SURFACE_ISO: err_set(said, "iso %.6g", p->iso[k].s); return;
    case SURFACE_SLICE:
        err_set(said, "slice %c %.6g", "xyz"[p->slice[k].axis], p -> slice[k].at);
        return;
    case SURFACE_CLIP:
        err_set(said, "clip %c %s %.6g", "xyz"[k / 2], ends[k % 2], p -> clip[k / 2][k % 2]);
    }
}

void subject_select(struct subject *s, char said[ERR_BYTES])
{
    const size_t n = surfaces(&s->spec);
    if (!n) {
        err_set(said, "the specification has no iso, slice or clip");
        return;
    }
    s->surface = (s->surface + 1) % n;
    name_surface(s, said);
}

/* The place of the surface, in *next, which has its own lists, and its range. */
static double *place_of(
    const struct subject *s, struct spec *next, size_t i, double *from, double *to)
{
    size_t k;
    int axis = 0;
    double *place = NULL;
    switch (surface_of(next, i, &k)) {
    case SURFACE_ISO: *from = s->least, *to = s->most; return &next->iso[k].s;
    case SURFACE_SLICE: axis = next->slice[k].axis, place = &next->slice[k].at; break;
    case SURFACE_CLIP: axis = (int)k / 2, place = &next->clip[axis][k % 2];
    }
    *from = s->grid.at[axis][0];
    *to = s->grid.at[axis][s->grid.n[axis] - 1];
    return place;
}

/* Sorting may have given it another number. */
static void find_surface(struct subject *s, double value)
{
    const size_t n = surfaces(&s->spec), before = s->surface;
    for (size_t i = 0; i < n; i++) {
        double from, to;
        s->surface = (before + i) % n;
        if (*place_of(s, &s->spec, s->surface, &from, &to) == value) return;
    }
}

bool subject_shift(struct subject *s, double part, char said[ERR_BYTES])
{
    struct buf b = {0};
    double from, to;
    if (!surfaces(&s->spec)) return subject_select(s, said), false;
    double *place = place_of(s, &s->spec, s->surface, &from, &to);
    const double before = *place, after = fmin(fmax(before + part * (to - from), from), to);
    *place = after;
    spec_write(&s->spec, &b);
    *place = before;
    if (!adopt(s, &b, said)) return false;
    find_surface(s, after);
    name_surface(s, said);
    return true;
}
