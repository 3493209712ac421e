/*
 * spd: the scenes of the Standard Procedural Databases, version 3.14 (E. Haines, "A proposal for
 * standard graphics environments", IEEE CG&A 7(11), 1987), generated anew: the same entities in
 * the same order with the same numbers, at every size factor.
 *
 * A scene is one file and one row of the table. What it writes is complete NFF: background, view,
 * lights, materials, primitives.
 */
#ifndef STORMRING_SPD_H
#define STORMRING_SPD_H

#include "scene/scene.h"

/* A size is accepted while it makes no more primitives than this. */
#define SPD_PRIMS_MAX UINT64_C(10000000)

struct spd_scene {
    const char *name;
    int size; /* SPD's own default: the most primitives under 10000 */
    /*
     * By so much the camera is turned upward, about its place, for the imbalanced view: costs of
     * rows then vary twice as much as in SPD's, by their coefficient of variation, or, where no
     * turn does that, most: of CPU time, at size 2 and 512x512, by whole degrees. Found by
     * tests/bench/90_views.sh. C.-N. Lee, T.-Y. Lee, T.-C. Lu ("Comparisons of Load Balancing
     * Strategies for Ray Tracing on Network Clustered Environments", 1996) moved the camera for
     * their second data type, whose costs vary more from row to row.
     */
    double imbalanced_deg;
    const char *formula; /* primitives at size s, for people */
    uint64_t (*count)(int size);
    void (*write)(struct nff_out *o, int size, double turn_deg);
};

extern const struct spd_scene spd_scenes[];
extern const size_t n_spd_scenes;

/* NULL when there is none of that name. */
const struct spd_scene *spd_find(const char *name);
/* Seen as by SPD, or as imbalanced. */
void spd_write(const struct spd_scene *scene, struct nff_out *o, int size, bool imbalanced);
/* The largest size that keeps within SPD_PRIMS_MAX. */
int spd_size_max(const struct spd_scene *scene);

uint64_t spd_balls_count(int size);
void spd_balls(struct nff_out *o, int size, double turn_deg);
uint64_t spd_gears_count(int size);
void spd_gears(struct nff_out *o, int size, double turn_deg);
uint64_t spd_tetra_count(int size);
void spd_tetra(struct nff_out *o, int size, double turn_deg);

#endif
