/*
 * axes: what a file states of its axes and its unit. The scene has y up and is in metres where they
 * are known. libassimp turns and scales Collada by the root's transform, and turns 3DS and
 * DXF, whose z is up; of FBX it only tells what the file states; glTF is as the scene.
 */
#include "mesh/mesh_int.h"

#include <string.h>

static const struct mesh_frame identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static const struct aiMetadataEntry *entry(
    const struct mesh *m, const char *key, enum aiMetadataType type)
{
    const struct aiMetadata *data = m->scene->mMetaData;
    for (unsigned i = 0; data && i < data->mNumProperties; i++)
        if (strcmp(data->mKeys[i].data, key) == 0)
            return data->mValues[i].mType == type ? &data->mValues[i] : NULL;
    return NULL;
}

static bool begins(const struct mesh *m, const char *key, const char *name)
{
    const struct aiMetadataEntry *e = entry(m, key, AI_AISTRING);
    return e && strncmp(((const struct aiString *)e->mData)->data, name, strlen(name)) == 0;
}

bool mesh_is_read_by(const struct mesh *m, const char *name)
{
    return begins(m, "SourceAsset_Format", name);
}

bool mesh_is_in_watts(const struct mesh *m)
{
    return begins(m, "SourceAsset_Generator", "Blender") &&
           (mesh_is_read_by(m, "Autodesk FBX") || mesh_is_read_by(m, "Collada"));
}

/* Sets a row to the file's axis, with its sign. False if the file does not state it. */
static bool take_axis(const struct mesh *m, const char *key, const char *sign_key, double row[4])
{
    const struct aiMetadataEntry *axis = entry(m, key, AI_INT32);
    const struct aiMetadataEntry *sign = entry(m, sign_key, AI_INT32);
    if (!axis || !sign) return false;
    const int32_t at = *(const int32_t *)axis->mData, s = *(const int32_t *)sign->mData;
    if (at < 0 || at > 2 || (s != 1 && s != -1)) return false;
    row[at] = s;
    return true;
}

/* FBX: its axes turn the scene, unless they are no axes of a right-handed system. */
static struct mesh_frame turned(const struct mesh *m)
{
    struct mesh_frame f = {{{0}}};
    const bool ok = take_axis(m, "CoordAxis", "CoordAxisSign", f.m[0]) &&
                    take_axis(m, "UpAxis", "UpAxisSign", f.m[1]) &&
                    take_axis(m, "FrontAxis", "FrontAxisSign", f.m[2]);
    const struct vec3 x = mesh_row(&f, 0), y = mesh_row(&f, 1), z = mesh_row(&f, 2);
    return ok && v3_dot(x, v3_cross(y, z)) > 0 ? f : identity;
}

/* The length of a unit of FBX, in metres; it is stated in centimetres. */
static double fbx_unit(const struct mesh *m)
{
    const struct aiMetadataEntry *e = entry(m, "UnitScaleFactor", AI_FLOAT);
    const double cm = e ? (double)*(const float *)e->mData : 1;
    return cm >= 1e-9 && cm <= 1e9 ? cm / 100 : .01;
}

/* Tells what differs between the file and the scene. f: from the one to the other. */
static void tell(struct mesh *m, const struct mesh_frame *f, double unit, bool metric)
{
    static const char axis[] = "xyz";
    const struct vec3 up = v3_scale(mesh_row(f, 1), 1 / unit);
    const double u[3] = {up.x, up.y, up.z};
    int most = 0, n = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(u[i]) > fabs(u[most])) most = i;
    const bool is_turned = u[1] < .999, is_scaled = metric && fabs(unit - 1) > 1e-6;
    const size_t room = sizeof m->turned;
    if (is_turned)
        n = snprintf(m->turned, room, "%s%c is up in the file, y in the scene",
            u[most] < 0 ? "-" : "", axis[most]);
    if (is_scaled)
        snprintf(m->turned + n, room - (size_t)n,
            "%sunits of %.6g m in the file, metres in the scene", n ? "; " : "", unit);
}

struct mesh_frame mesh_axes(struct mesh *m)
{
    struct mesh_frame f = identity;
    m->unit = 1;
    const bool collada = mesh_is_read_by(m, "Collada"), fbx = mesh_is_read_by(m, "Autodesk FBX");
    if (fbx) {
        const double unit = fbx_unit(m);
        f = turned(m);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) f.m[i][k] *= unit;
        tell(m, &f, unit, true);
        m->unit = unit;
    } else if (m->scene->mRootNode && (collada || mesh_is_read_by(m, "Discreet 3DS") ||
                                          mesh_is_read_by(m, "Drawing Interchange"))) {
        const struct mesh_frame root = mesh_frame_of(&m->scene->mRootNode->mTransformation);
        const double unit = v3_len(mesh_row(&root, 1));
        if (!mesh_is_length(unit)) return f;
        tell(m, &root, unit, collada);
        m->unit = unit;
    }
    return f;
}
