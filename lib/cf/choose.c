/* choose: one element of a dimension that is none of x, y, z and time, such as the members of an
 * ensemble; and what there is to choose from. */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

#define LABEL 64      /* bytes of a label; longer ones are cut */
#define LABELS_MOST 8 /* in a message */

/* ---- labels ---------------------------------------------------------------------------------- */

/* True if the variable has a text for each element of the dimension. */
static bool is_labels(int group, int id, int dim)
{
    nc_type type;
    int n, dims[NC_MAX_VAR_DIMS];
    return nc_inq_var(group, id, NULL, &type, &n, dims, NULL) == NC_NOERR && n > 0 &&
           dims[0] == dim && ((type == NC_STRING && n == 1) || (type == NC_CHAR && n == 2));
}

/* Finds it: it has the dimension's name, or stands among the coordinates of the field. */
static bool find_labels(
    struct cf_file *c, const struct cf_field *f, int dim, const char *name, int *id)
{
    char names[CF_TEXT], *rest = names, *word;
    if (nc_inq_varid(f->group, name, id) == NC_NOERR && is_labels(f->group, *id, dim)) return true;
    cf_text(c, f->group, f->id, "coordinates", names);
    while ((word = text_part(&rest, ' ')) != NULL)
        if (*word && nc_inq_varid(f->group, word, id) == NC_NOERR && is_labels(f->group, *id, dim))
            return true;
    return false;
}

/* Reads the label of element i. */
static bool label(struct cf_file *c, int group, int id, size_t i, char out[LABEL])
{
    nc_type type;
    int n = 0, dims[NC_MAX_VAR_DIMS];
    size_t start[2] = {i, 0}, count[2] = {1, 0};
    *out = '\0';
    if (!cf_did(c, nc_inq_var(group, id, NULL, &type, &n, dims, NULL))) return false;
    if (type == NC_STRING) {
        char *text = NULL;
        if (!cf_did(c, nc_get_vara_string(group, id, start, count, &text))) return false;
        text_shown(out, LABEL, text ? text : "");
        nc_free_string(1, &text);
        return true;
    }
    if (!cf_did(c, nc_inq_dimlen(group, dims[1], &count[1]))) return false;
    char *text = xcalloc(count[1] + 1, 1);
    bool good = cf_did(c, nc_get_vara_text(group, id, start, count, text));
    for (size_t k = strlen(text); k > 0 && text[k - 1] == ' '; k--) text[k - 1] = '\0';
    text_shown(out, LABEL, text);
    free(text);
    return good;
}

/* ---- what there is --------------------------------------------------------------------------- */

/* Refuses with the choices of a dimension in the message. */
static bool refuse(struct cf_file *c, const struct cf_field *f, const struct cf_axis *a,
    const char *why, char err[ERR_BYTES])
{
    char list[ERR_BYTES] = "", one[LABEL];
    int id;
    const bool labels = find_labels(c, f, a->dim, a->name, &id);
    size_t shown = a->n <= LABELS_MOST ? a->n : LABELS_MOST - 2, at = 0;
    for (size_t i = 0; (a->at || labels) && i < shown && at < 110; i++) {
        if (labels) label(c, f->group, id, i, one);
        else print_real(one, a->at[i], 6);
        bool whole = !labels && !strpbrk(one, ".en");
        at += (size_t)snprintf(
            list + at, sizeof list - at, "%s%.24s%s", i ? ", " : "", one, whole ? "." : "");
    }
    const bool values = a->at || labels;
    return err_set(err, "%s, expected -d %.30s=INDEX from 0 to %zu, mean or spread%s%s%s", why,
        a->name, a->n - 1, values ? ", or a value: " : "", list,
        values && shown < a->n ? ", ..." : "");
}

bool cf_choices(
    struct cf_file *c, const struct cf_field *f, const struct cf_axis *a, char err[ERR_BYTES])
{
    char why[ERR_BYTES];
    snprintf(
        why, sizeof why, "%.40s has %zu elements and is none of x, y, z and time", a->name, a->n);
    return refuse(c, f, a, why, err);
}

/* ---- choosing -------------------------------------------------------------------------------- */

static bool find_value(struct cf_axis *a, const char *value)
{
    double v;
    if (!a->at || !parse_real(value, -GRID_MAX, GRID_MAX, &v)) return false;
    for (size_t i = 0; i < a->n; i++)
        if (fabs(a->at[i] - v) <= 1e-6 * fabs(v)) {
            a->pick = i;
            return true;
        }
    return false;
}

static bool find_label(
    struct cf_file *c, const struct cf_field *f, struct cf_axis *a, const char *value)
{
    char one[LABEL];
    int id;
    if (!find_labels(c, f, a->dim, a->name, &id)) return false;
    for (size_t i = 0; i < a->n; i++)
        if (label(c, f->group, id, i, one) && strcmp(one, value) == 0) {
            a->pick = i;
            return true;
        }
    return false;
}

bool cf_choose(struct cf_file *c, struct cf_field *f, char err[ERR_BYTES])
{
    int over = 0;
    for (int i = 0; i < f->n_axes; i++)
        for (size_t k = 0; k < c->n_choices; k++) {
            struct cf_axis *a = &f->axis[i];
            const struct cf_choice *o = &c->choice[k];
            int64_t index;
            char why[ERR_BYTES];
            if (strncmp(a->name, o->dim, o->length) != 0 || a->name[o->length]) continue;
            a->chosen = true;
            a->kind = CF_NONE;
            a->over = o->over;
            over += o->over;
            if (o->over || find_label(c, f, a, o->value)) continue; /* a label may be of digits */
            if (parse_int(o->value, 0, INT64_MAX, &index)) {
                a->pick = (size_t)index;
                if (a->pick < a->n) continue;
            } else if (find_value(a, o->value)) continue;
            snprintf(why, sizeof why, "there is no %.30s=%.30s", a->name, o->value);
            return refuse(c, f, a, why, err);
        }
    return over < 2 || err_set(err, "mean or spread over two dimensions, expected one");
}

size_t cf_members(const struct cf_field *f)
{
    for (int i = 0; i < f->n_axes; i++)
        if (f->axis[i].over) return f->axis[i].n;
    return 1;
}
