/* sheet: how the globe is cut open for a projection. */
#include "plane/plane_int.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define RADIANS 0.017453292519943295
#define FAR 80.0         /* degrees: no further from the centre are points that PROJ puts well */
#define OPPOSITE (-80.0) /* near the point opposite to a centre, a latitude of the sheet */
#define POLE_GAP .1      /* degrees: left out where a pole is infinitely far away */
#define TURNS 1800.0     /* degrees: no map goes round the globe as often */
#define BEYOND 1e9       /* metres: rather infinite */
#define EARTH 6378137.   /* metres: radius at the equator */
#define LIMB .3          /* degrees: no nearer to the horizon, which the flattening moves */

static void vector_of(struct plane_at degrees, double v[3])
{
    const double lon = degrees.x * RADIANS, lat = degrees.y * RADIANS;
    v[0] = cos(lat) * cos(lon);
    v[1] = cos(lat) * sin(lon);
    v[2] = sin(lat);
}

static struct plane_at degrees_of(const double v[3])
{
    return (struct plane_at){atan2(v[1], v[0]) / RADIANS, atan2(v[2], hypot(v[0], v[1])) / RADIANS};
}

/* A sphere with its pole here. */
static void set_pole(struct plane *p, struct plane_at pole)
{
    double(*a)[3] = p->axis;
    vector_of(pole, a[2]);
    vector_of((struct plane_at){pole.x + 90, 0}, a[1]);
    for (int i = 0; i < 3; i++)
        a[0][i] = a[1][(i + 1) % 3] * a[2][(i + 2) % 3] - a[1][(i + 2) % 3] * a[2][(i + 1) % 3];
}

static bool is_turned(const struct plane *p)
{
    return p->kind == PLANE_POINT || p->kind == PLANE_NEAR || p->kind == PLANE_DISC;
}

struct plane_sheet plane_sheet(const struct plane *p) { return p->sheet; }

bool plane_forward(const struct plane *p, struct plane_at degrees, struct plane_at *at)
{
    double to[2];
    if (!projection_place(p->projection, degrees.x, degrees.y, to)) return false;
    *at = (struct plane_at){to[0] / p->metres, to[1] / p->metres};
    return true;
}

bool plane_inverse(const struct plane *p, struct plane_at at, struct plane_at *degrees)
{
    const double from[2] = {at.x * p->metres, at.y * p->metres};
    double to[2];
    if (!projection_degrees(p->projection, from, to)) return false;
    *degrees = (struct plane_at){to[0], to[1]};
    return true;
}

struct plane_at plane_to_sheet(const struct plane *p, struct plane_at degrees)
{
    struct plane_at at = degrees;
    if (p->kind == PLANE_ROTATED) plane_forward(p, degrees, &at);
    if (!is_turned(p)) return at;
    double v[3], turned[3];
    vector_of(degrees, v);
    for (int i = 0; i < 3; i++)
        turned[i] = p->axis[i][0] * v[0] + p->axis[i][1] * v[1] + p->axis[i][2] * v[2];
    return degrees_of(turned);
}

bool plane_from_sheet(const struct plane *p, struct plane_at sheet, struct plane_at *at)
{
    *at = sheet;
    if (p->kind == PLANE_ROTATED) return true;
    if (is_turned(p)) {
        double v[3], turned[3];
        vector_of(sheet, turned);
        for (int i = 0; i < 3; i++)
            v[i] =
                p->axis[0][i] * turned[0] + p->axis[1][i] * turned[1] + p->axis[2][i] * turned[2];
        sheet = degrees_of(v);
    }
    return plane_forward(p, sheet, at);
}

/* ---- which sheet ---------------------------------------------------------------------------- */

