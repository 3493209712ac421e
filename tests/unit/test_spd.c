/*
 * Scenes against SPD 3.14: facts about what its own programs write at each size (gcc -O on
 * x86-64), taken once. The sum is that of every number under 1000 times its position mod 97; the
 * hash is FNV-1a of all tokens in order, numbers as %g writes them and 0 where they are under
 * 1e-12: there SPD's are rounding errors, which other libraries make differently.
 */
#include "spd/spd.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const struct fact {
    const char *name;
    int size;
    unsigned l, f, s, c, p, pp; /* entities */
    unsigned numbers;
    double sum;
    uint64_t hash;
} facts[] = {
    {"balls", 1, 3, 2, 10, 0, 1, 0, 94, 17397.3063, UINT64_C(0x7f34d9e09e3d8a3d)},
    {"balls", 2, 3, 2, 91, 0, 1, 0, 418, 18234.0518, UINT64_C(0xd0c0a9cf1ede4a23)},
    {"balls", 3, 3, 2, 820, 0, 1, 0, 3334, 26193.0871, UINT64_C(0xf589e035b4b651af)},
    {"balls", 4, 3, 2, 7381, 0, 1, 0, 29578, 90704.5016, UINT64_C(0x31abb31af7730e29)},
    {"balls", 5, 3, 2, 66430, 0, 1, 0, 265774, 662188.056, UINT64_C(0xaf9f8b9906cfd1d5)},
    {"gears", 1, 5, 2, 0, 0, 147, 0, 2798, 98842.3609, UINT64_C(0x2e442531e40d2d6f)},
    {"gears", 2, 5, 9, 0, 0, 1169, 0, 22020, 590471.708, UINT64_C(0xb86bb09c91c988f3)},
    {"gears", 3, 5, 28, 0, 0, 3943, 0, 74194, 1830897.85, UINT64_C(0xb3e029844b89df78)},
    {"gears", 4, 5, 65, 0, 0, 9345, 0, 175796, 4206607.15, UINT64_C(0x36982c14b52c9e74)},
    {"gears", 5, 5, 126, 0, 0, 18251, 0, 343302, 8081894.17, UINT64_C(0xcde40f67bb945c35)},
    {"jacks", 1, 1, 1, 6, 3, 0, 0, 75, 8166.9247, UINT64_C(0x77263248b5301dbe)},
    {"jacks", 2, 1, 1, 54, 27, 0, 0, 459, 8359.70669, UINT64_C(0xab274c3b520a3632)},
    {"jacks", 3, 1, 1, 438, 219, 0, 0, 3531, 8910.77887, UINT64_C(0x48e2519d815dbbcc)},
    {"jacks", 4, 1, 1, 3510, 1755, 0, 0, 28107, 13420.6007, UINT64_C(0xc959ad3d0b324368)},
    {"jacks", 5, 1, 1, 28086, 14043, 0, 0, 224715, 29959.4902, UINT64_C(0xe6cc60106f8568a4)},
    {"lattice", 1, 6, 20, 8, 12, 0, 0, 322, 23020.5616, UINT64_C(0x3276b7e5c6250b2e)},
    {"lattice", 2, 6, 81, 27, 54, 0, 0, 1222, 41419.0951, UINT64_C(0xe50198db1fccef09)},
    {"lattice", 3, 6, 208, 64, 144, 0, 0, 3106, 78878.7591, UINT64_C(0x814d81eb5ed2398d)},
    {"lattice", 4, 6, 425, 125, 300, 0, 0, 6334, 141194.54, UINT64_C(0xc755c806cf0a6874)},
    {"lattice", 5, 6, 756, 216, 540, 0, 0, 11266, 237050.002, UINT64_C(0x7d31cf434d4c1bfe)},
    {"lattice", 12, 6, 8281, 2197, 6084, 0, 0, 123742, 2384468.82, UINT64_C(0xac484f5eb0a3ee5e)},
    {"mount", 1, 1, 2, 4, 0, 8, 0, 131, 18920.5779, UINT64_C(0x29b11a112e9417cc)},
    {"mount", 2, 1, 2, 4, 0, 32, 0, 371, 23827.2704, UINT64_C(0x90df8c582e489358)},
    {"mount", 3, 1, 2, 4, 0, 128, 0, 1331, 39542.0255, UINT64_C(0x1a6e0f1eaeeb2499)},
    {"mount", 4, 1, 2, 4, 0, 512, 0, 5171, 105869.097, UINT64_C(0x165f839ef5322f56)},
    {"mount", 5, 1, 2, 4, 0, 2048, 0, 20531, 371196.92, UINT64_C(0x73401d095bb63dd2)},
    {"mount", 6, 1, 2, 4, 0, 8192, 0, 81971, 1432585.39, UINT64_C(0xb386b349c744fd43)},
    {"mount", 8, 1, 2, 4, 0, 131072, 0, 1310771, 17226422.3, UINT64_C(0x5a882fcb268375fd)},
    {"nurbtst", 1, 1, 1, 0, 0, 0, 1500, 28527, 466401.666, UINT64_C(0xcbf87464af50847f)},
    {"nurbtst", 2, 1, 1, 0, 0, 0, 1500, 28527, 466401.666, UINT64_C(0xcbf87464af50847f)},
    {"rings", 1, 3, 7, 30, 30, 1, 0, 454, 30365.8086, UINT64_C(0x8cfdbb58d8935b09)},
    {"rings", 2, 3, 31, 150, 150, 1, 0, 2086, 128653.538, UINT64_C(0x197c945efda26b79)},
    {"rings", 3, 3, 85, 420, 420, 1, 0, 5758, 449390.324, UINT64_C(0xf77c82466dcf95a8)},
    {"rings", 4, 3, 181, 900, 900, 1, 0, 12286, 1202808.38, UINT64_C(0x6bec4ef34b8d3e36)},
    {"rings", 5, 3, 331, 1650, 1650, 1, 0, 22486, 2662860.19, UINT64_C(0x52265ceb7d3a6d11)},
    {"rings", 7, 3, 841, 4200, 4200, 1, 0, 57166, 9127134.06, UINT64_C(0xbceab96fd1b7535d)},
    {"sample", 1, 1, 5, 0, 1, 16, 864, 16643, 151589.015, UINT64_C(0x8bffb290452e1f59)},
    {"sample", 2, 1, 5, 0, 1, 16, 864, 16643, 151589.015, UINT64_C(0x8bffb290452e1f59)},
    {"shells", 1, 1, 1, 361, 0, 0, 0, 1471, -25403.4006, UINT64_C(0x37e73d20c4c832c0)},
    {"shells", 2, 1, 1, 721, 0, 0, 0, 2911, -59782.094, UINT64_C(0x79257e3c7ce1529f)},
    {"shells", 3, 1, 1, 1441, 0, 0, 0, 5791, -139297.683, UINT64_C(0x2e446496e6e0b24d)},
    {"shells", 4, 1, 1, 2881, 0, 0, 0, 11551, -294398.782, UINT64_C(0xfe1c641108421c14)},
    {"shells", 5, 1, 1, 5761, 0, 0, 0, 23071, -603842.907, UINT64_C(0xe144b5840c66d6a1)},
    {"sombrero", 1, 1, 1, 0, 0, 1922, 0, 19247, -538177.337, UINT64_C(0xb5a5b4468d14a6cd)},
    {"sombrero", 2, 1, 1, 0, 0, 7938, 0, 79407, -2245395.87, UINT64_C(0x2f9257127e484dd9)},
    {"sombrero", 3, 1, 1, 0, 0, 32258, 0, 322607, -9286169.19, UINT64_C(0x936b06632d94d1d3)},
    {"teapot", 1, 2, 3, 0, 0, 1, 56, 1123, 40462.5423, UINT64_C(0x61f92c95d165df8e)},
    {"teapot", 2, 2, 3, 0, 0, 4, 240, 4658, 118886.652, UINT64_C(0x1b03c52978bb932e)},
    {"teapot", 3, 2, 3, 0, 0, 9, 552, 10651, 247727.165, UINT64_C(0xcfe9ca7a405761e6)},
    {"teapot", 4, 2, 3, 0, 0, 16, 992, 19102, 431174.729, UINT64_C(0xd4886651ef525ec7)},
    {"teapot", 5, 2, 3, 0, 0, 25, 1560, 30011, 658930.207, UINT64_C(0xc86d22cc91c2d26e)},
    {"teapot", 6, 2, 3, 0, 0, 36, 2256, 43378, 948651.113, UINT64_C(0x84e2cdd4bc601a36)},
    {"tetra", 1, 1, 1, 0, 0, 4, 0, 67, 16686.3564, UINT64_C(0xa2bde8d48366cd38)},
    {"tetra", 2, 1, 1, 0, 0, 16, 0, 187, 18928.3564, UINT64_C(0xc5823a64465e6762)},
    {"tetra", 3, 1, 1, 0, 0, 64, 0, 667, 25676.3564, UINT64_C(0xb9945d77b5046016)},
    {"tetra", 4, 1, 1, 0, 0, 256, 0, 2587, 52396.1064, UINT64_C(0xeabddfe0b10186a2)},
    {"tetra", 5, 1, 1, 0, 0, 1024, 0, 10267, 163625.606, UINT64_C(0x652c7e39d93b9eba)},
    {"tetra", 6, 1, 1, 0, 0, 4096, 0, 40987, 604718.044, UINT64_C(0x85a599a579b73b2a)},
    {"tetra", 7, 1, 1, 0, 0, 16384, 0, 163867, 2374611.73, UINT64_C(0x7c597a5bec348b76)},
    {"tetra", 8, 1, 1, 0, 0, 65536, 0, 655387, 9452332.14, UINT64_C(0xe061b60e3c0c57fa)},
    {"tree", 1, 7, 2, 3, 3, 1, 0, 102, 22024.8769, UINT64_C(0x05f5efdb7c270325)},
    {"tree", 2, 7, 2, 7, 7, 1, 0, 150, 22863.5406, UINT64_C(0x97c8eb2973ad90e3)},
    {"tree", 3, 7, 2, 15, 15, 1, 0, 246, 25424.0433, UINT64_C(0xe47beaddde7a9ef9)},
    {"tree", 4, 7, 2, 31, 31, 1, 0, 438, 31327.4755, UINT64_C(0xaa4e6d748e2512cd)},
    {"tree", 5, 7, 2, 63, 63, 1, 0, 822, 43584.1824, UINT64_C(0x4273a6e4c5b81097)},
    {"tree", 11, 7, 2, 4095, 4095, 1, 0, 49206, 1700605.9, UINT64_C(0xafaddc5b9daeeead)},
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

/* 64-bit FNV-1a (Fowler, Noll, Vo), continued from h. */
static uint64_t fnv(uint64_t h, const char *text)
{
    for (; *text; text++) h = (h ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return h;
}

static struct fact measure(const char *name, int size, char *text)
{
    struct fact got = {.name = name, .size = size, .hash = UINT64_C(0xcbf29ce484222325)};
    char *save = NULL;
    for (char *t = strtok_r(text, " \n", &save); t; t = strtok_r(NULL, " \n", &save)) {
        char *end, shown[32];
        double v = strtod(t, &end);
        if (*end) {
            got.l += strcmp(t, "l") == 0, got.f += strcmp(t, "f") == 0;
            got.s += strcmp(t, "s") == 0, got.c += strcmp(t, "c") == 0;
            got.p += strcmp(t, "p") == 0, got.pp += strcmp(t, "pp") == 0;
            snprintf(shown, sizeof shown, "%s ", t);
        } else {
            got.numbers++;
            if (fabs(v) < 1e-12) v = 0;
            if (fabs(v) < 1000) got.sum += v * (got.numbers % 97);
            snprintf(shown, sizeof shown, "%g ", v);
        }
        got.hash = fnv(got.hash, shown);
    }
    return got;
}

static void check_fact(const struct fact *want, int digits)
{
    char *text = scene_text(want->name, want->size, digits);
    struct fact got = measure(want->name, want->size, text);
    free(text);
    if (got.l != want->l || got.f != want->f || got.s != want->s || got.c != want->c ||
        got.p != want->p || got.pp != want->pp || got.numbers != want->numbers ||
        fabs(got.sum - want->sum) > 1e-6 * fabs(want->sum) || got.hash != want->hash)
        fail_msg("%s size %d: l %u f %u s %u c %u p %u pp %u numbers %u sum %.9g hash %016llx",
            got.name, got.size, got.l, got.f, got.s, got.c, got.p, got.pp, got.numbers, got.sum,
            (unsigned long long)got.hash);
}

static void test_as_spd_writes_them(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) check_fact(&facts[i], NFF_DIGITS_SPD);
}

/*
 * More digits, rounded to six, are the same numbers. The teapot has coordinates like 1.621875,
 * half way between two of six digits, of which only all 17 digits tell how they round.
 */
static void test_more_digits(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) {
        if (facts[i].size > 3) continue;
        check_fact(&facts[i], NFF_DIGITS_MAX);
        if (strcmp(facts[i].name, "teapot") != 0) check_fact(&facts[i], 15);
    }
}

