/* Expressions: which variables they name, their values and units; and what is refused. */
#include "convert/convert.h"
#include "units/units.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* What the file of these tests has. */
static const char *const names[] = {"U", "V", "a/U", "10u", "T", "q", "sea-ice", "a", NULL};
static bool known(void *ctx, const char *name)
{
    (void)ctx;
    for (const char *const *n = names; *n; n++)
        if (strcmp(*n, name) == 0) return true;
    return false;
}

static bool parse(const char *text, struct convert_request *r)
{
    char err[ERR_BYTES] = "";
    bool good = convert_request_parse(text, known, NULL, r, err);
    assert_true(good == !err[0]);
    return good;
}

static void test_names(void **state)
{
    (void)state;
    static const struct {
        const char *text, *name, *part[2];
        int n;
    } good[] = {{"U", "U", {"U"}, 1}, {"x/y/U", "U", {"x/y/U"}, 1}, {"T(K)", "T(K)", {"T(K)"}, 1},
        {"speed=hypot(a/U,V)", "speed", {"a/U", "V"}, 2},
        {" s = hypot( U , V ) ", "s", {"U", "V"}, 2}, {"s=U", "s", {"U"}, 1},
        {"s=a/V", "s", {"a", "V"}, 2}, {"s=U/a/U", "s", {"U", "a/U"}, 2},
        {"s=10u*10", "s", {"10u"}, 1}, {"s=2*'sea-ice'-U", "s", {"sea-ice", "U"}, 2},
        {"s=U*U+V*V", "s", {"U", "V"}, 2}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct convert_request r;
        assert_true(parse(good[i].text, &r));
        assert_string_equal(r.name, good[i].name);
        assert_int_equal(r.n, good[i].n);
        for (int k = 0; k < r.n; k++) assert_string_equal(r.part[k], good[i].part[k]);
    }
}

static void test_bad(void **state)
{
    (void)state;
    static const char *const bad[] = {"", " ", "=", "s=", "s=hypot(U)", "s=hypot(U,V",
        "s=hypot(,V)", "s=hypot(U,)", "s=hypot(U,", "hypot(U,V)", "s=sqrt(U,V)", "s=hypot(",
        "=hypot(U,V)", "s=U+", "s=*U", "s=U V", "s=1+2", "s=U)", "s=(U", "s=U^0", "s=U^1.5",
        "s=U^10", "s=1e999*U", "s='U", "s=''", "s=3x*U", "s=U^", "s=-"};
    char deep[4096], err[ERR_BYTES];
    struct convert_request r;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) assert_false(parse(bad[i], &r));
    strcpy(deep, "s=");
    memset(deep + 2, '(', sizeof deep - 3);
    deep[sizeof deep - 1] = '\0';
    assert_false(parse(deep, &r));
    memset(deep + 2, '-', sizeof deep - 3);
    assert_false(parse(deep, &r));
    for (size_t i = 2; i < sizeof deep - 1; i++) deep[i] = "U+"[i % 2];
    assert_false(convert_request_parse(deep, known, NULL, &r, err));
    assert_string_equal(err, "too long, expected 64 steps at most");
    assert_false(convert_request_parse("s=b+c+d+e+f+g+h+i+j", known, NULL, &r, err));
    assert_string_equal(err, "too many variables, expected 8 at most");
}

static void test_values(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value; /* with U 3, V 4 */
    } table[] = {{"s=hypot(U,V)", 5}, {"s=U+V*2", 11}, {"s=(U+V)*2", 14}, {"s=U-V-1", -2},
        {"s=V/U/2", 4 / 3. / 2}, {"s=-U^2", -9}, {"s=(-U)^3+1e1", -17}, {"s=sqrt(U*U+V^2)", 5},
        {"s=1/(U-3)", (double)NAN}, {"s=sqrt(U-V)", (double)NAN}, {"s=2*-U", -6},
        {"s=.5*sqrt( V )", 1}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct convert_request r;
        const float u = 3, v = 4, *part[2];
        assert_true(parse(table[i].text, &r));
        for (int k = 0; k < r.n; k++) part[k] = r.part[k][0] == 'U' ? &u : &v;
        const double got = convert_request_at(&r, part, 0);
        if (isnan(table[i].value)) assert_true(isnan(got));
        else assert_true(fabs(got - table[i].value) < 1e-12);
    }
}

/* The unit of an expression of U and T in these units; NULL: refused. */
static const char *unit_of(const char *text, const char *u, const char *t)
{
    static struct convert_request r;
    const char *unit[2];
    char err[ERR_BYTES];
    assert_true(parse(text, &r));
    for (int k = 0; k < r.n; k++) unit[k] = r.part[k][0] == 'U' ? u : t;
    return convert_request_unit(&r, unit, NULL, err) ? r.unit : NULL;
}

static void test_units(void **state)
{
    (void)state;
    struct units_linear l;
    char err[ERR_BYTES];
    assert_string_equal(unit_of("s=hypot(U,T)", "m/s", "m/s"), "m/s");
    assert_string_equal(unit_of("s=T-273.15", "m", "K"), "K");
    assert_string_equal(unit_of("s=2*T", "m", "degC"), "degC");
    assert_null(unit_of("s=U+T", "m", "K"));
    assert_string_equal(unit_of("s=U*T", "", "K"), "");
    if (!units_linear("km", "m", &l, err)) return; /* built without libudunits2 */
    assert_string_equal(unit_of("s=U+T", "m s-1", "m/s"), "m s-1");
    assert_null(unit_of("s=U+T", "m/s", "km/h"));
    static const struct {
        const char *text, *u, *t, *unit;
    } table[] = {{"s=U*T", "m s-1", "kg m-3", "kg m-2 s-1"}, {"s=U/T", "m", "s", "m/s"},
        {"s=sqrt(U*U+T*T)", "m/s", "m s**-1", "m/s"}, {"s=U^2", "m/s", "K", "m2 s-2"},
        {"s=1/T", "m", "s", "Hz"}, {"s=U/U", "m", "s", "1"}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const char *got = unit_of(table[i].text, table[i].u, table[i].t);
        assert_non_null(got);
        assert_true(units_linear(got, table[i].unit, &l, err) && fabs(l.factor - 1) < 1e-12);
    }
    assert_null(unit_of("s=U*T", "m", "degC"));
    assert_null(unit_of("s=sqrt(U)", "m/s", "K"));
    assert_null(unit_of("s=U*T", "m", "no unit at all"));
}

static void test_differences(void **state)
{
    (void)state;
    struct convert_request r;
    char err[ERR_BYTES];
    const char *const unit[] = {"degC", "degC"};
    assert_true(parse("s=T-U", &r) && convert_request_unit(&r, unit, NULL, err) && r.difference);
    assert_true(parse("s=T-3", &r) && convert_request_unit(&r, unit, NULL, err) && !r.difference);
    const bool second[] = {false, true};
    assert_true(parse("s=T+U", &r) && convert_request_unit(&r, unit, second, err) && !r.difference);
    assert_true(parse("s=T-U", &r) && convert_request_unit(&r, unit, second, err) && !r.difference);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_names), cmocka_unit_test(test_bad),
        cmocka_unit_test(test_values), cmocka_unit_test(test_units),
        cmocka_unit_test(test_differences)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
