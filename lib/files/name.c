/* name: which names an archive may have. */
#include "files/files.h"

#include <string.h>

#define NAME_MOST 1024 /* bytes */

bool files_name_check(const char *name, char err[ERR_BYTES])
{
    char shown[ERR_WORD];
    size_t n = strlen(name);
    err_word(shown, name, n);
    if (!n || n > NAME_MOST)
        return err_set(err, "name %s has %zu bytes, expected 1 to %d", shown, n, NAME_MOST);
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)name[i] < ' ' || name[i] == 0x7f)
            return err_set(err, "name %s: expected no control characters", shown);
    for (const char *part = name, *end; part; part = end ? end + 1 : NULL) {
        end = strchr(part, '/');
        size_t bytes = end ? (size_t)(end - part) : strlen(part);
        bool dots = bytes <= 2 && strspn(part, ".") >= bytes; /* empty, "." or ".." */
        if (dots) return err_set(err, "name %s: expected one below its directory", shown);
    }
    return true;
}
