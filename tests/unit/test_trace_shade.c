/* The shaders give the bits of the scalar functions, in each lane and at every width. */
#include "trace/shade.h"

#include <stdarg.h>
#include "trace_scenes.h"

static const struct shaders *all[2];

static bool same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

static void test_pow(void **state)
{
    (void)state;
    static const double edges[] = {
        0, 1e-310, 1e-300, 1e-299, .5, 0.70710678118654746, 0.70710678118654757, 1 - 0x1p-53, 1};
    const unsigned n_edges = sizeof edges / sizeof *edges;
    uint64_t c = 0;
    for (int round = 0; round < 2000; round++) {
        double x[WAVE_RAYS], y[WAVE_RAYS], got[WAVE_RAYS];
        for (unsigned i = 0; i < WAVE_RAYS; i++) {
            x[i] = between(1, &c, 0, 1), y[i] = pow(10, between(1, &c, -2, 5));
            if (i % 4 == 1) x[i] = 1 - x[i] * 1e-5;
            if (i % 4 == 2) x[i] = pow(x[i], 1000);
            if (i % 8 == 3) x[i] = edges[c % n_edges];
            if (i % 16 == 7) y[i] = 0;
        }
        for (int k = 0; k < 2 && all[k]; k++) {
            all[k]->pow(x, y, WAVE_RAYS, got);
            for (unsigned i = 0; i < WAVE_RAYS; i++)
                if (!same(got[i], trace_pow(x[i], y[i])))
                    fail_msg("%.17g ^ %.17g = %.17g, in lane %u of width %d %.17g", x[i], y[i],
                        trace_pow(x[i], y[i]), i, k, got[i]);
        }
    }
}

static struct vec3 random_vector(uint64_t *c)
{
    return v3(between(2, c, -1, 1), between(2, c, -1, 1), between(2, c, -1, 1));
}

/* Points near and far from the lamp, in its plane and behind it; matt, glossy and black ones. */
static void make_point(struct hit_point *at, struct surface *f, const struct light *l, uint64_t *c,
    struct shade_points *to, unsigned i)
{
    double dull = between(2, c, 0, 1), black = between(2, c, 0, 1);
    at->p = v3_scale(random_vector(c), pow(10, between(2, c, -2, 3)));
    at->n = v3_unit(random_vector(c));
    at->mirrored = v3_unit(random_vector(c));
    struct vec3 d = v3_sub(l->pos, at->p);
    if (dull < .1) at->n = v3_unit(v3_cross(d, at->n)); /* in the plane */
    if (dull > .7) at->mirrored = v3_unit(d);           /* the centre of the highlight */
    at->err = ERR_UNIT * (fabs(at->p.x) + fabs(at->p.y) + fabs(at->p.z));
    at->surface = f;
    *f = (struct surface){.ks = dull < .4 ? 0 : dull, .shine = pow(10, between(2, c, -2, 4))};
    if (black > .3) f->colour_kd = v3(between(2, c, 0, 1), 0, between(2, c, 0, 1));
    f->diffuse = black > .3;
    const struct vec3 v[] = {at->p, at->n, at->mirrored, f->colour_kd};
    double(*lanes[])[WAVE_RAYS] = {to->p, to->n, to->mirrored, to->colour_kd};
    for (int k = 0; k < 4; k++)
        lanes[k][0][i] = v[k].x, lanes[k][1][i] = v[k].y, lanes[k][2][i] = v[k].z;
    to->err[i] = at->err, to->ks[i] = f->ks, to->shine[i] = f->shine;
}

static void compare_lane(const struct tracer *t, const struct hit_point *at, bool lit,
    const struct shade_light *got, unsigned i)
{
    struct vec3 light;
    struct ray r;
    assert_int_equal(light_from(t, at, 0, &light, &r), lit);
    if (!lit) return;
    assert_true(same(got->distance[i], r.t_max));
    assert_true(same(got->light[0][i], light.x) && same(got->light[1][i], light.y));
    assert_true(same(got->light[2][i], light.z));
    assert_true(same(got->d[0][i], r.d.x) && same(got->d[1][i], r.d.y));
    assert_true(same(got->d[2][i], r.d.z));
}

static void test_light(void **state)
{
    (void)state;
    uint64_t c = 0;
    unsigned n_lit = 0, n_dark = 0;
    for (unsigned round = 0; round < 2000; round++) {
        struct light l = {.pos = v3_scale(random_vector(&c), 10), .r = .5, .g = .25, .b = 1};
        struct scene s = {.lights = &l, .n_lights = 1};
        bool in_surface = false;
        struct tracer t = {.scene = &s, .light_in_surface = &in_surface};
        struct hit_point at[WAVE_RAYS];
        struct surface f[WAVE_RAYS];
        static struct shade_points points;
        unsigned n = 1 + round % WAVE_RAYS;
        for (unsigned i = 0; i < n; i++) make_point(&at[i], &f[i], &l, &c, &points, i);
        for (int k = 0; k < 2 && all[k]; k++) {
            static struct shade_light got;
            uint64_t bits = all[k]->light(&points, n, &l, &got);
            if (n < 64) assert_int_equal(bits >> n, 0);
            for (unsigned i = 0; i < n; i++) {
                bool lit = bits >> i & 1;
                compare_lane(&t, &at[i], lit, &got, i);
                n_lit += lit, n_dark += !lit;
            }
        }
    }
    assert_true(n_lit > 1000 && n_dark > 1000);
}

static void test_eye_rays(void **state)
{
    (void)state;
    struct camera cam = camera_new(v3(1, 2, 3), v3(.1, -.2, .3), v3(0, .1, 1), 37);
    uint64_t c = 0;
    cam.w = 641, cam.h = 479;
    for (unsigned n = 1; n <= WAVE_RAYS; n++) {
        double x[WAVE_RAYS] = {0}, y[WAVE_RAYS] = {0};
        struct ray r[WAVE_RAYS];
        for (unsigned i = 0; i < n; i++)
            x[i] = between(3, &c, 0, 641), y[i] = between(3, &c, 0, 479);
        for (int k = 0; k < 2 && all[k]; k++) {
            all[k]->eye_rays(&cam, .7, x, y, n, r);
            for (unsigned i = 0; i < n; i++) {
                struct vec3 d = camera_direction(&cam, x[i], y[i]), unit = v3_unit(d);
                assert_true(same(r[i].d.x, unit.x) && same(r[i].d.y, unit.y));
                assert_true(same(r[i].d.z, unit.z) && same(r[i].t_min, .7 * v3_len(d)));
                assert_true(same(r[i].o.x, 1) && r[i].t_max > 1e300 && same(r[i].err, 0));
                assert_false(r[i].to_surface);
            }
        }
    }
}

int main(void)
{
    all[0] = trace_shaders_sse2();
    all[1] = trace_shaders_avx2();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pow),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_eye_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
