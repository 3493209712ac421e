/* Texts: found, compared, divided. */
#include "base/base.h"

#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void bytes_are_found(void **state)
{
    (void)state;
    static const char in[] = "aab\0aabc";
    assert_ptr_equal(text_find(in, 8, "aabc", 4), in + 4);
    assert_ptr_equal(text_find(in, 8, "b\0a", 3), in + 2);
    assert_ptr_equal(text_find(in, 8, "c", 1), in + 7);
    assert_ptr_equal(text_find(in, 3, "aab", 3), in);
    assert_null(text_find(in, 7, "c", 1));
    assert_null(text_find(in, 2, "aab", 3));
    assert_null(text_find(in, 0, "a", 1));
    assert_null(text_find(NULL, 0, "a", 1));
}

static void words_are_found_in_any_case(void **state)
{
    (void)state;
    assert_true(text_has("Geopotential Height", "height"));
    assert_true(text_has("degrees_W", "_w"));
    assert_false(text_has("heigh", "height"));
    assert_false(text_has("", "h"));
}

/* In order. */
static const char *const ordered[] = {"", "0", "00", "01", "1", "2", "9", "010", "10", "99", "100",
    "18446744073709551616", "18446744073709551617", "a", "a0", "a1", "a1b2", "a1b10", "a2", "a010",
    "aa", "b", "\xc3\xa9"};

static void numbers_in_texts_come_by_value(void **state)
{
    (void)state;
    const size_t n = sizeof ordered / sizeof *ordered;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            int order = text_order(ordered[i], ordered[k]);
            if ((order > 0) - (order < 0) == (i > k) - (i < k)) continue;
            fail_msg("'%s' and '%s': %d", ordered[i], ordered[k], order);
        }
}

static void parts_are_cut(void **state)
{
    (void)state;
    char text[] = "a,,bc,", *rest = text;
    assert_string_equal(text_part(&rest, ','), "a");
    assert_string_equal(text_part(&rest, ','), "");
    assert_string_equal(text_part(&rest, ','), "bc");
    assert_string_equal(text_part(&rest, ','), "");
    assert_null(text_part(&rest, ','));
    assert_null(rest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_are_found),
        cmocka_unit_test(words_are_found_in_any_case),
        cmocka_unit_test(numbers_in_texts_come_by_value),
        cmocka_unit_test(parts_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
