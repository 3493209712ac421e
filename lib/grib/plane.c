/*
 * plane: the planes of projection of grids. WMO Manual on Codes, FM 92 GRIB, edition 2, templates
 * 3.1, 3.10, 3.20, 3.30, 3.31, 3.90 and 3.140; FM 92 GRIB, edition 1, grids 1, 3, 5, 10 and 90.
 */
#include "grib/grib_int.h"

#include <string.h>

static void add(
    const codes_handle *h, const char *key, const char *of_proj, char text[PROJECTION_TEXT])
{
    projection_add(text, of_proj, gb_real(h, key));
}

static void add_earth(const codes_handle *h, char text[PROJECTION_TEXT])
{
    const double r = gb_real(h, "radius");
    if (!gb_long(h, "earthIsOblate")) projection_earth(text, r, r);
    else
        projection_earth(
            text, gb_real(h, "earthMajorAxisInMetres"), gb_real(h, "earthMinorAxisInMetres"));
}

/* The conics differ in their names. */
static void conic(const codes_handle *h, char text[PROJECTION_TEXT])
{
    add(h, "Latin1InDegrees", "lat_1", text);
    add(h, "Latin2InDegrees", "lat_2", text);
    const double lad = gb_real(h, "LaDInDegrees");
    projection_add(text, "lat_0", isfinite(lad) ? lad : gb_real(h, "Latin1InDegrees"));
    add(h, "LoVInDegrees", "lon_0", text);
}

static void polar(const codes_handle *h, char text[PROJECTION_TEXT])
{
    const double lad = gb_real(h, "LaDInDegrees");
    projection_add(text, "lat_0", gb_long(h, "southPoleOnProjectionPlane") ? -90 : 90);
    projection_add(text, "lat_ts", isfinite(lad) ? lad : 60); /* that of edition 1 */
    add(h, "orientationOfTheGridInDegrees", "lon_0", text);
}

/* Its middle lies half the length of a row away from the first point. */
static void mercator(const codes_handle *h, char text[PROJECTION_TEXT])
{
    const double degree = 3.14159265358979323846 / 180, lad = gb_real(h, "LaDInDegrees");
    const double length = (double)(gb_long(h, "Ni") - 1) * gb_real(h, "DiInMetres");
    double radius = gb_real(h, "radius");
    if (gb_long(h, "earthIsOblate")) radius = gb_real(h, "earthMajorAxisInMetres");
    const double half = length / 2 / radius / cos(lad * degree) / degree;
    const double first = gb_real(h, "longitudeOfFirstGridPointInDegrees");
    projection_add(text, "lat_ts", lad);
    projection_add(text, "lon_0", rint(first + (gb_long(h, "iScansNegatively") ? -half : half)));
}

/*
 * What a satellite over the equator sees. The keys count grid lengths in the order of scanning, and
 * state the Earth's apparent diameter in them, from pole to pole that of the smaller half axis, as
 * EUMETSAT and ecCodes have it. A plane of PROJ is the angle times the height over the equator.
 */
static void satellite(const codes_handle *h, struct gb_plane *p)
{
    const double from_center = gb_real(h, "NrInRadiusOfEarth"); /* in radii of the equator */
    const double seen = 2 * asin(1 / from_center);
    double a = gb_real(h, "radius"), b = a;
    if (gb_long(h, "earthIsOblate"))
        a = gb_real(h, "earthMajorAxisInMetres"), b = gb_real(h, "earthMinorAxisInMetres");
    if (!(from_center > 1) || gb_real(h, "latitudeOfSubSatellitePointInDegrees") != 0) return;
    const double height = (from_center - 1) * a;
    p->step[0] = height * seen / gb_real(h, "dx") * (gb_runs_west(h) ? -1 : 1);
    p->step[1] = height * seen / gb_real(h, "dy") * b / a * (gb_runs_north(h) ? 1 : -1);
    p->x = p->step[0] * (gb_real(h, "Xo") - gb_real(h, "XpInGridLengths"));
    p->y = p->step[1] * (gb_real(h, "Yo") - gb_real(h, "YpInGridLengths"));
    const double turned = gb_real(h, "orientationOfTheGridInDegrees");
    if (turned != 0 && fabs(turned) != 180) return;
    snprintf(p->text, PROJECTION_TEXT, "+proj=geos");
    add(h, "longitudeOfSubSatellitePointInDegrees", "lon_0", p->text);
    projection_add(p->text, "h", height);
    add_earth(h, p->text);
}

/* Metres between nodes, from the first key that exists. */
static double distance(const codes_handle *h, const char *const keys[3])
{
    double v = (double)NAN;
    for (int i = 0; i < 3 && !(v > 0); i++) v = gb_real(h, keys[i]);
    return v;
}

static void find_steps(const codes_handle *h, double step[2])
{
    static const char *const dx[] = {"DxInMetres", "DiInMetres", "xDirectionGridLengthInMetres"};
    static const char *const dy[] = {"DyInMetres", "DjInMetres", "yDirectionGridLengthInMetres"};
    step[0] = distance(h, dx) * (gb_runs_west(h) ? -1 : 1);
    step[1] = distance(h, dy) * (gb_runs_north(h) ? 1 : -1);
}

void gb_find_plane(const codes_handle *h, const char *kind, struct gb_plane *p)
{
    static const struct {
        const char *kind, *proj;
        void (*parameters)(const codes_handle *h, char text[PROJECTION_TEXT]);
    } planes[] = {{"lambert", "lcc", conic}, {"albers", "aea", conic},
        {"polar_stereographic", "stere", polar}, {"mercator", "merc", mercator},
        {"lambert_azimuthal_equal_area", "laea", NULL}};
    char err[ERR_BYTES];
    *p = (struct gb_plane){.x = 0};
    if (strcmp(kind, "rotated_ll") == 0) {
        const double lat = gb_real(h, "latitudeOfSouthernPoleInDegrees");
        const double lon = gb_real(h, "longitudeOfSouthernPoleInDegrees");
        if (gb_real(h, "angleOfRotationInDegrees") == 0)
            projection_rotated(p->text, -lat, lon + 180, 0);
        return;
    }
    if (strcmp(kind, "space_view") == 0) {
        satellite(h, p);
        return;
    }
    find_steps(h, p->step);
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
        if (strcmp(kind, planes[i].kind) != 0) continue;
        snprintf(p->text, PROJECTION_TEXT, "+proj=%s", planes[i].proj);
        if (planes[i].parameters) planes[i].parameters(h, p->text);
        else {
            add(h, "standardParallelInDegrees", "lat_0", p->text);
            add(h, "centralLongitudeInDegrees", "lon_0", p->text);
        }
        add_earth(h, p->text);
    }
    const double lat = gb_real(h, "latitudeOfFirstGridPointInDegrees");
    const double lon = gb_real(h, "longitudeOfFirstGridPointInDegrees");
    double first[2];
    struct projection *plane = *p->text ? projection_open(p->text, err) : NULL;
    if (plane && projection_place(plane, lon, lat, first)) p->x = first[0], p->y = first[1];
    else *p->text = '\0';
    projection_close(plane);
}

bool gb_plane_of(
    const char *path, const struct gb_stack *s, char text[PROJECTION_TEXT], char err[ERR_BYTES])
{
    struct gb_file in;
    struct gb_plane p = {.x = 0};
    if (!gb_open_at(path, s->at->number, &in, err)) return false;
    gb_find_plane(in.h, s->at->kind, &p);
    gb_close(&in);
    memcpy(text, p.text, PROJECTION_TEXT);
    return true;
}
