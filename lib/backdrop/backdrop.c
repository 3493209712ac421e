/* backdrop: the drawing as a whole. */
#include "backdrop/lines.h"

/* The part of the grid's lowest plane that is in front of the eye. */
static void plane(const struct drawing *s)
{
    struct outline o = {.flat = s->b->flat};
    for (int i = 0; i <= 4; i++)
        outline_append(&o,
            (struct outline_point){(i + 1) & 2 ? s->hi[0] : s->lo[0], i & 2 ? s->hi[1] : s->lo[1]});
    outline_bound(&o);
    mark_begin(s->list, BACKDROP_PLANE, SEA, 0);
    outline_fill(s, &o, BACKDROP_PLANE, SEA);
    outline_free(&o);
}

uint32_t backdrop_strip(const struct backdrop *b)
{
    struct drawing s;
    drawing_init(&s, b);
    return (uint32_t)s.strip;
}

/* Lines and places of one level. */
static void lines_and_places(const struct drawing *s, struct backdrop_lines *lines)
{
    mark_begin(s->list, BACKDROP_LINES, COAST, COAST_WIDTH);
    lines_stroke(s, lines);
    lines_mark(s, lines);
    lines_write(s, lines);
}

static void draw(struct drawing *s, struct backdrop_lines *lines, unsigned parts)
{
    if (parts & BACKDROP_AXES) backdrop_labels(s);
    if (parts & BACKDROP_LEGEND) backdrop_legend(s);
    if (parts & BACKDROP_CAPTION) backdrop_caption(s);
    if (parts & BACKDROP_MAP) {
        plane(s);
        lines_fill(s, lines);
    }
    if (parts & BACKDROP_AXES) {
        mark_begin(s->list, BACKDROP_GRATICULE, GRATICULE, 1);
        backdrop_graticule(s);
    }
    s->labels->in_strip = false; /* the legend's are all there */
    if (parts & BACKDROP_MAP) lines_and_places(s, lines);
    if (parts & BACKDROP_AXES) {
        mark_begin(s->list, BACKDROP_EDGES, FRAME, 1);
        backdrop_edges(s);
    }
    const int n_heights = lines && parts & BACKDROP_RAISED ? lines->n_heights : 0;
    for (int i = 0; i < n_heights; i++) {
        drawing_raise(s, i + 1, lines->height[i]);
        s->list->boxed = true;
        lines_and_places(s, lines);
    }
}

void backdrop_draw(const struct backdrop *b, struct backdrop_lines *lines, unsigned parts,
    struct backdrop_list *list)
{
    struct labels labels = {.series = 0};
    struct outline scratch[2] = {{.n = 0}};
    struct drawing s;
    drawing_init(&s, b);
    mark_cut(list, 0);
    list->em = s.em;
    list->boxed = false;
    s.list = list;
    s.labels = &labels;
    s.scratch = scratch;
    s.plane = lines ? lines_plane(lines) : NULL;
    s.clipped = parts & BACKDROP_CLIPPED;
    drawing_raise(&s, 0, s.lo[2]);
    draw(&s, lines, parts);
    buf_free(&labels.boxes);
    outline_free(&scratch[0]);
    outline_free(&scratch[1]);
}
