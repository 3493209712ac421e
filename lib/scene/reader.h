/* reader: the state of one nff_read. Private to lib/scene. */
#ifndef STORMRING_SCENE_READER_H
#define STORMRING_SCENE_READER_H

#include "scene/scene.h"
#include "scene/token.h"

struct reader {
    struct tokens t;
    const char *name; /* stands in messages */
    char *err;        /* SCENE_ERR bytes */
    struct scene *s;
    uint32_t room_lights, room_materials, room_prims, room_vertices;
    uint32_t material;                   /* of the primitives that follow */
    uint32_t *material_slot;             /* hash table: index of a material + 1, 0 free */
    uint32_t n_slots;                    /* a power of two, or 0 */
    uint32_t view_line, background_line; /* where they were given, 0 if not yet */
};

/* All return false with the message in r->err. */
bool reader_fail(struct reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* "WHAT is 'the next token', expected EXPECTED", or that the file ends there. */
bool reader_fail_token(struct reader *r, const char *what, const char *expected);
/* The next token must be a number within [min, max]; `what` names it in messages. */
bool reader_real(struct reader *r, const char *what, double min, double max, double *out);
bool reader_int(struct reader *r, const char *what, uint32_t min, uint32_t max, uint32_t *out);
/* Three reals. */
bool reader_vec(struct reader *r, const char *what, double min, double max, struct vec3 *out);
bool reader_rgb(struct reader *r, const char *what, double rgb[3]);
/* The view's words, after its `v`. */
bool reader_view(struct reader *r);
/* The numbers after `f`: sets r->material, to an equal one given before where there is one. */
bool reader_material(struct reader *r);

/* Newell's normal of a polygon, unit length; +z where it is zero. */
struct vec3 newell_unit(const struct vec3 *v, uint32_t n);

/*
 * Sizes: squares of coordinates, and areas of boxes, stay far inside a float; what is smaller than
 * LENGTH_MIN would have a square that underflows in one.
 */
#define COORDINATE_MAX 1e18
#define LENGTH_MIN 1e-18
#define COLOUR_MAX 1e6

#endif
