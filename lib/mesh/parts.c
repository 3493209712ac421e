/* parts: walks the tree of nodes, and multiplies their transforms. */
#include "mesh/mesh_int.h"

#include <stdlib.h>
#include <string.h>

static const struct mesh_frame identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/* Nodes that are not visited yet. The tree may be as deep as the file is long: no recursion. */
struct stack {
    struct entry {
        const struct aiNode *node;
        struct mesh_frame parent;
    } * at;
    size_t n;
};

static void push(struct stack *s, const struct aiNode *node, const struct mesh_frame *parent)
{
    if (!node) return;
    s->at = xgrown(s->at, s->n, sizeof *s->at);
    s->at[s->n++] = (struct entry){node, *parent};
}

static struct mesh_frame product(const struct mesh_frame *a, const struct aiMatrix4x4 *b)
{
    const struct mesh_frame right = mesh_frame_of(b);
    struct mesh_frame out;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            out.m[i][k] = a->m[i][0] * right.m[0][k] + a->m[i][1] * right.m[1][k] +
                          a->m[i][2] * right.m[2][k] + (k == 3 ? a->m[i][3] : 0);
    return out;
}

static bool same_name(const struct aiString *a, const struct aiString *b)
{
    return a->length == b->length && memcmp(a->data, b->data, a->length) == 0;
}

/*
 * Only the name tells which node has a light or camera, and several nodes may have one name. Those
 * without meshes go before the others, and the first of them before the rest.
 */
static void place(struct mesh_place *p, const struct aiNode *node, const struct mesh_frame *f)
{
    bool bare = node->mNumMeshes == 0;
    if (bare && !p->bare) p->n = 0, p->bare = true;
    if (bare != p->bare) return;
    if (p->n++ == 0) p->frame = *f;
}

static void place_all(struct mesh *m, const struct aiNode *node, const struct mesh_frame *f)
{
    const struct aiScene *s = m->scene;
    for (unsigned i = 0; i < s->mNumLights; i++)
        if (same_name(&s->mLights[i]->mName, &node->mName)) place(&m->light_places[i], node, f);
    for (unsigned i = 0; i < s->mNumCameras; i++)
        if (same_name(&s->mCameras[i]->mName, &node->mName)) place(&m->camera_places[i], node, f);
}

static void add_part(struct mesh *m, const struct aiMesh *mesh, struct mesh_frame f)
{
    m->parts = xgrown(m->parts, m->n_parts, sizeof *m->parts);
    struct vec3 x = mesh_row(&f, 0), y = mesh_row(&f, 1), z = mesh_row(&f, 2), yz = v3_cross(y, z);
    bool mirrors = v3_dot(x, yz) < 0;
    double sign = mirrors ? -1 : 1; /* cofactors are the inverse transpose times the determinant */
    m->parts[m->n_parts++] = (struct mesh_part){mesh, f,
        {v3_scale(yz, sign), v3_scale(v3_cross(z, x), sign), v3_scale(v3_cross(x, y), sign)},
        mirrors, mesh_has_colours(m, mesh)};
}

static bool visit(struct mesh *m, uint64_t *faces, const struct entry *e)
{
    const struct aiScene *s = m->scene;
    struct mesh_frame f = product(&e->parent, &e->node->mTransformation);
    place_all(m, e->node, &f);
    for (unsigned i = 0; i < e->node->mNumMeshes; i++) {
        unsigned at = e->node->mMeshes[i];
        if (at >= s->mNumMeshes) continue;
        *faces += s->mMeshes[at]->mNumFaces;
        if (*faces > MESH_FACES_MAX) return false;
        add_part(m, s->mMeshes[at], f);
    }
    return true;
}

/* Places without a node yet. */
static struct mesh_place *places(unsigned n)
{
    struct mesh_place *p = xcalloc(n + 1, sizeof *p);
    for (unsigned i = 0; i < n; i++) p[i].frame = identity;
    return p;
}

static void count_doubtful(struct mesh *m, const struct mesh_place *p, unsigned n)
{
    for (unsigned i = 0; i < n; i++) m->loss[LOSS_PLACES].n += p[i].n > 1;
}

bool mesh_parts_find(struct mesh *m, char err[ERR_BYTES])
{
    const struct aiScene *s = m->scene;
    struct stack stack = {.n = 0};
    uint64_t faces = 0;
    bool ok = true;
    if (s->mNumLights > MESH_LIGHTS_MAX || s->mNumCameras > MESH_LIGHTS_MAX)
        return err_set(err, "%u lights and %u cameras, expected at most %u of each", s->mNumLights,
            s->mNumCameras, MESH_LIGHTS_MAX);
    m->light_places = places(s->mNumLights);
    m->camera_places = places(s->mNumCameras);
    const struct mesh_frame axes = mesh_axes(m);
    push(&stack, s->mRootNode, &axes);
    while (ok && stack.n) {
        struct entry e = stack.at[--stack.n];
        struct mesh_frame f = product(&e.parent, &e.node->mTransformation);
        ok = visit(m, &faces, &e);
        for (unsigned i = e.node->mNumChildren; ok && i-- > 0;)
            push(&stack, e.node->mChildren[i], &f);
    }
    free(stack.at);
    count_doubtful(m, m->light_places, s->mNumLights);
    count_doubtful(m, m->camera_places, s->mNumCameras);
    return ok || err_set(err, "more than %u faces, expected at most as many", MESH_FACES_MAX);
}
