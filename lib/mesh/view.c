/* view: the file's first usable camera, or a view in which all faces are. */
#include "mesh/mesh_int.h"

#include <assimp/version.h>

#define ROWS 512
#define SIDE_MAX 65535
#define FITTED_ANGLE 40 /* degrees */
#define MARGIN 1.05     /* of half the picture */
#define RIGHT .4        /* the eye of a fitted view is this far to the right, and upwards */
#define ABOVE .3
#define UP_SINE_MIN 1e-4 /* single precision keeps it apart from the viewing direction */

static struct vec3 centre(const struct mesh *m) { return v3_scale(v3_add(m->lo, m->hi), .5); }

static void set_resolution(struct mesh *m, double aspect)
{
    bool chosen = m->o.width != 0;
    double columns = rint(ROWS * fmin(aspect, SIDE_MAX));
    m->view.res_x = chosen ? m->o.width : (uint32_t)fmax(1, fmin(columns, SIDE_MAX));
    m->view.res_y = chosen ? m->o.height : ROWS;
}

/* ---- the file's camera ---------------------------------------------------------------------- */

/*
 * The angle of view from top to bottom, in degrees. libassimp's is from left to right, in spite of
 * its header, which says half of that. Before 5.3 that of glTF was the vertical angle times the
 * aspect ratio.
 */
static double vertical_angle(const struct mesh *m, const struct aiCamera *c)
{
    double across = (double)c->mHorizontalFOV, aspect = (double)c->mAspect;
    bool old = aiGetVersionMajor() < 5 || (aiGetVersionMajor() == 5 && aiGetVersionMinor() < 3);
    if (!(aspect > 0)) aspect = mesh_is_gltf(m) ? 1 : (double)m->view.res_x / m->view.res_y;
    if (mesh_is_gltf(m) && old) return across / aspect * 180 / PI;
    return 2 * atan(tan(across / 2) / aspect) * 180 / PI;
}

/*
 * True if libassimp's default of pi/4 stands for an angle that it did not read in a Collada file:
 * it takes that number for degrees.
 */
static bool is_angle_unread(const struct aiCamera *c)
{
    return fabs((double)c->mHorizontalFOV - PI / 4 * PI / 180) < 1e-6;
}

static bool take_camera(struct mesh *m, unsigned i)
{
    const struct aiCamera *c = m->scene->mCameras[i];
    const struct mesh_frame *f = &m->camera_places[i].frame;
    struct view *v = &m->view;
    if (is_angle_unread(c) || mesh_is_gltf1(m)) return false;
    /* A camera of glTF is placed by its node alone; before 5.3 it had the node's place as well. */
    struct vec3 position = mesh_is_gltf(m) ? v3(0, 0, 0) : mesh_vec(c->mPosition);
    struct vec3 forward = mesh_frame_vector(f, mesh_vec(c->mLookAt));
    v->up = mesh_frame_vector(f, mesh_vec(c->mUp));
    v->from = mesh_frame_point(f, position);
    double length = v3_len(forward), up = v3_len(v->up), aspect = (double)c->mAspect;
    if (!mesh_is_length(length) || !mesh_is_length(up) || !mesh_is_place(v->from)) return false;
    forward = v3_scale(forward, 1 / length);
    v->up = v3_scale(v->up, 1 / up);
    set_resolution(m, aspect > 0 ? aspect : 1);
    v->angle_deg = vertical_angle(m, c);
    /* The point looked at is as far away as the centre, and apart from the eye. */
    double away = fmax(v3_len(v3_sub(centre(m), v->from)), 1e-3 * v3_len(v->from));
    v->at = v3_mad(v->from, forward, away > 0 ? away : 1);
    return v->angle_deg >= 1e-3 && v->angle_deg <= 179.9 &&
           v3_len(v3_cross(forward, v->up)) >= UP_SINE_MIN;
}

/* ---- a view that fits ------------------------------------------------------------------------ */

struct fit {
    struct vec3 centre, right, up, forward;
    double half_w, half_h; /* of the picture at distance 1, less the margin */
    double distance;       /* from eye to centre: the least at which all corners are seen */
};

static void fit_face(void *ctx, const struct mesh_face *face)
{
    struct fit *f = ctx;
    for (uint32_t i = 0; i < face->n; i++) {
        struct vec3 q = v3_sub(face->v[i], f->centre);
        double across = fabs(v3_dot(q, f->right)) / f->half_w;
        double along = fabs(v3_dot(q, f->up)) / f->half_h;
        f->distance = fmax(f->distance, fmax(across, along) - v3_dot(q, f->forward));
    }
}

static void fit_view(struct mesh *m)
{
    struct view *v = &m->view;
    set_resolution(m, 1);
    v->up = m->o.z_up ? v3(0, 0, 1) : v3(0, 1, 0);
    struct vec3 front = m->o.z_up ? v3(0, -1, 0) : v3(0, 0, 1);
    struct vec3 to_eye = v3_mad(v3_mad(front, v3(1, 0, 0), RIGHT), v->up, ABOVE);
    struct fit f = {.centre = centre(m), .forward = v3_unit(v3_scale(to_eye, -1))};
    f.right = v3_unit(v3_cross(f.forward, v->up));
    f.up = v3_cross(f.right, f.forward);
    f.half_h = tan(FITTED_ANGLE / 2. * PI / 180) / MARGIN;
    f.half_w = f.half_h * v->res_x / v->res_y;
    f.distance = v3_len(v3_sub(m->hi, m->lo)) * .51; /* outside the bounds */
    mesh_faces_each(m, NULL, fit_face, &f);
    v->at = f.centre;
    v->from = v3_mad(f.centre, f.forward, -f.distance);
    v->angle_deg = FITTED_ANGLE;
}

void mesh_view_find(struct mesh *m)
{
    unsigned n = m->scene->mNumCameras, i = 0;
    set_resolution(m, 1);
    while (i < n && !take_camera(m, i)) i++;
    m->loss[LOSS_BAD_CAMERAS].n = i + m->viewpoints;
    if (i < n) m->loss[LOSS_CAMERAS].n = n - i - 1;
    else fit_view(m);
}
