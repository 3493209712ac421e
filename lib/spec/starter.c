/* starter: a specification for all of a grid; look.c chooses the lines for the values. */
#include "geometry/geometry.h"
#include "spec/starter.h"

#include <string.h>
#include <strings.h>

/* ---- the view ------------------------------------------------------------------------------- */

#define HEIGHT .25 /* least height of the box, in its longest side */
#define WIDTH .125 /* least width or depth */
#define TALL 4     /* greatest height */
#define FLAT .01   /* height of a flat grid */
#define WALL .5    /* least height of a section */
#define THIN .02   /* least width of it */
#define ANGLE 30   /* degrees */
#define FILL .9    /* part of the frame that the box fills */
#define TURNS 50   /* of a fit; each brings the box to a part of the last error */

struct frame {
    double scale[3];
    struct vec3 lo, hi; /* corners of the box, scaled */
    struct vec3 from, at, towards, up; /* towards: the eye */
    double step; /* to which places are rounded: a thousandth of the frame's width, or less */
};

/* Metres in a unit of length; 0: no length. A degree is one of latitude. */
static double metres(const char *unit)
{
    if (strncasecmp(unit, "degree", 6) == 0) return 111195;
    if (strcasecmp(unit, "km") == 0) return 1000;
    return strcasecmp(unit, "m") == 0 || strncasecmp(unit, "meter", 5) == 0 ||
                   strncasecmp(unit, "metre", 5) == 0
               ? 1
               : 0;
}

/* As a specification has it. */
static double six_digits(double v)
{
    char text[32];
    snprintf(text, sizeof text, "%.6g", v);
    parse_real(text, -HUGE_VAL, HUGE_VAL, &v);
    return v;
}

/* False if no scale that a specification may have is large enough. */
static bool set_scale(const struct grid *g, struct frame *f, const struct grid_named unit[3])
{
    const bool section = spec_is_section(g);
    double e[3];
    for (int a = 0; a < 3; a++) e[a] = g->at[a][g->n[a] - 1] - g->at[a][0];
    const double longest = fmax(e[0], e[1]);
    const double base = longest > 1e9 ? 1e-9 : longest < 1e-9 ? 1e9 : 1;
    for (int a = 0; a < 3; a++) {
        const double level = g->flat ? FLAT : section ? WALL : HEIGHT;
        double least = a == 2 ? level : section ? THIN : WIDTH, fitting = 1;
        bool same = a != 2 || (!g->flat && strcmp(unit[0].unit, unit[2].unit) == 0);
        if (e[a] < least * longest || !same) fitting = least * longest / e[a];
        else if (e[a] > TALL * longest) fitting = TALL * longest / e[a];
        f->scale[a] = six_digits(fmax(base * fmin(fitting, base > 1 ? 1 : 1e9), 1e-9));
        if (e[a] * f->scale[a] < least / 2 * longest * base) return false;
    }
    f->lo = v3(g->at[0][0] * f->scale[0], g->at[1][0] * f->scale[1], g->at[2][0] * f->scale[2]);
    f->hi = v3_add(f->lo, v3(e[0] * f->scale[0], e[1] * f->scale[1], e[2] * f->scale[2]));
    return true;
}

/* The smallest rectangle around the box in the frame: -1 and 1 are the frame's edges. */
static void outline(const struct frame *f, const struct camera *c, double lo[2], double hi[2])
{
    const double unit = v3_dot(c->up, c->up), aspect = (double)c->w / c->h;
    for (int i = 0; i < 2; i++) lo[i] = HUGE_VAL, hi[i] = -HUGE_VAL;
    for (int k = 0; k < 8; k++) {
        struct vec3 p =
            v3(k & 1 ? f->hi.x : f->lo.x, k & 2 ? f->hi.y : f->lo.y, k & 4 ? f->hi.z : f->lo.z);
        p = v3_sub(p, f->from);
        double depth = v3_dot(p, c->forward) * unit;
        double at[2] = {v3_dot(p, c->right) / depth / aspect, v3_dot(p, c->up) / depth};
        for (int i = 0; i < 2; i++) lo[i] = fmin(lo[i], at[i]), hi[i] = fmax(hi[i], at[i]);
    }
}

