/*
 * grid2pov: converts a grid and a rendering specification to an equivalent POV-Ray 3.7 scene.
 *
 * The picture is POV-Ray's integral of two media in one box: one absorbs k(s), the other emits c(s)
 * k(s), a product of two densities. s is POV-Ray's own trilinear interpolation of a DF3 file;
 * piecewise linear splines map coordinates to its nodes. Each mapping below was checked by
 * rendering:
 *
 *   - In a DF3 file, node i of n is at i / n; the file wraps round from there.
 *   - A pattern's value of 1 counts as 0. A colour map's numbers are float. They are relative to
 *     the map's width, so that rounding does not lose a narrow map.
 *   - A medium is sampled in the middles of equal intervals from one surface to the next. Invisible
 *     planes at the grid's planes turn cell faces into surfaces, where the field has kinks. A ray
 *     passes at most 256 surfaces.
 *   - POV-Ray merges surfaces nearer than a fixed distance. The scene is scaled to make that
 *     distance small.
 */
#include "geometry/geometry.h"
#include "volume/volume.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PLANES_MAX 250
#define INTERVALS_MAX 255
#define KNOTS_MAX 250   /* a colour map has room for 256 entries */
#define NODES_MAX 32767 /* limit of a DF3 file, including the mask after the field */
#define REACH 1e5 /* distance from the eye to the box's farthest corner: POV-Ray's limit is 1e7 */

static const char usage_text[] = "[-h] [-n SAMPLES] GRID.vtk SPEC FILE.df3";

struct options {
    int samples; /* -n: samples between two planes of the grid */
    const char *grid, *spec, *df3;
};

struct pov {
    const struct options *o;
    const struct grid *g;
    const struct spec *s;
    double unit;        /* POV-Ray's length per unit of scaled space */
    double least, most; /* lowest and highest value of the field */
    bool missing;       /* some values are missing: the mask of cells follows the field */
    double lo, width;   /* of the map, with a transparent margin on either side */
    double stride;      /* from one invisible plane to the next, in cells: 2^n or 1 / n */
    int intervals;      /* between two invisible planes */
};

/* ---- the scene ------------------------------------------------------------------------------- */

static void put_vec(const char *lead, struct vec3 v)
{
    printf("%s<%.17g,%.17g,%.17g>", lead, v.x, v.y, v.z);
}
/* Coordinate of node i, or between two nodes. */
static double place(const struct pov *p, int a, double i)
{
    const double *at = p->g->at[a];
    uint32_t low = (uint32_t)i;
    double x = i > low ? at[low] + (i - low) * (at[low + 1] - at[low]) : at[low];
    return x * p->s->scale[a] * p->unit;
}
/* An end of what is seen along an axis: of the grid, or of the clip box if that is nearer. */
static double end_of(const struct pov *p, int a, bool far)
{
    const double *at = p->g->at[a], *clip = p->s->clip[a];
    double x = far ? at[p->g->n[a] - 1] : at[0];
    if (p->s->clipped) x = far ? fmin(x, clip[1]) : fmax(x, clip[0]);
    return x * p->s->scale[a] * p->unit;
}
static struct vec3 corner(const struct pov *p, bool far)
{
    return v3(end_of(p, 0, far), end_of(p, 1, far), end_of(p, 2, far));
}
static bool is_empty(const struct pov *p)
{
    for (int a = 0; a < 3; a++)
        if (p->s->clipped && !(fmax(p->s->clip[a][0], p->g->at[a][0]) <
                                 fmin(p->s->clip[a][1], p->g->at[a][p->g->n[a] - 1])))
            return true;
    return false;
}

static void put_head(const struct pov *p)
{
    const struct spec *s = p->s;
    printf("// Render this file, scene.pov, to linear 16 bit with\n"
           "//   povray +Iscene.pov +Oscene.ppm +W%u +H%u File_Gamma=1 +FP16 -A -D\n"
           "#version 3.7;\n"
           "global_settings { assumed_gamma 1 max_trace_level 256 adc_bailout 0 }\n",
        s->w, s->h);
    struct vec3 from = v3(s->from[0], s->from[1], s->from[2]);
    struct vec3 dir = v3_unit(v3_sub(v3(s->at[0], s->at[1], s->at[2]), from));
    struct vec3 right = v3_unit(v3_cross(dir, v3_unit(v3(s->up[0], s->up[1], s->up[2]))));
    double height = 2 * tan(s->angle * (M_PI / 360));
    put_vec("camera { perspective location ", v3_scale(from, p->unit));
    put_vec(" direction ", dir);
    put_vec("\n  up ", v3_scale(v3_cross(right, dir), height));
    put_vec(" right image_width/image_height*", v3_scale(right, height));
    put_vec(" }\nbackground { rgb ", v3(s->background[0], s->background[1], s->background[2]));
    puts(" }");
}

