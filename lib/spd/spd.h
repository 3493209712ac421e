/*
 * spd: generates the scenes of the Standard Procedural Databases, version 3.14 (E. Haines, "A
 * proposal for standard graphics environments", IEEE CG&A 7(11), 1987): the same entities in the
 * same order with the same numbers, at every size factor.
 *
 * A scene is one file and one row of the table. It writes complete NFF: background, view, lights,
 * materials, primitives.
 */
#ifndef STORMRING_SPD_H
#define STORMRING_SPD_H

#include "scene/scene.h"

/* Sizes that make more primitives than this are refused. */
#define SPD_PRIMS_MAX UINT64_C(10000000)
#define SPD_SIZE_MAX 1000000 /* of scenes that do not scale, which take every size */

struct spd_scene {
    const char *name;
    int size; /* SPD's own default */
    /*
     * Upward tilt of the camera about its position for the imbalanced view. The coefficient of
     * variation of row costs is then twice that of SPD's view; if no tilt achieves that, it is the
     * largest possible. Measured as CPU time at size 2 and 512x512, in whole degrees, by
     * tests/bench/90_views.sh. C.-N. Lee, T.-Y. Lee, T.-C. Lu ("Comparisons of Load Balancing
     * Strategies for Ray Tracing on Network Clustered Environments", 1996) moved the camera for
     * their second data type, whose costs vary more from row to row. They did so for balls, gears
     * and tetra. 0: the scene has no imbalanced view.
     */
    double imbalanced_deg;
    const char *what;    /* a sentence without its full stop */
    const char *formula; /* number of primitives at size s, as text */
    uint64_t (*count)(int size);
    void (*write)(struct nff_out *o, int size, double turn_deg);
};

extern const struct spd_scene spd_scenes[];
extern const size_t spd_n_scenes;

/* NULL if no scene has this name. */
const struct spd_scene *spd_find(const char *name);
/* Writes the scene with SPD's view or, if it has one, with the imbalanced view. */
void spd_write(const struct spd_scene *scene, struct nff_out *o, int size, bool imbalanced);
/* The largest size with at most SPD_PRIMS_MAX primitives. */
int spd_size_max(const struct spd_scene *scene);

#endif
