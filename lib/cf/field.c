/* field: finds variables and checks that they are fields on a rectilinear grid. */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define CORNERS 8           /* of a cell, at most */
#define PATH_MAX_BYTES 1024 /* bytes of a variable's full name, as printed */

/*
 * The operator of the Climate Data Operators that makes a field rectilinear, and what it is: its
 * longitudes and latitudes lie along two dimensions, or both along one. NULL: they do not.
 */
static const char *remapping(struct cf_file *c, const struct cf_field *f, const char **what)
{
    char feature[CF_TEXT];
    cf_text(c, c->root, NC_GLOBAL, "featureType", feature);
    if (*feature && strcasecmp(feature, "grid") != 0) {
        *what = "places of their own, such as stations, and no grid";
        return NULL;
    }
    char *names = cf_whole_text(c, f->group, f->id, "coordinates"), *rest = names, *word;
    int first = -1, curved = 0;
    const char *name = NULL;
    while (!name && (word = text_part(&rest, ' ')) != NULL) {
        int group = f->group, id, n, dims[NC_MAX_VAR_DIMS];
        nc_type type;
        char units[CF_TEXT];
        if (!*word || !cf_find_above(&group, word, &id) ||
            nc_inq_var(group, id, NULL, &type, &n, dims, NULL) != NC_NOERR || n < 1)
            continue;
        cf_text(c, group, id, "units", units);
        if (n > 1 && type != NC_CHAR) *what = "a curvilinear grid";
        if (strncasecmp(units, "deg", 3) != 0 && strncasecmp(units, "rad", 3) != 0) continue;
        if (n > 1) name = curved++ ? "remapbil" : NULL; /* both are there */
        else if (dims[0] == first) name = "remapnn", *what = "an unstructured grid";
        first = dims[0];
    }
    free(names);
    for (int i = 0; name && i < f->n_axes; i++) { /* cdo skips levels of each node, as of FVCOM */
        int id, n;
        nc_type type;
        if (i && f->axis[i].kind == CF_T) name = NULL; /* and variables with time behind */
        if (nc_inq_varid(f->group, f->axis[i].name, &id) == NC_NOERR &&
            nc_inq_var(f->group, id, NULL, &type, &n, NULL, NULL) == NC_NOERR && n > 1 &&
            type != NC_CHAR)
            name = NULL;
    }
    return name;
}

/* Refuses a dimension without coordinates. */
static bool refuse_axis(
    struct cf_file *c, const struct cf_field *f, const struct cf_axis *a, char err[ERR_BYTES])
{
    const char *what = "no rectilinear grid", *operator= remapping(c, f, &what);
    char why[ERR_BYTES];
    err_set(why, "there are no coordinates along %.60s, expected them", a->name);
    if (*f->plane_fault) err_set(why, "%.150s, expected coordinates", f->plane_fault);
    if (!operator) return err_set(err, "%s: %s along each axis", what, why);
    return err_set(err,
        "%s: %s along each axis, as cdo %s,GRID -selname,%.60s IN OUT writes; nc2vtk(1) has a GRID",
        what, why, operator, f->name);
}

static bool check_axis(const struct cf_axis *a, char err[ERR_BYTES])
{
    if (a->kind == CF_T || a->kind == CF_NONE || a->made) return true;
    const size_t least = a->kind == CF_Z ? 1 : 2;
    if (a->n < least)
        return err_set(err, "%.60s has %zu nodes, expected %zu at least", a->name, a->n, least);
    uint32_t at = grid_axis_fault(a->at, (uint32_t)a->n);
    if (!at) return true;
    char why[GRID_FAULT];
    grid_axis_why(a->at, at, why);
    return err_set(err, "%.60s is %s", a->name, why);
}

static bool check_axes(struct cf_file *c, struct cf_field *f, char err[ERR_BYTES])
{
    for (int i = 0; i < f->n_axes; i++) {
        const struct cf_axis *a = &f->axis[i];
        if (a->at || a->kind == CF_T || a->n == 1 || a->chosen) continue;
        const bool flat = cf_axis_of(f, CF_X) && cf_axis_of(f, CF_Y);
        return flat ? cf_choices(c, f, a, err) : refuse_axis(c, f, a, err);
    }
    if (!cf_tell_axes_apart(c, f, err)) return false;
    for (int i = 0; i < f->n_axes; i++) {
        cf_unwrap(&f->axis[i]);
        if (!check_axis(&f->axis[i], err)) return false;
    }
    return true;
}

