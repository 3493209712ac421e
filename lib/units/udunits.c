/* udunits: units through libudunits2 (UCAR/Unidata). */
#include "units/units.h"

#include <string.h>
#include <udunits2.h>

/* The library reads "mb" as millibarn, and does not know the others. */
static const char *spelling(const char *unit)
{
    static const char *const others[][2] = {
        {"mb", "millibar"}, {"gpm", "m"}, {"DEG C", "degC"}, {"C", "degC"}, {"METERS", "m"}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(unit, others[i][0]) == 0) return others[i][1];
    return unit;
}

/* The units of the library, read once: that takes 5 ms. NULL with a message in err if there are
 * none. */
static ut_system *units_of_library(char err[ERR_BYTES])
{
    static ut_system *all;
    ut_set_error_message_handler(ut_ignore);
    if (!all) all = ut_read_xml(NULL);
    if (!all) err_set(err, "the units of udunits2 cannot be read, expected libudunits2-data");
    return all;
}

static bool find(
    ut_system *all, const char *from, const char *to, struct units_linear *l, char err[ERR_BYTES])
{
    ut_unit *a = ut_parse(all, spelling(from), UT_UTF8), *b = ut_parse(all, spelling(to), UT_UTF8);
    cv_converter *c = a && b && ut_are_convertible(a, b) ? ut_get_converter(a, b) : NULL;
    bool good = c != NULL;
    if (!a || !b) err_set(err, "'%.60s' is unknown, expected a unit of udunits2", a ? to : from);
    else if (!c) err_set(err, "'%.60s' does not convert to '%.60s'", from, to);
    else {
        double zero = cv_convert_double(c, 0), one = cv_convert_double(c, 1);
        *l = (struct units_linear){one - zero, zero};
        double want = 3 * one - 2 * zero;
        good = fabs(cv_convert_double(c, 3) - want) <= 1e-9 * (fabs(want) + fabs(zero));
        if (!good) err_set(err, "'%.60s' to '%.60s' is not linear", from, to);
    }
    if (c) cv_free(c);
    ut_free(a);
    ut_free(b);
    return good;
}

bool units_linear(const char *from, const char *to, struct units_linear *l, char err[ERR_BYTES])
{
    ut_system *all = units_of_library(err);
    return all && find(all, from, to, l, err);
}

/* ---- products -------------------------------------------------------------------------------- */

/* A unit whose 0 is nothing; NULL with the reason in err if it is another, or unknown. */
static ut_unit *factor_of(ut_system *all, const char *unit, char err[ERR_BYTES])
{
    struct units_linear l;
    char why[ERR_BYTES];
    ut_unit *u = ut_parse(all, spelling(unit), UT_UTF8);
    if (!u) {
        err_set(err, "'%.60s' is unknown, expected a unit of udunits2", unit);
        return NULL;
    }
    if (!find(all, unit, "K", &l, why) || fabs(l.offset) <= 0) return u;
    ut_free(u);
    err_set(err, "'%.60s' is no factor, expected K", unit);
    return NULL;
}

/* Formats u, which may be NULL, and frees it. */
static bool put(ut_unit *u, char *out, size_t room)
{
    const int n = u ? ut_format(u, out, room, UT_ASCII) : -1;
    ut_free(u);
    return n >= 0 && (size_t)n < room;
}

bool units_product(
    const char *a, const char *b, int sign, char *out, size_t room, char err[ERR_BYTES])
{
    ut_system *all = units_of_library(err);
    ut_unit *u = all ? factor_of(all, a, err) : NULL, *v = u ? factor_of(all, b, err) : NULL;
    bool good = v && put(sign < 0 ? ut_divide(u, v) : ut_multiply(u, v), out, room);
    if (v && !good)
        err_set(err, "'%.60s' and '%.60s' have no %s", a, b, sign < 0 ? "quotient" : "product");
    ut_free(u);
    ut_free(v);
    return good;
}

bool units_power(const char *unit, int power, char *out, size_t room, char err[ERR_BYTES])
{
    ut_system *all = units_of_library(err);
    ut_unit *u = all ? factor_of(all, unit, err) : NULL;
    bool good = u && put(power < 0 ? ut_root(u, -power) : ut_raise(u, power), out, room);
    if (u && !good)
        err_set(err, "'%.60s' has no %s of a unit", unit, power < 0 ? "square root" : "power");
    ut_free(u);
    return good;
}

bool units_date(double v, const char *unit, struct units_date *d)
{
    struct units_linear to;
    char err[ERR_BYTES];
    if (!units_linear(unit, "seconds since 1970-01-01 00:00:00 UTC", &to, err)) return false;
    double minutes = round((to.factor * v + to.offset) / 60), second, precision_s;
    if (!(fabs(minutes) < 5e9)) return false; /* some thousands of years */
    ut_decode_time(ut_encode_time(1970, 1, 1, 0, 0, 0) + 60 * minutes, &d->year, &d->month, &d->day,
        &d->hour, &d->minute, &second, &precision_s);
    d->year += d->year < 0; /* the library has no year 0 */
    return d->year >= 0 && d->year <= 9999;
}
