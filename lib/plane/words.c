/* words: a string of PROJ from a file. Only words that name neither files nor other strings go on
 * to PROJ, with numbers in their plain form. */
#include "plane/plane_int.h"

#include <math.h>
#include <string.h>

struct projection {
    const char *name;
    enum plane_kind kind;
};
static const struct projection projections[] = {{"lcc", PLANE_CONE}, {"aea", PLANE_CONE},
    {"eqdc", PLANE_CONE}, {"merc", PLANE_CYLINDER}, {"eqc", PLANE_CYLINDER},
    {"cea", PLANE_CYLINDER}, {"stere", PLANE_POINT}, {"ups", PLANE_POINT}, {"laea", PLANE_POINT},
    {"aeqd", PLANE_POINT}, {"tmerc", PLANE_NEAR}, {"utm", PLANE_NEAR}, {"omerc", PLANE_NEAR},
    {"sinu", PLANE_CONE}, {"geos", PLANE_DISC}, {"nsper", PLANE_DISC}, {"ortho", PLANE_DISC},
    {"ob_tran", PLANE_ROTATED}};
#define FAR_M 1e12 /* the height from which an orthographic view is seen, as good as any */

static const char *const numbers[] = {"R", "a", "alpha", "b", "f", "gamma", "h", "k", "k_0",
    "lat_0", "lat_1", "lat_2", "lat_ts", "lon_0", "lon_1", "lon_2", "lonc", "o_lat_p", "o_lon_p",
    "rf", "x_0", "y_0", "zone"};
/* The others are nothing to PROJ here: they say that this is a whole system of coordinates. */
static const char *const flags[] = {"no_off", "no_rot", "no_uoff", "south"};
static const char *const idle[] = {"no_defs", "wktext", "units=m", "type=crs"};

static bool is_among(const char *word, const char *const *words, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(word, words[i]) == 0) return true;
    return false;
}
#define IS_AMONG(word, words) is_among(word, words, sizeof(words) / sizeof *(words))

static bool set_kind(struct plane_words *w, const char *name)
{
    for (size_t i = 0; i < sizeof projections / sizeof *projections; i++)
        if (strcmp(name, projections[i].name) == 0) {
            w->kind = projections[i].kind;
            w->polar = strcmp(name, "ups") == 0;
            if (strcmp(name, "ortho") == 0) w->height = FAR_M;
            return true;
        }
    return false;
}

static bool set_number(struct plane_words *w, const char *key, const char *value)
{
    double v;
    if (!IS_AMONG(key, numbers) || !parse_real(value, -1e9, 1e9, &v)) return false;
    if (strcmp(key, "lon_0") == 0) w->lon_0 = v = remainder(v, 360);
    if (strcmp(key, "lat_0") == 0) w->lat_0 = v;
    if (strcmp(key, "h") == 0) w->height = v;
    buf_printf(&w->text, "+%s=%.17g ", key, v);
    return true;
}

/* A name of PROJ's own lists. */
static bool set_name(struct plane_words *w, const char *key, const char *value)
{
    const bool ellipsoid = strcmp(key, "ellps") == 0;
    if (strcmp(key, "proj") == 0) {
        if (buf_size(&w->text) || !set_kind(w, value)) return false;
    } else if (strcmp(key, "o_proj") == 0) {
        w->longlat = strcmp(value, "longlat") == 0 || strcmp(value, "latlong") == 0;
        if (!w->longlat) return false;
    } else if (strcmp(key, "sweep") == 0) {
        if (strcmp(value, "x") != 0 && strcmp(value, "y") != 0) return false;
    } else if (!ellipsoid && !(strcmp(key, "datum") == 0 && strcmp(value, "WGS84") == 0))
        return false;
    if (strlen(value) > 16 || value[strspn(value, "abcdefghijklmnopqrstuvwxyz"
                                                  "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_")])
        return false;
    buf_printf(&w->text, "+%s=%s ", key, value);
    return true;
}

/* The word is cut at its equals sign. */
static bool set_word(struct plane_words *w, char *word)
{
    if (IS_AMONG(word, idle)) return true;
    if (IS_AMONG(word, flags)) {
        if (strcmp(word, "south") == 0) w->south = true;
        buf_printf(&w->text, "+%s ", word);
        return true;
    }
    char *value = strchr(word, '=');
    if (!value) return false;
    *value++ = '\0';
    return set_number(w, word, value) || set_name(w, word, value);
}

bool plane_words(const char *proj, struct plane_words *w, char err[ERR_BYTES])
{
    *w = (struct plane_words){.lon_0 = 0};
    for (const char *at = proj + strspn(proj, " "); *at; at += strspn(at, " ")) {
        char word[64];
        const size_t n = strcspn(at, " ");
        snprintf(word, sizeof word, "%.*s", (int)n, at);
        if (n >= sizeof word || !set_word(w, word + (*word == '+')))
            return err_set(err,
                "'%.*s' in '%.150s', expected a projection such as +proj=lcc, and "
                "words such as +lat_1=50",
                n < 60 ? (int)n : 60, at, proj);
        at += n;
    }
    if (w->kind == PLANE_ROTATED && !w->longlat)
        return err_set(err, "'%.150s', expected +o_proj=longlat", proj);
    if (strncmp((const char *)buf_data(&w->text), "+proj=", 6 * (buf_size(&w->text) > 0)) != 0 ||
        !buf_size(&w->text))
        return err_set(err, "'%.150s', expected +proj= first", proj);
    /* so that longitudes 180 degrees away from lon_0, and beyond, do not jump */
    if (w->kind == PLANE_CONE || w->kind == PLANE_CYLINDER) buf_printf(&w->text, "+over");
    buf_append(&w->text, "", 1);
    return true;
}
