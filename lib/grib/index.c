/* index: builds the index of a file. */
#include "grib/grib_int.h"
#include "units/units.h"

#include <stdlib.h>
#include <string.h>

/* ---- the index ------------------------------------------------------------------------------ */

/* Of a surface: topLevel and level have fewer digits. */
static double hectopascals(const codes_handle *h, const char *value, const char *scale)
{
    return gb_real(h, value) * pow(10, -gb_real(h, scale)) / 100;
}

/* The number of a level, for a layer that of its middle. Edition 2 states pressures in Pa, which
 * ecCodes cuts to hPa. Edition 1 has its own units, such as cm and kPa (table 3), which ecCodes
 * keeps. */
static double level_of(const codes_handle *h, const char *levels)
{
    static const struct {
        long type;
        double factor, from;
    } old[] = {{101, 10, 0}, {104, 100, 0}, {106, 100, 0}, {107, 1e-4, 0}, {108, .01, 0},
        {111, .01, 0}, {112, .01, 0}, {114, -1, 475}, {115, 100, 0}, {116, 100, 0}, {119, 1e-4, 0},
        {120, .01, 0}, {121, -1, 1100}, {125, .01, 0}, {128, -.001, 1.1}, {210, .01, 0}};
    const double top = gb_real(h, "topLevel"), bottom = gb_real(h, "bottomLevel");
    const double v = strstr(levels, "Layer") ? (top + bottom) / 2 : gb_real(h, "level");
    if (gb_long(h, "edition") == 2) {
        const bool layer = strcmp(levels, "isobaricLayer") == 0;
        if (!layer && strcmp(levels, "isobaricInhPa") != 0) return v;
        const double first =
            hectopascals(h, "scaledValueOfFirstFixedSurface", "scaleFactorOfFirstFixedSurface");
        if (!layer) return first;
        const double second =
            hectopascals(h, "scaledValueOfSecondFixedSurface", "scaleFactorOfSecondFixedSurface");
        return (first + second) / 2;
    }
    const long type = gb_long(h, "indicatorOfTypeOfLevel");
    for (size_t i = 0; i < sizeof old / sizeof *old; i++)
        if (old[i].type == type) return old[i].from + old[i].factor * v;
    return type == 141 ? (top * 10 + 1100 - bottom) / 2 : v;
}

/* Where the grid lies, by keys of both editions. */
static void read_place(const codes_handle *h, struct gb_entry *e)
{
    static const char *const keys[GB_PLACES] = {"latitudeOfFirstGridPointInDegrees",
        "latitudeOfLastGridPointInDegrees", "longitudeOfFirstGridPointInDegrees",
        "longitudeOfLastGridPointInDegrees", "N", "latitudeOfSouthernPoleInDegrees",
        "longitudeOfSouthernPoleInDegrees", "angleOfRotationInDegrees", "LaDInDegrees",
        "LoVInDegrees", "Latin1InDegrees", "Latin2InDegrees", "DxInMetres", "DyInMetres",
        "iScansNegatively", "jScansPositively"};
    for (int i = 0; i < GB_PLACES; i++) e->place[i] = gb_real(h, keys[i]);
}

bool gb_same_grid(const struct gb_entry *a, const struct gb_entry *b)
{
    if (strcmp(a->grid, b->grid) == 0) return true;
    bool same = a->edition != b->edition && strcmp(a->kind, b->kind) == 0 && a->nx == b->nx &&
                a->ny == b->ny && isfinite(a->place[0]);
    for (int i = 0; same && i < GB_PLACES; i++) {
        const double p = a->place[i], q = b->place[i], off = fabs(p - q);
        const double slack = i == 12 || i == 13 ? 1 : 1.5e-3; /* metres, degrees */
        same = isnan(p) || isnan(q) || off <= slack || fabs(off - 360) <= slack;
    }
    return same;
}

/* ecCodes calls all parameters "unknown" that its tables lack. Their numbers tell them apart. */
static void read_name(const codes_handle *h, char name[GB_TEXT])
{
    gb_text(h, "shortName", name, GB_TEXT);
    if (strcmp(name, "unknown") != 0) return;
    if (gb_long(h, "edition") == 2)
        snprintf(name, GB_TEXT, "unknown.%ld.%ld.%ld", gb_long(h, "discipline"),
            gb_long(h, "parameterCategory"), gb_long(h, "parameterNumber"));
    else
        snprintf(name, GB_TEXT, "unknown.%ld.%ld", gb_long(h, "table2Version"),
            gb_long(h, "indicatorOfParameter"));
}

