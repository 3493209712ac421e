/*
 * nff_parts: reads NFF with several threads. The text is cut into parts where a line begins with an
 * entity. Each part is read as a scene of its own, and the parts are joined in their order.
 *
 * A cut must be between two entities. A line that begins with an entity's word and a blank begins
 * an entity, because entities consist of numbers and, in a view, of other words. In bad text such
 * a line may be within an entity; then the part before the cut ends too early and is refused. If a
 * part is refused, or parts contradict each other, one thread reads all of the text again. So
 * messages and their lines are always those of nff_read.
 */
#include "scene/reader.h"

#include <stdlib.h>
#include <string.h>

#define PART_BYTES 65536 /* shorter parts are not worth a thread */

struct part {
    struct reader r;
    struct scene s;
    char err[SCENE_ERR];
    bool ok;
    uint32_t *material;       /* by index in this part: index in the whole scene */
    uint32_t prims, vertices; /* the scene's number of them before this part */
};

struct parts {
    const char *name;
    struct part *at;
    uint32_t n;
    struct scene whole;
};

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

static bool begins_entity(const char *p, const char *end)
{
    size_t n = 0;
    while (p + n < end && n < NFF_WORD_MAX && !is_blank(p[n])) n++;
    return p + n < end && is_blank(p[n]) && nff_is_entity(p, n);
}

/* The first place after p at which the text can be cut; or its end. */
static const char *cut_after(const char *p, const char *end)
{
    while ((p = memchr(p, '\n', (size_t)(end - p))) != NULL)
        if (begins_entity(++p, end)) return p;
    return end;
}

static void cut(struct parts *p, const char *text, size_t n)
{
    const char *at = text, *end = text + n;
    for (uint32_t i = 0; i < p->n; i++) {
        const char *to = text + n / p->n * (i + 1);
        if (i + 1 == p->n) to = end;
        else if (to < at) to = at; /* the part before it went further: this one is empty */
        else to = cut_after(to, end);
        struct part *a = &p->at[i];
        a->r = (struct reader){.name = p->name, .err = a->err, .s = &a->s};
        tokens_init(&a->r.t, at, (size_t)(to - at));
        at = to;
    }
}

/* The first material stands for the one that is current where the part begins. That is the default
 * for the first part; no other part has a material that equals NaN. */
static void read_part(void *ctx, uint32_t i)
{
    struct part *a = &((struct parts *)ctx)->at[i];
    struct material first = NFF_MATERIAL_DEFAULT;
    if (i) first.r = (double)NAN;
    reader_add_material(&a->r, &first);
    a->ok = reader_entities(&a->r);
}

/* ---- joining ------------------------------------------------------------------------------ */

/* True if the parts fit together; counts what they have. */
static bool fit(struct parts *p)
{
    uint64_t lights = 0, prims = 0, vertices = 0, views = 0, backgrounds = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        struct part *a = &p->at[i];
        if (!a->ok) return false;
        a->prims = (uint32_t)prims;
        a->vertices = (uint32_t)vertices;
        lights += a->s.n_lights;
        prims += a->s.n_prims;
        vertices += a->s.n_vertices;
        views += a->r.view_line > 0;
        backgrounds += a->r.background_line > 0;
        if (a->r.view_line) p->whole.view = a->s.view;
        if (a->r.background_line)
            memcpy(p->whole.background, a->s.background, sizeof p->whole.background);
    }
    p->whole.n_lights = (uint32_t)lights;
    p->whole.n_prims = (uint32_t)prims;
    p->whole.n_vertices = (uint32_t)vertices;
    return views == 1 && backgrounds <= 1 && lights <= NFF_COUNT_MAX && prims <= NFF_COUNT_MAX &&
           vertices <= NFF_COUNT_MAX;
}

