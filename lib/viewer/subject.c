/* What is looked at: a grid of several, and the specification that the user changes; or a scene,
 * and its view. */
#include "scene/scene.h"
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

static bool step_grid(struct subject *s, size_t at, char err[ERR_BYTES])
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
    s->new_file = true;
    find_range(s);
    return true;
}

static bool load_spec(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES])
{
    struct buf b = {0};
    if (!s->job.starter) return spec_load(s->job.path[s->job.subjects], &s->spec, err) == 0;
    bool good =
        job_starter(*s->job.path, o->w, o->h, &b, err) &&
        spec_read(*s->job.path, (const char *)buf_data(&b), buf_size(&b), &s->spec, err) == 0;
    buf_free(&b);
    return good;
}

static bool open_grids(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES])
{
    return load_spec(s, o, err) && step_grid(s, 0, err);
}

static void put_vec(double to[3], struct vec3 v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

static void take_view(struct subject *s, const struct view *v)
{
    put_vec(s->spec.from, v->from);
    put_vec(s->spec.at, v->at);
    put_vec(s->spec.up, v->up);
    s->spec.angle = v->angle_deg;
    s->hither = v->hither;
}

/* Reads a scene of which only the view is kept: the command gets the file. */
static bool step_scene(struct subject *s, size_t at, struct view *view, char err[ERR_BYTES])
{
    struct buf b;
    struct scene scene;
    const char *path = s->job.path[at];
    if (!load_file(path, &b, err)) return false;
    const bool good = nff_read(path, (const char *)buf_data(&b), buf_size(&b), &scene, err) == 0;
    buf_free(&b);
    if (!good) return false;
    *view = scene.view;
    scene_free(&scene);
    s->at = at;
    return s->scene = s->new_file = true;
}

bool subject_step(struct subject *s, size_t at, char err[ERR_BYTES])
{
    struct view view;
    return s->scene ? step_scene(s, at, &view, err) : step_grid(s, at, err);
}

/* With the view of the scene, or of a file. */
static bool open_scene(struct subject *s, char err[ERR_BYTES])
{
    struct buf b;
    struct view view;
    if (!step_scene(s, 0, &view, err)) return false;
    take_view(s, &view);
    s->spec.w = view.res_x, s->spec.h = view.res_y;
    if (s->job.n == s->job.subjects) return true;
    const char *path = s->job.path[s->job.subjects];
    if (!load_file(path, &b, err)) return false;
    const bool good =
        nff_read_view(path, (const char *)buf_data(&b), buf_size(&b), &view, err) == 0;
    buf_free(&b);
    if (!good) return false;
    take_view(s, &view);
    if (view.res_x) s->spec.w = view.res_x, s->spec.h = view.res_y;
    return true;
}

bool subject_open(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES])
{
    char shown[ERR_PATH];
    if (!job_of(&s->job, o->files, o->n_files, err)) return false;
    if (job_foreign(&s->job))
        return err_set(err, "%s: is a scene of %s, expected grids or an NFF scene",
            err_path(shown, *o->files), s->job.what == JOB_POV ? "POV-Ray" : "Blender");
    if (!s->job.starter && s->job.n > s->job.subjects + 1)
        return err_set(err, "%s: is a second view, expected one",
            err_path(shown, s->job.path[s->job.subjects + 1]));
    if (!(s->job.what == JOB_GRIDS ? open_grids(s, o, err) : open_scene(s, err))) return false;
    if (o->w) s->spec.w = o->w, s->spec.h = o->h;
    s->home = subject_camera(s);
    s->backed = s->spec.backed;
    memcpy(s->light, s->spec.lit ? s->spec.light : s->spec.from, sizeof s->light);
    return true;
}

void subject_free(struct subject *s)
{
    grid_free(&s->grid);
    spec_free(&s->spec);
}

static void put_words(struct buf *out, const char *word, const double *v, int n)
{
    char text[32];
    buf_printf(out, "%s", word);
    for (int i = 0; i < n; i++) {
        print_real(text, v[i], 6);
        buf_printf(out, " %s", text);
    }
    buf_printf(out, "\n");
}

void subject_text(const struct subject *s, struct buf *out)
{
    const struct spec *p = &s->spec;
    if (!s->scene) {
        spec_write(p, out);
        return;
    }
    put_words(out, "from", p->from, 3);
    put_words(out, "at", p->at, 3);
    put_words(out, "up", p->up, 3);
    put_words(out, "angle", &p->angle, 1);
    put_words(out, "hither", &s->hither, 1);
    buf_printf(out, "resolution %u %u\n", p->w, p->h);
}

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
    if (s->new_file) {
        if (read_file(s->job.path[s->at], &body) != 0) die(ST_USAGE, "%s:", s->job.path[s->at]);
        put_state(to, s->scene ? REC_SCENE : REC_GRID, &body);
        buf_consume(&body, buf_size(&body));
        s->new_file = false;
    }
    subject_text(s, &body);
    wire_state(&to->bytes, s->scene ? REC_VIEW : REC_SPEC, buf_data(&body), buf_size(&body));
    buf_free(&body);
}

/* ---- changes --------------------------------------------------------------------------------- */

static bool adopt_view(struct subject *s, const struct buf *b, char err[ERR_BYTES])
{
    struct view v;
    if (nff_read_view("view", (const char *)buf_data(b), buf_size(b), &v, err) != 0) return false;
    take_view(s, &v);
    return true;
}

static bool adopt_spec(struct subject *s, const struct buf *b, char err[ERR_BYTES])
{
    struct spec next;
    if (spec_read("view", (const char *)buf_data(b), buf_size(b), &next, err) != 0) return false;
    spec_free(&s->spec);
    s->spec = next;
    return true;
}

bool subject_adopt(struct subject *s, struct buf *b, char err[ERR_BYTES])
{
    const bool good = s->scene ? adopt_view(s, b, err) : adopt_spec(s, b, err);
    buf_free(b);
    return good;
}

/* Takes `next`, which has the lists of the present one. */
static bool try(struct subject *s, const struct spec *next, char err[ERR_BYTES])
{
    const struct spec before = s->spec;
    struct buf b = {0};
    s->spec = *next;
    subject_text(s, &b);
    s->spec = before;
    return subject_adopt(s, &b, err);
}

struct look_camera subject_camera(const struct subject *s)
{
    const struct spec *p = &s->spec;
    return (struct look_camera){v3_of(p->from), v3_of(p->at), v3_of(p->up), p->angle};
}

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
    if (s->scene) return err_set(err, "a scene has no palette");
    spec_write_in(&s->spec, palette, &b);
    return subject_adopt(s, &b, err);
}

bool subject_light(struct subject *s, char err[ERR_BYTES])
{
    struct spec next = s->spec;
    if (s->scene) return err_set(err, "a scene has its own lights");
    next.lit = !next.lit;
    memcpy(next.light, s->light, sizeof next.light);
    return try(s, &next, err);
}