/* Finds the eye from which the box fills the frame: in the south, a little in the west, and above;
 * nearly level before a section; of a flat grid above. */
static void set_view(struct frame *f, const struct grid *g, uint32_t w, uint32_t h)
{
    const struct vec3 oblique = spec_is_section(g) ? v3(-.1, -1, .12) : v3(-.35, -1, .9);
    f->towards = g->flat ? v3(0, 0, 1) : v3_unit(oblique);
    f->up = g->flat ? v3(0, 1, 0) : v3(0, 0, 1);
    const double size = v3_len(v3_sub(f->hi, f->lo));
    double distance = 2 * size, lo[2], hi[2];
    f->at = v3_scale(v3_add(f->lo, f->hi), .5);
    for (int turn = 0; turn < TURNS; turn++) {
        f->from = v3_mad(f->at, f->towards, distance);
        struct camera c = camera_new(f->from, f->at, f->up, ANGLE);
        c.w = w, c.h = h;
        outline(f, &c, lo, hi);
        f->at = v3_mad(f->at, c.right, distance * (lo[0] + hi[0]) / 2 * w / h);
        f->at = v3_mad(f->at, c.up, distance * (lo[1] + hi[1]) / 2);
        distance = fmax(distance * fmax(hi[0] - lo[0], hi[1] - lo[1]) / 2 / FILL, size);
    }
    f->from = v3_mad(f->at, f->towards, distance);
    f->step = pow(10, floor(log10(distance * fmin(1, (double)w / h))) - 3);
}

/* Where a light shows the shapes of surfaces: above, and at the left of the eye. */
static struct vec3 lamp(const struct frame *f)
{
    const struct vec3 middle = v3_scale(v3_add(f->lo, f->hi), .5);
    return v3_mad(middle, v3(-.8, -.5, 1.2), v3_len(v3_sub(f->hi, f->lo)));
}

static void put_place(struct buf *out, const char *word, struct vec3 p, double step)
{
    buf_printf(out, "%s %.15g %.15g %.15g\n", word, round(p.x / step) * step,
        round(p.y / step) * step, round(p.z / step) * step);
}

/* ---- the ground ------------------------------------------------------------------------------ */

#define TERRAIN .002 /* of the grid's height: heights of a terrain differ by more */

/* The least and the greatest height of the ground. */
static void ground_range(const struct grid *of, float *lo, float *hi)
{
    *lo = HUGE_VALF, *hi = -HUGE_VALF; /* fminf and fmaxf pass over NaN */
    for (size_t i = 0; i < grid_node(of, 0, 0, 1); i++)
        *lo = fminf(*lo, of->value[i]), *hi = fmaxf(*hi, of->value[i]);
}

/* True if the values of the ground are heights in the unit of z that differ enough to be seen. */
static bool is_terrain(const struct grid *g)
{
    struct grid_named z, h;
    float lo, hi;
    const struct grid *of = g->ground;
    if (g->flat) return false;
    if (!grid_title(g->title, 'z', &z)) z.unit[0] = '\0';
    if (!grid_title(of->title, 0, &h)) h.unit[0] = '\0';
    if (strcmp(z.unit, h.unit) != 0 && !(metres(z.unit) > 0 && metres(z.unit) == metres(h.unit)))
        return false;
    ground_range(of, &lo, &hi);
    return (double)hi - (double)lo > TERRAIN * (g->at[2][g->n[2] - 1] - g->at[2][0]);
}