/* The greatest distance of the map's edge from the sheet's pole, and some more. */
static double reach(const struct plane *p, struct plane_at lo, struct plane_at hi)
{
    double far = 0;
    for (int i = 0; i <= 16; i++)
        for (int side = 0; side < 4; side++) {
            const double x = lo.x + (hi.x - lo.x) * i / 16, y = lo.y + (hi.y - lo.y) * i / 16;
            const struct plane_at at[] = {{x, lo.y}, {x, hi.y}, {lo.x, y}, {hi.x, y}};
            struct plane_at degrees;
            if (!plane_inverse(p, at[side], &degrees)) return FAR;
            far = fmax(far, 90 - plane_to_sheet(p, degrees).y);
        }
    return fmin(FAR, 1.2 * far + 1);
}

/* Keeps off a pole that the projection puts far away. */
static double pole_of(const struct plane *p, double pole)
{
    struct plane_at at;
    const bool near = plane_from_sheet(p, (struct plane_at){p->sheet.middle, pole}, &at) &&
                      hypot(at.x, at.y) * p->metres < BEYOND;
    return near ? pole : pole * (1 - POLE_GAP / 90);
}

static bool set_sheet(
    struct plane *p, const struct plane_words *w, struct plane_at lo, struct plane_at hi)
{
    const struct plane_at middle = {(lo.x + hi.x) / 2, (lo.y + hi.y) / 2};
    struct plane_at centre = {w->lon_0, w->polar ? w->south ? -90 : 90 : w->lat_0};
    p->sheet = (struct plane_sheet){w->lon_0, -90, 90};
    switch (p->kind) {
    case PLANE_CYLINDER:
        if (!plane_inverse(p, middle, &centre)) return false;
        p->sheet.middle = centre.x;
        if (!(fabs(centre.x) < TURNS)) return false;
        break;
    case PLANE_CONE: break;
    case PLANE_ROTATED: p->sheet.middle = middle.x; return fabs(middle.x) < TURNS;
    case PLANE_NEAR:
        if (!plane_inverse(p, middle, &centre)) return false;
        set_pole(p, centre);
        p->sheet = (struct plane_sheet){0, 90 - reach(p, lo, hi), 90};
        return true;
    case PLANE_DISC:
        set_pole(p, centre);
        p->sheet = (struct plane_sheet){0, asin(EARTH / (EARTH + w->height)) / RADIANS + LIMB, 90};
        return p->sheet.lo < 90;
    case PLANE_POINT:
        set_pole(p, centre);
        p->sheet = (struct plane_sheet){0, OPPOSITE, 90};
        return true;
    }
    p->sheet.lo = pole_of(p, -90);
    p->sheet.hi = pole_of(p, 90);
    return true;
}

/* False if x and y are not in a unit of the projection. */
static bool set_unit(struct plane *p, const char *unit)
{
    const bool metres = strcmp(unit, "m") == 0 || strncasecmp(unit, "met", 3) == 0;
    if (strcmp(unit, "km") == 0) p->metres = 1000;
    else if (metres || p->kind == PLANE_ROTATED) p->metres = 1;
    return p->metres > 0 && (p->kind == PLANE_ROTATED) == (strncasecmp(unit, "degree", 6) == 0);
}

struct plane *plane_open(
    const char *proj, const char *unit, struct plane_at lo, struct plane_at hi, char err[ERR_BYTES])
{
    struct plane *p = xcalloc(1, sizeof *p);
    struct plane_words w;
    bool good = plane_words(proj, &w, err);
    p->kind = w.kind;
    if (good) p->projection = projection_open((const char *)buf_data(&w.text), err);
    good = good && p->projection;
    if (good && !set_unit(p, unit))
        good = err_set(err, "x has the unit '%.40s', expected %s", unit,
            p->kind == PLANE_ROTATED ? "degrees" : "m or km");
    if (good && !set_sheet(p, &w, lo, hi))
        good = err_set(err, "the middle of the map is no place on the globe, expected x and y of "
                            "this plane");
    buf_free(&w.text);
    if (good) return p;
    plane_free(p);
    return NULL;
}

void plane_free(struct plane *p)
{
    if (!p) return;
    projection_close(p->projection);
    free(p);
}