static void test_counts(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; i++) {
        const struct fact *want = &facts[i];
        struct scene s;
        char err[SCENE_ERR];
        uint64_t prims = want->s + want->c + want->p + want->pp;
        assert_int_equal(spd_find(want->name)->count(want->size), prims);
        if (want->size > 4) continue;
        char *text = scene_text(want->name, want->size, NFF_DIGITS_SPD);
        assert_int_equal(nff_read(want->name, text, strlen(text), &s, err), 0);
        assert_int_equal(s.n_prims, prims);
        assert_int_equal(s.n_lights, want->l);
        scene_free(&s);
        free(text);
    }
}

/* True if SPD chose the scene's default as the last size under 10000 primitives. */
static bool is_nearly_10000(const char *name)
{
    static const char *const others[] = {"jacks", "nurbtst", "sample", "sombrero", "teapot"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(name, others[i]) == 0) return false;
    return true;
}

static void test_table(void **state)
{
    (void)state;
    assert_null(spd_find("ball"));
    assert_null(spd_find(""));
    assert_int_equal(spd_n_scenes, 13);
    for (size_t i = 0; i < spd_n_scenes; i++) {
        const struct spd_scene *scene = &spd_scenes[i];
        int max = spd_size_max(scene);
        assert_ptr_equal(spd_find(scene->name), scene);
        assert_true(i == 0 || strcmp(spd_scenes[i - 1].name, scene->name) < 0);
        assert_true(max > scene->size);
        assert_true(scene->count(max) <= SPD_PRIMS_MAX);
        assert_true(max == SPD_SIZE_MAX || scene->count(max + 1) > SPD_PRIMS_MAX);
        assert_true(scene->count(scene->size) < 10000);
        if (is_nearly_10000(scene->name)) assert_true(scene->count(scene->size + 1) >= 10000);
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
