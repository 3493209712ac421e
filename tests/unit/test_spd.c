/*
 * Scenes against SPD 3.14: facts about what its own programs write at each size (gcc -O on
 * x86-64), taken once. The sum is that of every number under 1000 times its position mod 97; the
 * hash is of all tokens in order, numbers as %g writes them and 0 where they are under 1e-12:
 * there SPD's are rounding errors, which other libraries make differently.
 */
#include "spd/spd.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const struct fact {
    const char *name;
    int size;
    unsigned l, f, s, p; /* entities */
    unsigned numbers;
    double sum;
    uint64_t hash;
} facts[] = {
    {"balls", 1, 3, 2, 10, 1, 94, 17397.3063, UINT64_C(0x7f34d9e09e3d8a3d)},
    {"balls", 2, 3, 2, 91, 1, 418, 18234.0518, UINT64_C(0xd0c0a9cf1ede4a23)},
    {"balls", 3, 3, 2, 820, 1, 3334, 26193.0871, UINT64_C(0xf589e035b4b651af)},
    {"balls", 4, 3, 2, 7381, 1, 29578, 90704.5016, UINT64_C(0x31abb31af7730e29)},
    {"balls", 5, 3, 2, 66430, 1, 265774, 662188.056, UINT64_C(0xaf9f8b9906cfd1d5)},
    {"gears", 1, 5, 2, 0, 147, 2798, 98842.3609, UINT64_C(0x2e442531e40d2d6f)},
    {"gears", 2, 5, 9, 0, 1169, 22020, 590471.708, UINT64_C(0xb86bb09c91c988f3)},
    {"gears", 3, 5, 28, 0, 3943, 74194, 1830897.85, UINT64_C(0xb3e029844b89df78)},
    {"gears", 4, 5, 65, 0, 9345, 175796, 4206607.15, UINT64_C(0x36982c14b52c9e74)},
    {"gears", 5, 5, 126, 0, 18251, 343302, 8081894.17, UINT64_C(0xcde40f67bb945c35)},
    {"tetra", 1, 1, 1, 0, 4, 67, 16686.3564, UINT64_C(0xa2bde8d48366cd38)},
    {"tetra", 2, 1, 1, 0, 16, 187, 18928.3564, UINT64_C(0xc5823a64465e6762)},
    {"tetra", 3, 1, 1, 0, 64, 667, 25676.3564, UINT64_C(0xb9945d77b5046016)},
    {"tetra", 4, 1, 1, 0, 256, 2587, 52396.1064, UINT64_C(0xeabddfe0b10186a2)},
    {"tetra", 5, 1, 1, 0, 1024, 10267, 163625.606, UINT64_C(0x652c7e39d93b9eba)},
    {"tetra", 6, 1, 1, 0, 4096, 40987, 604718.044, UINT64_C(0x85a599a579b73b2a)},
    {"tetra", 7, 1, 1, 0, 16384, 163867, 2374611.73, UINT64_C(0x7c597a5bec348b76)},
    {"tetra", 8, 1, 1, 0, 65536, 655387, 9452332.14, UINT64_C(0xe061b60e3c0c57fa)},
};

/* The scene as text, to free. */
static char *scene_text(const char *name, int size, int digits)
{
    char *text;
    size_t n;
    struct nff_out o = {open_memstream(&text, &n), digits};
    spd_write(spd_find(name), &o, size, false);
    assert_int_equal(fclose(o.f), 0);
    return text;
}

static struct fact measure(const char *name, int size, char *text)
{
    struct fact got = {.name = name, .size = size, .hash = HASH64_INIT};
    char *save = NULL;
    for (char *t = strtok_r(text, " \n", &save); t; t = strtok_r(NULL, " \n", &save)) {
        char *end, shown[32];
        double v = strtod(t, &end);
        if (*end) {
            got.l += strcmp(t, "l") == 0, got.f += strcmp(t, "f") == 0;
            got.s += strcmp(t, "s") == 0, got.p += strcmp(t, "p") == 0;
            snprintf(shown, sizeof shown, "%s ", t);
        } else {
            got.numbers++;
            if (fabs(v) < 1e-12) v = 0;
            if (fabs(v) < 1000) got.sum += v * (got.numbers % 97);
            snprintf(shown, sizeof shown, "%g ", v);
        }
        got.hash = hash64(got.hash, shown, strlen(shown));
    }
    return got;
}

static void check_fact(const struct fact *want, int digits)
{
    char *text = scene_text(want->name, want->size, digits);
    struct fact got = measure(want->name, want->size, text);
    free(text);
    if (got.l != want->l || got.f != want->f || got.s != want->s || got.p != want->p ||
        got.numbers != want->numbers || fabs(got.sum - want->sum) > 1e-6 * fabs(want->sum) ||
        got.hash != want->hash)
        fail_msg("%s size %d: l %u f %u s %u p %u numbers %u sum %.9g hash %016llx", got.name,
            got.size, got.l, got.f, got.s, got.p, got.numbers, got.sum,
            (unsigned long long)got.hash);
}

static void test_as_spd_writes_them(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) check_fact(&facts[i], NFF_DIGITS_SPD);
}

/* More digits, rounded to six, are the same numbers. */
static void test_more_digits(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++)
        if (facts[i].size <= 3) check_fact(&facts[i], 15);
}

static void test_counts(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) {
        const struct fact *want = &facts[i];
        struct scene s;
        char err[SCENE_ERR];
        assert_int_equal(spd_find(want->name)->count(want->size), want->s + want->p);
        if (want->size > 4) continue;
        char *text = scene_text(want->name, want->size, NFF_DIGITS_SPD);
        assert_int_equal(nff_read(want->name, text, strlen(text), &s, err), 0);
        assert_int_equal(s.n_prims, want->s + want->p);
        assert_int_equal(s.n_lights, want->l);
        scene_free(&s);
        free(text);
    }
}

static void test_table(void **state)
{
    (void)state;
    assert_null(spd_find("ball"));
    assert_null(spd_find(""));
    for (size_t i = 0; i < spd_n_scenes; i++) {
        const struct spd_scene *scene = &spd_scenes[i];
        int max = spd_size_max(scene);
        assert_ptr_equal(spd_find(scene->name), scene);
        assert_true(max > scene->size);
        assert_true(scene->count(max) <= SPD_PRIMS_MAX && scene->count(max + 1) > SPD_PRIMS_MAX);
        /* SPD's defaults: the last size under 10000 primitives. */
        assert_true(scene->count(scene->size) < 10000 && scene->count(scene->size + 1) >= 10000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_spd_writes_them),
        cmocka_unit_test(test_more_digits),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_table),
    };
    return cmocka_run_group_tests_name("spd", tests, NULL, NULL);
}
