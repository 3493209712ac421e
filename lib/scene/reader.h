/* reader: the state of one reading of NFF text. Private to lib/scene. */
#ifndef STORMRING_SCENE_READER_H
#define STORMRING_SCENE_READER_H

#include "scene/scene.h"
#include "scene/token.h"

struct reader {
    struct tokens t;
    const char *name; /* for messages */
    char *err;        /* SCENE_ERR bytes */
    struct scene *s;
    uint32_t room_lights, room_materials, room_prims, room_vertices;
    uint32_t material;                   /* material of the following primitives */
    uint32_t *material_slot;             /* hash table: index of a material + 1; 0: free */
    uint32_t n_slots;                    /* a power of two, or 0 */
    uint32_t view_line, background_line; /* lines of `v` and `b`; 0: not seen yet */
};

/* These functions return false with the message in r->err. */
bool reader_fail(struct reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* Fails with "WHAT is 'the next token', expected EXPECTED", or reports the end of the file. */
bool reader_fail_token(struct reader *r, const char *what, const char *expected);
/* Reads a number within [min, max]; `what` names it in messages. */
bool reader_real(struct reader *r, const char *what, double min, double max, double *out);
bool reader_int(struct reader *r, const char *what, uint32_t min, uint32_t max, uint32_t *out);
/* Reads three reals. */
bool reader_vec(struct reader *r, const char *what, double min, double max, struct vec3 *out);
bool reader_rgb(struct reader *r, const char *what, double rgb[3]);
/* Reads the words of a view after its `v`. */
bool reader_view(struct reader *r);
/* Reads the numbers after `f` and sets r->material. */
bool reader_material(struct reader *r);
/* Sets r->material to the index of a material. Equal materials share one. The first one of a scene
 * is added before anything is read. */
void reader_add_material(struct reader *r, const struct material *m);
/* True if an entity begins with this word of n bytes. */
bool nff_is_entity(const char *word, size_t n);
#define NFF_WORD_MAX 2
/* Reads all entities. */
bool reader_entities(struct reader *r);

/* Gives lights without a colour their intensity. */
void nff_share_light(struct scene *s);
/* As nff_read, by this number of threads, which take n_parts parts of the text in turn. */
int nff_read_parts(const char *name, const char *text, size_t n, uint32_t n_parts, int threads,
    struct scene *s, char err[SCENE_ERR]);

/* Newell's normal of a polygon, of unit length; +z if it is zero. */
struct vec3 scene_newell_unit(const struct vec3 *v, uint32_t n);

/*
 * Limits of sizes. Squares of coordinates and areas of boxes stay far inside float. The square of a
 * length below LENGTH_MIN would underflow in float.
 */
#define COORDINATE_MAX 1e18
#define LENGTH_MIN 1e-18
#define COLOUR_MAX 1e6
#define NFF_COUNT_MAX 0x7fffffffU /* entities or vertices in total: indices fit in 31 bits */

/* clang-format off */
#define NFF_MATERIAL_DEFAULT (struct material){.r = 1, .g = 1, .b = 1, .kd = 1}
/* clang-format on */

#endif