/* Leaves out what the ground has outside of the grid, which would cover frame and labels. */
static void put_clip(struct buf *out, const struct grid *g, bool terrain)
{
    double lo[3], hi[3], more = 0;
    float least, most;
    for (int a = 0; a < 3; a++) {
        lo[a] = g->at[a][0], hi[a] = g->at[a][g->n[a] - 1];
        if (a == 2) continue;
        const struct grid *of = g->ground;
        more = fmax(more, fmax(lo[a] - of->at[a][0], of->at[a][of->n[a] - 1] - hi[a]));
    }
    if (!(more > 0)) return;
    ground_range(g->ground, &least, &most);
    if (terrain) lo[2] = fmin(lo[2], (double)least), hi[2] = fmax(hi[2], (double)most);
    const double room = hi[2] - lo[2]; /* none of the faces above and below cuts anything */
    buf_printf(out, "clip %.15g %.15g %.15g %.15g %.15g %.15g\n", lo[0], lo[1], lo[2] - room, hi[0],
        hi[1], hi[2] + room);
}

/* ---- comments ------------------------------------------------------------------------------- */

/* Text of a file becomes a comment: it stays on its line. */
static void put_words(struct buf *out, const char *text)
{
    for (; *text; text++)
        buf_printf(out, "%c", (unsigned char)*text < ' ' || *text == 0x7f ? '?' : *text);
}

static void put_about(struct buf *out, const struct grid *g, const struct spec_survey *v,
    const struct grid_named unit[3])
{
    struct grid_named scalar;
    bool known = grid_title(g->title, 0, &scalar);
    char lo[32], hi[32];
    buf_printf(out, "# ");
    put_words(out, known ? scalar.name : g->name);
    print_float(lo, v->quantile[0], 3), print_float(hi, v->quantile[SPEC_RANKS - 1], 3);
    buf_printf(out, ": %s to %s ", lo, hi);
    if (known) put_words(out, scalar.unit);
    buf_printf(out, " at %u x %u x %u nodes", g->n[0], g->n[1], g->flat ? 1 : g->n[2]);
    if (v->there < v->nodes)
        buf_printf(out, ", %.3g %% missing", 100 - 100 * ((double)v->there / (double)v->nodes));
    for (int a = 0; a < (g->flat ? 2 : 3); a++) {
        double from = g->at[a][0], to = g->at[a][g->n[a] - 1];
        bool down = unit[a].down;
        buf_printf(
            out, "\n# %c: %.6g to %.6g ", "xyz"[a], down ? 0 - from : from, down ? 0 - to : to);
        put_words(out, unit[a].unit);
        if (down) buf_printf(out, ", negated in the grid");
    }
    buf_printf(out, "\n");
}

/* Says how z is stretched. */
static void put_stretch(struct buf *out, const struct frame *f, const struct grid_named unit[3])
{
    const double ratio = f->scale[2] / f->scale[0];
    const double x = metres(unit[0].unit), z = metres(unit[2].unit);
    bool none = !unit[0].unit[0] && !unit[2].unit[0];
    if ((x > 0 && z > 0) || none)
        buf_printf(out, "# vertical exaggeration: %.3g\n", ratio * (none ? 1 : x / z));
    else {
        buf_printf(out, "# as high as 1 ");
        put_words(out, unit[0].unit[0] ? unit[0].unit : "x");
        buf_printf(out, " is wide: %.3g ", 1 / ratio);
        put_words(out, unit[2].unit[0] ? unit[2].unit : "z");
        buf_printf(out, "\n");
    }
}

/* ---- computed tomography --------------------------------------------------------------------- */

/* In Hounsfield units (G. N. Hounsfield, "Computerized transverse axial scanning", British Journal
 * of Radiology, 1973) air is -1000 and water 0. Air is not seen, tissue is haze, and bone, which
 * begins near 300, has a surface. */
static const struct {
    int hu;
    double r, g, b, depth; /* depth: optical, of the mean chord */
    const char *what;
} tissues[] = {{-300, .8, .45, .35, 0, "air ends"}, {-50, .85, .5, .4, .4, "fat"},
    {100, .75, .2, .15, .8, "soft tissue"}, {300, 1, .95, .85, 4, "bone begins"},
    {3000, 1, 1, .95, 40, "metal"}};

