/* Tables: what is read, what is refused and where, and the points of the rows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "table/table.h"

#define NAMES "experiment\tkind\tmethod\tx\tx_unit\ty\ty_unit\tsample\tseed"

static char path[] = "/tmp/stormring-table-XXXXXX";

static bool load(struct table *t, const char *text, char err[ERR_BYTES])
{
    unlink(path); /* what was read is not replaced */
    assert_int_equal(outfile_put(path, text, strlen(text)), 0);
    return table_load(t, path, err);
}

static struct table loaded(const char *text)
{
    struct table t;
    char err[ERR_BYTES] = "";
    if (!load(&t, text, err)) fail_msg("%s", err);
    return t;
}

static struct table pointed(const char *text)
{
    char err[ERR_BYTES] = "";
    struct table t = loaded(text);
    if (!table_points(&t, err)) fail_msg("%s", err);
    return t;
}

/* The message is that of this line, and says this. */
static void refuses(const char *text, size_t line, const char *why)
{
    struct table t;
    char err[ERR_BYTES] = "", begin[80];
    bool good = load(&t, text, err);
    if (good) {
        good = table_points(&t, err);
        table_free(&t);
    }
    assert_false(good);
    snprintf(begin, sizeof begin, "%s:%zu: ", path, line);
    if (strncmp(err, begin, strlen(begin)) != 0 || !strstr(err, why) || !strstr(err, "expected"))
        fail_msg("%s, not %s%s", err, begin, why);
}

static void rows_comments_and_units(void **state)
{
    (void)state;
    struct table t =
        loaded("# level: .9\n#x:  time \n# free text\n" NAMES
               "\ngears\treal\tm@q=1@r\t-1.5e2\ts\t+.5\tms\t3\t7\n# level: .5\n# note:\n"
               "gears\treplayed\tm\t2.\ts\t3\tms\t0\t0"); /* no line feed at its end */
    size_t line;
    assert_int_equal(t.n_rows, 2);
    assert_int_equal(t.head, 4);
    assert_false(t.intervals);
    const struct table_row *r = t.rows;
    assert_string_equal(r->setting, "q=1@r");
    assert_true(r->x == -150 && r->y == .5 && r->sample == 3 && r->seed == 7);
    assert_int_equal(r[1].line, 8);
    assert_null(r[1].setting);
    assert_ptr_equal(r->experiment, r[1].experiment);
    assert_string_equal(t.x_unit, "s");
    assert_string_equal(t.y_unit, "ms");
    assert_string_equal(table_said(&t, "level", &line), ".9");
    assert_int_equal(line, 1);
    assert_string_equal(table_said(&t, "x", NULL), "time ");
    assert_null(table_said(&t, "note", NULL));
    assert_null(table_said(&t, "le", NULL));
    table_free(&t);
    assert_null(t.rows);
}

