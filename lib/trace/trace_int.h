/*
 * trace_int: declarations that the files of trace share. Files outside trace do not include it.
 *
 * Each primitive of the scene becomes one or more items: a sphere, a cone, or each triangle of a
 * polygon or patch. Items are numbered in the order of primitives, and of triangles within a
 * primitive. So the lower item is the lower primitive index, then the lower triangle. Items are
 * stored in blocks of four of one kind, as arrays of lanes. The leaves of the hierarchy refer to
 * blocks.
 */
#ifndef STORMRING_TRACE_INT_H
#define STORMRING_TRACE_INT_H

#include "trace/trace.h"

#define LANES 4
#define NO_ITEM UINT32_MAX

/* Bound on the rounding error of a computed point, relative to the numbers it was computed from. */
#define ERR_UNIT 0x1p-48

struct ray {
    struct vec3 o, d;    /* d has length 1 */
    double t_min, t_max; /* a hit counts if t_min < t < t_max, or t == t_max with a lower item */
    double err;          /* bound on the distance of o from the surface it was computed on */
    bool to_surface;     /* a shadow ray whose light lies on a surface */
    uint32_t start;      /* 1 + the item that it starts on; 0: none */
};

struct hit {
    double t;
    uint32_t item;
};

/* ---- items and blocks ------------------------------------------------------------------ */

/* A row for each kind: its name, and that of its files, NAME.h (the vectors) and NAME.c (struct
 * shape). */
#define TRACE_SHAPES(ROW) ROW(TRIANGLE, triangle) ROW(SPHERE, sphere) ROW(CONE, cone)

#define ENUMERATOR(KIND, name) ITEM_##KIND,
enum item_kind { TRACE_SHAPES(ENUMERATOR) };
#define ONE_MORE(KIND, name) +1
enum { ITEM_KINDS = 0 TRACE_SHAPES(ONE_MORE) };
_Static_assert(ITEM_KINDS <= 4, "items and leaves have two bits for the kind");

struct item {
    uint32_t prim;
    uint32_t vertex[3]; /* triangle: indices into the scene's vertices */
    uint32_t material : 29;
    uint32_t kind : 2;
    uint32_t smooth : 1; /* triangle of a patch: normals are interpolated */
};
#define MATERIAL_MASK ((UINT32_C(1) << 29) - 1)

/* What is asked of a kind outside of the vectors. Lane i of a block holds item[i]; lanes with
 * NO_ITEM hold numbers that no ray can hit. */
struct shape {
    enum prim_kind prim;         /* that becomes such an item; triangles: polygons and patches */
    size_t block_size, items_at; /* items_at: offset of the array item in a block */
    /* False: degenerate. */
    bool (*has_surface)(const struct scene *s, const struct item *it);
    /* Fills a lane of a block. No coordinate of a ray's origin or hit exceeds reach. */
    void (*fill)(const struct scene *s, const struct item *it, double reach, void *block, int lane);
    /* Makes a lane that no ray hits. */
    void (*clear)(void *block, int lane);
    void (*bounds)(const struct scene *s, const struct item *it, struct vec3 *lo, struct vec3 *hi);
    /* The bounds of n.p over the points p of the item. n need not have length 1. */
    void (*extent)(
        const struct scene *s, const struct item *it, struct vec3 n, double *lo, double *hi);
    /* The unit normal at p, on either side. Moves p onto the surface if that is more accurate than
     * o + t d. */
    struct vec3 (*normal)(const struct scene *s, const struct item *it, struct vec3 *p);
    /* True if p is inside. NULL: the shape encloses nothing. */
    bool (*contains)(const struct prim *q, struct vec3 p);
    /* A ray from the eye begins in larger media before smaller ones. */
    double (*size)(const struct prim *q);
};
#define EXTERN(KIND, name) extern const struct shape trace_##name;
TRACE_SHAPES(EXTERN)
extern const struct shape *const trace_shapes[ITEM_KINDS];
enum item_kind trace_kind_of(const struct prim *p);

/* The items of a block. */
static inline uint32_t *block_items(uint32_t kind, void *block)
{
    return (uint32_t *)(void *)((char *)block + trace_shapes[kind]->items_at);
}

/* True: each item is the surface of a medium of its own. False: all items of one material are the
 * surface of one medium, which contains no eye. */
static inline bool shape_encloses(uint32_t kind) { return trace_shapes[kind]->contains != NULL; }

/* ---- the hierarchy ---------------------------------------------------------------------- */

#define WIDTH 8       /* children of a node */
#define STACK_MAX 704 /* > (SAH_DEPTH + 32 levels of halving + 3 of kinds) * (WIDTH - 1) */

