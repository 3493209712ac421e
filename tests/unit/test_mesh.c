/* The numbers of mesh2nff: the shortest decimals that read back as the same float. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "mesh/mesh.h"

static const char *text_of(float v)
{
    static char text[MESH_NUMBER + 1];
    size_t n = mesh_number(text, v);
    assert_true(n < sizeof text);
    text[n] = '\0';
    return text;
}

static void written_as_people_write_them(void **state)
{
    (void)state;
    static const struct {
        float v;
        const char *text;
    } table[] = {{0, "0"}, {-0.0F, "0"}, {1, "1"}, {-1, "-1"}, {.5F, "0.5"}, {.1F, "0.1"},
        {-12.25F, "-12.25"}, {100, "100"}, {1e9F, "1000000000"}, {123456, "123456"},
        {16777216, "16777216"}, {.001F, "0.001"}, {1e-5F, "0.00001"}, {1.5e-6F, "1.5e-6"},
        {1e10F, "1e10"}, {-2.5e12F, "-2.5e12"}, {.3F, "0.3"}, {1.F / 3, "0.33333334"},
        {999999.9F, "999999.9"}, {9.999999e9F, "9999999000"}, {.99999994F, "0.99999994"}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        assert_string_equal(text_of(table[i].v), table[i].text);
}

static float of_bits(uint32_t bits)
{
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* Digits without zeros at either end. */
static int significant(const char *text)
{
    int n = 0, zeros = 0;
    for (; *text && *text != 'e'; text++) {
        if (*text < '0' || *text > '9') continue;
        if (*text == '0') zeros += n > 0;
        else n += zeros + 1, zeros = 0;
    }
    return n;
}

static void check(float v)
{
    const char *text = text_of(v);
    char *end, other[40];
    double back = strtod(text, &end);
    if (*end || (float)back != v) fail_msg("%.9g became %s", (double)v, text);
    int n = significant(text);
    if (n > 9) fail_msg("%.9g has %d digits: %s", (double)v, n, text);
    if (n < 2) return;
    snprintf(other, sizeof other, "%.*e", n - 2, (double)v);
    if ((float)strtod(other, NULL) == v) fail_msg("%s is shorter than %s", other, text);
}

static void read_back_and_the_shortest(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 200000; i++) {
        float v = of_bits((uint32_t)rng_u64(1, i));
        if (isfinite(v)) check(v);
        check((float)(rng_unit(2, i) * 200 - 100));
        check((float)((double)(rng_u64(3, i) % 100000) / 1000));
    }
    for (int e = -45; e <= 38; e++) {
        float v = (float)pow(10, e);
        check(v);
        check(nextafterf(v, 0));
        if (e < 38) check(nextafterf(v, 1e38F));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(written_as_people_write_them),
        cmocka_unit_test(read_back_and_the_shortest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
