/*
 * Whatever the bytes: nff_read returns a scene or a message. What it accepts is in range,
 * triangulates within its bounds, and survives being written and read again. Text that is read in
 * two parts gives the same. nff_read_view returns a view or a message.
 *
 *     clang -g -O1 -std=c11 -D_GNU_SOURCE -ffp-contract=off -Ilib \
 *         -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined \
 *         -o build/fuzz_nff tests/fuzz/fuzz_nff.c lib/scene/?*.c lib/base/?*.c -lm
 *     mkdir -p build/corpus
 *     build/fuzz_nff -max_total_time=600 build/corpus tests/fuzz/corpus/nff
 */
#include "scene/reader.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

static void check_triangles(const struct scene *s, const struct prim *p)
{
    struct triangle *t = xmalloc(p->poly.count - 2, sizeof *t);
    uint32_t n = scene_triangulate(s, p, t);
    MUST(n <= p->poly.count - 2);
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            MUST(t[i].v[k] >= p->poly.first && t[i].v[k] < p->poly.first + p->poly.count);
            MUST(t[i].v[k] != t[i].v[(k + 1) % 3]);
        }
    free(t);
}

static void check_prim(const struct scene *s, const struct prim *p)
{
    struct vec3 lo, hi;
    MUST(p->material < s->n_materials);
    scene_prim_bounds(s, p, &lo, &hi);
    MUST(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z);
    MUST(isfinite(lo.x + lo.y + lo.z) && isfinite(hi.x + hi.y + hi.z));
    if (p->kind == PRIM_SPHERE) MUST(p->sphere.radius > 0);
    if (p->kind == PRIM_CONE) MUST(p->cone.base_radius >= 0 && p->cone.apex_radius >= 0);
    if (!prim_is_poly(p)) return;
    MUST(p->poly.count >= 3 && p->poly.first + p->poly.count <= s->n_vertices);
    check_triangles(s, p);
    for (uint32_t i = 0; i < p->poly.count && p->kind == PRIM_PATCH; i++)
        MUST(fabs(v3_len(s->normals[p->poly.first + i]) - 1) < 1e-12);
}

static void check_round_trip(const struct scene *s)
{
    char *text, err[SCENE_ERR];
    size_t n;
    struct nff_out o = {open_memstream(&text, &n), NFF_DIGITS_MAX};
    struct scene again;
    nff_put_view(&o, &s->view);
    nff_put_background(&o, s->background[0], s->background[1], s->background[2]);
    for (uint32_t i = 0; i < s->n_lights; i++) nff_put_light(&o, &s->lights[i]);
    for (uint32_t i = 0; i < s->n_prims; i++) {
        nff_put_material(&o, &s->materials[s->prims[i].material]);
        scene_put_prim(&o, s, &s->prims[i]);
    }
    MUST(fclose(o.f) == 0);
    MUST(nff_read("again", text, n, &again, err) == 0);
    MUST(memcmp(&s->view, &again.view, sizeof s->view) == 0);
    MUST(again.n_lights == s->n_lights && again.n_prims == s->n_prims);
    MUST(again.n_vertices == s->n_vertices);
    MUST(!s->n_lights || memcmp(s->lights, again.lights, s->n_lights * sizeof *s->lights) == 0);
    MUST(!s->n_vertices ||
         memcmp(s->vertices, again.vertices, s->n_vertices * sizeof *s->vertices) == 0);
    for (uint32_t i = 0; i < s->n_prims; i++) {
        const struct prim *a = &s->prims[i];
        struct prim b = again.prims[i];
        MUST(memcmp(&s->materials[a->material], &again.materials[b.material],
                 sizeof *s->materials) == 0);
        b.material = a->material;
        MUST(memcmp(a, &b, sizeof b) == 0);
    }
    scene_free(&again);
    free(text);
}

static void check_parts(const char *text, size_t n, int rc, const char *err, const struct scene *s)
{
    struct scene p;
    char err_p[SCENE_ERR];
    MUST(nff_read_parts("fuzz", text, n, 2, 1, &p, err_p) == rc && strcmp(err_p, err) == 0);
    MUST(p.n_lights == s->n_lights && p.n_materials == s->n_materials);
    MUST(p.n_prims == s->n_prims && p.n_vertices == s->n_vertices);
    MUST(!p.n_materials ||
         memcmp(p.materials, s->materials, p.n_materials * sizeof *p.materials) == 0);
    MUST(!p.n_vertices || memcmp(p.vertices, s->vertices, p.n_vertices * sizeof *p.vertices) == 0);
    MUST(!p.normals == !s->normals);
    MUST(!p.normals || memcmp(p.normals, s->normals, p.n_vertices * sizeof *p.normals) == 0);
    MUST(!p.n_prims || memcmp(p.prims, s->prims, p.n_prims * sizeof *p.prims) == 0);
    scene_free(&p);
}

static void check_pov(const struct scene *s)
{
    char *text;
    size_t n;
    FILE *f = open_memstream(&text, &n);
    pov_write(f, s, 100);
    MUST(fclose(f) == 0);
    MUST(!strstr(text, "nan") && !strstr(text, "inf"));
    free(text);
}

static void check_view(const char *text, size_t n)
{
    struct view v, again;
    char err[SCENE_ERR], *written;
    if (nff_read_view("fuzz", text, n, &v, err) != 0) {
        MUST(strncmp(err, "fuzz:", 5) == 0 && strstr(err, "expected"));
        return;
    }
    struct nff_out o = {open_memstream(&written, &n), NFF_DIGITS_MAX};
    nff_put_view_words(&o, &v);
    MUST(fclose(o.f) == 0);
    MUST(nff_read_view("again", written, n, &again, err) == 0);
    MUST(memcmp(&v, &again, sizeof v) == 0);
    free(written);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct scene s;
    char err[SCENE_ERR];
    uint32_t which;
    /* Exactly as long as the bytes, so that a read past them is seen. */
    char *text = xmalloc(size, 1);
    if (size) memcpy(text, data, size);
    int rc = nff_read("fuzz", text, size, &s, err);
    check_parts(text, size, rc, err, &s);
    check_view(text, size);
    free(text);
    if (rc != 0) {
        MUST(strncmp(err, "fuzz:", 5) == 0 && strlen(err) > 8);
        MUST(!s.prims && !s.materials && !s.n_prims);
        return 0;
    }
    for (uint32_t i = 0; i < s.n_prims; i++) check_prim(&s, &s.prims[i]);
    if (scene_hither_clips(&s, &which)) MUST(which < s.n_prims);
    check_round_trip(&s);
    check_pov(&s);
    scene_free(&s);
    return 0;
}
