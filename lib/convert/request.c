/* request: parses which variables become a grid: one, or two from which a third is derived. */
#include "convert/convert.h"

#include <string.h>

/* Part of a text, without surrounding blanks. */
struct part {
    const char *at;
    size_t n;
};

static struct part part_of(const char *begin, const char *end)
{
    while (begin < end && *begin == ' ') begin++;
    while (end > begin && end[-1] == ' ') end--;
    return (struct part){begin, (size_t)(end - begin)};
}

static void set_name(struct convert_request *r, struct part p)
{
    snprintf(r->name, GRID_NAME, "%.*s", (int)(p.n < GRID_NAME ? p.n : GRID_NAME - 1), p.at);
}

static bool add_part(struct convert_request *r, struct part p)
{
    r->part[r->n] = p.at;
    r->length[r->n++] = (int)p.n;
    return p.n > 0;
}

bool convert_request_parse(const char *text, struct convert_request *r)
{
    static const char call[] = "hypot(";
    const char *end = text + strlen(text), *equals = strchr(text, '=');
    struct part p = part_of(equals ? equals + 1 : text, end);
    bool derived = p.n > sizeof call && strncmp(p.at, call, sizeof call - 1) == 0;
    *r = (struct convert_request){.n = 0};
    if (!equals && !derived) {
        const char *slash = strrchr(text, '/');
        set_name(r, part_of(slash ? slash + 1 : text, end));
        return add_part(r, p);
    }
    const char *comma = memchr(p.at, ',', p.n);
    if (!equals || !derived || !comma || p.at[p.n - 1] != ')') return false;
    set_name(r, part_of(text, equals));
    return add_part(r, part_of(p.at + sizeof call - 1, comma)) &&
           add_part(r, part_of(comma + 1, p.at + p.n - 1)) && r->name[0];
}