/* The beginning of the interval of an accumulation, a mean or an extreme value; 0: none. */
static int64_t begin_of(const codes_handle *h, int64_t when)
{
    static const double minutes[] = {
        1, 60, 1440, [10] = 180, 360, 720, 1 / 60.}; /* code table 4.4 */
    const long unit = gb_long(h, "stepUnits"), n = sizeof minutes / sizeof *minutes;
    const long steps = gb_long(h, "endStep") - gb_long(h, "startStep");
    struct units_date d;
    char since[64];
    if (steps <= 0 || unit < 0 || unit >= n) return 0;
    snprintf(since, sizeof since, "minutes since %04d-%02d-%02d %02d:%02d", (int)(when / 100000000),
        (int)(when / 1000000 % 100), (int)(when / 10000 % 100), (int)(when / 100 % 100),
        (int)(when % 100));
    if (minutes[unit] <= 0 || !units_date(-(double)steps * minutes[unit], since, &d)) return 0;
    return (((d.year * INT64_C(100) + d.month) * 100 + d.day) * 100 + d.hour) * 100 + d.minute;
}

static void read_entry(const struct gb_file *in, struct gb_entry *e)
{
    *e = (struct gb_entry){.number = in->number};
    read_name(in->h, e->name);
    gb_text(in->h, "name", e->long_name, GB_TEXT);
    gb_text(in->h, "units", e->units, GB_TEXT);
    gb_text(in->h, "typeOfLevel", e->levels, GB_TEXT);
    /* ecCodes gives pressures that are no whole hPa a type of their own. */
    if (strcmp(e->levels, "isobaricInPa") == 0) snprintf(e->levels, GB_TEXT, "isobaricInhPa");
    e->no_pv = strncmp(e->levels, "hybrid", 6) == 0 && !gb_long(in->h, "PVPresent");
    gb_text(in->h, "md5GridSection", e->grid, GB_TEXT);
    gb_text(in->h, "gridType", e->kind, GB_TEXT);
    e->level = level_of(in->h, e->levels);
    if (isnan(e->level)) e->level = 0; /* as of what a satellite sees, which has no level */
    e->when = (int64_t)gb_long(in->h, "validityDate") * 10000 + gb_long(in->h, "validityTime");
    e->begin = begin_of(in->h, e->when);
    e->nx = gb_long(in->h, "Ni");
    e->ny = gb_long(in->h, "Nj");
    e->edition = gb_long(in->h, "edition");
    read_place(in->h, e);
    gb_read_choices(in->h, in->number, e);
}

static int in_order(const void *a, const void *b)
{
    const struct gb_entry *p = a, *q = b;
    int d = strcmp(p->name, q->name);
    if (!d) d = strcmp(p->levels, q->levels);
    if (!d) d = text_order(p->member, q->member);
    if (!d) d = (p->when > q->when) - (p->when < q->when);
    if (!d) d = (p->level > q->level) - (p->level < q->level);
    return d ? d : (p->number > q->number) - (p->number < q->number);
}

bool gb_index_read(const char *path, const struct gb_where *where, size_t n, struct gb_index *x,
    char err[ERR_BYTES])
{
    struct gb_file in;
    size_t room = 0;
    *x = (struct gb_index){0};
    if (!gb_open(path, &in, err)) return false;
    bool good;
    while ((good = gb_next(&in, err)) && in.h) {
        if (x->n == room) {
            room = room ? 2 * room : 256;
            x->at = xrealloc(x->at, room, sizeof *x->at);
        }
        read_entry(&in, &x->at[x->n]);
        x->n += gb_counts(in.h, in.number, where, n, &x->at[x->n]);
    }
    const size_t all = in.number;
    gb_close(&in);
    if (good && !x->n && all)
        good = err_set(err, "no message has what -w asks for, expected one or more of %zu", all);
    if (good && !x->n) good = err_set(err, "no GRIB message, expected one or more");
    if (good && x->at) qsort(x->at, x->n, sizeof *x->at, in_order);
    else gb_index_free(x);
    return good;
}

void gb_index_free(struct gb_index *x)
{
    free(x->at);
    *x = (struct gb_index){0};
}

/* ---- stacks --------------------------------------------------------------------------------- */

