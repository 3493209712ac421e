/*
 * starter: what the files of a starter share: the values of a grid, surveyed, and how they are
 * seen. Private to lib/spec.
 */
#ifndef STORMRING_SPEC_STARTER_H
#define STORMRING_SPEC_STARTER_H

#include "geometry/geometry.h"
#include "spec/spec.h"

/* ---- the values (survey.c) ------------------------------------------------------------------ */

/* Ends of bands, as parts of all values. The last tenth is cut: jets and cores are there. */
#define SPEC_RANKS 12
extern const double spec_rank[SPEC_RANKS];

struct spec_survey {
    float quantile[SPEC_RANKS]; /* the first and the last are the least and the greatest value */
    size_t there, nodes;        /* values that are not missing */
    bool ground;                /* many are the least one: quantiles are those of the others */
    double part;                /* of all nodes: those in the quantiles */
    double by_level;            /* the part of the variance that the levels' means explain */
};
void spec_survey(const struct grid *g, struct spec_survey *v);
/* True if y has two rows with the same values: a vertical section. */
bool spec_is_section(const struct grid *g);

/* Deviations from a profile. Their magnitudes at these parts of all of them bound bands. */
#define SPEC_CUTS 6
extern const double spec_cut[SPEC_CUTS];
struct spec_deviations {
    double *mean;         /* of each level, as it is printed; NaN: all values are missing */
    float least, most;    /* deviations */
    float cut[SPEC_CUTS]; /* magnitudes; the last one is the greatest */
};
/* Surveys the deviations from the mean of each level, or from 0. The caller frees mean. */
void spec_survey_deviations(const struct grid *g, bool from_zero, struct spec_deviations *d);

/* ---- how they are seen (look.c) ------------------------------------------------------------- */

struct spec_box {
    double chord;     /* the mean length of a ray in the visible values, in scaled space */
    struct vec3 lamp; /* for surfaces */
};
/* Appends the lines that say how the field is seen. */
void spec_look(const struct grid *g, const struct spec_survey *v, const struct spec_wish *wish,
    const struct spec_box *box, struct buf *out);
/* Appends the lines of the ground of g, whose values are heights of a terrain, or flat. */
void spec_put_ground(const struct grid *g, bool terrain, struct buf *out);

#endif