/* A child is a node's index or a leaf: LEAF | kind << 29 | (blocks - 1) << 27 | first block of that
 * kind. */
#define LEAF UINT32_C(0x80000000)
#define LEAF_BLOCKS_MAX 4
#define LEAF_FIRST_MASK UINT32_C(0x07ffffff)
#define NO_CHILD UINT32_MAX
static inline uint32_t leaf_of(uint32_t kind, uint32_t n, uint32_t first)
{
    return LEAF | kind << 29 | (n - 1) << 27 | first;
}
static inline enum item_kind leaf_kind(uint32_t c) { return (enum item_kind)(c >> 29 & 3); }
static inline uint32_t leaf_count(uint32_t c) { return (c >> 27 & 3) + 1; }
static inline uint32_t leaf_first(uint32_t c) { return c & LEAF_FIRST_MASK; }

/* Bounds of eight children, rounded to the nearest float; bvh.slack covers the rounding. An unused
 * child has lo > hi. */
struct node8 {
    float lo[3][WIDTH], hi[3][WIDTH];
    uint32_t child[WIDTH];
    uint32_t used;   /* one bit per child */
    uint32_t pad[7]; /* four cache lines */
};

struct bvh {
    struct node8 *nodes; /* nodes[0] is the root; NULL if no item has a surface */
    struct slabs *slabs; /* in place of nodes (slabs.h); otherwise NULL */
    struct trace_tests *tests;
    uint32_t n_nodes;
    void *blocks[ITEM_KINDS];
    uint32_t n_blocks[ITEM_KINDS];
    float slack; /* box tests add this on every side, and a margin for the ray's origin */
};

/* A reference to an item or a part of one. The builder sorts references. */
struct ref {
    _Alignas(16) float lo[3];
    uint32_t item;
    float hi[3];
    uint32_t kind;
};

/* Permutes refs. s and items are needed to fill the blocks. */
void bvh_build(struct bvh *b, struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach, struct parallel *p);
void bvh_free(struct bvh *b);
/* Makes b, of either hierarchy, what it would be if it had been built with this reach. */
void bvh_reach(struct bvh *b, const struct scene *s, const struct item *items, double reach,
    struct parallel *p);
/* True if p, known up to err, lies on the surface of an item, and within its bounds. */
bool bvh_holds(const struct bvh *b, const struct scene *s, const struct item *items, struct vec3 p,
    double err);

/* Builds the blocks, and slabs as their hierarchy or none. refs: in the order of items. */
void slabs_build(struct bvh *b, const struct ref *refs, uint32_t n, const struct scene *s,
    const struct item *items, double reach, bool hierarchy);
uint64_t slabs_bytes(const struct slabs *s);
void slabs_free(struct slabs *s);

/* ---- tracing ------------------------------------------------------------------------------ */

/* Transmitting items that a shadow ray crossed, in traversal order: a triangle at least once, other
 * items once per crossing. */
struct crossings {
    uint32_t *item;
    uint32_t n, cap;
};
void crossings_add(struct crossings *c, uint32_t item);

struct tracer;

/* kernel.h calls these after each test. slabs.c, which counts, defines them first. */
#ifndef COUNT_BOXES
#define COUNT_BOXES(b, node) ((void)0)
#define COUNT_ITEMS(b, items) ((void)0)
#endif

#define PACKET 16 /* rays traced together */

/* The kernels of one instruction set. All return the same bits. */
struct kernels {
    const char *name;
    /* The nearest hit within (t_min, t_max); for equal t the lower item. h->item is NO_ITEM if
     * there is no hit. */
    void (*closest)(const struct bvh *b, const struct ray *r, struct hit *h);
    /* True if the ray hits an opaque item. Otherwise c holds every transmitting item that it hits,
     * some of them twice. */
    bool (*blocked)(
        const struct bvh *b, const struct ray *r, const uint8_t *transmits, struct crossings *c);
    /* The same for n <= PACKET rays at once. blocked_packet: bit i stands for ray i, c[i] for its
     * crossings. */
    void (*closest_packet)(
        const struct bvh *b, const struct ray *const *r, unsigned n, struct hit *const *h);
    unsigned (*blocked_packet)(const struct bvh *b, const struct ray *const *r, unsigned n,
        const uint8_t *transmits, struct crossings *c);
};
/* NULL if this build or this machine lacks the instruction set. */
const struct kernels *trace_kernels_sse2(void);
const struct kernels *trace_kernels_avx2(void);
const struct kernels *trace_kernels_avx512(void);
/* For all hierarchies, without packets; these count the tests. */
const struct kernels *slabs_kernels(void);

/* A medium that contains rays (shape_encloses). All polygons of one material bound one medium,
 * because they are one mesh in the reference. */
