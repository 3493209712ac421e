/* Grids and specifications from files. */
#include "volume/volume.h"

#include <errno.h>
#include <string.h>

static bool load(const char *path, struct buf *b, char err[VOLUME_ERR])
{
    *b = (struct buf){0};
    if (read_file(path, b) == 0) return true;
    buf_free(b);
    return err_set(err, "%.128s: %s", path, strerror(errno));
}

int grid_load(const char *path, struct grid *g, char err[VOLUME_ERR])
{
    struct buf b;
    *g = (struct grid){.value = NULL};
    if (!load(path, &b, err)) return -1;
    int failed = grid_read(path, buf_data(&b), buf_size(&b), g, err);
    buf_free(&b);
    return failed;
}

int spec_load(const char *path, struct spec *s, char err[VOLUME_ERR])
{
    struct buf b;
    *s = (struct spec){.knot = NULL};
    if (!load(path, &b, err)) return -1;
    int failed = spec_read(path, (const char *)buf_data(&b), buf_size(&b), s, err);
    buf_free(&b);
    return failed;
}
