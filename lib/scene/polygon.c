/*
 * polygon: what prim.h asks of a polygon, and of a patch, which has normals. Whether hither may
 * hide it is decided triangle by triangle. Each is clipped plane by plane (I. Sutherland, G.
 * Hodgman, "Reentrant polygon clipping", CACM 17(1), 1974). Clipping is exact, which matters
 * because floors often pass close to the eye, outside the picture.
 */
#include "scene/prim.h"

#include <stdlib.h>

#define POLYGON_MAX 1000000U /* vertices per polygon; 10 s to triangulate, in most cases */
#define NORMAL_MAX 1e18
#define CLIPPED_MAX (3 + PYRAMID_PLANES)

static void add_vertex(struct reader *r, struct vec3 v)
{
    struct scene *s = r->s;
    if (s->n_vertices == r->room_vertices) {
        s->vertices = reader_grown(s->vertices, s->n_vertices, &r->room_vertices, sizeof v);
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
        if (!reader_point(r, patch ? "patch's vertex" : "polygon's vertex", &v)) return false;
        if (patch && !reader_vec(r, "patch's normal", -NORMAL_MAX, NORMAL_MAX, &n)) return false;
        add_vertex(r, v);
        if (patch) set_normal(r, n);
    }
    if (patch) fill_normals(s, first);
    struct prim *p = reader_add_prim(r, patch ? PRIM_PATCH : PRIM_POLYGON);
    p->poly.first = first;
    p->poly.count = count;
    return true;
}

static bool read_p(struct reader *r) { return read_polygon(r, false); }
static bool read_pp(struct reader *r) { return read_polygon(r, true); }

void nff_put_polygon(
    struct nff_out *o, uint32_t n, const struct vec3 *v, const struct vec3 *normals)
{
    fprintf(o->f, "%s %u\n", normals ? "pp" : "p", n);
    for (uint32_t i = 0; i < n; i++) {
        nff_put_vec(o, "", v[i]);
        if (normals) nff_put_vec(o, " ", normals[i]);
        putc('\n', o->f);
    }
}

static void write(struct nff_out *o, const struct scene *s, const struct prim *p)
{
    uint32_t first = p->poly.first;
    nff_put_polygon(
        o, p->poly.count, s->vertices + first, p->kind == PRIM_PATCH ? s->normals + first : NULL);
}

static void bounds(const struct scene *s, const struct prim *p, struct vec3 *lo, struct vec3 *hi)
{
    for (uint32_t i = 0; i < p->poly.count; i++) {
        struct vec3 v = s->vertices[p->poly.first + i];
        scene_include(lo, hi, v, v);
    }
}

static bool triangle_reaches(const struct pyramid *y, const struct vec3 t[3])
{
    struct vec3 a[CLIPPED_MAX + 1], b[CLIPPED_MAX + 1];
    int n = 3;
    for (int i = 0; i < 3; i++) a[i] = v3_sub(t[i], y->eye);
    for (int k = 0; k < PYRAMID_PLANES && n; k++) {
        int m = 0;
        for (int i = 0; i < n; i++) {
            struct vec3 p = a[i], q = a[(i + 1) % n];
            double dp = v3_dot(y->normal[k], p) - y->offset[k];
            double dq = v3_dot(y->normal[k], q) - y->offset[k];
            if (dp <= 0) b[m++] = p;
            if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0))
                b[m++] = v3_mad(p, v3_sub(q, p), dp / (dp - dq));
        }
        for (int i = 0; i < m; i++) a[i] = b[i];
        n = m;
    }
    return n > 0;
}

static bool reaches(const struct pyramid *y, const struct scene *s, const struct prim *p)
{
    struct triangle *cut = xmalloc(p->poly.count - 2, sizeof *cut);
    uint32_t n = scene_triangulate(s, p, cut);
    bool in = false;
    for (uint32_t i = 0; i < n && !in; i++) {
        struct vec3 t[3];
        for (int k = 0; k < 3; k++) t[k] = s->vertices[cut[i].v[k]];
        in = triangle_reaches(y, t);
    }
    free(cut);
    return in;
}

const struct prim_row scene_polygon = {
    .word = "p",
    .sample = "f 1 .9 .5 .8 .2 20 0 0\np 5 -3 -3 0 3 -3 0 3 3 0 0 1 0 -3 3 .01\n",
    .read = read_p,
    .write = write,
    .bounds = bounds,
    .reaches = reaches,
};

const struct prim_row scene_patch = {
    .word = "pp",
    .sample = "f .3 .4 1 .9 .1 5 0 0\n"
              "pp 3 1 -1 0 0 0 1 2 -1.5 .3 .3 0 1 1.4 -.3 1.1 0 .4 1\n",
    .read = read_pp,
    .write = write,
    .bounds = bounds,
    .reaches = reaches,
};
