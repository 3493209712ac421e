/* voxel: opens volumes by their first bytes, and tells of their arrays. */
#include "voxel/voxel_int.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- opening --------------------------------------------------------------------------------- */

static bool begins(const unsigned char *p, size_t n, const char *word)
{
    return n >= strlen(word) && strncasecmp((const char *)p, word, strlen(word)) == 0;
}

/* A header of MetaImage is lines "Word = value". */
static bool is_meta(const unsigned char *p, size_t n)
{
    static const char *const first[] = {"ObjectType", "NDims", "Comment", "ObjectSubType",
        "TransformType", "Name", "ID", "BinaryData", "DimSize"};
    for (size_t i = 0; i < sizeof first / sizeof *first; i++) {
        size_t at = strlen(first[i]);
        if (!begins(p, n, first[i])) continue;
        while (at < n && (p[at] == ' ' || p[at] == '\t')) at++;
        return at < n && p[at] == '=';
    }
    return false;
}

static bool read_any(struct voxel *v)
{
    const unsigned char *p = v->bytes;
    const size_t n = v->n_bytes;
    if (begins(p, n, "NRRD")) return voxel_read_nrrd(v);
    if (begins(p, n, "# vtk DataFile")) return voxel_read_legacy(v);
    if (is_meta(p, n)) return voxel_read_meta(v);
    if (begins(p, n, "\037\213")) return voxel_read_nifti(v);
    if (n >= 4 && (memcmp(p, "\0\0\1\134", 4) == 0 || memcmp(p, "\134\1\0\0", 4) == 0))
        return voxel_read_nifti(v);
    if (n >= 4 && (memcmp(p, "\0\0\2\034", 4) == 0 || memcmp(p, "\034\2\0\0", 4) == 0))
        return voxel_fail(v, "a NIfTI-2 volume, expected NIfTI-1");
    size_t at = begins(p, n, "\357\273\277") ? 3 : 0;
    while (at < n && p[at] && strchr(" \t\r\n", p[at])) at++;
    if (at < n && p[at] == '<') return voxel_read_xml(v);
    return voxel_fail(v, "no volume, expected a VTK file of an image or a rectilinear grid, NRRD, "
                         "MetaImage or NIfTI-1");
}

/* What VTK writes beside arrays of the user: bits that say which nodes or cells are hidden. */
static void take_ghosts(struct voxel *v)
{
    size_t n = 0;
    for (size_t i = 0; i < v->n_arrays; i++) {
        const struct voxel_array *a = &v->array[i];
        const bool ghost = strcmp(a->name, "vtkGhostType") == 0 && a->components == 1 &&
                           !v->ghost[a->cells].components;
        struct voxel_array *to = ghost ? &v->ghost[a->cells] : &v->array[n++];
        if (to != a) *to = *a;
    }
    v->n_arrays = n;
}

static bool check(struct voxel *v)
{
    v->line = 0;
    take_ghosts(v);
    if (!v->n_arrays) return voxel_fail(v, "no array of numbers, expected one at least");
    for (size_t i = 0; i < v->n_arrays; i++)
        if (!voxel_numbers(v, &v->array[i]))
            return voxel_fail(
                v, "more than 2^40 numbers in '%s', expected fewer", v->array[i].name);
    return true;
}

struct voxel *voxel_read(const char *name, const char *directory, const unsigned char *bytes,
    size_t n, char err[ERR_BYTES])
{
    struct voxel *v = xcalloc(1, sizeof *v);
    *v = (struct voxel){
        .name = name, .directory = directory, .bytes = bytes, .n_bytes = n, .slope = 1};
    v->err = err;
    voxel_even(v);
    for (int i = 0; i < 3; i++) snprintf(v->axis[i], sizeof v->axis[i], "%c", "xyz"[i]);
    if (read_any(v) && check(v)) return v;
    voxel_free(v);
    return NULL;
}

struct voxel *voxel_open(const char *path, char err[ERR_BYTES])
{
    struct buf b;
    char directory[4096] = ".";
    const bool input = strcmp(path, "-") == 0;
    const char *slash = strrchr(path, '/');
    if (!load_file(path, &b, err)) return NULL;
    if (slash) snprintf(directory, sizeof directory, "%.*s", (int)(slash - path) + 1, path);
    struct voxel *v = voxel_read(
        input ? "standard input" : path, input ? NULL : directory, buf_data(&b), buf_size(&b), err);
    if (v) v->file = b, v->directory = NULL;
    else buf_free(&b);
    return v;
}

void voxel_free(struct voxel *v)
{
    if (!v) return;
    for (int i = 0; i < 3; i++) free(v->at[i]);
    for (int i = 0; i < 2; i++) free(v->ghost[i].part);
    for (size_t i = 0; i < v->n_arrays; i++) free(v->array[i].part);
    for (size_t i = 0; i < v->n_pieces; i++) {
        free(v->piece[i].name);
        buf_free(&v->piece[i].bytes);
    }
    free(v->piece);
    free(v->array);
    buf_free(&v->file);
    buf_free(&v->data);
    free(v);
}

/* ---- arrays ---------------------------------------------------------------------------------- */

size_t voxel_arrays(const struct voxel *v) { return v->n_arrays; }

struct voxel_about voxel_array(const struct voxel *v, size_t i)
{
    static const char *const forms[] = {"int", "uint", "float"};
    const struct voxel_array *a = &v->array[i];
    struct voxel_about about = {a->name, "", {0}, a->components, a->cells};
    snprintf(about.type, sizeof about.type, "%s%d", forms[a->type.form], 8 * a->type.size);
    for (int axis = 0; axis < 3; axis++) about.n[axis] = voxel_side(v, a->cells, axis);
    return about;
}

size_t voxel_find(const struct voxel *v, const char *name)
{
    size_t i = 0;
    while (i < v->n_arrays && strcmp(v->array[i].name, name) != 0) i++;
    return i;
}
