/* far: coordinates that are large beside the extent of what they describe, as in maps. */
#include "mesh/mesh_int.h"

static double largest(struct vec3 v) { return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z))); }

static bool is_mesh_far(const struct aiMesh *mesh)
{
    struct vec3 lo = v3(HUGE_VAL, HUGE_VAL, HUGE_VAL), hi = v3_scale(lo, -1);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        const struct vec3 v = mesh_vec(mesh->mVertices[i]);
        if (!mesh_is_place(v)) continue;
        lo = v3(fmin(lo.x, v.x), fmin(lo.y, v.y), fmin(lo.z, v.z));
        hi = v3(fmax(hi.x, v.x), fmax(hi.y, v.y), fmax(hi.z, v.z));
    }
    return lo.x <= hi.x && mesh_is_far(fmax(largest(lo), largest(hi)), v3_len(v3_sub(hi, lo)));
}

void mesh_find_far(struct mesh *m)
{
    const double away = fmax(largest(m->lo), largest(m->hi)), extent = v3_len(v3_sub(m->hi, m->lo));
    for (unsigned i = 0; i < m->scene->mNumMeshes; i++)
        m->loss[LOSS_FAR].n += is_mesh_far(m->scene->mMeshes[i]);
    if (mesh_is_far(away, extent)) m->digits = (int)fmin(17, 8 + ceil(log10(away / extent)));
}
