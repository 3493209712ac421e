/*
 * nff_read: reads NFF (E. Haines, NFF.TXT 3.1): a stream of tokens. Each entity is a letter and its
 * numbers, with any line breaks. Differs in: view, lights and background may come anywhere; a
 * material may be missing; the words of a view may come in any order. A light has a colour if a
 * number follows its position, because no entity begins with a number.
 */
#include "scene/reader.h"

#include <stdlib.h>
#include <string.h>

#define POLYGON_MAX 1000000U /* vertices per polygon; 10 s to triangulate, in most cases */
#define NORMAL_MAX 1e18

/* Ensures room for one more element of `size` bytes in p, which holds n. Doubles the room. */
static void *grown(void *p, uint32_t n, uint32_t *room, size_t size)
{
    if (n < *room) return p;
    *room = *room ? 2 * *room : 16;
    return xrealloc(p, *room, size);
}

static bool coordinates(struct reader *r, const char *what, struct vec3 *out)
{
    return reader_vec(r, what, -COORDINATE_MAX, COORDINATE_MAX, out);
}

static bool read_background(struct reader *r)
{
    if (r->background_line)
        return reader_fail(
            r, "a second background, expected only the one at line %u", r->background_line);
    r->background_line = r->t.line;
    return reader_rgb(r, "background colour", r->s->background);
}

static bool read_light(struct reader *r)
{
    struct scene *s = r->s;
    struct light l = {.own_colour = false};
    if (!coordinates(r, "light's position", &l.pos)) return false;
    size_t n = token_peek(&r->t);
    if (n && strchr("0123456789+-.", r->t.at[0]) && r->t.at[0]) {
        double rgb[3];
        if (!reader_rgb(r, "light's colour", rgb)) return false;
        l.r = rgb[0], l.g = rgb[1], l.b = rgb[2];
        l.own_colour = true;
    }
    s->lights = grown(s->lights, s->n_lights, &r->room_lights, sizeof l);
    s->lights[s->n_lights++] = l;
    return true;
}

static struct prim *add_prim(struct reader *r, enum prim_kind kind)
{
    struct scene *s = r->s;
    s->prims = grown(s->prims, s->n_prims, &r->room_prims, sizeof *s->prims);
    struct prim *p = &s->prims[s->n_prims++];
    *p = (struct prim){.kind = kind, .material = r->material};
    return p;
}

static bool read_sphere(struct reader *r)
{
    struct vec3 center;
    double radius;
    if (!coordinates(r, "sphere's centre", &center) ||
        !reader_real(r, "sphere's radius", -COORDINATE_MAX, COORDINATE_MAX, &radius))
        return false;
    if (fabs(radius) < LENGTH_MIN)
        return reader_fail(r, "sphere's radius is %g, expected at least %g", radius, LENGTH_MIN);
    struct prim *p = add_prim(r, PRIM_SPHERE);
    p->sphere.center = center;
    p->sphere.radius = fabs(radius);
    return true;
}

static bool read_cone(struct reader *r)
{
    struct vec3 base, apex;
    double r0, r1;
    if (!coordinates(r, "cone's base", &base) ||
        !reader_real(r, "cone's base radius", -COORDINATE_MAX, COORDINATE_MAX, &r0) ||
        !coordinates(r, "cone's apex", &apex) ||
        !reader_real(r, "cone's apex radius", -COORDINATE_MAX, COORDINATE_MAX, &r1))
        return false;
    if ((r0 < 0 && r1 > 0) || (r0 > 0 && r1 < 0))
        return reader_fail(r, "cone's radii are %g and %g, expected one sign", r0, r1);
    if (fmax(fabs(r0), fabs(r1)) < LENGTH_MIN)
        return reader_fail(r, "cone's radii are both 0, expected one of at least %g", LENGTH_MIN);
    if (v3_len(v3_sub(apex, base)) < LENGTH_MIN)
        return reader_fail(r, "cone's base and apex are the same point, expected two");
    struct prim *p = add_prim(r, PRIM_CONE);
    p->cone.base = base, p->cone.apex = apex;
    p->cone.base_radius = fabs(r0), p->cone.apex_radius = fabs(r1);
    return true;
}

static void add_vertex(struct reader *r, struct vec3 v)
{
    struct scene *s = r->s;
    if (s->n_vertices == r->room_vertices) {
        s->vertices = grown(s->vertices, s->n_vertices, &r->room_vertices, sizeof v);
        if (s->normals) s->normals = xrealloc(s->normals, r->room_vertices, sizeof v);
    }
    if (s->normals) s->normals[s->n_vertices] = v3(0, 0, 0);
    s->vertices[s->n_vertices++] = v;
}

/* Sets the last vertex's normal. The first patch allocates the array, with zeros for earlier
 * polygons. */
