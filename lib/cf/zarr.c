/*
 * zarr: opens a Zarr store, which is a directory. "Zarr Storage Specification", version 2.
 *
 * Debian's libnetcdf has no filters, and takes packed numbers for plain ones without a word. So the
 * description of each array is read here first: it must name no compressor and no filter.
 */
#include "cf/cf_int.h"

#include <netcdf.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* True if the word is there, and null follows. */
static bool is_null(const struct buf *b, const char *word)
{
    const unsigned char *p = text_find(buf_data(b), buf_size(b), word, strlen(word));
    const unsigned char *end = buf_data(b) + buf_size(b);
    if (!p) return false;
    for (p += strlen(word); p < end && *p && strchr(" \t\r\n:", *p); p++) continue;
    return end - p >= 4 && memcmp(p, "null", 4) == 0;
}

static bool check_array(const char *store, const char *group, const char *name, char err[ERR_BYTES])
{
    struct buf path = {0}, text = {0};
    buf_printf(&path, "%s%s/%s/.zarray", store, strcmp(group, "/") == 0 ? "" : group, name);
    buf_append(&path, "", 1);
    bool good = read_file((const char *)buf_data(&path), &text) == 0 &&
                is_null(&text, "\"compressor\"") && is_null(&text, "\"filters\"");
    buf_free(&path);
    buf_free(&text);
    return good || err_set(err,
                       "%.60s is packed, and libnetcdf does not unpack Zarr, expected a "
                       "store without compressors and filters",
                       name);
}

bool cf_zarr_check(int id, const char *store, char err[ERR_BYTES])
{
    int n = 0, variables = 0;
    size_t length = 0;
    if (nc_inq_grps(id, &n, NULL) || nc_inq_nvars(id, &variables) ||
        nc_inq_grpname_full(id, &length, NULL))
        return err_set(err, "libnetcdf lists no groups, expected them");
    char *group = xcalloc(length + 1, 1), name[NC_MAX_NAME + 1];
    int *groups = xcalloc((size_t)n + 1, sizeof *groups);
    bool good = !nc_inq_grpname_full(id, &length, group) && !nc_inq_grps(id, &n, groups);
    for (int i = 0; good && i < variables; i++)
        good = !nc_inq_varname(id, i, name) && check_array(store, group, name, err);
    for (int i = 0; good && i < n; i++) good = cf_zarr_check(groups[i], store, err);
    free(groups);
    free(group);
    return good;
}

bool cf_zarr_url(const char *path, struct buf *url, char err[ERR_BYTES])
{
    char here[4096] = "";
    if (*path != '/' && !getcwd(here, sizeof here)) *here = '\0';
    if (strpbrk(here, "#?%[]") || strpbrk(path, "#?%[]"))
        return err_set(err, "a directory with #, ?, %%, [ or ] in its path, which libnetcdf does "
                            "not open, expected another name");
    buf_printf(url, "file://%s%s%s#mode=zarr,file", here, *path == '/' ? "" : "/", path);
    buf_append(url, "", 1);
    return true;
}
