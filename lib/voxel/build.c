/* build: what the readers of formats share: messages, arrays, and a file beside the header. */
#include "voxel/voxel_int.h"

#include <string.h>
#include <sys/stat.h>

#define NUMBERS_MAX (UINT64_C(1) << 40)

/* ---- messages -------------------------------------------------------------------------------- */

bool voxel_fail(struct voxel *v, const char *fmt, ...)
{
    char what[ERR_BYTES], shown[ERR_PATH];
    va_list ap;
    va_start(ap, fmt);
    if (v->line) err_at(v->err, v->name, v->line, fmt, ap);
    else {
        vsnprintf(what, sizeof what, fmt, ap);
        err_set(v->err, "%s: %s", err_path(shown, v->name), what);
    }
    va_end(ap);
    return false;
}

/* ---- what readers add ------------------------------------------------------------------------ */

bool voxel_set_nodes(struct voxel *v, int axis, int64_t n)
{
    if (n < 1 || n > VOXEL_NODES_MAX)
        return voxel_fail(
            v, "%lld nodes on axis %d, expected 1 to %u", (long long)n, axis + 1, VOXEL_NODES_MAX);
    v->n[axis] = (uint32_t)n;
    return true;
}

uint32_t voxel_side(const struct voxel *v, bool cells, int axis)
{
    return v->n[axis] - (cells && v->n[axis] > 1); /* VTK's flat grids have a layer of cells */
}

uint64_t voxel_numbers(const struct voxel *v, const struct voxel_array *a)
{
    uint64_t n = a->components;
    for (int axis = 0; axis < 3; axis++) {
        const uint64_t side = voxel_side(v, a->cells, axis);
        if (n > NUMBERS_MAX / (side ? side : 1)) return 0;
        n *= side;
    }
    return n;
}

void voxel_even(struct voxel *v)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) v->step[i][k] = i == k;
}

void voxel_across(struct voxel *v)
{
    const double *a = v->step[0], *b = v->step[1];
    double *c = v->step[2], length = 0;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        c[k] = a[l] * b[m] - a[m] * b[l];
        length += c[k] * c[k];
    }
    for (int k = 0; k < 3 && length > 0; k++) c[k] /= sqrt(length);
}

/* Names come from files: what breaks a line or a word of a list is replaced. */
static void copy_name(char out[GRID_NAME], const char *name)
{
    snprintf(out, GRID_NAME, "%s", *name ? name : "values");
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = '?';
}

struct voxel_array *voxel_add(
    struct voxel *v, const char *name, struct voxel_type type, uint64_t components, bool cells)
{
    v->array = xgrown(v->array, v->n_arrays, sizeof *v->array);
    struct voxel_array *a = &v->array[v->n_arrays++];
    *a = (struct voxel_array){
        .type = type, .components = components, .cells = cells, .component_stride = 1};
    copy_name(a->name, name);
    uint64_t stride = components;
    for (int axis = 0; axis < 3; axis++) {
        a->stride[axis] = stride;
        stride *= voxel_side(v, a->cells, axis);
    }
    return a;
}

void voxel_slowest(const struct voxel *v, struct voxel_array *a)
{
    uint64_t stride = 1;
    for (int axis = 0; axis < 3; axis++) {
        a->stride[axis] = stride;
        stride *= voxel_side(v, a->cells, axis);
    }
    a->component_stride = stride;
}

bool voxel_beside(struct voxel *v, const char *name, struct buf *bytes)
{
    char shown[ERR_PATH], path[4096];
    struct stat st;
    err_path(shown, name);
    if (!v->directory)
        return voxel_fail(
            v, "the values are in '%s', expected the header as a file beside it", shown);
    bool inside = *name && *name != '/';
    for (const char *at = name; at && inside; at = strchr(at, '/')) {
        at += *at == '/';
        inside = strncmp(at, "..", 2) != 0 || (at[2] && at[2] != '/');
    }
    if (!inside)
        return voxel_fail(v,
            "the values are in '%s', expected a file in the header's directory, "
            "or below it",
            shown);
    if (snprintf(path, sizeof path, "%s/%s", v->directory, name) >= (int)sizeof path)
        return voxel_fail(v, "'%s' is too long a name, expected a shorter one", shown);
    if (stat(path, &st) != 0 || !S_ISREG(st.st_mode) || read_file(path, bytes) != 0)
        return voxel_fail(v,
            "the values are in '%s', which is no file that can be read, expected "
            "it beside the header",
            shown);
    return true;
}