static void set_normal(struct reader *r, struct vec3 n)
{
    struct scene *s = r->s;
    if (!s->normals) s->normals = xcalloc(r->room_vertices, sizeof n);
    double len = v3_len(n);
    s->normals[s->n_vertices - 1] = len >= LENGTH_MIN ? v3_scale(n, 1 / len) : v3(0, 0, 0);
}

/* Replaces a patch's zero normals by the patch's own normal, so that shading always has one.
 * Patches may be wound either way, so that points to the side of the others. */
static void fill_normals(struct scene *s, uint32_t first)
{
    struct vec3 own = v3(0, 0, 0), others = own;
    for (uint32_t i = first; i < s->n_vertices; i++) others = v3_add(others, s->normals[i]);
    for (uint32_t i = first; i < s->n_vertices; i++) {
        if (s->normals[i].x != 0 || s->normals[i].y != 0 || s->normals[i].z != 0) continue;
        if (v3_dot(own, own) == 0)
            own = scene_newell_unit(s->vertices + first, s->n_vertices - first);
        if (v3_dot(own, others) < 0) own = v3_scale(own, -1);
        s->normals[i] = own;
    }
}

/* Reads p or pp. Memory grows with the vertices read, not with the declared count. */
static bool read_polygon(struct reader *r, bool patch)
{
    struct scene *s = r->s;
    uint32_t count, first = s->n_vertices;
    if (!reader_int(r, patch ? "patch's count" : "polygon's count", 3, POLYGON_MAX, &count))
        return false;
    if (count > NFF_COUNT_MAX - first)
        return reader_fail(r, "more vertices than %u in all", NFF_COUNT_MAX);
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 v, n;
        if (!coordinates(r, patch ? "patch's vertex" : "polygon's vertex", &v)) return false;
        if (patch && !reader_vec(r, "patch's normal", -NORMAL_MAX, NORMAL_MAX, &n)) return false;
        add_vertex(r, v);
        if (patch) set_normal(r, n);
    }
    if (patch) fill_normals(s, first);
    struct prim *p = add_prim(r, patch ? PRIM_PATCH : PRIM_POLYGON);
    p->poly.first = first;
    p->poly.count = count;
    return true;
}

static bool read_p(struct reader *r) { return read_polygon(r, false); }
static bool read_pp(struct reader *r) { return read_polygon(r, true); }

static const struct entity {
    char word[NFF_WORD_MAX + 1];
    bool prim;
    bool (*read)(struct reader *);
} entities[] = {{"p", true, read_p}, {"s", true, read_sphere}, {"c", true, read_cone},
    {"pp", true, read_pp}, {"f", false, reader_material}, {"l", false, read_light},
    {"v", false, reader_view}, {"b", false, read_background}};

static const struct entity *find_entity(const char *word, size_t n)
{
    for (size_t i = 0; i < sizeof entities / sizeof *entities; i++)
        if (strlen(entities[i].word) == n && memcmp(entities[i].word, word, n) == 0)
            return &entities[i];
    return NULL;
}

bool nff_is_entity(const char *word, size_t n) { return find_entity(word, n) != NULL; }

static bool read_entity(struct reader *r, size_t n)
{
    const struct entity *e = find_entity(r->t.at, n);
    if (!e) return reader_fail_token(r, "entity", "one of v b l f s c p pp");
    if (r->s->n_prims >= NFF_COUNT_MAX || r->s->n_lights >= NFF_COUNT_MAX)
        return reader_fail(r, "more entities than %u", NFF_COUNT_MAX);
    token_take(&r->t, n);
    return e->read(r);
}

bool reader_entities(struct reader *r)
{
    for (size_t n; (n = token_peek(&r->t)) != 0;)
        if (!read_entity(r, n)) return false;
    return true;
}

void nff_share_light(struct scene *s)
{
    for (uint32_t i = 0; i < s->n_lights; i++) {
        struct light *l = &s->lights[i];
        if (!l->own_colour) l->r = l->g = l->b = 1 / sqrt(s->n_lights);
    }
}

static bool read_all(struct reader *r)
{
    reader_add_material(r, &NFF_MATERIAL_DEFAULT);
    if (!reader_entities(r)) return false;
    if (!r->view_line) return reader_fail(r, "the file ends without a view, expected a 'v'");
    nff_share_light(r->s);
    return true;
}

int nff_read(const char *name, const char *text, size_t n, struct scene *s, char err[SCENE_ERR])
{
    struct reader r = {.name = name, .err = err, .s = s};
    *s = (struct scene){0};
    err[0] = '\0';
    tokens_init(&r.t, text, n);
    bool ok = read_all(&r);
    free(r.material_slot);
    if (!ok) scene_free(s);
    return ok ? 0 : -1;
}

uint32_t nff_line(const char *text, size_t n, uint32_t i)
{
    struct tokens t;
    tokens_init(&t, text, n);
    for (size_t len; (len = token_peek(&t)) > 0; token_take(&t, len)) {
        const struct entity *e = find_entity(t.at, len);
        if (e && e->prim && i-- == 0) return t.line;
    }
    return t.line;
}