/* The first part's materials become those of the whole scene. */
static void join_materials(struct parts *p)
{
    struct reader *first = &p->at[0].r;
    for (uint32_t i = 1; i < p->n; i++) {
        struct part *a = &p->at[i];
        a->material = xmalloc(a->s.n_materials, sizeof *a->material);
        a->material[0] = first->material;
        for (uint32_t k = 1; k < a->s.n_materials; k++) {
            reader_add_material(first, &a->s.materials[k]);
            a->material[k] = first->material;
        }
        first->material = a->material[a->r.material];
    }
    p->whole.materials = p->at[0].s.materials;
    p->whole.n_materials = p->at[0].s.n_materials;
    p->at[0].s.materials = NULL;
}

/* Makes room for everything: the first part's memory grows. */
static void join_room(struct parts *p)
{
    struct scene *s = &p->whole, *first = &p->at[0].s;
    bool normals = false;
    for (uint32_t i = 0; i < p->n; i++) normals |= p->at[i].s.normals != NULL;
    if (s->n_prims) s->prims = xrealloc(first->prims, s->n_prims, sizeof *s->prims);
    if (s->n_vertices) s->vertices = xrealloc(first->vertices, s->n_vertices, sizeof *s->vertices);
    if (normals) s->normals = xrealloc(first->normals, s->n_vertices, sizeof *s->normals);
    if (normals && !first->normals) memset(s->normals, 0, first->n_vertices * sizeof *s->normals);
    first->prims = NULL;
    first->vertices = first->normals = NULL;
}

/* Copies n vectors, or zeros, to to[first]. */
static void copy_vectors(struct vec3 *to, uint32_t first, const struct vec3 *from, uint32_t n)
{
    if (!n || !to) return;
    if (from) memcpy(to + first, from, n * sizeof *to);
    else memset(to + first, 0, n * sizeof *to);
}

static void join_part(void *ctx, uint32_t i)
{
    struct parts *p = ctx;
    struct part *a = &p->at[i];
    if (!i) return;
    for (uint32_t k = 0; k < a->s.n_prims; k++) {
        struct prim *to = &p->whole.prims[a->prims + k];
        *to = a->s.prims[k];
        to->material = a->material[to->material];
        if (prim_is_poly(to)) to->poly.first += a->vertices;
    }
    copy_vectors(p->whole.vertices, a->vertices, a->s.vertices, a->s.n_vertices);
    copy_vectors(p->whole.normals, a->vertices, a->s.normals, a->s.n_vertices);
    scene_free(&a->s);
}

static void join_lights(struct parts *p)
{
    struct scene *s = &p->whole;
    if (s->n_lights) s->lights = xmalloc(s->n_lights, sizeof *s->lights);
    for (uint32_t i = 0, n = 0; i < p->n; n += p->at[i++].s.n_lights)
        if (p->at[i].s.n_lights)
            memcpy(s->lights + n, p->at[i].s.lights, p->at[i].s.n_lights * sizeof *s->lights);
    nff_share_light(s);
}

static void parts_free(struct parts *p)
{
    for (uint32_t i = 0; i < p->n; i++) {
        scene_free(&p->at[i].s);
        free(p->at[i].material);
        free(p->at[i].r.material_slot);
    }
    free(p->at);
}

int nff_read_parts(const char *name, const char *text, size_t n, uint32_t n_parts, int threads,
    struct scene *s, char err[SCENE_ERR])
{
    struct parts p = {.name = name, .at = xcalloc(n_parts, sizeof *p.at), .n = n_parts};
    struct parallel *pool = parallel_new(threads);
    cut(&p, text, n);
    parallel_run(pool, p.n, read_part, &p);
    bool ok = fit(&p);
    if (ok) {
        join_lights(&p);
        join_materials(&p);
        join_room(&p);
        parallel_run(pool, p.n, join_part, &p);
    }
    parallel_free(pool);
    parts_free(&p);
    if (!ok) return nff_read(name, text, n, s, err);
    *s = p.whole;
    err[0] = '\0';
    return 0;
}

int nff_read_parallel(
    const char *name, const char *text, size_t n, int threads, struct scene *s, char err[SCENE_ERR])
{
    size_t parts = n / PART_BYTES;
    if (parts > (size_t)threads) parts = (size_t)threads;
    if (parts < 2) return nff_read(name, text, n, s, err);
    return nff_read_parts(name, text, n, (uint32_t)parts, (int)parts, s, err);
}
