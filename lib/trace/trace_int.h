/*
 * trace_int: what the files of trace share; nobody else includes it.
 *
 * Every primitive of the scene becomes one or more items (a sphere, a cone, or each triangle of a
 * polygon or patch). Items are numbered in the order of primitives, and of triangles within one,
 * so that "the lower primitive index, then the lower triangle" is simply the lower item. Items
 * are kept in blocks of four of a kind, arrays of lanes, which the leaves of the hierarchy name.
 */
#ifndef STORMRING_TRACE_INT_H
#define STORMRING_TRACE_INT_H

#include "trace/trace.h"

#define LANES 4
#define NO_ITEM UINT32_MAX

/* A bound on what rounding does to a computed point, relative to the numbers that went into it. */
#define ERR_UNIT 0x1p-48

struct ray {
    struct vec3 o, d;    /* d has length 1 */
    double t_min, t_max; /* hits count where t_min < t < t_max, or == t_max with a lower item */
    double err;          /* how far o may be from the surface it was computed to lie on */
    bool to_surface;     /* a shadow ray whose light lies in some surface */
};

struct hit {
    double t;
    uint32_t item;
};

/* ---- items and blocks ------------------------------------------------------------------ */

enum item_kind { ITEM_TRIANGLE, ITEM_SPHERE, ITEM_CONE, ITEM_KINDS };

struct item {
    uint32_t prim;
    uint32_t material;
    uint32_t vertex[3]; /* triangle: indices into the scene's vertices */
    struct vec3 n;      /* triangle: the plane's unit normal */
    uint8_t kind;
    bool smooth; /* a patch's triangle: normals are interpolated */
};

/* Lane i of a block holds item[i]; NO_ITEM lanes hold numbers that no ray can hit. */
struct tri4 {
    _Alignas(32) double n[3][LANES], d[LANES]; /* the plane: n.p = d, n of length 1 */
    /* u.p + du >= 0, v.p + dv >= 0, their sum <= 1: inside, with a margin */
    double u[3][LANES], du[LANES], v[3][LANES], dv[LANES];
    double err[LANES]; /* how far the plane may be from the vertices it was made of */
    uint32_t item[LANES];
};
struct sphere4 {
    _Alignas(32) double c[3][LANES], r[LANES], err[LANES];
    uint32_t item[LANES];
};
/* Axis a from base b, 0 <= z <= h along it, radius r + k z. */
struct cone4 {
    _Alignas(32) double b[3][LANES], a[3][LANES], h[LANES], r[LANES], k[LANES], err[LANES];
    uint32_t item[LANES];
};

/* One row per kind (shapes.c). */
struct shape {
    size_t block_size;
    /* Sets what the item keeps beside its indices; false when it has no surface (degenerate). */
    bool (*init)(const struct scene *s, struct item *it);
    /* Fills a lane of a block. No coordinate of the scene, eye and lights included, is beyond
     * reach. */
    void (*fill)(const struct scene *s, const struct item *it, double reach, void *block, int lane);
    /* A lane that nothing hits. */
    void (*clear)(void *block, int lane);
    void (*bounds)(const struct scene *s, const struct item *it, struct vec3 *lo, struct vec3 *hi);
    /* The unit normal at p, either side; p is moved onto the surface where that can be told
     * better than by o + t d. */
    struct vec3 (*normal)(const struct scene *s, const struct item *it, struct vec3 *p);
};
extern const struct shape triangle_shape, sphere_shape, cone_shape;
extern const struct shape *const shapes[ITEM_KINDS];

/* ---- the hierarchy ---------------------------------------------------------------------- */

#define WIDTH 8       /* children of a node */
#define STACK_MAX 704 /* (SAH_DEPTH + 32 levels of halving + 3 of kinds) * (WIDTH - 1), and some */

/* A child: a node's index, or a leaf: LEAF | kind << 29 | (blocks - 1) << 27 | first block of
 * that kind. */
#define LEAF UINT32_C(0x80000000)
#define LEAF_BLOCKS_MAX 4
#define LEAF_FIRST_MASK UINT32_C(0x07ffffff)
#define NO_CHILD UINT32_MAX
static inline enum item_kind leaf_kind(uint32_t c) { return (enum item_kind)(c >> 29 & 3); }
static inline uint32_t leaf_count(uint32_t c) { return (c >> 27 & 3) + 1; }
static inline uint32_t leaf_first(uint32_t c) { return c & LEAF_FIRST_MASK; }

/* Bounds of eight children, to the nearest float (bvh.slack covers that); an unused child is inside
 * out. */
struct node8 {
    float lo[3][WIDTH], hi[3][WIDTH];
    uint32_t child[WIDTH];
    uint32_t used;   /* a bit a child */
    uint32_t pad[7]; /* four cache lines */
};

struct bvh {
    struct node8 *nodes; /* nodes[0] is the root; NULL when there is nothing to hit */
    uint32_t n_nodes;
    void *blocks[ITEM_KINDS];
    uint32_t n_blocks[ITEM_KINDS];
    float slack; /* what box tests add on every side, beside what the ray's origin calls for */
};

