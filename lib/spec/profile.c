/*
 * profile: the lines of a specification that say what is subtracted from the field at each height.
 */
#include "spec/spec_int.h"

bool spec_add_level(struct spec_reader *r, const double v[2])
{
    struct spec *s = r->s;
    if (s->n_profile && v[0] <= s->profile[s->n_profile - 1].z)
        return spec_fail(r, "profile: %.17g after %.17g, expected heights that ascend", v[0],
            s->profile[s->n_profile - 1].z);
    s->profile = xgrown(s->profile, s->n_profile, sizeof *s->profile);
    s->profile[s->n_profile++] = (struct spec_level){v[0], v[1]};
    return true;
}

double spec_profile_at(const struct spec *s, double z)
{
    const struct spec_level *p = s->profile, *last = p + s->n_profile - 1;
    if (!s->n_profile) return 0;
    if (z >= last->z) return last->s;
    while (z >= p->z && p < last) p++;
    if (p == s->profile) return p->s;
    return p[-1].s + (p->s - p[-1].s) * ((z - p[-1].z) / (p->z - p[-1].z));
}

float *spec_deviation(const struct spec *s, const struct grid *g)
{
    if (!s->n_profile) return NULL;
    const size_t layer = (size_t)g->n[0] * g->n[1];
    float *out = xmalloc(layer * g->n[2], sizeof *out);
    for (uint32_t k = 0; k < g->n[2]; k++) {
        const double less = spec_profile_at(s, g->at[2][k]);
        const float *from = g->value + k * layer;
        float *to = out + k * layer;
        for (size_t i = 0; i < layer; i++) to[i] = (float)((double)from[i] - less);
    }
    return out;
}
