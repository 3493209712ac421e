/* title: parses "U [m/s]; x lon [degrees_east]; ...; z -lev [hPa]; ...; proj STRING", where any
 * part may be missing. */
#include "grid/grid.h"

#include <string.h>

/* Parses "NAME [UNIT]". */
static bool take(const char *at, const char *end, struct grid_named *n)
{
    const char *open = end;
    if (at == end || end[-1] != ']') return false;
    while (open > at && *open != '[') open--;
    if (open <= at || open[-1] != ' ') return false;
    snprintf(n->name, sizeof n->name, "%.*s", (int)(open - 1 - at), at);
    snprintf(n->unit, sizeof n->unit, "%.*s", (int)(end - open - 2), open + 1);
    return true;
}

bool grid_title(const char *title, char axis, struct grid_named *n)
{
    for (const char *next, *at = title; at; at = next ? next + 2 : NULL) {
        next = strstr(at, "; ");
        const char *end = next ? next : at + strlen(at);
        *n = (struct grid_named){.down = false};
        if (axis && (at == title || *at != axis || at[1] != ' ')) continue;
        if (axis) at += 2;
        n->down = axis == 'z' && *at == '-';
        return take(at + n->down, end, n);
    }
    return false;
}

bool grid_title_proj(const char *title, char proj[GRID_TITLE])
{
    static const char mark[] = "; proj ";
    const char *at = strstr(title, mark);
    if (!at || strlen(title) >= GRID_TITLE - 1) return false;
    at += sizeof mark - 1;
    snprintf(proj, GRID_TITLE, "%.*s", (int)strcspn(at, ";"), at);
    return true;
}