bool cf_field_read(struct cf_file *c, int group, int id, struct cf_field *f, char err[ERR_BYTES])
{
    int n = 0, dims[NC_MAX_VAR_DIMS];
    char name[NC_MAX_NAME + 1] = "", about[CF_TEXT];
    *f = (struct cf_field){.group = group, .id = id};
    cf_did(c, nc_inq_var(group, id, name, NULL, &n, dims, NULL));
    snprintf(f->name, CF_TEXT, "%.*s", CF_TEXT - 1, name);
    cf_text(c, group, id, "units", f->units);
    cf_text(c, group, id, "long_name", f->long_name);
    cf_text(c, group, id, "units_metadata", about);
    f->difference = strcmp(about, "temperature: difference") == 0;
    cf_packing(c, group, id, &f->packing);
    if (!cf_look(c, err)) return false;
    if (!cf_is_numeric(&f->packing))
        return err_set(err, "its values are not numbers, expected numbers");
    if (!cf_unpacks(&f->packing, f->name, err)) return false;
    if (n > CF_AXES_MAX)
        return err_set(err, "it has %d dimensions, expected %d at most", n, CF_AXES_MAX);
    for (; f->n_axes < n; f->n_axes++)
        if (!cf_axis_read(c, group, dims[f->n_axes], &f->axis[f->n_axes], err)) return false;
    if (!cf_look(c, err) || !cf_choose(c, f, err)) return false;
    cf_wrf_center(f);
    cf_mapping_read(c, f);
    cf_curvilinear(c, f);
    if (!cf_look(c, err)) return false;
    if (!check_axes(c, f, err)) return false;
    cf_mapping_use(f);
    return cf_look(c, err);
}

void cf_field_free(struct cf_field *f)
{
    for (int i = 0; i < f->n_axes; i++) free(f->axis[i].at);
    f->n_axes = 0;
}

/* Finds a variable by its name, perhaps with groups before it. */
static bool find_variable(const struct cf_file *c, const char *name, size_t n, int *group, int *id)
{
    char *path = xmalloc(n + 1, 1);
    memcpy(path, name, n);
    path[n] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) *slash = '\0';
    *group = c->root;
    bool found = !slash || slash == path || nc_inq_grp_full_ncid(c->root, path, group) == NC_NOERR;
    found = found && nc_inq_varid(*group, slash ? slash + 1 : path, id) == NC_NOERR;
    free(path);
    return found;
}

bool cf_knows(const struct cf_file *c, const char *name)
{
    int group, id;
    return find_variable(c, name, strlen(name), &group, &id);
}

bool cf_find(struct cf_file *c, const char *name, size_t n, struct cf_field *f, char err[ERR_BYTES])
{
    int group, id;
    *f = (struct cf_field){0};
    return find_variable(c, name, n, &group, &id)
               ? cf_field_read(c, group, id, f, err)
               : err_set(err, "no such variable, expected one that -l lists");
}

/* True if another variable of the group calls this one its bounds. Their last dimension counts
 * corners, so most variables need no search. */
static bool is_bounds(struct cf_file *c, int group, int id, const char *name)
{
    static const char *const how[] = {"bounds", "climatology"};
    int n = 0, dims = 0, dim[NC_MAX_VAR_DIMS], coordinate;
    size_t corners = 0;
    char text[CF_TEXT];
    if (nc_inq_var(group, id, NULL, NULL, &dims, dim, NULL) || dims < 2 ||
        nc_inq_dim(group, dim[dims - 1], text, &corners) || corners > CORNERS ||
        nc_inq_varid(group, text, &coordinate) == NC_NOERR)
        return false;
    cf_did(c, nc_inq_nvars(group, &n));
    for (int of = 0; of < n; of++)
        for (size_t k = 0; k < sizeof how / sizeof *how; k++) {
            if (nc_inq_attid(group, of, how[k], NULL) != NC_NOERR) continue;
            cf_text(c, group, of, how[k], text);
            if (strcmp(text, name) == 0) return true;
        }
    return false;
}

static void visit_group(struct cf_file *c, int group, cf_visit *visit, void *arg, size_t *count)
{
    int n = 0, dims = 0;
    size_t length = 0;
    char path[PATH_MAX_BYTES] = "/", name[NC_MAX_NAME + 1] = "";
    if (nc_inq_grpname_len(group, &length) == NC_NOERR && length + NC_MAX_NAME + 2 < sizeof path)
        cf_did(c, nc_inq_grpname_full(group, NULL, path));
    size_t at = path[1] ? strlen(path) : 0;
    cf_did(c, nc_inq_nvars(group, &n));
    for (int id = 0; id < n; id++) {
        cf_did(c, nc_inq_var(group, id, name, NULL, &dims, NULL, NULL));
        snprintf(path + at, sizeof path - at, "/%s", name);
        if (dims < 2 || is_bounds(c, group, id, name)) continue;
        ++*count;
        visit(c, group, id, path, arg);
    }
    n = 0;
    cf_did(c, nc_inq_grps(group, &n, NULL));
    int *inside = xcalloc((size_t)n, sizeof *inside);
    cf_did(c, nc_inq_grps(group, &n, inside));
    for (int i = 0; i < n; i++) visit_group(c, inside[i], visit, arg, count);
    free(inside);
}

bool cf_each(struct cf_file *c, cf_visit *visit, void *arg, size_t *count, char err[ERR_BYTES])
{
    *count = 0;
    visit_group(c, c->root, visit, arg, count);
    return cf_look(c, err);
}
