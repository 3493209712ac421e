/* The pixel of a ray: over the ground, the background, or as it is. */
#include "volume/volume_int.h"

void volume_put(const struct volume *v, const double rgb[3], double transmittance, float *rgba)
{
    bool backed = v->spec->backed && !v->brick;
    for (int c = 0; c < 3; c++)
        rgba[c] = (float)(rgb[c] + (backed ? transmittance * v->spec->background[c] : 0));
    rgba[3] = backed ? 1 : (float)(1 - transmittance);
}

void volume_put_ground(const struct volume *v, const struct meeting *m, const double rgb[3],
    double transmittance, float *rgba)
{
    double sum[3];
    for (int c = 0; c < 3; c++) sum[c] = rgb[c] + transmittance * m->rgb[c];
    volume_put(v, sum, transmittance * m->through, rgba);
}
