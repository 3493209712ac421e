/* packing: attributes, and their rules for stored numbers: missing ones and unpacking. */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A string of n bytes, printable and without blanks at its end, which the caller frees. */
static char *clean(const char *text, size_t n)
{
    char *s = xcalloc(n + 1, 1);
    memcpy(s, text, n);
    for (char *c = s; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = ' ';
    for (n = strlen(s); n > 0 && s[n - 1] == ' '; n--) s[n - 1] = '\0';
    return s;
}

char *cf_whole_text(struct cf_file *c, int group, int id, const char *name)
{
    nc_type type = NC_NAT;
    size_t n = 0;
    char *s = NULL;
    if (nc_inq_att(group, id, name, &type, &n) != NC_NOERR || n == 0) return clean("", 0);
    if (type == NC_CHAR) {
        char *text = xcalloc(n, 1);
        if (cf_did(c, nc_get_att_text(group, id, name, text))) s = clean(text, n);
        free(text);
    } else if (type == NC_STRING) {
        char **text = xcalloc(n, sizeof *text);
        if (cf_did(c, nc_get_att_string(group, id, name, text))) {
            if (text[0]) s = clean(text[0], strlen(text[0]));
            nc_free_string(n, text);
        }
        free(text);
    }
    return s ? s : clean("", 0);
}

void cf_text(struct cf_file *c, int group, int id, const char *name, char out[CF_TEXT])
{
    char *whole = cf_whole_text(c, group, id, name);
    snprintf(out, CF_TEXT, "%s", whole);
    free(whole);
}

static bool is_number(int type) { return type > NC_CHAR ? type < NC_STRING : type == NC_BYTE; }
bool cf_is_numeric(const struct cf_packing *p) { return is_number(p->type); }

/* Reads at most `most` numbers of an attribute. Returns their count; 0 if there are none. An
 * attribute that is no number is noted in p. */
static size_t numbers(struct cf_file *c, int group, int id, const char *name, size_t most,
    double *out, int *type, struct cf_packing *p)
{
    size_t n;
    nc_type is;
    if (nc_inq_att(group, id, name, &is, &n) != NC_NOERR || n == 0) return 0;
    if (!is_number(is)) p->bad = name;
    if (!is_number(is)) return 0;
    double *all = xcalloc(n, sizeof *all);
    bool got = cf_did(c, nc_get_att_double(group, id, name, all));
    if (n > most) n = most;
    if (got) memcpy(out, all, n * sizeof *out), *type = is;
    free(all);
    return got ? n : 0;
}

size_t cf_reals(struct cf_file *c, int group, int id, const char *name, double out[2])
{
    size_t n;
    nc_type type;
    if (nc_inq_att(group, id, name, &type, &n) != NC_NOERR || n < 1 || n > 2 || !is_number(type))
        return 0;
    if (!cf_did(c, nc_get_att_double(group, id, name, out))) return 0;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(out[i])) return 0;
    return n;
}

/* Reads an attribute that would change all values. */
static void one(struct cf_file *c, int group, int id, const char *name, double *out, int *type,
    struct cf_packing *p)
{
    nc_type is;
    size_t n;
    if (nc_inq_att(group, id, name, &is, &n) != NC_NOERR) return;
    if (n != 1 || !is_number(is) || !numbers(c, group, id, name, 1, out, type, p)) p->bad = name;
}

/* Adds the default fill value of a variable without _FillValue. Bytes have none, because they have
 * too few values. */
static void add_default_fill(struct cf_packing *p)
{
    static const struct {
        int type;
        double fill;
    } fills[] = {{NC_SHORT, NC_FILL_SHORT}, {NC_USHORT, NC_FILL_USHORT}, {NC_INT, NC_FILL_INT},
        {NC_UINT, NC_FILL_UINT}, {NC_INT64, (double)NC_FILL_INT64},
        {NC_UINT64, (double)NC_FILL_UINT64}, {NC_FLOAT, (double)NC_FILL_FLOAT},
        {NC_DOUBLE, NC_FILL_DOUBLE}};
    for (size_t i = 0; i < sizeof fills / sizeof *fills; i++)
        if (fills[i].type == p->type) p->missing[p->n_missing++] = fills[i].fill;
}

static double widen(const struct cf_packing *p, double stored)
{
    if (!p->unsigned_too || stored >= 0) return stored;
    return stored + (p->type == NC_BYTE ? 0x1p8 : p->type == NC_SHORT ? 0x1p16 : 0x1p32);
}

/* Rounds an attribute to the stored type, because the attribute may be more precise. */
static double as_stored(const struct cf_packing *p, double v)
{
    return widen(p, p->type == NC_FLOAT ? (double)(float)v : v);
}

void cf_packing(struct cf_file *c, int group, int id, struct cf_packing *p)
{
    char text[CF_TEXT];
    double range[2];
    int type, of_scale = NC_NAT, of_offset = NC_NAT;
    *p = (struct cf_packing){
        .scale = 1, .valid_min = (double)-INFINITY, .valid_max = (double)INFINITY};
    cf_did(c, nc_inq_vartype(group, id, &p->type));
    cf_text(c, group, id, "_Unsigned", text);
    p->unsigned_too = strcasecmp(text, "true") == 0 &&
                      (p->type == NC_BYTE || p->type == NC_SHORT || p->type == NC_INT);
    one(c, group, id, "add_offset", &p->offset, &of_offset, p);
    one(c, group, id, "scale_factor", &p->scale, &of_scale, p);
    /* Values have the wider type of the two. Of the integers, none is that of values. */
    if (of_scale == NC_NAT || of_offset == NC_DOUBLE ||
        (of_offset == NC_FLOAT && of_scale != NC_DOUBLE))
        of_scale = of_offset;

    p->n_missing = numbers(c, group, id, "_FillValue", 1, p->missing, &type, p);
    if (!p->n_missing) add_default_fill(p);
    p->n_missing += numbers(c, group, id, "missing_value", CF_MISSING_MAX - p->n_missing,
        p->missing + p->n_missing, &type, p);
    for (size_t i = 0; i < p->n_missing; i++) p->missing[i] = as_stored(p, p->missing[i]);

    type = p->type;
    if (numbers(c, group, id, "valid_range", 2, range, &type, p) == 2)
        p->valid_min = range[0], p->valid_max = range[1];
    numbers(c, group, id, "valid_min", 1, &p->valid_min, &type, p);
    numbers(c, group, id, "valid_max", 1, &p->valid_max, &type, p);
    /* They apply to stored numbers, unless their type is that of the values. */
    p->valid_unpacked = type != p->type && type == of_scale;
    if (!p->valid_unpacked) {
        p->valid_min = as_stored(p, p->valid_min);
        p->valid_max = as_stored(p, p->valid_max);
    }
}

bool cf_unpacks(const struct cf_packing *p, const char *name, char err[ERR_BYTES])
{
    return !p->bad || err_set(err, "%.60s: %s is not a number, expected one number", name, p->bad);
}

double cf_unpack(const struct cf_packing *p, double stored)
{
    double raw = widen(p, stored), v = raw * p->scale + p->offset;
    double judged = p->valid_unpacked ? v : raw;
    if (isnan(v) || judged < p->valid_min || judged > p->valid_max) return (double)NAN;
    for (size_t i = 0; i < p->n_missing; i++)
        if (raw == p->missing[i]) return (double)NAN;
    return v;
}
