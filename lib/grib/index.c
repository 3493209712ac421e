/* index: iterates over messages and builds the index of a file. */
#include "grib/grib_int.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ------------------------------------------------------------------------------- */

static void say_nothing(const codes_context *c, int level, const char *text)
{
    (void)c, (void)level, (void)text; /* errors are returned as a status */
}

bool gb_open(const char *path, struct gb_file *in, char err[ERR_BYTES])
{
    *in = (struct gb_file){.f = fopen(path, "re")};
    if (!in->f) return err_set(err, "%s", strerror(errno));
    codes_context_set_logging_proc(codes_context_get_default(), say_nothing);
    codes_grib_multi_support_on(NULL);
    codes_grib_multi_support_reset_file(NULL, in->f);
    return true;
}

bool gb_next(struct gb_file *in, char err[ERR_BYTES])
{
    int status = 0;
    if (in->h) {
        codes_handle_delete(in->h);
        in->number++;
    }
    in->h = codes_grib_handle_new_from_file(NULL, in->f, &status);
    if (!status) return true;
    if (in->h) codes_handle_delete(in->h);
    in->h = NULL;
    return err_set(err, "message %zu: %s", in->number + 1, codes_get_error_message(status));
}

void gb_close(struct gb_file *in)
{
    if (in->h) codes_handle_delete(in->h);
    fclose(in->f);
}

/* "" if the key is missing. */
static void get_text(const codes_handle *h, const char *key, char out[GB_TEXT])
{
    size_t n = GB_TEXT;
    if (codes_get_string(h, key, out, &n) != CODES_SUCCESS) out[0] = '\0';
    out[GB_TEXT - 1] = '\0';
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = ' ';
}

long gb_long(const codes_handle *h, const char *key)
{
    long v = 0;
    return codes_get_long(h, key, &v) == CODES_SUCCESS ? v : 0;
}

double gb_real(const codes_handle *h, const char *key)
{
    double v = 0;
    return codes_get_double(h, key, &v) == CODES_SUCCESS ? v : (double)NAN;
}

/* ---- the index ------------------------------------------------------------------------------ */

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
    if (gb_long(h, "edition") == 2)
        return strcmp(levels, "isobaricInhPa") != 0
                   ? v
                   : gb_real(h, "scaledValueOfFirstFixedSurface") *
                         pow(10, -gb_real(h, "scaleFactorOfFirstFixedSurface")) / 100;
    const long type = gb_long(h, "indicatorOfTypeOfLevel");
    for (size_t i = 0; i < sizeof old / sizeof *old; i++)
        if (old[i].type == type) return old[i].from + old[i].factor * v;
    return type == 141 ? (top * 10 + 1100 - bottom) / 2 : v;
}

static void read_entry(const struct gb_file *in, struct gb_entry *e)
{
    *e = (struct gb_entry){.number = in->number};
    get_text(in->h, "shortName", e->name);
    get_text(in->h, "name", e->long_name);
    get_text(in->h, "units", e->units);
    get_text(in->h, "typeOfLevel", e->levels);
    /* ecCodes gives pressures that are no whole hPa a type of their own. */
    if (strcmp(e->levels, "isobaricInPa") == 0) snprintf(e->levels, GB_TEXT, "isobaricInhPa");
    e->no_pv = strncmp(e->levels, "hybrid", 6) == 0 && !gb_long(in->h, "PVPresent");
    get_text(in->h, "md5GridSection", e->grid);
    get_text(in->h, "gridType", e->kind);
    e->level = level_of(in->h, e->levels);
    e->when = (int64_t)gb_long(in->h, "validityDate") * 10000 + gb_long(in->h, "validityTime");
    e->nx = gb_long(in->h, "Ni");
    e->ny = gb_long(in->h, "Nj");
}

static int in_order(const void *a, const void *b)
{
    const struct gb_entry *p = a, *q = b;
    int d = strcmp(p->name, q->name);
    if (!d) d = strcmp(p->levels, q->levels);
    if (!d) d = (p->when > q->when) - (p->when < q->when);
    if (!d) d = (p->level > q->level) - (p->level < q->level);
    return d ? d : (p->number > q->number) - (p->number < q->number);
}

bool gb_index_read(const char *path, struct gb_index *x, char err[ERR_BYTES])
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
        read_entry(&in, &x->at[x->n++]);
    }
    gb_close(&in);
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
    struct gb_stack s = {.at = x->at + first, .n = 1, .n_levels = 1};
    while (first + s.n < x->n && strcmp(s.at[s.n].name, s.at->name) == 0 &&
           strcmp(s.at[s.n].levels, s.at->levels) == 0) {
        if (s.at[s.n].when == s.at->when) s.n_levels++;
        s.n++;
    }
    s.n_times = s.n / s.n_levels;
    return s;
}

static bool is_rectilinear(const char *kind)
{
    static const char *const kinds[] = {"regular_ll", "rotated_ll", "regular_gg", "lambert",
        "polar_stereographic", "mercator", "lambert_azimuthal_equal_area", "albers"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kind, kinds[i]) == 0) return true;
    return false;
}

/* The operator of Climate Data Operators that makes a rectilinear grid. */
static const char *advice(const char *kind)
{
    if (strncmp(kind, "reduced_gg", 10) == 0) return "setgridtype,regular";
    return strcmp(kind, "sh") == 0 ? "sp2gpl" : "remapnn,r360x180";
}

bool gb_stack_check(const struct gb_stack *s, char err[ERR_BYTES])
{
    const struct gb_entry *a = s->at;
    if (!is_rectilinear(a->kind))
        return err_set(err,
            "a grid of type '%s', expected a rectilinear one, as cdo %s IN OUT writes", a->kind,
            advice(a->kind));
    if (a->nx < 2 || a->nx > INT32_MAX || a->ny < 2 || a->ny > INT32_MAX)
        return err_set(err, "%lldx%lld nodes, expected 2 at least on each axis", (long long)a->nx,
            (long long)a->ny);
    for (size_t i = 1; i < s->n; i++) {
        const struct gb_entry *e = &a[i];
        size_t k = i % s->n_levels;
        if (strcmp(e->grid, a->grid) != 0 || e->nx != a->nx || e->ny != a->ny)
            return err_set(err, "grids differ between levels, expected one grid");
        if (e->when == e[-1].when && !(e->level > e[-1].level))
            return err_set(err, "several fields at level %g of one time, expected one", e->level);
        if (s->n % s->n_levels || e->level != a[k].level || e->when != a[i - k].when)
            return err_set(err, "levels differ between times, expected the same");
    }
    return s->n_levels > 1 || err_set(err, "1 level, expected 2 at least");
}

bool gb_same_axes(const struct gb_stack *a, const struct gb_stack *b)
{
    bool same = a->n == b->n && a->n_levels == b->n_levels &&
                strcmp(a->at->grid, b->at->grid) == 0 && strcmp(a->at->levels, b->at->levels) == 0;
    for (size_t i = 0; same && i < a->n; i++)
        same = a->at[i].level == b->at[i].level && a->at[i].when == b->at[i].when;
    return same;
}