static void rules(void **state)
{
    (void)state;
    static const char good[] = "a\treal\tm\t1\ts\t2\ts\t1\t0\n";
    static const struct {
        const char *row, *why;
    } bad[] = {{"a\treal\tm\t1\ts\t2\ts\t1\n", "8 fields"}, {"\n", "0 fields"},
        {"a\treal\tm\t1\ts\t2\ts\t1\t0\t0\n", "10 fields"},
        {"a\tfake\tm\t1\ts\t2\ts\t1\t0\n", "kind is \"fake\""},
        {"a\treal\t\t1\ts\t2\ts\t1\t0\n", "method is empty"},
        {"a\treal\tm\tnan\ts\t2\ts\t1\t0\n", "x is \"nan\""},
        {"a\treal\tm\t1\ts\t1e301\ts\t1\t0\n", "y is \"1e301\""},
        {"a\treal\tm\t1\ts\t2\ts\t-1\t0\n", "sample is \"-1\""},
        {"a\treal\tm\t1\ts\t2\ts\t1\t.5\n", "seed is \".5\""},
        {"a\treal\tm\t1\tms\t2\ts\t2\t0\n", "x_unit is \"ms\""},
        {"a\treal\tm\t1\ts\t2\tms\t2\t0\n", "y_unit is \"ms\""},
        {"a\treal\tm\t1\ts\t2\ts\t2\t0\r\n", "carriage return"},
        {"a\treal\tm\t1.0\ts\t9\ts\t1\t0\n", "x, sample and seed as in line 2"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[300];
        snprintf(text, sizeof text, NAMES "\n%s%s", good, bad[i].row);
        refuses(text, 3, bad[i].why);
    }
    refuses("", 1, "no column line");
    refuses("# only\n# comments\n", 2, "no column line");
    refuses(NAMES "\n", 1, "no measurements");
    refuses(NAMES "\tmore\n", 1, "10 columns");
    refuses("experiment\tkind\tmethods\n", 1, "column 3 is \"methods\"");
    refuses(NAMES "\na\treal\tm@s\t1\ts\t2\ts\t1\t0\na\treal\tm@s\t9\ts\t2\ts\t1\t0\n", 3,
        "setting, sample and seed as in line 2");
    struct table t;
    char err[ERR_BYTES];
    assert_false(table_load(&t, "/nonexistent.tsv", err));
    assert_string_equal(err, "/nonexistent.tsv: No such file or directory");
}

static void intervals(void **state)
{
    (void)state;
#define UNTIL NAMES "\tuntil\n"
    struct table t = pointed(UNTIL "b\treal\ttask@x\t1\ts\t3\t1\t1\t0\t2\na\treal\tt\t0\ts\t0\t1\t1"
                                   "\t0\t0\n");
    char err[ERR_BYTES];
    assert_true(t.intervals);
    assert_int_equal(t.n_points, 0);
    table_as_read(&t);
    assert_true(t.rows[0].until == 2 && t.rows[0].y == 3);
    assert_null(t.rows[0].setting);
    assert_true(table_positive(&t, "", err));
    assert_false(table_positive(&t, "x", err));
    assert_non_null(strstr(err, ":1: intervals, expected no logarithmic axis"));
    table_free(&t);
    refuses(UNTIL "a\treal\tt\t2\ts\t0\t1\t1\t0\t1\n", 2, "until is \"1\"");
    refuses(UNTIL "a\treal\tt\t2\ts\t1.5\t1\t1\t0\t3\n", 2, "y is 1.5");
    refuses(UNTIL "a\treal\tt\t2\ts\t10000\t1\t1\t0\t3\n", 2, "y is 10000");
}

static void logarithmic_axes(void **state)
{
    (void)state;
    char err[ERR_BYTES];
    struct table t =
        loaded(NAMES "\na\treal\tm\t1\ts\t2\ts\t1\t0\na\treal\tm\t3\ts\t-2\ts\t1\t0\n");
    assert_true(table_positive(&t, "", err));
    assert_true(table_positive(&t, "x", err));
    assert_false(table_positive(&t, "xy", err));
    assert_non_null(strstr(err, ":3: y is -2, expected more than 0"));
    table_free(&t);
}

static void points_and_medians(void **state)
{
    (void)state;
    struct table t = pointed(NAMES "\nb\treal\tn\t1\ts\t9\ts\t1\t0\n" /* 2 */
                                   "a\treal\tm\t2\ts\t5\ts\t1\t0\n"   /* 3 */
                                   "a\treal\tm\t1\ts\t4\ts\t1\t1\n"   /* 4 */
                                   "a\treal\tm\t1\ts\t8\ts\t2\t0\n"   /* 5 */
                                   "a\treal\tm\t1\ts\t1\ts\t1\t0\n"   /* 6 */
                                   "a\treal\tm@c\t5\ts\t1\ts\t1\t0\n" /* 7 */
                                   "a\treal\tm@c\t7\ts\t3\ts\t2\t0\n" /* 8 */
                                   "a\tsimulated\tm\t1\ts\t6\ts\t1\t0\n");
    assert_int_equal(t.n_points, 5);
    table_medians(&t);
    const struct table_point *p = t.points;
    assert_int_equal(p[0].n, 3); /* a, real, m at 1: by sample, then seed */
    assert_int_equal(p[0].line, 4);
    assert_int_equal(t.rows[p[0].from].line, 6);
    assert_int_equal(t.rows[p[0].from + 1].line, 4);
    assert_true(p[0].y.low == 1 && p[0].y.at == 4 && p[0].y.high == 8 && p[0].shown.at == 4);
    assert_int_equal(p[2].n, 2); /* a setting is one point at any x */
    assert_true(p[2].x.low == 5 && p[2].x.at == 6 && p[2].x.high == 7);
    double y[3];
    t.rows[p[0].from + 1].outlier = true;
    assert_int_equal(table_samples(&t.rows[p[0].from], p[0].n, y), 2);
    assert_true(y[0] == 1 && y[1] == 8);
    table_as_read(&t);
    for (size_t i = 0; i + 1 < t.n_points; i++) assert_true(p[i].line < p[i + 1].line);
    assert_int_equal(p[0].line, 2);
    table_free(&t);
}

/* Against the definition, with ties. */
static void front(void **state)
{
    (void)state;
    enum { N = 120 };
    struct buf b = {0};
    buf_printf(&b, NAMES "\n");
    for (uint64_t i = 0; i < N; i++)
        buf_printf(&b, "e%d\treal\tm@%d\t%d\ts\t%d\ts\t1\t0\n", (int)(i % 2), (int)i,
            (int)(rng_u64(1, i) % 9), (int)(rng_u64(2, i) % 9));
    buf_append(&b, "", 1);
    struct table t = pointed((const char *)buf_data(&b));
    table_medians(&t);
    table_front(&t);
    int on = 0;
    for (size_t i = 0; i < N; i++) {
        const struct table_point *p = &t.points[i];
        bool beaten = false;
        for (const struct table_point *q = t.points; q < t.points + N; q++)
            beaten |= t.rows[q->from].experiment == t.rows[p->from].experiment &&
                      q->x.at <= p->x.at && q->y.at <= p->y.at &&
                      (q->x.at < p->x.at || q->y.at < p->y.at || q->line < p->line);
        assert_int_equal(p->front, !beaten);
        on += p->front;
    }
    assert_in_range(on, 2, 18);
    table_free(&t);
    buf_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_comments_and_units),
        cmocka_unit_test(rules),
        cmocka_unit_test(intervals),
        cmocka_unit_test(logarithmic_axes),
        cmocka_unit_test(points_and_medians),
        cmocka_unit_test(front),
    };
    int fd = mkstemp(path);
    if (fd < 0) die(ST_SYSTEM, "%s:", path);
    close(fd);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    return failed;
}
