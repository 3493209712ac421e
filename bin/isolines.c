/* isolines: prints lines along which a level of a grid has a value, for the map of backdrop. */
#include "backdrop/backdrop.h"
#include "layer/layer.h"

#include <stdlib.h>
#include <unistd.h>

#define VALUES_MAX 1000
#define STEPS 12 /* at most as many, without -e and -v */

struct options {
    double step;   /* -e; 0: a round one */
    double *value; /* -v; NULL: by step */
    size_t n_values;
    bool has_z, flat; /* flat: -m: on the map, whatever the height */
    double z;         /* -z; otherwise the lowest level */
    const char *path;
};

static const char usage_text[] = "[-hm] [-e STEP|-v VALUE,...] [-z HEIGHT] GRID.vtk";

static struct options parse(int argc, char **argv)
{
    struct options o = {.step = 0};
    for (int c; (c = prog_getopt(argc, argv, "e:hmv:z:")) != -1;) switch (c) {
        case 'e': o.step = opt_real(c, optarg, 1e-18, GRID_MAX); break;
        case 'h': usage(ST_OK, usage_text);
        case 'm': o.flat = true; break;
        case 'v':
            free(o.value);
            o.value = opt_reals(c, optarg, -GRID_MAX, GRID_MAX, &o.n_values);
            if (o.n_values > VALUES_MAX)
                die(ST_USAGE, "-v: %zu values, expected %d at most", o.n_values, VALUES_MAX);
            break;
        case 'z':
            o.z = opt_real(c, optarg, -GRID_MAX, GRID_MAX);
            o.has_z = true;
            break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 1 || (o.step > 0 && o.value)) usage(ST_USAGE, usage_text);
    o.path = argv[optind];
    return o;
}

/* Sets the values to multiples of the step within the range of the level. */
static void take_values(struct options *o, const float *level, size_t n)
{
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        least = fmin(least, (double)level[i]); /* a NaN changes nothing */
        most = fmax(most, (double)level[i]);
    }
    if (!(least < most)) return;
    if (o->step <= 0) o->step = backdrop_step(most - least, STEPS);
    const double first = ceil(least / o->step), last = floor(most / o->step);
    if (last - first >= VALUES_MAX)
        die(ST_USAGE, "-e %g: %.0f values between %g and %g, expected %d at most", o->step,
            last - first + 1, least, most, VALUES_MAX);
    o->value = xcalloc(VALUES_MAX, sizeof *o->value);
    for (; first + (double)o->n_values <= last; o->n_values++)
        o->value[o->n_values] = (first + (double)o->n_values) * o->step;
}

static void print(void *ctx, const struct layer_point *at, size_t n)
{
    const double *value = ctx;
    printf("> line %.9g\n", *value + 0.0);
    for (size_t i = 0; i < n; i++) printf("%.15g %.15g\n", at[i].x, at[i].y);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct grid g;
    float *level;
    char err[ERR_BYTES];
    if (grid_load(o.path, &g, err) != 0) die(ST_USAGE, "%s", err);
    if (!layer_level(&g, o.has_z ? o.z : g.at[2][0], &level, err)) die(ST_USAGE, "-z %s", err);
    if (!o.value) take_values(&o, level, grid_node(&g, 0, 0, 1));
    printf("%s", backdrop_head(&g));
    if (o.has_z && !o.flat) printf("> height %.15g\n", o.z);
    for (size_t i = 0; i < o.n_values; i++)
        layer_isolines(&g, level, o.value[i], print, &o.value[i]);
    printf("%s", backdrop_tail(&g));
    free(level);
    free(o.value);
    grid_free(&g);
    close_stdout();
    return ST_OK;
}
