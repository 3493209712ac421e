/* neighbour: files beside the mesh whose names are written in another case, as Windows allows. */
#include "mesh/mesh_int.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

char *mesh_any_case(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const size_t lead = (size_t)(name - path), n = strlen(path) + 1;
    char *found = xmalloc(n, 1);
    snprintf(found, n, "%.*s", (int)lead, path);
    DIR *dir = opendir(lead ? found : ".");
    const struct dirent *e;
    do e = dir ? readdir(dir) : NULL;
    while (e && strcasecmp(e->d_name, name) != 0);
    if (e) snprintf(found + lead, n - lead, "%s", e->d_name);
    else free(found), found = NULL;
    if (dir) closedir(dir);
    return found;
}