/* M: the field's position in the map, 0 .. 1, at a point of the scene; transparent at both ends. */
static void put_field(const struct pov *p)
{
    const char *df3 = p->o->df3;
    double layers = p->g->n[2] * (p->missing ? 2.0 : 1);
    for (int a = 0; a < 3; a++) {
        double n = a == 2 ? layers : p->g->n[a];
        printf("#declare Node_%c = function { spline { linear_spline", "xyz"[a]);
        for (uint32_t i = 0; i < p->g->n[a]; i++)
            printf("%s%.17g,%.17g", i % 4 ? ", " : i ? ",\n  " : "\n  ", place(p, a, i), i / n);
        puts(" } }");
    }
    printf(
        "#declare Field = function { pattern { density_file df3 \"%s\" interpolate 1 } }\n", df3);
    if (p->missing)
        printf("#declare Cell = function { pattern { density_file df3 \"%s\" interpolate 0 } }\n",
            df3);
    const char *node = "Node_x(x).x, Node_y(y).x, Node_z(z).x";
    printf("#declare M = function { ");
    if (p->missing) printf("select(Cell(%s + 0.5) - 0.5, 0, ", node);
    printf("min(1, max(0, %.17g + %.17g * Field(%s)))", (p->least - p->lo) / p->width,
        (p->most - p->least) / p->width, node);
    puts(p->missing ? ") }" : " }");
}

/* Writes the map's extinction or colour as a colour map `name`. */
static void put_map(const struct pov *p, const char *name, bool colour)
{
    printf("#declare %s = color_map {\n", name);
    for (size_t i = 0; i < p->s->n_knots; i++) {
        const struct spec_knot *k = &p->s->knot[i];
        double at = (k->s - p->lo) / p->width, e = k->k / p->unit;
        struct vec3 v = colour ? v3(k->rgb[0], k->rgb[1], k->rgb[2]) : v3(e, e, e);
        if (i == 0) printf("  [0 rgb 0] [%.17g rgb 0]\n", at);
        printf("  [%.17g ", at);
        put_vec("rgb ", v);
        puts("]");
        if (i + 1 == p->s->n_knots) printf("  [%.17g rgb 0] [1 rgb 0]\n", at);
    }
    puts("}");
}

static void put_medium(const struct pov *p, const char *what, bool emits)
{
    printf("  media { %s 1 method 2 samples 1,1 intervals %d jitter 0\n", what, p->intervals);
    puts("    density { function { M(x,y,z) } color_map { Extinction } }");
    if (emits) puts("    density { function { M(x,y,z) } color_map { Colour } }");
    if (emits && p->s->attenuation > 0) {
        const double *e = p->s->from, u = p->unit;
        printf(
            "    density { function { exp(-%.17g * sqrt(pow(x - (%.17g), 2) + pow(y - (%.17g), 2) "
            "+ pow(z - (%.17g), 2))) } color_map { [0 rgb 0] [1 rgb 1] } }\n",
            p->s->attenuation / u, e[0] * u, e[1] * u, e[2] * u);
    }
    puts("  }");
}

static void put_box(const struct pov *p)
{
    const struct grid *g = p->g;
    for (int a = 0; a < 3; a++)
        for (uint32_t i = 1; i * p->stride < g->n[a] - 1; i++)
            printf("plane { %c, %.17g pigment { rgbt 1 } hollow }\n", "xyz"[a],
                place(p, a, i * p->stride));
    put_vec("box { ", corner(p, false));
    put_vec(", ", corner(p, true));
    puts(" pigment { rgbt 1 } hollow interior {");
    put_medium(p, "absorption", false);
    put_medium(p, "emission", true);
    puts("} }");
}

/* ---- input and options ---------------------------------------------------------------------- */