struct gb_stack gb_stack_at(const struct gb_index *x, size_t first)
{
    struct gb_stack s = {.at = x->at + first, .n = 1, .n_levels = 1, .n_members = 1};
    size_t of_first = 1; /* entries of the first member */
    while (first + s.n < x->n && strcmp(s.at[s.n].name, s.at->name) == 0 &&
           strcmp(s.at[s.n].levels, s.at->levels) == 0) {
        const struct gb_entry *e = &s.at[s.n++];
        const bool same = strcmp(e->member, s.at->member) == 0;
        s.n_members += strcmp(e->member, e[-1].member) != 0;
        of_first += same;
        s.n_levels += same && e->when == s.at->when;
    }
    s.n_times = of_first / s.n_levels;
    return s;
}

struct gb_stack gb_member(const struct gb_stack *s, size_t member)
{
    struct gb_stack one = *s;
    one.n /= s->n_members;
    one.at += member * one.n;
    one.n_members = 1;
    return one;
}

static bool is_rectilinear(const char *kind)
{
    static const char *const kinds[] = {"regular_ll", "rotated_ll", "regular_gg", "lambert",
        "polar_stereographic", "mercator", "lambert_azimuthal_equal_area", "albers", "space_view"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kind, kinds[i]) == 0) return true;
    return false;
}

/* Names the type of a grid that is not rectilinear, and the operator of the Climate Data Operators
 * that makes it so, if there is one. */
static bool refuse_grid(const struct gb_entry *e, char err[ERR_BYTES])
{
    const char *kind = e->kind[0] ? e->kind : "unknown";
    const char *operator= strcmp(kind, "reduced_gg") == 0 ? "setgridtype,regular"
    : strcmp(kind, "sh") == 0                             ? "sp2gpl"
                                                          : NULL;
    return err_set(err, "a grid of type '%s', expected a rectilinear one%s%s%s", kind,
        operator? ", as cdo " : "", operator? operator: "", operator? " IN OUT writes" : "");
}

/* Checks one member. */
static bool check_member(
    const struct gb_stack *s, const struct gb_entry *first, char err[ERR_BYTES])
{
    const struct gb_entry *a = s->at;
    for (size_t i = 0; i < s->n; i++) {
        const struct gb_entry *e = &a[i];
        size_t k = i % s->n_levels;
        if (!gb_same_grid(e, a) || e->nx != a->nx || e->ny != a->ny)
            return err_set(err, "grids differ between levels, expected one grid");
        if (s->n % s->n_levels || e->level != a[k].level || e->when != a[i - k].when)
            return err_set(err, "levels differ between times, expected the same");
        if (!gb_same_grid(e, first) || e->level != first[i].level || e->when != first[i].when)
            return err_set(err, "grids, levels or times differ between members, expected the same");
    }
    return true;
}

bool gb_stack_check(const struct gb_stack *s, char err[ERR_BYTES])
{
    const struct gb_entry *a = s->at;
    if (!is_rectilinear(a->kind)) return refuse_grid(a, err);
    if (a->nx < 2 || a->nx > INT32_MAX || a->ny < 2 || a->ny > INT32_MAX)
        return err_set(err, "%lldx%lld nodes, expected 2 at least on each axis", (long long)a->nx,
            (long long)a->ny);
    for (size_t i = 1; i < s->n; i++)
        if (a[i].when == a[i - 1].when && strcmp(a[i].member, a[i - 1].member) == 0 &&
            !(a[i].level > a[i - 1].level))
            return gb_refuse(s, &a[i], err);
    if (s->n % s->n_members || s->n / s->n_members % s->n_levels)
        return err_set(err, "levels differ between times%s, expected the same",
            s->n_members > 1 ? " or members" : "");
    for (size_t m = 0; m < s->n_members; m++) {
        const struct gb_stack one = gb_member(s, m);
        if (!check_member(&one, a, err)) return false;
    }
    return true;
}

bool gb_same_axes(const struct gb_stack *a, const struct gb_stack *b)
{
    bool same = a->n == b->n && a->n_levels == b->n_levels && a->n_members == b->n_members &&
                gb_same_grid(a->at, b->at) && strcmp(a->at->levels, b->at->levels) == 0;
    for (size_t i = 0; same && i < a->n; i++)
        same = a->at[i].level == b->at[i].level && a->at[i].when == b->at[i].when;
    return same;
}
