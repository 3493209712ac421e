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
    struct units_date d;
    if (!number || !strstr(t->unit, " since ") || !has_length(t->unit) ||
        !parse_real(number + 1, -1e18, 1e18, &v) || !units_date(v, t->unit, &d))
        return false;
    snprintf(text, BACKDROP_TIME, "%04d-%02d-%02d %02d:%02d UTC", d.year, d.month, d.day, d.hour,
        d.minute);
    return true;
}

/* The same, with the name of a calendar in parentheses behind it. */
static bool by_calendar(const struct grid_named *t, char text[BACKDROP_TIME])
{
    const char *number = strrchr(t->name, ' '), *open = strrchr(t->unit, '(');
    char unit[GRID_NAME], calendar[GRID_NAME];
    double v;
    struct units_date d;
    if (!number || !open || open == t->unit || open[-1] != ' ' || !strchr(open, ')')) return false;
    snprintf(unit, sizeof unit, "%.*s", (int)(open - 1 - t->unit), t->unit);
    snprintf(calendar, sizeof calendar, "%.*s", (int)strcspn(open + 1, ")"), open + 1);
    if (!parse_real(number + 1, -1e18, 1e18, &v) || !units_calendar_date(v, unit, calendar, &d))
        return false;
    snprintf(text, BACKDROP_TIME, "%04d-%02d-%02d %02d:%02d (%s)", d.year, d.month, d.day, d.hour,
        d.minute, calendar);
    return true;
}

static bool is_dated(const struct grid_named *t, char text[BACKDROP_TIME])
{
    return by_digits(t, text) || by_calendar(t, text) || by_date(t, text);
}

void backdrop_time(const char *title, char text[BACKDROP_TIME])
{
    struct grid_named t;
    char begin[BACKDROP_TIME], end[BACKDROP_TIME];
    *text = '\0';
    if (!grid_title(title, 't', &t)) return;
    if (!is_dated(&t, end)) {
        snprintf(text, BACKDROP_TIME, "%s %s", t.name, t.unit);
        return;
    }
    char *to = strstr(t.name, " to ");
    if (to) *to = '\0';
    if (to && is_dated(&t, begin)) snprintf(text, BACKDROP_TIME, "%.16s to %.60s", begin, end);
    else snprintf(text, BACKDROP_TIME, "%s", end);
}
