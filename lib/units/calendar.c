/*
 * calendar: dates in the calendars of climate models, by the leap years that the CF Conventions
 * (B. Eaton et al., "NetCDF Climate and Forecast (CF) Metadata Conventions", version 1.11, 2023,
 * section 4.4) state.
 */
#include "units/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum calendar { NO_LEAP, ALL_LEAP, DAYS_360, JULIAN, PROLEPTIC, UNKNOWN };

static enum calendar calendar_of(const char *name)
{
    static const char *const names[][2] = {{"noleap", "365_day"}, {"all_leap", "366_day"},
        {"360_day", "360_day"}, {"julian", "julian"},
        {"proleptic_gregorian", "proleptic_gregorian"}};
    int c = NO_LEAP;
    while (c < UNKNOWN && strcasecmp(name, names[c][0]) != 0 && strcasecmp(name, names[c][1]) != 0)
        c++;
    return (enum calendar)c;
}

static bool is_leap(enum calendar c, int y)
{
    return c == ALL_LEAP || (c == JULIAN && y % 4 == 0) ||
           (c == PROLEPTIC && y % 4 == 0 && (y % 100 != 0 || y % 400 == 0));
}

static int month_days(enum calendar c, int y, int m)
{
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return c == DAYS_360 ? 30 : days[m - 1] + (m == 2 && is_leap(c, y));
}

/* Days from the first day of year 0 to that of year y >= 0. */
static int64_t days_before(enum calendar c, int y)
{
    if (c == DAYS_360) return 360 * (int64_t)y;
    int leap = c == ALL_LEAP    ? y
               : c == JULIAN    ? (y + 3) / 4
               : c == PROLEPTIC ? (y + 3) / 4 - (y + 99) / 100 + (y + 399) / 400
                                : 0;
    return 365 * (int64_t)y + leap;
}

/* Reads a number of digits, and skips it. False if there is none, or it is above most. */
static bool number(const char **p, int most, int *v)
{
    const size_t n = strspn(*p, "0123456789");
    *v = 0;
    for (size_t i = 0; i < n && *v <= most; i++) *v = 10 * *v + (*p)[i] - '0';
    *p += n;
    return n && *v <= most;
}

/* Reads "Y-M-D", and perhaps "h:m:s" and UTC, as minutes since year 0. */
static bool start_of(enum calendar c, const char *p, double *minutes)
{
    int y, m, d, hour = 0, minute = 0, second = 0;
    if (!number(&p, 9999, &y) || *p++ != '-' || !number(&p, 12, &m) || *p++ != '-' || m < 1 ||
        !number(&p, month_days(c, y, m), &d) || d < 1)
        return false;
    if (*p == 'T' || *p == ' ') p++;
    if (number(&p, 23, &hour) && *p == ':' && (p++, !number(&p, 59, &minute))) return false;
    if (*p == ':' && (p++, !number(&p, 59, &second))) return false;
    if (*p == '.') p += 1 + strspn(p + 1, "0");
    p += strspn(p, " ");
    if (*p && strcmp(p, "UTC") != 0 && strcmp(p, "Z") != 0) return false;
    int64_t days = days_before(c, y) + d - 1;
    while (--m > 0) days += month_days(c, y, m);
    *minutes = 1440 * (double)days + 60 * hour + minute + second / 60.0;
    return true;
}

/* The minutes of a unit: a month or a year of 360_day has 30 or 360 days. */
static bool length_of(enum calendar c, const char *unit, double *minutes)
{
    struct units_linear l;
    char err[ERR_BYTES];
    const bool month = strcmp(unit, "month") == 0 || strcmp(unit, "months") == 0;
    const bool year = strcmp(unit, "year") == 0 || strcmp(unit, "years") == 0;
    if (month || year) return *minutes = 1440 * (month ? 30 : 360), c == DAYS_360;
    return units_linear(unit, "min", &l, err) && (*minutes = l.factor) > 0;
}

bool units_calendar_date(double v, const char *unit, const char *calendar, struct units_date *d)
{
    char one[64];
    const enum calendar c = calendar_of(calendar);
    const char *since = strstr(unit, " since ");
    double start, length;
    if (c == UNKNOWN || !since || (size_t)(since - unit) >= sizeof one) return false;
    snprintf(one, sizeof one, "%.*s", (int)(since - unit), unit);
    if (!start_of(c, since + strlen(" since "), &start) || !length_of(c, one, &length))
        return false;
    const double minutes = round(start + v * length);
    if (!(minutes >= 0 && minutes < 1440 * (double)days_before(c, 10000))) return false;
    int64_t days = (int64_t)(minutes / 1440), rest = (int64_t)minutes - 1440 * days;
    *d = (struct units_date){.year = (int)(days / 367), .month = 1};
    while (days_before(c, d->year + 1) <= days) d->year++;
    days -= days_before(c, d->year);
    while (days >= month_days(c, d->year, d->month)) days -= month_days(c, d->year, d->month++);
    d->day = (int)days + 1;
    d->hour = (int)(rest / 60);
    d->minute = (int)(rest % 60);
    return true;
}
