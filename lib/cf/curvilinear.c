/*
 * curvilinear: coordinates of x and y from the longitude and latitude of each node, where these
 * make a rectilinear grid: on the plane that the file states, or in degrees.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NODES_MOST (1 << 26)
#define MOVED_DEG 1e-4
#define SAMPLES 64 /* rows, and columns, that are looked at, or up to twice as many */
#define SLACK .01  /* of a step: single precision moves places by metres */

/* Two variables along two axes: of[0] is y, of[1] is x. */
struct places {
    int in[2]; /* groups: the field's, or enclosing ones */
    int id[2]; /* longitude, latitude; -1: none */
    char name[2][CF_TEXT];
    struct cf_axis *of[2];
    double *at[2];
    double degrees[2]; /* in their units */
    size_t skip[2];    /* each such row, and each such column, is looked at */
};

/* ---- the variables --------------------------------------------------------------------------- */

/* CF_X for longitudes, CF_Y for latitudes. */
static enum cf_kind direction(struct cf_file *c, int group, int id, const char *name)
{
    char units[CF_TEXT], standard[CF_TEXT];
    cf_text(c, group, id, "units", units);
    cf_text(c, group, id, "standard_name", standard);
    const bool degrees = strncasecmp(units, "degree", 6) == 0;
    const char *of = degrees ? units + 6 + strspn(units + 6, "s_") : units;
    if (*units && !degrees && cf_degrees_in(units) == 1) return CF_NONE;
    if (*of == 'e' || *of == 'E' || strcmp(standard, "longitude") == 0) return CF_X;
    if (*of == 'n' || *of == 'N' || strcmp(standard, "latitude") == 0) return CF_Y;
    return text_has(name, "lon") ? CF_X : text_has(name, "lat") ? CF_Y : CF_NONE;
}

/* True if the axis has no coordinates, or perhaps only counts its nodes, as those of HYCOM and of
 * ocean models in CMIP do. */
static bool is_counted(const struct cf_axis *a)
{
    return !a->at || (a->in >= 0 && (!*a->units || strcmp(a->units, "1") == 0));
}

/* True if the last two dimensions of a variable are those of two such axes. */
static bool lies_along(struct cf_field *f, int group, int id, struct cf_axis *of[2])
{
    int n, dims[NC_MAX_VAR_DIMS];
    nc_type type;
    of[0] = of[1] = NULL;
    if (nc_inq_var(group, id, NULL, &type, &n, dims, NULL) != NC_NOERR || n < 2 ||
        n > CF_AXES_MAX || type == NC_CHAR || type >= NC_STRING)
        return false;
    for (int k = 0; k < 2; k++) {
        char name[NC_MAX_NAME + 1];
        size_t length;
        if (nc_inq_dim(group, dims[n - 2 + k], name, &length) != NC_NOERR) return false;
        for (int i = 0; i < f->n_axes; i++) {
            struct cf_axis *a = &f->axis[i];
            const bool same = strncmp(a->name, name, CF_TEXT - 1) == 0 && a->n == length;
            if (same && is_counted(a) && !a->chosen && a->n > 1) of[k] = a;
        }
    }
    return of[0] && of[1] && of[0] != of[1];
}

static void take(struct cf_file *c, struct cf_field *f, const char *name, struct places *p)
{
    int group = f->group, id;
    struct cf_axis *of[2];
    char units[CF_TEXT];
    if (!*name || !cf_find_above(&group, name, &id) || !lies_along(f, group, id, of)) return;
    const enum cf_kind kind = direction(c, group, id, name);
    if (kind > CF_Y || p->id[kind] >= 0) return;
    if (p->of[0] && (p->of[0] != of[0] || p->of[1] != of[1])) return;
    p->in[kind] = group, p->id[kind] = id;
    cf_text(c, group, id, "units", units);
    p->degrees[kind] = cf_degrees_in(units);
    snprintf(p->name[kind], CF_TEXT, "%s", name);
    p->of[0] = of[0], p->of[1] = of[1];
}

