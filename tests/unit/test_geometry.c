/* geometry: vectors, the camera and its tangent. */
#include "geometry/geometry.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void test_vectors(void **state)
{
    (void)state;
    struct vec3 c = v3_cross(v3(1, 2, 3), v3(-4, 5, 7)), m = v3_mad(v3(1, 2, 3), v3(2, 4, 6), .5);
    assert_true(c.x == -1 && c.y == -19 && c.z == 13);
    assert_true(m.x == 2 && m.y == 4 && m.z == 6);
    assert_true(v3_dot(v3(1, 2, 3), v3(4, -5, 6)) == 12);
    assert_true(v3_len(v3_unit(v3(3, 4, 12))) == 1);
    assert_true(v3_sub(v3_add(v3(1, 1, 1), v3(2, 3, 4)), v3(1, 1, 1)).z == 4);
}

/* Also where `up` is along the view, which leaves the roll open. */
static void test_camera(void **state)
{
    (void)state;
    const struct vec3 up[] = {{0, 0, 1}, {0, 1, 0}, {-3, 0, 0}, {1e-9, 0, 1}};
    for (size_t i = 0; i < sizeof up / sizeof *up; i++) {
        struct camera c = camera_new(v3(1, 2, 10), v3(1, 2, 4), up[i], 90);
        c.w = 200, c.h = 100;
        assert_true(c.eye.z == 10 && c.forward.z == -1);
        assert_true(fabs(v3_len(c.right) - 1) < 1e-12 && fabs(v3_len(c.up) - 1) < 1e-12);
        assert_true(fabs(v3_dot(c.right, c.up)) < 1e-12 && fabs(v3_dot(c.up, c.forward)) < 1e-12);
        struct vec3 middle = camera_direction(&c, 100, 50), corner = camera_direction(&c, 0, 100);
        assert_true(v3_len(v3_sub(middle, c.forward)) < 1e-12);
        struct vec3 aside = v3_sub(corner, c.forward);
        assert_true(v3_len(v3_sub(aside, v3_sub(v3_scale(c.right, -2), c.up))) < 1e-12);
    }
    struct camera north = camera_new(v3(1, 2, 10), v3(1, 2, 4), up[1], 90);
    assert_true(north.right.x > .999 && north.up.y > .999);
}

static void test_tangent(void **state)
{
    (void)state;
    for (int i = 0; i < 20000; i++) {
        double a = 1.5 * i / 20000;
        assert_true(fabs(portable_tan(a) - tan(a)) <= 1e-14 * tan(a));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vectors),
        cmocka_unit_test(test_camera),
        cmocka_unit_test(test_tangent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
