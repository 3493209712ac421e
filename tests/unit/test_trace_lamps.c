/*
 * Lamps that lie in a surface, and just behind one: what a shadow ray meets, at every vector width,
 * against a reference in long double that takes the lamp to be on the surface and leaves out that
 * root.
 */
#define SIMD_MOST 8
#include "trace/packet.h"

#include <stdarg.h>
#include "trace_scenes.h"

static const struct kernels scalar = {"scalar", closest, blocked, closest_packet, blocked_packet};

enum answer { CLEAR, SHADED, TOO_NEAR };

/* Where the way from p to the lamp, 0 to 1, crosses the surface but at the lamp. */
static enum answer reference(const struct scene *s, struct vec3 lamp, struct vec3 p)
{
    const struct prim *q = &s->prims[0];
    const real slack = 1e-4L;
    if (!prim_kinds[q->kind].again) return CLEAR;
    real z, t = prim_kinds[q->kind].again(q, lamp, less(lamp, p), &z);
    if (fabsl(t) < slack || fabsl(t - 1) < slack || fabsl(z) < slack || fabsl(z - 1) < slack)
        return TOO_NEAR;
    return t > 0 && t < 1 && z > 0 && z < 1 ? SHADED : CLEAR;
}

static struct vec3 lamp_on(const struct scene *s, uint64_t seed, uint64_t *n, struct vec3 *normal)
{
    struct vec3 d = v3_unit(random_point(seed, n, 1));
    double u = between(seed, n, .1, .4), v = between(seed, n, .1, .4);
    return prim_kinds[s->prims[0].kind].lamp(s, &s->prims[0], d, u, v, normal);
}

static void seen_from(const struct tracer *t, struct vec3 p, enum answer want, const char *what)
{
    const struct kernels *all[] = {
        &scalar, trace_kernels_sse2(), trace_kernels_avx2(), trace_kernels_avx512()};
    struct vec3 light, n = v3_unit(v3_sub(t->scene->lights[0].pos, p));
    double err = ERR_UNIT * (fabs(p.x) + fabs(p.y) + fabs(p.z));
    struct hit_point at = {p, n, n, err, &t->items[0], &t->surfaces[0], 0};
    struct ray r;
    const struct ray *one = &r;
    assert_true(light_from(t, &at, 0, &light, &r));
    for (int k = 0; k < 4; k++) {
        struct crossings c = {NULL, 0, 0};
        if (!all[k] || want == TOO_NEAR) continue;
        bool alone = all[k]->blocked(&t->bvh, &r, NULL, &c);
        bool packed = all[k]->blocked_packet(&t->bvh, &one, 1, NULL, &c);
        if (alone != (want == SHADED) || packed != alone)
            fail_msg("%s, %s, kind %d, from %.17g %.17g %.17g: blocked %d, %d in a packet", what,
                all[k]->name, t->scene->prims[0].kind, p.x, p.y, p.z, alone, packed);
    }
}

/* One primitive at a place, and a lamp in it, or behind it as near as can be told. */
static void try_lamps(struct placing at, uint64_t seed, bool behind)
{
    struct buf text = {0};
    struct scene s;
    uint64_t n = 0;
    put_view(&text, at, 5, 0, 1, 0);
    put_light(&text, at, 0, 0, 9);
    put_random_prim(&text, at, seed, &n);
    read_scene(&text, &s);
    struct vec3 normal, lamp = lamp_on(&s, seed, &n, &normal);
    double far = fabs(lamp.x) + fabs(lamp.y) + fabs(lamp.z) + 10 * at.scale;
    s.lights[0].pos = v3_mad(lamp, normal, behind ? -8 * ERR_UNIT * far : 0);
    struct tracer *t = tracer_with(&s, &scalar);
    for (int i = 0; i < 60; i++) {
        struct vec3 across, other = lamp_on(&s, seed, &n, &across);
        struct vec3 p = random_point(seed, &n, 3 * at.scale);
        p = v3_add(p, v3(at.shift, at.shift, at.shift));
        bool outside = v3_dot(v3_unit(v3_sub(p, lamp)), normal) > 1e-2;
        if (behind && outside) seen_from(t, p, SHADED, "lamp behind the surface");
        if (behind) continue;
        seen_from(t, p, reference(&s, lamp, p), "lamp in the surface");
        seen_from(t, other, CLEAR, "both in the surface");
    }
    tracer_free(t);
    scene_free(&s);
}

static void test_lamps_in_surfaces(void **state)
{
    (void)state;
    static const struct placing places[] = {{1, 0}, {1e-4, 0}, {1e6, 0}, {1, 1e6}, {1e-4, 7}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        for (uint64_t seed = 0; seed < 240; seed++)
            try_lamps(places[i], 1000 * i + seed / 2, seed % 2);
}

/* A floor that a lamp lies in gets none of its light, not even a highlight as seen at 1e-2. */
static void test_lamp_in_the_plane(void **state)
{
    (void)state;
    struct buf text = {0};
    struct scene s;
    buf_printf(&text, "b 0 0 0 v from 9 3 4.1 at 0 0 0.3 up 0 0 1 angle 60 hither 0 "
                      "resolution 64 64 l 1.3 -.7 .1 f 1 1 1 0 1 3 0 0 p 3 ");
    for (int i = 0; i < 3; i++) { /* lamp + 37 * two directions in the plane */
        const double u[] = {-1, 2, -1}, v[] = {-1, -1, 2};
        put_point(&text, in_place, 1.3 + 37 * (.7 * u[i] + .1 * v[i]),
            -.7 + 37 * (.2 * u[i] + .9 * v[i]), .1 + 37 * (.3 * u[i] + .4 * v[i]));
    }
    buf_printf(&text, "\n");
    read_scene(&text, &s);
    struct tracer *t = tracer_with(&s, &scalar);
    float *rgba = render(t, 64, 64, 64, false);
    for (int i = 0; i < 64 * 64; i++) assert_true(rgba[4 * i] == 0);
    free(rgba);
    tracer_free(t);
    scene_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lamps_in_surfaces),
        cmocka_unit_test(test_lamp_in_the_plane),
    };
    return cmocka_run_group_tests_name("trace: lamps", tests, NULL, NULL);
}
