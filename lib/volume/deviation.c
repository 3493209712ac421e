/*
 * deviation: the field less the profile of the specification. Views with the same profile share the
 * values, which are as large as the grid's.
 */
#include "volume/volume_int.h"

#include <stdlib.h>
#include <string.h>

struct deviation {
    const struct grid *g;
    struct spec_level *profile; /* a copy */
    size_t n_profile, users;
    float *value;
    struct deviation *next;
};
static struct deviation *all;

const float *volume_deviation(const struct grid *g, const struct spec *s)
{
    if (!s->n_profile) return g->value;
    const size_t bytes = s->n_profile * sizeof *s->profile;
    struct deviation *d = all;
    while (d && !(d->g == g && d->n_profile == s->n_profile &&
                    memcmp(d->profile, s->profile, bytes) == 0))
        d = d->next;
    if (!d) {
        d = xcalloc(1, sizeof *d);
        *d = (struct deviation){.g = g, .n_profile = s->n_profile, .next = all};
        d->profile = xmalloc(s->n_profile, sizeof *d->profile);
        memcpy(d->profile, s->profile, bytes);
        d->value = spec_deviation(s, g);
        all = d;
    }
    d->users++;
    return d->value;
}

void volume_deviation_free(const float *value)
{
    struct deviation **at = &all;
    while (*at && (*at)->value != value) at = &(*at)->next;
    struct deviation *d = *at;
    if (!d || --d->users > 0) return;
    *at = d->next;
    free(d->profile);
    free(d->value);
    free(d);
}
