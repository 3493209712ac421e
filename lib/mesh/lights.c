/* lights: the file's lights as point lights that do not fade, or two lights beside the eye. */
#include "mesh/mesh_int.h"

#define FAR 1e4    /* distance of directional lights, in diagonals of the bounds */
#define KEY_FAR 10 /* of the bright light in a scene without lights */
#define KEY_RIGHT (-.6)
#define KEY_ABOVE .8
#define INTENSITY_MAX 1e6

static struct vec3 centre(const struct mesh *m) { return v3_scale(v3_add(m->lo, m->hi), .5); }
static double diagonal(const struct mesh *m) { return v3_len(v3_sub(m->hi, m->lo)); }
static double largest(const struct light *l) { return fmax(l->r, fmax(l->g, l->b)); }

/*
 * The factor of the light at this distance, in units of the file. A light of which the file says
 * nothing has libassimp's default, 1/distance, which is not meant; nor is the constant that it has
 * for a light of FBX that does not fade.
 */
static double fading(const struct mesh *m, const struct aiLight *l, double distance)
{
    double c = (double)l->mAttenuationConstant, k = (double)l->mAttenuationLinear;
    double q = (double)l->mAttenuationQuadratic;
    if (c == 0 && k == 1 && q == 0) return 1;
    if (k == 0 && q == 0 && mesh_is_read_by(m, "Autodesk FBX")) return 1;
    double by = c + k * distance + q * distance * distance;
    return mesh_is_length(by) ? 1 / by : 1;
}

/* The same of a lamp in watts, as Blender takes them: it shines to all sides, an area to one. */
static double spread(const struct aiLight *l, double distance_m)
{
    const double by = (l->mType == aiLightSource_AREA ? PI : 4 * PI) * distance_m * distance_m;
    return mesh_is_length(by) ? 1 / by : 1;
}

/* Adds a light, if it shines. False if its numbers are unusable. */
static bool add(
    struct mesh *m, const struct aiLight *l, const struct mesh_frame *f, double *most, double *sum)
{
    struct light out = {.own_colour = true};
    double fade = 1;
    if (l->mType == aiLightSource_DIRECTIONAL) {
        struct vec3 d = mesh_frame_vector(f, mesh_vec(l->mDirection));
        double length = v3_len(d);
        if (!mesh_is_length(length)) return false;
        out.pos = v3_mad(centre(m), d, -FAR * diagonal(m) / length);
    } else {
        out.pos = mesh_frame_point(f, mesh_vec(l->mPosition));
        if (!mesh_is_place(out.pos)) return false;
        const double away = v3_len(v3_sub(out.pos, centre(m)));
        fade = mesh_is_in_watts(m) ? spread(l, away) : fading(m, l, away / m->unit);
    }
    const struct aiColor3D *c = &l->mColorDiffuse;
    out.r = fmax(0, fade * (double)c->r);
    out.g = fmax(0, fade * (double)c->g);
    out.b = fmax(0, fade * (double)c->b);
    if (!isfinite(out.r) || !isfinite(out.g) || !isfinite(out.b)) return false;
    *sum += largest(&out);
    *most = fmax(*most, largest(&out));
    if (largest(&out) > 0) m->lights[m->n_lights++] = out;
    return true;
}

/* Candela, lux and watts (per square metre) become shares of the light at the centre. */
static void scale(struct mesh *m, double factor)
{
    for (uint32_t i = 0; i < m->n_lights; i++) {
        struct light *l = &m->lights[i];
        l->r = fmin(l->r * factor, INTENSITY_MAX);
        l->g = fmin(l->g * factor, INTENSITY_MAX);
        l->b = fmin(l->b * factor, INTENSITY_MAX);
    }
}

/*
 * A bright light over the viewer's left shoulder, and a weak one at the eye: NFF has no ambient
 * light, and this one lights all that is seen.
 */
static void add_two(struct mesh *m)
{
    const struct view *v = &m->view;
    struct vec3 back = v3_unit(v3_sub(v->from, v->at));
    struct vec3 right = v3_unit(v3_cross(v->up, back)), up = v3_cross(back, right);
    struct vec3 d = v3_unit(v3_mad(v3_mad(back, right, KEY_RIGHT), up, KEY_ABOVE));
    double far = fmax(KEY_FAR * diagonal(m), 2 * v3_len(v3_sub(v->from, centre(m))));
    struct vec3 at = v3_mad(centre(m), d, far);
    m->lights[m->n_lights++] = (struct light){at, .8, .8, .8, true};
    m->lights[m->n_lights++] = (struct light){v->from, .3, .3, .3, true};
}

void mesh_lights_find(struct mesh *m)
{
    const struct aiScene *s = m->scene;
    double most = 0, sum = 0;
    m->lights = xcalloc(s->mNumLights + 2, sizeof *m->lights);
    for (unsigned i = 0; i < s->mNumLights; i++) {
        const struct aiLight *l = s->mLights[i];
        switch (l->mType) {
        case aiLightSource_SPOT: m->loss[LOSS_SPOTS].n++; break;
        case aiLightSource_AREA: m->loss[LOSS_AREAS].n++; break;
        case aiLightSource_POINT:
        case aiLightSource_DIRECTIONAL: break;
        default: m->loss[LOSS_AMBIENTS].n++; continue;
        }
        if (!add(m, l, &m->light_places[i].frame, &most, &sum)) m->loss[LOSS_BAD_LIGHTS].n++;
    }
    if (!m->n_lights) add_two(m);
    else {
        const bool physical = mesh_is_gltf(m) || mesh_is_in_watts(m);
        scale(m, (physical || most > 1) && mesh_is_length(sum) ? 1 / sum : 1);
    }
}