/* Finds those that the field names, or those of usual names. */
static bool find(struct cf_file *c, struct cf_field *f, struct places *p)
{
    static const char *const others[] = {"XLONG", "XLAT", "XLONG_M", "XLAT_M", "longitude",
        "latitude", "lon", "lat", "nav_lon", "nav_lat"};
    char *names = cf_whole_text(c, f->group, f->id, "coordinates"), *rest = names, *word;
    *p = (struct places){.id = {-1, -1}};
    while ((word = text_part(&rest, ' ')) != NULL) take(c, f, word, p);
    free(names);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) take(c, f, others[i], p);
    return p->id[0] >= 0 && p->id[1] >= 0;
}

/* Reads the places of the first time. */
static bool read_places(struct cf_file *c, struct places *p)
{
    const size_t ny = p->of[0]->n, nx = p->of[1]->n;
    for (int k = 0; k < 2; k++) {
        size_t start[CF_AXES_MAX] = {0}, count[CF_AXES_MAX];
        int n = 0;
        struct cf_packing packing;
        if (!cf_did(c, nc_inq_varndims(p->in[k], p->id[k], &n))) return false;
        for (int i = 0; i < n; i++) count[i] = i == n - 2 ? ny : i == n - 1 ? nx : 1;
        cf_packing(c, p->in[k], p->id[k], &packing);
        p->at[k] = xcalloc(ny * nx, sizeof *p->at[k]);
        if (!cf_did(c, nc_get_vara_double(p->in[k], p->id[k], start, count, p->at[k])))
            return false;
        for (size_t i = 0; i < ny * nx; i++)
            p->at[k][i] = p->degrees[k] * cf_unpack(&packing, p->at[k][i]);
    }
    return true;
}

/* True if a place is another one at the last time, as in a nest that follows a storm. */
static bool move(struct cf_file *c, const struct places *p)
{
    for (int k = 0; k < 2; k++) {
        int n, dims[NC_MAX_VAR_DIMS];
        size_t times = 0;
        double v;
        struct cf_packing packing;
        if (!cf_did(c, nc_inq_var(p->in[k], p->id[k], NULL, NULL, &n, dims, NULL))) return false;
        if (n != 3 || nc_inq_dimlen(p->in[k], dims[0], &times) != NC_NOERR || times < 2) continue;
        const size_t last[3] = {times - 1, 0, 0};
        cf_packing(c, p->in[k], p->id[k], &packing);
        if (!cf_did(c, nc_get_var1_double(p->in[k], p->id[k], last, &v))) return false;
        if (fabs(p->degrees[k] * cf_unpack(&packing, v) - p->at[k][0]) > MOVED_DEG) return true;
    }
    return false;
}

/* ---- the grid -------------------------------------------------------------------------------- */

/* Makes places on the plane of longitudes and latitudes; of no plane, continuous longitudes. */
static bool place(const struct cf_field *f, struct places *p, char err[ERR_BYTES])
{
    const size_t nx = p->of[1]->n, nodes = nx * p->of[0]->n;
    if (!*f->plane) {
        for (size_t i = 1; i < nodes; i++) {
            const double before = p->at[0][i < nx || i % nx ? i - 1 : i - nx];
            p->at[0][i] = before + remainder(p->at[0][i] - before, 360);
        }
        return true;
    }
    struct projection *plane = projection_open(f->plane, err);
    for (size_t i = 0; plane && i < nodes; i++) {
        if (i / nx % p->skip[0] && i % nx % p->skip[1]) continue;
        double to[2];
        if (!projection_place(plane, p->at[0][i], p->at[1][i], to)) to[0] = to[1] = (double)NAN;
        p->at[0][i] = to[0], p->at[1][i] = to[1];
    }
    projection_close(plane);
    return plane != NULL;
}

/* Finds the coordinates along an axis, which are means across it, and returns how far a place is
 * from them, in steps. axis: 0 for y, 1 for x. */
static double means(const struct places *p, int axis, double *at)
{
    const size_t n = p->of[axis]->n, nx = p->of[1]->n, m = p->of[!axis]->n;
    const size_t step = axis ? 1 : nx, across = axis ? nx : 1, skip = p->skip[!axis];
    double off = 0, least = (double)INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double *v = p->at[!axis] + i * step;
        double sum = 0;
        for (size_t k = 0; k < m; k += skip) sum += v[k * across];
        at[i] = sum / (double)((m + skip - 1) / skip);
        if (!isfinite(at[i])) return (double)INFINITY;
        for (size_t k = 0; k < m; k += skip) off = fmax(off, fabs(v[k * across] - at[i]));
        if (i) least = fmin(least, fabs(at[i] - at[i - 1]));
    }
    return least > 0 ? off / least : (double)INFINITY;
}