struct medium {
    uint32_t id;    /* a material, or the number of materials + a primitive */
    uint32_t outer; /* the rest of the list; in an unused link, the next unused one */
    uint32_t users; /* of the list that begins here: rays, and links of inner media */
};

/* The media that contain a ray are a list, the innermost first: the index of its first link, or 0
 * if there are none. Lists share their outer parts. */
struct media {
    struct medium *link; /* link[0] is in no list */
    uint32_t n, cap;     /* links that were ever used; room */
    uint32_t unused;     /* 0: none */
};

/* A material, prepared for shading. */
struct surface {
    struct vec3 colour_kd; /* colour times kd */
    double ks, shine, t, ior;
    bool diffuse; /* colour_kd is not zero */
};

struct shaders;
struct enclosing; /* around.c */

struct tracer {
    const struct scene *scene;
    struct trace_options options;
    const struct kernels *k;
    const struct shaders *shaders; /* shade.h */
    struct bvh bvh;
    struct item *items;
    uint32_t n_items;
    struct surface *surfaces;
    uint8_t *transmits;                   /* per item: its material's t > 0 */
    bool *light_in_surface;               /* per light */
    double radiance[TRACE_DEPTH_MAX + 1]; /* by level: the most light a ray can bring */
    struct enclosing *enclosing;          /* what may contain the start of an eye ray */
    uint32_t n_enclosing;
    struct crossings crossings[PACKET];
    struct wave *wave;
    struct trace_counts counts;
    struct trace_tests tests;
    struct view view;
    struct camera camera; /* of the view */
    double item_reach;    /* the largest absolute coordinate of an item */
    double reach; /* no coordinate of a ray's origin or hit is larger (tracer.c) */
};

/* The point where a ray hit an item. */
struct hit_point {
    struct vec3 p, n; /* n faces the ray */
    struct vec3 mirrored;
    double err;
    const struct item *item;
    const struct surface *surface;
    uint32_t start; /* of rays from here */
};

/* light.c. Computes the point where r hit h. */
void trace_hit_point(
    const struct tracer *t, const struct ray *r, const struct hit *h, struct hit_point *at);
/* Computes the contribution of light i at that point if unshadowed, and the shadow ray to test.
 * False: no contribution, no ray. */
bool light_from(const struct tracer *t, const struct hit_point *at, uint32_t i, struct vec3 *light,
    struct ray *shadow);
/* Product of the transmissions of the crossed surfaces. Sorts c. */
double light_through(const struct tracer *t, struct crossings *c);

/* onward.c: the secondary rays of a point. */
struct onward {
    bool reflected, passed;
    struct ray mirror, through;
    double mirror_weight, through_weight; /* share of their light in this ray's light */
    int mirror_level, through_level;
    uint32_t inside; /* if passed: the transmitted ray's media, which the caller drops */
};
/* Computes the mirrored and the transmitted ray. The mirrored ray stays in `outside`. */
void trace_spawn_secondary(const struct tracer *t, const struct ray *r, const struct hit_point *at,
    int level, struct media *m, uint32_t outside, struct onward *o);

/* media.c. m may be zeroed. Each user drops the list once. */
void media_free(struct media *m);
/* A list of medium id and those of list `outer`, whose user becomes the link. */
uint32_t media_add(struct media *m, uint32_t id, uint32_t outer);
/* Returns the list, which has one more user. */
uint32_t media_keep(struct media *m, uint32_t list);
void media_drop(struct media *m, uint32_t list);
/* The media of a ray that enters or leaves medium id. */
uint32_t media_cross(struct media *m, uint32_t list, uint32_t id);
/* around.c. Sets t->enclosing for the frame's size. Needs t->surfaces. */
void media_list_enclosing(struct tracer *t);
/* The media that contain an eye ray starting at p. */
uint32_t media_around(const struct tracer *t, struct vec3 p, struct media *m);

/* items.c: sets items, n_items and transmits. Returns references to the items that have a surface,
 * which the caller frees. Sets item_reach. */
struct ref *items_make(struct tracer *t, uint32_t *n_refs, struct parallel *p);

/* bound.c: sets t->radiance. Needs t->surfaces. */
void bound_radiance(struct tracer *t);

/* wave.c: the colours of n <= WAVE_RAYS eye rays. */
#define WAVE_RAYS 64
struct wave *wave_new(void);
void wave_free(struct wave *w);
void wave_colours(struct tracer *t, const struct ray *eye, uint32_t n, struct vec3 *colour);

/* math.c: x^y with the same bits on every host. x in [0, 1], y > 0. */
double trace_pow(double x, double y);

#endif
