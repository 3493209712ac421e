/*
 * tetra: a tetrahedron of four tetrahedra of half its size, and so on, size - 1 times. The view is
 * that of A. Glassner (IEEE CG&A 4(10), 1984) and T. Kay and J. Kajiya (SIGGRAPH 1986). One light.
 */
#include "spd/parts.h"

static const struct view view = {.from = {1.022846, -3.177154, -2.174512},
    .at = {-0.004103, -0.004103, 0.216539},
    .up = {-0.816497, -0.816497, 0.816497},
    .angle_deg = 45,
    .hither = 1,
    .res_x = 512,
    .res_y = 512};
static const struct vec3 lights[] = {{2, -18, -5}};

/* Every second corner of a cube; together the corners of a tetrahedron. */
static const struct vec3 corners[4] = {{-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 1, 1}};
/* Its faces, counterclockwise from outside. */
static const int faces[4][3] = {{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}};

uint64_t spd_tetra_count(int size) { return UINT64_C(1) << 2 * size; }

static void put_tetra(struct nff_out *o, int depth, struct vec3 center, double half)
{
    struct vec3 p[4];
    for (int i = 0; i < 4; i++) p[i] = v3_mad(center, corners[i], depth > 1 ? half / 2 : half);
    for (int i = 0; i < 4; i++) {
        struct vec3 face[3] = {p[faces[i][0]], p[faces[i][1]], p[faces[i][2]]};
        if (depth > 1) put_tetra(o, depth - 1, p[i], half / 2);
        else nff_put_polygon(o, 3, face, NULL);
    }
}

void spd_tetra(struct nff_out *o, int size, double turn_deg)
{
    spd_put_setting(o, SPD_SKY, &view, turn_deg, lights, sizeof lights / sizeof *lights);
    nff_put_material(o, &(struct material){1, 0.2, 0.2, 1, 0, spd_shine(0), 0, 0});
    put_tetra(o, size, v3(0, 0, 0), 1);
}
