/*
 * accuracy_bench: what integrators of volumes cost, and what they are wrong by, on the wind of the
 * tests as it is seen from above, by the smooth map or by a contour of so many m/s.
 *
 *     error MAP METHOD ...    METHOD, RMS error and the greatest error of a channel
 *     time MAP METHOD ...     METHOD, CPU us a ray
 *
 * MAP is `smooth` or a width. Errors are against marching in long double (volume_scenes.h), which
 * shares no code with what is measured, at every 4th pixel of every 4th row. No ray ends early.
 */
#include "../unit/volume_scenes.h"

#include <string.h>

#define SIDE 160
#define EVERY 4
#define REF_SIDE (SIDE / EVERY)
#define REF_STEPS 24 /* in each stretch between faces, to find knots by */

static struct scene scene_of(const char *map)
{
    struct scene c = wind_scene(SIDE);
    double width;
    if (strcmp(map, "smooth") == 0) smooth_map(&c);
    else if (parse_real(map, 1e-6, 1e3, &width)) contour_map(&c, width);
    else die(ST_USAGE, "%s: expected smooth or a width", map);
    return c;
}

static struct volume_options method_of(const char *name)
{
    struct volume_options o;
    char err[VOLUME_ERR];
    if (!volume_method_parse(name, &o, err)) die(ST_USAGE, "%s: expected %s", name, err);
    o.isa = ISA_AUTO;
    return o;
}

static struct volume *volume_of(const struct grid *g, const struct spec *s, const char *method)
{
    struct volume_options o = method_of(method);
    struct volume *v = volume_new(g, s, &o);
    volume_frame(v, SIDE, SIDE);
    return v;
}

static void put_error(
    const struct grid *g, const struct spec *s, const char *method, const real *ref)
{
    static float p[4 * REF_SIDE * REF_SIDE];
    const struct lattice every = {0, 0, REF_SIDE, REF_SIDE, EVERY, EVERY};
    struct volume *v = volume_of(g, s, method);
    double sum = 0, most = 0;
    volume_pixels(v, &every, 0, REF_SIDE * REF_SIDE, p);
    for (int i = 0; i < 4 * REF_SIDE * REF_SIDE; i++) {
        double e = fabs((double)((real)p[i] - ref[i]));
        sum += e * e;
        most = fmax(most, e);
    }
    printf("%s %.3g %.3g\n", method, sqrt(sum / (4 * REF_SIDE * REF_SIDE)), most);
    volume_free(v);
}

static void put_time(const struct grid *g, const struct spec *s, const char *method)
{
    static float p[4 * SIDE * SIDE];
    const struct lattice all = {0, 0, SIDE, SIDE, 1, 1};
    struct volume *v = volume_of(g, s, method);
    int64_t begin = cpu_us();
    volume_pixels(v, &all, 0, SIDE * SIDE, p);
    printf("%s %.4g\n", method, (double)(cpu_us() - begin) / (SIDE * SIDE));
    volume_free(v);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    if (argc < 4 || (*argv[1] != 'e' && *argv[1] != 't'))
        usage(ST_USAGE, "error MAP METHOD ... | time MAP METHOD ...");
    struct grid g = wind_grid();
    struct scene c = scene_of(argv[2]);
    static real ref[4 * REF_SIDE * REF_SIDE];
    c.s.knot = c.knot;
    for (uint32_t i = 0; *argv[1] == 'e' && i < REF_SIDE * REF_SIDE; i++)
        ref_pixel(&g, &c.s, i % REF_SIDE * EVERY, i / REF_SIDE * EVERY, REF_STEPS, ref + 4 * i);
    for (int i = 3; i < argc; i++)
        if (*argv[1] == 'e') put_error(&g, &c.s, argv[i], ref);
        else put_time(&g, &c.s, argv[i]);
    free_grid(&g);
    close_stdout();
    return 0;
}
