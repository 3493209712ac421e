/* put_scene: prints the camera, the picture's side and the map of a scene, for renderers of others. */
#ifndef PUT_SCENE_H
#define PUT_SCENE_H

#include <stdio.h>

#include "spec/spec.h"

static void put_scene(int side, const struct spec *s)
{
    const double *const triple[] = {s->from, s->at, s->up};
    for (int i = 0; i < 3; i++)
        printf("%.17g %.17g %.17g\n", triple[i][0], triple[i][1], triple[i][2]);
    printf("%.17g %d\n", s->angle, side);
    for (size_t i = 0; i < s->n_knots; i++) {
        const struct spec_knot *k = &s->knot[i];
        printf("%.17g %.17g %.17g %.17g %.17g\n", k->s, k->rgb[0], k->rgb[1], k->rgb[2], k->k);
    }
}

#endif
