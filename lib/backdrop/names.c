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

/* True for degrees of a rotated sphere, which are no longitudes. */
static bool is_rotated(const char *name)
{
    return strcasecmp(name, "grid_longitude") == 0 || strcasecmp(name, "rlon") == 0;
}

/* The unit of x and y, or NULL if they are longitude and latitude. */
static const char *flat_unit(const struct grid *g, struct grid_named *x)
{
    char proj[GRID_TITLE];
    if (!grid_title(g->title, 'x', x)) return NULL;
    if (x->unit[0] && strncasecmp(x->unit, "degree", 6) != 0) return x->unit;
    if (text_has(x->unit, "_w")) return x->unit; /* degrees_west */
    const bool rotated = grid_title_proj(g->title, proj) && strstr(proj, "proj=ob_tran");
    return is_rotated(x->name) || rotated ? BACKDROP_DEGREE : NULL;
}

/* The legend has two bars: adds the name of the flat ground. */
static void name_flat(const struct grid *g, char title[2 * BACKDROP_NAMED])
{
    struct grid_named n;
    const bool known = grid_title(g->ground_title, 0, &n) && n.unit[0];
    const size_t had = strlen(title);
    snprintf(title + had, BACKDROP_NAMED, " (left); %.40s%s%.40s (right)",
        known ? n.name : g->ground_name, known ? ", " : "", known ? n.unit : "");
}

bool backdrop_on_globe(const struct grid *g)
{
    struct grid_named x;
    return !flat_unit(g, &x) && grid_title(g->title, 'x', &x) && x.unit[0];
}

const char *backdrop_head(const struct grid *g)
{
    char proj[GRID_TITLE];
    if (backdrop_on_globe(g)) return "> globe\n";
    return grid_title_proj(g->title, proj) ? "> plane\n" : "";
}

const char *backdrop_tail(const struct grid *g)
{
    return strcmp(backdrop_head(g), "> plane\n") == 0 ? "> globe\n" : "";
}

void backdrop_name(
    struct backdrop *b, const char *title, const char *unit, struct backdrop_names *n)
{
    const struct grid *g = b->grid;
    const bool second = b->spec->n_colours > 0; /* the legend is that of this field */
    bool known = grid_title(second ? g->second_title : g->title, 0, &n->scalar);
    const char *name = second ? g->second_name : g->name, *unit_of = "";
    if (known && n->scalar.unit[0]) name = n->scalar.name, unit_of = n->scalar.unit;
    snprintf(n->title, BACKDROP_NAMED, "%s%s%s%s",
        b->spec->n_profile && !second ? "deviation of " : "", name, *unit_of ? ", " : "", unit_of);
    if (b->spec->flat && !title) name_flat(g, n->title);
    b->title = title ? title : n->title;
    b->flat = flat_unit(g, &n->x);
    b->proj = b->flat && grid_title_proj(g->title, n->proj) ? n->proj : NULL;
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
    char plane[2][GRID_TITLE] = {"", ""};
    grid_title_proj(a, plane[0]);
    grid_title_proj(b, plane[1]);
    return n == timeless(b) && strncmp(a, b, n) == 0 && strcmp(plane[0], plane[1]) == 0;
}

bool backdrop_alike(const struct grid *a, const struct grid *b)
{
    if (!same_title(a->title, b->title) || !same_title(a->second_title, b->second_title) ||
        !same_title(a->ground_title, b->ground_title))
        return false;
    for (int i = 0; i < 3; i++)
        if (a->n[i] != b->n[i] || memcmp(a->at[i], b->at[i], a->n[i] * sizeof *a->at[i]) != 0)
            return false;
    return strcmp(a->name, b->name) == 0 && strcmp(a->second_name, b->second_name) == 0 &&
           strcmp(a->ground_name, b->ground_name) == 0;
}
