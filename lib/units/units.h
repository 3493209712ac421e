/* units: units of measurement and dates through libudunits2. No I/O except its database. */
#ifndef STORMRING_UNITS_H
#define STORMRING_UNITS_H

#include "base/base.h"

/* A value v in one unit is factor * v + offset in the other. */
struct units_linear {
    double factor, offset;
};
/*
 * Finds the conversion between two units, such as "m s**-1" and "knots". "mb" is a millibar, and
 * "gpm" a metre. False with a message in err if a unit is unknown, if they measure different
 * things or not linearly, or if the library was missing when this was built.
 */
bool units_linear(const char *from, const char *to, struct units_linear *l, char err[ERR_BYTES]);

/*
 * Write the unit of a product of values in two units, or of a quotient if `sign` is -1; and that of
 * a power from 2 on, or of the square root if it is -2. False with a message in err if there is
 * none, such as of degrees Celsius, whose 0 is not 0, or if the library was missing.
 */
bool units_product(
    const char *a, const char *b, int sign, char *out, size_t room, char err[ERR_BYTES]);
bool units_power(const char *unit, int power, char *out, size_t room, char err[ERR_BYTES]);

/* Years 0 to 9999, in UTC; Gregorian from 1582-10-15 on, Julian before. */
struct units_date {
    int year, month, day, hour, minute;
};
/* Finds the date of v in a unit such as "hours since 2000-01-01", to the nearest minute. False if
 * there is none, or if the library was missing. */
bool units_date(double v, const char *unit, struct units_date *d);
/* The same in another calendar: noleap or 365_day, all_leap or 366_day, 360_day, julian, or
 * proleptic_gregorian. Months and years are units of 360_day only. */
bool units_calendar_date(double v, const char *unit, const char *calendar, struct units_date *d);

#endif
