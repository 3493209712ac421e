/* file: opens and closes NetCDF files; reports libnetcdf's failures. */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <sys/stat.h>

bool cf_look(struct cf_file *c, char err[ERR_BYTES])
{
    int status = c->status;
    c->status = NC_NOERR;
    return !status || err_set(err, "%s", nc_strerror(status));
}

static bool open_zarr(const char *path, struct cf_file *c, char err[ERR_BYTES])
{
    struct buf url = {0};
    bool good = cf_zarr_url(path, &url, err);
    if (good) cf_did(c, nc_open((const char *)buf_data(&url), NC_NOWRITE, &c->root));
    buf_free(&url);
    if (!good || !cf_look(c, err)) return false;
    if (cf_zarr_check(c->root, path, err)) return true;
    nc_close(c->root);
    return false;
}

bool cf_open(const char *path, struct cf_file *c, char err[ERR_BYTES])
{
    struct stat st;
    *c = (struct cf_file){0};
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode)) return open_zarr(path, c, err);
    if (!cf_is_whole(path, err)) return false;
    cf_did(c, nc_open(path, NC_NOWRITE, &c->root));
    return cf_look(c, err);
}

void cf_close(struct cf_file *c) { nc_close(c->root); }
