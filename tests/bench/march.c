/*
 * march: the picture of GRID by SPEC as it should be: marched in long double by code that shares
 * none with what renders (volume_scenes.h), as a PFM, premultiplied, on standard output.
 * tests/experiments/limits holds the methods of vcworker against it. SPEC has a map and nothing beside.
 */
#include "../unit/volume_scenes.h"
#include "image/image.h"

#define STEPS 24 /* in each stretch between faces, to find knots by */

static void check(const char *name, const struct spec *s)
{
    bool scaled = s->scale[0] != 1 || s->scale[1] != 1 || s->scale[2] != 1;
    if (s->n_isos || s->lit || s->backed || scaled)
        die(ST_USAGE, "%s: has iso, light, background or scale, expected a map alone", name);
    if (s->n_knots > KNOTS_MAX)
        die(ST_USAGE, "%s: a map of %zu knots, expected at most %d", name, s->n_knots, KNOTS_MAX);
}

int main(int argc, char **argv)
{
    struct grid g;
    struct spec s;
    struct image im;
    char err[ERR_BYTES];
    prog_init(argv[0]);
    if (argc != 3) usage(ST_USAGE, "GRID SPEC");
    if (grid_load(argv[1], &g, err) != 0 || spec_load(argv[2], &s, err) != 0)
        die(ST_USAGE, "%s", err);
    check(argv[2], &s);
    image_init(&im, s.w, s.h);
    for (uint32_t i = 0; i < s.w * s.h; i++) {
        real p[4];
        ref_pixel(&g, &s, i % s.w, i / s.w, STEPS, p);
        for (int c = 0; c < 4; c++) im.rgba[4 * (size_t)i + (size_t)c] = (float)p[c];
    }
    if (image_write(stdout, &im, IMAGE_PFM, 0, NULL) != 0) die(ST_SYSTEM, "standard output:");
    image_free(&im);
    grid_free(&g);
    spec_free(&s);
    close_stdout();
    return ST_OK;
}
