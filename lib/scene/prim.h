/*
 * prim: what scene asks of a kind of primitive. Each kind is a row of SCENE_PRIMS (scene.h), and a
 * file with its struct prim_row. Private to lib/scene.
 */
#ifndef STORMRING_SCENE_PRIM_H
#define STORMRING_SCENE_PRIM_H

#include "scene/reader.h"

/* The space between the eye and the hither plane. Inside: dot(normal, p) <= offset. p is relative
 * to the eye; normals have unit length. */
enum { PYRAMID_PLANES = 6 };
struct pyramid {
    struct vec3 normal[PYRAMID_PLANES];
    double offset[PYRAMID_PLANES];
    struct vec3 corner[5]; /* the eye and the four corners on the hither plane */
    struct vec3 eye;
};

/* A scene for POV-Ray. */
struct pov {
    FILE *f;
    const struct scene *s;
    double scale; /* of all lengths */
};

struct prim_row {
    char word[NFF_WORD_MAX + 1]; /* that begins the entity */
    const char *sample;          /* scene_sample */
    /* Reads what follows the word. */
    bool (*read)(struct reader *r);
    /* Writes the entity, as nff_put_NAME. */
    void (*write)(struct nff_out *o, const struct scene *s, const struct prim *p);
    /* Widens lo and hi to the primitive's bounds. */
    void (*bounds)(const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi);
    /* True if the surface may reach into the pyramid: see scene_hither_clips. */
    bool (*reaches)(const struct pyramid *y, const struct scene *s, const struct prim *p);
    /* Writes the object, by the functions below. NULL: it is part of its material's mesh. */
    void (*pov)(struct pov *o, const struct prim *p);
    /* False if POV-Ray refuses the object. NULL: it takes all that nff_read accepts. */
    bool (*pov_takes)(const struct prim *p, double scale);
};
#define SCENE_PRIM_EXTERN(KIND, name) extern const struct prim_row scene_##name;
SCENE_PRIMS(SCENE_PRIM_EXTERN)
extern const struct prim_row *const scene_prims[PRIM_KINDS]; /* prims.c */

/* reader.c: adds a primitive of the current material; its other bytes are 0. */
struct prim *reader_add_prim(struct reader *r, enum prim_kind kind);
/* Ensures room for one more element of `size` bytes in p, which holds n. Doubles the room. */
void *reader_grown(void *p, uint32_t n, uint32_t *room, size_t size);
/* Reads three coordinates. */
bool reader_point(struct reader *r, const char *what, struct vec3 *out);

/* nff_write.c: lead, then "a b c". */
void nff_put_vec(struct nff_out *o, const char *lead, struct vec3 v);

/* scene.c: includes a and b. */
void scene_include(struct vec3 *lo, struct vec3 *hi, struct vec3 a, struct vec3 b);
/* Includes c - e and c + e, slightly widened. */
void scene_include_about(struct vec3 *lo, struct vec3 *hi, struct vec3 c, struct vec3 e);

/* pov_put.c: lead, then a number, a vector, or a scaled point. */
void pov_real(struct pov *o, const char *lead, double v);
void pov_vec(struct pov *o, const char *lead, struct vec3 v);
void pov_point(struct pov *o, const char *lead, struct vec3 v);
/* Ends an object. */
void pov_material(struct pov *o, uint32_t i);

#endif
