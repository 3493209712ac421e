/* faces: the faces of all parts in the scene's coordinates, without those that are unusable. */
#include "mesh/mesh_int.h"

#include <stdlib.h>

/*
 * Normals within 1e-9 of the face's own (cosine) shade as a flat face does: an angle of .003
 * degrees. Single precision and the six digits of STL files are finer.
 */
#define FLAT_COSINE (1 - 1e-9)

struct scratch {
    struct vec3 *v, *normal;
    uint32_t room;
};

static void make_room(struct scratch *s, uint32_t n)
{
    if (n <= s->room) return;
    s->room = n < 8 ? 8 : n;
    s->v = xrealloc(s->v, s->room, sizeof *s->v);
    s->normal = xrealloc(s->normal, s->room, sizeof *s->normal);
}

/* False if a corner is not there, not finite or too far away. */
static bool corners(const struct mesh_part *p, const struct aiFace *f, struct scratch *s)
{
    if (f->mNumIndices > MESH_CORNERS_MAX) return false;
    make_room(s, f->mNumIndices);
    for (unsigned i = 0; i < f->mNumIndices; i++) {
        unsigned at = mesh_vertex(p, f, i);
        if (at >= p->mesh->mNumVertices) return false;
        s->v[i] = mesh_frame_point(&p->frame, mesh_vec(p->mesh->mVertices[at]));
        if (!mesh_is_place(s->v[i])) return false;
    }
    return true;
}

/* Twice the area, along the normal (M. E. Newell's sum, about the first corner). */
static struct vec3 area(const struct vec3 *v, uint32_t n)
{
    struct vec3 sum = v3(0, 0, 0);
    for (uint32_t i = 1; i + 1 < n; i++)
        sum = v3_add(sum, v3_cross(v3_sub(v[i], v[0]), v3_sub(v[i + 1], v[0])));
    return sum;
}

enum normals { NORMALS_FLAT, NORMALS_BENT, NORMALS_BAD };

/* Turns the corners' normals. */
static enum normals normals(
    const struct mesh_part *p, const struct aiFace *f, struct vec3 own, struct scratch *s)
{
    const struct vec3 *c = p->turn;
    enum normals kind = NORMALS_FLAT;
    if (!p->mesh->mNormals) return NORMALS_FLAT;
    for (unsigned i = 0; i < f->mNumIndices; i++) {
        struct vec3 n = mesh_vec(p->mesh->mNormals[mesh_vertex(p, f, i)]);
        n = v3(v3_dot(c[0], n), v3_dot(c[1], n), v3_dot(c[2], n));
        double length = v3_len(n);
        if (length == 0) return NORMALS_FLAT; /* libassimp fills in what a face lacks */
        if (!mesh_is_length(length)) return NORMALS_BAD;
        s->normal[i] = v3_scale(n, 1 / length);
        if (fabs(v3_dot(s->normal[i], own)) < FLAT_COSINE) kind = NORMALS_BENT;
    }
    return kind;
}

static void count(struct mesh_loss *loss, enum mesh_loss_kind kind)
{
    if (loss) loss[kind].n++;
}

/* Fills in the face. False if it is unusable. */
static bool make(const struct mesh_part *p, const struct aiFace *f, struct mesh_loss *loss,
    struct scratch *s, struct mesh_face *out)
{
    if (f->mNumIndices == 1 || f->mNumIndices == 2) {
        count(loss, f->mNumIndices == 2 ? LOSS_LINES : LOSS_POINTS);
        return false;
    }
    if (f->mNumIndices == 0 || !corners(p, f, s)) {
        count(loss, LOSS_BAD_FACES);
        return false;
    }
    struct vec3 normal = area(s->v, f->mNumIndices);
    double length = v3_len(normal);
    if (!mesh_is_length(length)) {
        count(loss, LOSS_FLAT_FACES);
        return false;
    }
    normal = v3_scale(normal, 1 / length);
    enum normals kind = normals(p, f, normal, s);
    if (kind == NORMALS_BAD) count(loss, LOSS_BAD_NORMALS);
    *out = (struct mesh_face){.n = f->mNumIndices,
        .v = s->v,
        .normals = kind == NORMALS_BENT ? s->normal : NULL,
        .normal = normal,
        .material = p->mesh->mMaterialIndex,
        .part = p,
        .face = f};
    return true;
}

void mesh_faces_each(const struct mesh *m, struct mesh_loss *loss,
    void (*f)(void *ctx, const struct mesh_face *face), void *ctx)
{
    struct scratch s = {.room = 0};
    for (size_t i = 0; i < m->n_parts; i++) {
        const struct mesh_part *p = &m->parts[i];
        for (unsigned k = 0; k < p->mesh->mNumFaces; k++) {
            struct mesh_face face;
            if (make(p, &p->mesh->mFaces[k], loss, &s, &face)) f(ctx, &face);
        }
    }
    free(s.v);
    free(s.normal);
}
