/*
 * scene: the contents of a Neutral File Format file (E. Haines, "A proposal for standard graphics
 * environments", IEEE CG&A 7(11), 1987; NFF.TXT of the Standard Procedural Databases). Reads and
 * writes NFF, and holds the triangulation that all users of polygons share.
 */
#ifndef STORMRING_SCENE_H
#define STORMRING_SCENE_H

#include "base/base.h"
#include "geometry/geometry.h"

#define SCENE_ERR ERR_BYTES

struct view {
    struct vec3 from, at, up;
    double angle_deg;      /* vertical field of view */
    double hither;         /* distance of the near plane along the viewing direction, >= 0 */
    uint32_t res_x, res_y; /* 0: a view in a file of its own need not say it */
};

struct light {
    struct vec3 pos;
    double r, g, b; /* intensity: own colour, or 1/sqrt(number of lights) */
    bool own_colour;
};

struct material {
    double r, g, b; /* colour */
    double kd, ks, shine, t, ior;
};

/* A row for each kind of primitive (prim.h). */
#define SCENE_PRIMS(ROW) ROW(SPHERE, sphere) ROW(CONE, cone) ROW(POLYGON, polygon) ROW(PATCH, patch)
#define SCENE_PRIM_ENUMERATOR(KIND, name) PRIM_##KIND,
enum prim_kind { SCENE_PRIMS(SCENE_PRIM_ENUMERATOR) };
#define SCENE_PRIM_ONE_MORE(KIND, name) +1
enum { PRIM_KINDS = 0 SCENE_PRIMS(SCENE_PRIM_ONE_MORE) };

struct prim {
    enum prim_kind kind;
    uint32_t material;
    union { /* the reader drops the signs of radii: both sides are visible */
        struct {
            struct vec3 center;
            double radius; /* > 0 */
        } sphere;
        struct { /* open; a cylinder if the radii are equal */
            struct vec3 base, apex;
            double base_radius, apex_radius; /* >= 0, not both 0 */
        } cone;
        struct { /* vertices [first, first+count) of the scene; for a patch also its normals */
            uint32_t first, count;
        } poly;
    };
};

static inline bool prim_is_poly(const struct prim *p)
{
    return p->kind == PRIM_POLYGON || p->kind == PRIM_PATCH;
}

struct scene {
    struct view view;
    double background[3];
    struct light *lights;
    struct material *materials; /* all different; materials[0] is the default: white, kd 1 */
    struct prim *prims;         /* in file order: the lower index wins ties */
    struct vec3 *vertices;
    struct vec3 *normals; /* parallel to vertices: unit, or zero for polygons; NULL: no patches */
    uint32_t n_lights, n_materials, n_prims, n_vertices;
};

/*
 * Parses the n bytes of text; `name` is for messages. Returns 0 and a scene, which the caller frees
 * with scene_free; or -1 with "name:line: what is wrong, expected what" in err and *s empty. Never
 * exits and does no I/O.
 */
int nff_read(const char *name, const char *text, size_t n, struct scene *s, char err[SCENE_ERR]);
/* The same scene or message, by up to `threads` threads: the caller's and others, which end before
 * the function returns. */
int nff_read_parallel(const char *name, const char *text, size_t n, int threads, struct scene *s,
    char err[SCENE_ERR]);
/* The line of primitive i of a text that nff_read has accepted. */
uint32_t nff_line(const char *text, size_t n, uint32_t i);
/* A view in a file of its own: the words of `v`, without the `v`. Returns as nff_read; there is
 * nothing to free. */
int nff_read_view(
    const char *name, const char *text, size_t n, struct view *v, char err[SCENE_ERR]);
void scene_free(struct scene *s);
/* Axis-aligned bounds of one primitive. */
void scene_prim_bounds(
    const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi);

/* Indices into the scene's vertices. */
struct triangle {
    uint32_t v[3];
};
/*
 * Triangulates a polygon or patch into out, which has room for count - 2 triangles. Returns their
 * number. A polygon is cut by ear clipping in its own plane (Newell's normal). The result is
 * deterministic. Concave and slightly non-planar polygons are allowed. A polygon without area
 * yields no triangles. With crossing edges the triangles are unspecified. A patch becomes a fan
 * from its first vertex.
 */
uint32_t scene_triangulate(const struct scene *s, const struct prim *p, struct triangle *out);
/*
 * True if a ray of the view (res_x by res_y pixels, frame edges included) may hit a primitive
 * nearer than hither, which is then invisible. May return true without such a ray, never false with
 * one. *which is the first such primitive.
 */
bool scene_hither_clips(const struct scene *s, uint32_t *which);

/* ---- writing -------------------------------------------------------------------------- */

#define NFF_DIGITS_SPD 6  /* as the SPD programs write (%g) */
#define NFF_DIGITS_MAX 17 /* exact for every double; with 15 or fewer, reading is fastest */

/*
 * Each function writes one entity as text to f, with `digits` significant digits. Arguments are not
 * checked: f's error flag reports lost output, and nff_read rejects invalid values.
 */
struct nff_out {
    FILE *f;
    int digits; /* 1 to NFF_DIGITS_MAX */
};

void nff_put_view(struct nff_out *o, const struct view *v);
/* Without its `v`, as nff_read_view takes it. */
void nff_put_view_words(struct nff_out *o, const struct view *v);
void nff_put_background(struct nff_out *o, double r, double g, double b);
/* With its colour if own_colour. */
void nff_put_light(struct nff_out *o, const struct light *l);
void nff_put_material(struct nff_out *o, const struct material *m);
void nff_put_sphere(struct nff_out *o, struct vec3 center, double radius);
void nff_put_cone(
    struct nff_out *o, struct vec3 base, double base_radius, struct vec3 apex, double apex_radius);
/* n >= 3 vertices; a patch if normals is not NULL. */
void nff_put_polygon(
    struct nff_out *o, uint32_t n, const struct vec3 *v, const struct vec3 *normals);
/* A primitive of any kind, without its material. */
void scene_put_prim(struct nff_out *o, const struct scene *s, const struct prim *p);
/* Text of a material and one primitive, for self-tests: within 3 of the origin, in front of an eye
 * at 3 4 5. */
const char *scene_sample(enum prim_kind kind);

/*
 * Writes the scene for POV-Ray 3.7, which renders the same picture (except hither, which POV-Ray's
 * camera lacks). Multiplies every length by scale > 0. f's error flag reports lost output.
 */
void pov_write(FILE *f, const struct scene *s, double scale);
/*
 * Number of primitives for which POV-Ray 3.7 refuses the scene so written: cones and cylinders
 * shorter than POV_CONE_MIN. *which is the first one. POV-Ray takes every other primitive that
 * nff_read accepts.
 */
uint32_t pov_refused(const struct scene *s, double scale, uint32_t *which);
#define POV_CONE_MIN 1e-10

#endif
