/* Which variables become a grid: one, or two from which a third is derived. */
#include "convert/convert.h"

#include <string.h>

static void set_name(char to[VOLUME_NAME], const char *name, size_t n)
{
    snprintf(to, VOLUME_NAME, "%.*s", (int)(n < VOLUME_NAME ? n : VOLUME_NAME - 1), name);
}

static void set_part(struct convert_request *r, const char *begin, const char *end)
{
    r->part[r->n] = begin;
    r->length[r->n++] = (int)(end - begin);
}

bool convert_request_parse(const char *text, struct convert_request *r)
{
    static const char call[] = "=hypot(";
    const char *end = text + strlen(text), *at = strstr(text, call);
    const char *comma = at ? strchr(at, ',') : NULL;
    *r = (struct convert_request){.n = 0};
    if (!comma || end[-1] != ')') {
        const char *slash = strrchr(text, '/'), *name = slash ? slash + 1 : text;
        set_part(r, text, end);
        set_name(r->name, name, (size_t)(end - name));
        return true;
    }
    set_part(r, at + sizeof call - 1, comma);
    set_part(r, comma + 1, end - 1);
    set_name(r->name, text, (size_t)(at - text));
    return at > text;
}