static double distance_to_box(const struct pov *p)
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        const double *at = p->g->at[a], scale = p->s->scale[a], eye = p->s->from[a];
        double d = fmax(fabs(at[0] * scale - eye), fabs(at[p->g->n[a] - 1] * scale - eye));
        sum += d * d;
    }
    return sqrt(sum);
}

static void survey(struct pov *p)
{
    size_t nodes = grid_node(p->g, 0, 0, p->g->n[2]);
    p->least = HUGE_VAL, p->most = -HUGE_VAL;
    for (size_t i = 0; i < nodes; i++) {
        double v = (double)p->g->value[i];
        if (isnan(v)) p->missing = true;
        else p->least = fmin(p->least, v), p->most = fmax(p->most, v);
    }
    if (!(p->least <= p->most)) p->least = p->most = 0;
    if (!(p->least < p->most)) p->most = p->least + 1;
    const struct spec_knot *k = p->s->knot;
    double width = k[p->s->n_knots - 1].s - k[0].s, margin = (width > 0 ? width : 1) / 16;
    p->lo = k[0].s - margin;
    p->width = width + 2 * margin;
    p->unit = REACH / distance_to_box(p);
}

/* Chooses the invisible planes. False if the number of samples cannot be reached. */
static bool cut(struct pov *p)
{
    double samples = p->o->samples, cells = -3.0 + p->g->n[0] + p->g->n[1] + p->g->n[2];
    for (p->stride = 1 / ceil(samples / INTERVALS_MAX); cells / p->stride > PLANES_MAX;)
        p->stride *= 2;
    p->intervals = (int)ceil(samples * p->stride);
    return p->intervals <= INTERVALS_MAX;
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.samples = 64};
    for (int c; (c = prog_getopt(argc, argv, "hn:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'n': o.samples = (int)opt_int(c, optarg, 1, PLANES_MAX * INTERVALS_MAX); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 3) usage(ST_USAGE, usage_text);
    o.grid = argv[optind], o.spec = argv[optind + 1], o.df3 = argv[optind + 2];
    return o;
}

static void read_both(const struct options *o, struct grid *g, struct spec *s)
{
    char err[ERR_BYTES];
    if (grid_load(o->grid, g, err) != 0 || spec_load(o->spec, s, err) != 0)
        die(ST_USAGE, "%s", err);
    if (g->brick.is) die(ST_USAGE, "%s: is a brick, expected a whole grid", o->grid);
    float *deviation = spec_deviation(s, g);
    if (deviation) free(g->value), g->value = deviation;
    for (int a = 0; a < 3; a++)
        if (g->n[a] > NODES_MAX)
            die(ST_USAGE, "%s: %u nodes along %c, expected at most %d", o->grid, g->n[a], "xyz"[a],
                NODES_MAX);
    if (s->n_knots == 0 || s->n_knots > KNOTS_MAX)
        die(ST_USAGE, "%s: %zu map lines, expected 2 to %d", o->spec, s->n_knots, KNOTS_MAX);
    input_keep(o->df3);
    if (strpbrk(o->df3, "\"\\\n"))
        die(ST_USAGE, "%s: expected a name without quote, backslash and line end", o->df3);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid g;
    struct spec s;
    struct buf df3 = {0};
    read_both(&o, &g, &s);
    struct pov p = {.o = &o, .g = &g, .s = &s};
    survey(&p);
    if (!cut(&p))
        die(ST_USAGE, "-n %d: more than POV-Ray takes of a grid of this size, expected fewer",
            o.samples);
    grid_df3(&g, p.least, p.most, p.missing, &df3);
    if (outfile_put(o.df3, buf_data(&df3), buf_size(&df3)) != 0) die(ST_SYSTEM, "%s:", o.df3);
    buf_free(&df3);
    put_head(&p);
    put_field(&p);
    put_map(&p, "Extinction", false);
    put_map(&p, "Colour", true);
    if (!is_empty(&p)) put_box(&p);
    close_stdout();
    bool whole = !s.lit && !s.n_isos && !s.n_slices && !s.n_colours && !s.n_grounds;
    if (!whole)
        warn("%s: light, iso-surfaces, slices, ground and a second field are left out", o.spec);
    grid_free(&g);
    spec_free(&s);
    return whole ? ST_OK : ST_PARTIAL;
}
