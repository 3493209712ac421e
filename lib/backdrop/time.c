/* time: the time of a grid as text. */
#include "backdrop/backdrop.h"
#include "units/units.h"

#include <stdio.h>
#include <string.h>

/* Of grib2vtk: digits of year, month, day, hour and minute. */
static bool by_digits(const struct grid_named *t, char text[BACKDROP_TIME])
{
    const char *d = strrchr(t->name, ' ');
    if (strcmp(t->unit, "YYYYMMDDhhmm") != 0 || !d || strspn(++d, "0123456789") != 12 || d[12])
        return false;
    snprintf(text, BACKDROP_TIME, "%.4s-%.2s-%.2s %.2s:%.2s UTC", d, d + 4, d + 6, d + 8, d + 10);
    return true;
}

struct date {
    int64_t year, month, day, minute;
};

#define DAY_MINUTES 1440
#define GREGORIAN 2299161 /* Julian day number of 1582-10-15, the first day of this calendar */

/*
 * The date of minutes since 1970 in the calendar of libudunits2 and CF, Gregorian from 1582 on and
 * Julian before. E. G. Richards, "Calendars", in: Explanatory Supplement to the Astronomical
 * Almanac, 3rd edition, 2013.
 */
static struct date date_of(int64_t minutes)
{
    int64_t unix_day = minutes / DAY_MINUTES - (minutes % DAY_MINUTES < 0);
    int64_t j = unix_day + 2440588, f = j + 1401;
    if (j >= GREGORIAN) f += (4 * j + 274277) / 146097 * 3 / 4 - 38;
    int64_t e = 4 * f + 3, h = 5 * (e % 1461 / 4) + 2;
    struct date d = {.day = h % 153 / 5 + 1, .month = (h / 153 + 2) % 12 + 1};
    d.year = e / 1461 - 4716 + (14 - d.month) / 12;
    d.minute = minutes - unix_day * DAY_MINUTES;
    return d;
}

/* Months and years do not. */
static bool has_length(const char *unit)
{
    return strncmp(unit, "min", 3) == 0 || !strchr("mMyY", *unit);
}

/* A number of units since a date. */
static bool by_date(const struct grid_named *t, char text[BACKDROP_TIME])
{
    const char *number = strrchr(t->name, ' ');
    double v;
    struct units_linear to;
    char err[ERR_BYTES];
    if (!number || !strstr(t->unit, " since ") || !has_length(t->unit) ||
        !parse_real(number + 1, -1e18, 1e18, &v))
        return false;
    if (!units_linear(t->unit, "seconds since 1970-01-01 00:00:00 UTC", &to, err)) return false;
    double minutes = round((to.factor * v + to.offset) / 60);
    if (!(fabs(minutes) < 5e9)) return false; /* some thousands of years */
    struct date d = date_of((int64_t)minutes);
    if (d.year < 0 || d.year > 9999) return false;
    snprintf(text, BACKDROP_TIME, "%04d-%02d-%02d %02d:%02d UTC", (int)d.year, (int)d.month,
        (int)d.day, (int)d.minute / 60, (int)d.minute % 60);
    return true;
}

void backdrop_time(const char *title, char text[BACKDROP_TIME])
{
    struct grid_named t;
    *text = '\0';
    if (!grid_title(title, 't', &t) || by_digits(&t, text) || by_date(&t, text)) return;
    snprintf(text, BACKDROP_TIME, "%s %s", t.name, t.unit);
}