/* An ideal case of WRF has all nodes at one place, and states the steps in metres. */
static bool steps(struct cf_file *c, const struct places *p, double *at[2])
{
    static const char *const names[] = {"DY", "DX"};
    const size_t nodes = p->of[0]->n * p->of[1]->n;
    for (int k = 0; k < 2; k++) {
        double step[2];
        for (size_t i = 0; i < nodes; i++)
            if (p->at[k][i] != p->at[k][0]) return false;
        if (!cf_reals(c, c->root, NC_GLOBAL, names[k], step) || !(step[0] > 0)) return false;
        for (size_t i = 0; i < p->of[k]->n; i++) at[k][i] = step[0] * (double)i;
    }
    return true;
}

/* Steps that are even to the precision of the file become exactly even. */
static void even(double *at, size_t n)
{
    const double mid = (double)(n - 1) / 2;
    double mean = 0, slope = 0, square = 0;
    for (size_t i = 0; i < n; i++) {
        const double from = (double)i - mid;
        mean += at[i] / (double)n;
        slope += at[i] * from, square += from * from;
    }
    slope /= square;
    for (size_t i = 0; i < n; i++)
        if (!(fabs(mean + slope * ((double)i - mid) - at[i]) <= SLACK * fabs(slope))) return;
    for (size_t i = 0; i < n; i++) at[i] = mean + slope * ((double)i - mid);
}

static void set_axis(struct cf_axis *a, enum cf_kind kind, const char *units, double *at)
{
    even(at, a->n);
    free(a->at);
    a->kind = kind;
    a->at = at;
    a->in = a->id = -1;
    snprintf(a->units, CF_TEXT, "%s", units);
}

/* Numbers of nodes are no coordinates. */
static void forget(struct cf_axis *a)
{
    free(a->at);
    a->at = NULL;
    a->kind = CF_NONE;
}

void cf_curvilinear(struct cf_file *c, struct cf_field *f)
{
    struct places p;
    char err[ERR_BYTES];
    if (!find(c, f, &p)) return;
    if (p.of[0]->n > NODES_MOST / p.of[1]->n) {
        err_set(f->plane_fault, "%.30s has more than %d places", p.name[0], NODES_MOST);
        return;
    }
    if (!*f->plane) cf_wrf_plane(c, f->plane);
    const size_t ny = p.of[0]->n, nx = p.of[1]->n;
    p.skip[0] = 1 + ny / (2 * SAMPLES), p.skip[1] = 1 + nx / (2 * SAMPLES);
    double *x = xcalloc(nx, sizeof *x), *y = xcalloc(ny, sizeof *y);
    if (read_places(c, &p)) {
        if (move(c, &p))
            err_set(f->plane_fault, "%.30s and %.30s change with time", p.name[0], p.name[1]);
        else if (steps(c, &p, (double *[]){y, x})) {
            *f->plane = '\0';
            set_axis(p.of[1], CF_X, "m", x);
            set_axis(p.of[0], CF_Y, "m", y);
            x = y = NULL;
        } else if (!place(f, &p, err)) err_set(f->plane_fault, "%s", err);
        else {
            const double off = fmax(means(&p, 1, x), means(&p, 0, y));
            if (off <= SLACK) {
                const bool metres = *f->plane && !strstr(f->plane, "+o_proj");
                set_axis(p.of[1], CF_X, metres ? "m" : "degrees_east", x);
                set_axis(p.of[0], CF_Y, metres ? "m" : "degrees_north", y);
                x = y = NULL;
            } else if (p.of[0]->at && p.of[1]->at && isinf(off)) {
                /* places are missing, or are equal: the numbers of the nodes remain */
            } else if (*f->plane)
                err_set(f->plane_fault,
                    "%.30s and %.30s leave a rectilinear grid on the plane of the file by %.2g "
                    "steps",
                    p.name[0], p.name[1], off);
            else
                err_set(f->plane_fault,
                    "%.30s and %.30s are rectilinear neither in degrees nor on a plane of the file",
                    p.name[0], p.name[1]);
            for (int k = 0; off > SLACK && isfinite(off) && k < 2; k++) forget(p.of[k]);
        }
    }
    free(p.at[0]), free(p.at[1]);
    free(x), free(y);
}
