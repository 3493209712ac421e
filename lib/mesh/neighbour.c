/* neighbour: files beside the mesh whose names are written in another case, as Windows allows, or
 * as in a URI, where %20 is a blank. */
#include "mesh/mesh_int.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* Changes the case of the last component to that of an entry of its directory. */
static bool spell(char *path, char *name)
{
    char *slash = name > path ? name - 1 : NULL;
    if (slash) *slash = '\0';
    DIR *dir = opendir(!slash ? "." : slash == path ? "/" : path);
    if (slash) *slash = '/';
    const struct dirent *e;
    do e = dir ? readdir(dir) : NULL;
    while (e && strcasecmp(e->d_name, name) != 0);
    if (e) memcpy(name, e->d_name, strlen(name));
    if (dir) closedir(dir);
    return e != NULL;
}

/* Changes the case of components until the path is there. */
static bool spell_all(char *path)
{
    for (char *name = path, *end; name; name = end ? end + 1 : NULL) {
        end = strchr(name, '/');
        if (end) *end = '\0';
        const bool there = !*name || access(path, F_OK) == 0 || spell(path, name);
        if (end) *end = '/';
        if (!there) return false;
    }
    return true;
}

static int digit(char c)
{
    static const char digits[] = "0123456789abcdef0123456789ABCDEF";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) % 16 : -1;
}

/* Replaces %XX by the byte. False if there is none. */
static bool decode(char *path)
{
    char *to = path;
    for (const char *at = path; *at; at++) {
        const int high = *at == '%' ? digit(at[1]) : -1, low = high < 0 ? -1 : digit(at[2]);
        *to++ = low < 0 || !(high + low) ? *at : (char)(high * 16 + low);
        if (low >= 0 && high + low) at += 2;
    }
    const bool shorter = *to != '\0';
    *to = '\0';
    return shorter;
}

char *mesh_neighbour(const char *path)
{
    char *found = xstrdup(path);
    bool there = spell_all(found);
    if (!there) {
        snprintf(found, strlen(path) + 1, "%s", path);
        there = decode(found) && spell_all(found);
    }
    if (!there) free(found), found = NULL;
    return found;
}