/* A reference to (a part of) an item: what the builder sorts. */
struct ref {
    _Alignas(16) float lo[3];
    uint32_t item;
    float hi[3];
    uint32_t kind;
};

/* refs are permuted; items, s: for filling blocks. */
void bvh_build(struct bvh *b, struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach);
void bvh_free(struct bvh *b);
/* Whether p, known up to err, is on some surface. */
bool bvh_holds(const struct bvh *b, struct vec3 p, double err);

struct bnode {
    float lo[3], hi[3];
    uint32_t left, right; /* leaf: left is the first ref, right NO_CHILD */
    uint32_t count;       /* refs below; only leaves use it */
};
/* The binary tree over refs[0..n) into nodes[2n-1]; leaves are of one kind, at most
 * LEAF_BLOCKS_MAX blocks. Root is 0. */
uint32_t sah_build(struct bnode *nodes, struct ref *refs, uint32_t n);

/* ---- tracing ------------------------------------------------------------------------------ */

/* The transmitting items a shadow ray met, as they came: a triangle at least once, others once a
 * crossing. */
struct crossings {
    uint32_t *item;
    uint32_t n, cap;
};
void crossings_add(struct crossings *c, uint32_t item);

struct tracer;

#define PACKET 16 /* rays that go together */

/* The kernels of one instruction set. All give the same answers, bit for bit. */
struct kernels {
    const char *name;
    /* The nearest hit within (t_min, t_max), equal t: the lower item; h->item NO_ITEM when
     * there is none. */
    void (*closest)(const struct bvh *b, const struct ray *r, struct hit *h);
    /* True when an opaque item is hit; else c holds every transmitting item that is, maybe
     * twice. */
    bool (*blocked)(
        const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c);
    /* The same for n <= PACKET rays at once; blocked_packet: bit i for ray i, c[i] what that
     * crosses. */
    void (*closest_packet)(
        const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h);
    unsigned (*blocked_packet)(const struct bvh *b, const struct ray *const *r, unsigned n,
        const uint8_t *transmits, struct crossings *c);
};
/* NULL where this build or machine has none. */
const struct kernels *kernels_sse2(void);
const struct kernels *kernels_avx2(void);

#define MEDIA_MAX TRACE_DEPTH_MAX

/* What a ray is inside of, innermost last. All polygons of one material bound one medium (they
 * are one mesh in the reference), a sphere or cone bounds its own. Deeper than MEDIA_MAX is not
 * kept. */
struct media {
    uint32_t n;
    uint32_t id[MEDIA_MAX]; /* a material, or the number of materials + a primitive */
};

/* A material as shading wants it. */
struct surface {
    struct vec3 colour_kd; /* colour times kd */
    double ks, shine, t, ior;
    bool diffuse; /* colour_kd is not zero */
};

struct tracer {
    const struct scene *scene;
    struct trace_options options;
    const struct kernels *k;
    struct bvh bvh;
    struct item *items;
    uint32_t n_items;
    struct surface *surfaces;
    uint8_t *transmits;     /* per item: its material's t > 0 */
    bool *light_in_surface; /* per light */
    struct media around;    /* what eye rays begin inside of */
    struct crossings crossings[PACKET];
    struct wave *wave;
    struct trace_counts counts;
    struct camera camera;
};

/* Where a ray met an item. */
struct point {
    struct vec3 p, n; /* n toward the ray */
    struct vec3 mirrored;
    double err;
    const struct item *item;
    const struct surface *surface;
};

/* light.c: h as a point of r, */
void meet(const struct tracer *t, const struct ray *r, const struct hit *h, struct point *at);
/* light i as it arrives there if nothing is in the way, and the ray that asks whether something is
 * (false: none arrives anyhow), */
bool light_from(const struct tracer *t, const struct point *at, uint32_t i, struct vec3 *light,
    struct ray *shadow);
/* and what the crossed surfaces let through (c is sorted). */
double light_through(const struct tracer *t, struct crossings *c);

/* onward.c: the rays that go on from a point. */
struct onward {
    bool reflected, passed;
    struct ray mirror, through;
    double mirror_weight, through_weight; /* of what they see, in what this ray sees */
    int mirror_level, through_level;
};
/* The mirrored ray stays where r is; what the other one is inside of comes in *inside, if there
 * is one. */
void go_on(const struct tracer *t, const struct ray *r, const struct point *at, int level,
    const struct media *outside, struct media *inside, struct onward *o);
void media_copy(struct media *to, const struct media *from);
/* around.c: what a ray that begins at p is inside of, once surfaces are set. */
void media_around(const struct tracer *t, struct vec3 p, struct media *in);

/* wave.c: the colours that n <= WAVE_RAYS eye rays see. */
#define WAVE_RAYS 64
struct wave *wave_new(const struct tracer *t);
void wave_free(struct wave *w);
void wave_colours(struct tracer *t, const struct ray *eye, uint32_t n, struct vec3 *colour);

/* math.c: the same bits on every host. x in [0, 1], y > 0. */
double trace_pow(double x, double y);

#endif