static bool is_tomogram(const struct grid *g)
{
    struct grid_named scalar;
    return grid_title(g->title, 0, &scalar) && strcasecmp(scalar.unit, "HU") == 0;
}

static void put_tissues(struct buf *out, const struct frame *f, double chord)
{
    const double size = v3_len(v3_sub(f->hi, f->lo));
    buf_printf(
        out, "# Hounsfield units: air is transparent, tissue is haze, bone has a surface.\n");
    put_place(out, "light", v3_add(f->from, v3(0, 0, size)), f->step);
    buf_printf(out, "iso 300 1 0.95 0.85 1\n");
    for (size_t i = 0; i < sizeof tissues / sizeof *tissues; i++)
        buf_printf(out, "map %d %g %g %g %.3g\t# %s\n", tissues[i].hu, tissues[i].r, tissues[i].g,
            tissues[i].b, tissues[i].depth / chord, tissues[i].what);
}

/* True if a cell has all its corners: the others are transparent. */
static bool has_cell(const struct grid *g)
{
    for (uint32_t k = 0; k + 1 < g->n[2]; k++)
        for (uint32_t j = 0; j + 1 < g->n[1]; j++)
            for (uint32_t i = 0, whole = 0; i < g->n[0]; i++) {
                const float *at = g->value + grid_node(g, i, j, k);
                size_t row = g->n[0], layer = row * g->n[1];
                whole = isnan(at[0] + at[row] + at[layer] + at[row + layer]) ? 0 : whole + 1;
                if (whole == 2) return true;
            }
    return false;
}

/* The mean chord of a convex body is 4 volume / surface (A. Cauchy, 1841). Where much is empty, it
 * is that of a body with the volume of the rest. */
static double mean_chord(const struct frame *f, double part)
{
    const struct vec3 e = v3_sub(f->hi, f->lo);
    return cbrt(part) * 2 * e.x * e.y * e.z / (e.x * e.y + e.y * e.z + e.z * e.x);
}

bool spec_starter(
    const struct grid *g, const struct spec_wish *wish, struct buf *out, char err[ERR_BYTES])
{
    struct grid_named unit[3];
    struct frame f;
    struct spec_survey v;
    if (g->brick.is) return err_set(err, "is a brick, expected a whole grid");
    spec_survey(g, &v);
    if (!v.there) return err_set(err, "all values are missing, expected some that are not");
    if (!has_cell(g))
        return err_set(err, "each cell has a missing corner, expected one that has none");
    for (int a = 0; a < 3; a++)
        if (!grid_title(g->title, "xyz"[a], &unit[a])) unit[a] = (struct grid_named){.down = false};
    if (!set_scale(g, &f, unit))
        return err_set(err, "an axis is 1e9 times as long as another, expected lengths closer");
    set_view(&f, g, wish->w, wish->h);

    put_about(out, g, &v, unit);
    put_place(out, "from", f.from, f.step);
    put_place(out, "at", f.at, f.step);
    buf_printf(out, "up 0 %g %g\nangle %d\nresolution %u %u\n", f.up.y, f.up.z, ANGLE, wish->w,
        wish->h);
    if (!g->flat) put_stretch(out, &f, unit);
    buf_printf(out, "scale %.6g %.6g %.6g\n", f.scale[0], f.scale[1], f.scale[2]);
    buf_printf(out, "background .02 .02 .025\n");
    if (g->ground) {
        const bool terrain = is_terrain(g);
        put_clip(out, g, terrain);
        spec_put_ground(g, terrain, out);
    }
    if (wish->kind == SPEC_AUTO && !g->flat && is_tomogram(g))
        return put_tissues(out, &f, mean_chord(&f, v.part)), true;
    const struct spec_box box = {.chord = mean_chord(&f, v.part), .lamp = lamp(&f)};
    spec_look(g, &v, wish, &box, out);
    return true;
}
