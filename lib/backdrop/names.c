/* names: what a grid's title says about its map. */
#include "backdrop/backdrop.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* True if these levels have no unit, only a name. */
static bool is_level(const char *unit)
{
    return !*unit || strcmp(unit, "1") == 0 || strncmp(unit, "level", 5) == 0 ||
           strncmp(unit, "layer", 5) == 0 || strstr(unit, "sigma") || strstr(unit, "hybrid");
}

void backdrop_name(
    struct backdrop *b, const char *title, const char *unit, struct backdrop_names *n)
{
    const struct grid *g = b->grid;
    const bool second = b->spec->n_colours > 0; /* the legend is that of this field */
    bool known = grid_title(second ? g->second_title : g->title, 0, &n->scalar);
    known = known && n->scalar.unit[0];
    if (known) snprintf(n->title, sizeof n->title, "%s, %s", n->scalar.name, n->scalar.unit);
    b->title = title ? title : known ? n->title : second ? g->second_name : g->name;
    if (grid_title(g->title, 'x', &n->x) && n->x.unit[0] &&
        strncasecmp(n->x.unit, "degree", 6) != 0)
        b->flat = n->x.unit;
    known = grid_title(g->title, 'z', &n->z);
    b->down = unit ? unit[0] == '-' : known && n->z.down;
    b->unit = unit ? unit + b->down : known ? n->z.unit : "";
    if (known && !unit && is_level(n->z.unit)) b->levels = n->z.name;
}

/* The title without its time has this length. */
static size_t timeless(const char *title)
{
    const char *t = strstr(title, "; t ");
    return t ? (size_t)(t - title) : strlen(title);
}

static bool same_title(const char *a, const char *b)
{
    size_t n = timeless(a);
    return n == timeless(b) && strncmp(a, b, n) == 0;
}

bool backdrop_alike(const struct grid *a, const struct grid *b)
{
    if (!same_title(a->title, b->title) || !same_title(a->second_title, b->second_title))
        return false;
    for (int i = 0; i < 3; i++)
        if (a->n[i] != b->n[i] || memcmp(a->at[i], b->at[i], a->n[i] * sizeof *a->at[i]) != 0)
            return false;
    return strcmp(a->name, b->name) == 0 && strcmp(a->second_name, b->second_name) == 0;
}
