/*
 * scene: what a Neutral File Format file describes (E. Haines, "A proposal for standard graphics
 * environments", IEEE CG&A 7(11), 1987; NFF.TXT of the Standard Procedural Databases), reading and
 * writing it, and the one triangulation that every user of polygons shares.
 */
#ifndef STORMRING_SCENE_H
#define STORMRING_SCENE_H

#include "base/base.h"

#define SCENE_ERR ERR_BYTES

struct view {
    struct vec3 from, at, up;
    double angle_deg; /* from the picture's top edge to its bottom edge */
    double hither;    /* nearest distance seen, along the viewing direction, >= 0 */
    uint32_t res_x, res_y;
};

struct light {
    struct vec3 pos;
    double r, g, b; /* intensity: its own colour, or 1/sqrt(number of lights) */
    bool own_colour;
};

struct material {
    double r, g, b; /* colour */
    double kd, ks, shine, t, ior;
};

enum prim_kind { PRIM_SPHERE, PRIM_CONE, PRIM_POLYGON, PRIM_PATCH };

struct prim {
    enum prim_kind kind;
    uint32_t material;
    union { /* radii are read without their sign: both sides are seen */
        struct {
            struct vec3 center;
            double radius; /* > 0 */
        } sphere;
        struct { /* open; equal radii: a cylinder */
            struct vec3 base, apex;
            double base_radius, apex_radius; /* >= 0, not both 0 */
        } cone;
        struct { /* vertices [first, first+count) of the scene; a patch's normals too */
            uint32_t first, count;
        } poly;
    };
};

struct scene {
    struct view view;
    double background[3];
    struct light *lights;
    struct material *materials; /* all different; materials[0] is the default: white, kd 1 */
    struct prim *prims;         /* in file order: the index decides ties */
    struct vec3 *vertices;
    struct vec3 *normals; /* parallel to vertices: unit, or zero at a polygon's; NULL: no patches */
    uint32_t n_lights, n_materials, n_prims, n_vertices;
};

/*
 * Parses the n bytes of text; `name` stands in messages. Returns 0 and a scene to scene_free, or
 * -1 with "name:line: what is wrong, expected what" in err and *s empty. Never exits, reads
 * nothing but text.
 */
int nff_read(const char *name, const char *text, size_t n, struct scene *s, char err[SCENE_ERR]);
void scene_free(struct scene *s);
/* Axis-aligned bounds of one primitive. */
void prim_bounds(const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi);

/* Indices into the scene's vertices. */
struct triangle {
    uint32_t v[3];
};
/*
 * The triangles of a polygon (ear clipping in the polygon's own plane, by Newell's normal;
 * deterministic, concave and slightly off plane allowed; a polygon without area gives none, edges
 * that cross give what they may) or of a patch (a fan from its first vertex). out has room for
 * count - 2. Returns how many were written.
 */
uint32_t scene_triangulate(const struct scene *s, const struct prim *p, struct triangle *out);
/*
 * Whether a ray of the view (res_x by res_y pixels of its frame, edges included) may meet a
 * primitive nearer than hither, which then is not seen. Errs on the side of true; *which is the
 * first such primitive.
 */
bool scene_hither_clips(const struct scene *s, uint32_t *which);

/* ---- writing -------------------------------------------------------------------------- */

#define NFF_DIGITS_SPD 6  /* what the SPD programs write (%g) */
#define NFF_DIGITS_MAX 17 /* every double survives; 15 is the most that reads back at full speed */

/*
 * One entity each, as text on f, numbers with `digits` significant digits. Nothing is checked: f's
 * error flag tells of lost output, and nff_read of nonsense.
 */
struct nff_out {
    FILE *f;
    int digits; /* 1 to NFF_DIGITS_MAX */
};

void nff_put_view(struct nff_out *o, const struct view *v);
void nff_put_background(struct nff_out *o, double r, double g, double b);
/* With its colour where own_colour. */
void nff_put_light(struct nff_out *o, const struct light *l);
void nff_put_material(struct nff_out *o, const struct material *m);
void nff_put_sphere(struct nff_out *o, struct vec3 center, double radius);
void nff_put_cone(
    struct nff_out *o, struct vec3 base, double base_radius, struct vec3 apex, double apex_radius);
/* n >= 3 vertices; a patch when normals is not NULL. */
void nff_put_polygon(
    struct nff_out *o, uint32_t n, const struct vec3 *v, const struct vec3 *normals);

/*
 * The scene for POV-Ray 3.7, meaning the same picture (hither apart: its camera has none), with
 * every length multiplied by scale > 0. f's error flag tells of lost output.
 */
void pov_write(FILE *f, const struct scene *s, double scale);

#endif
