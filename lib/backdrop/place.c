/* place: named places on the map: a disc each, and the name beside it. */
#include "backdrop/lines.h"

#define ACROSS .42 /* em: a disc */

/* Right of the disc, left, above, or below. */
static void name(const struct drawing *s, const char *text, struct backdrop_at at)
{
    const double beside = .5 * s->em, line = .85 * s->em;
    const double xy[][2] = {
        {at.x + beside, at.y}, {at.x - beside, at.y}, {at.x, at.y + line}, {at.x, at.y - line}};
    static const int align[] = {-1, 1, 0, 0};
    for (int i = 0; i < 4; i++)
        if (backdrop_label(s, text, xy[i], align[i]) == LABEL_PLACED) return;
}

void lines_mark(const struct drawing *s, struct backdrop_lines *l)
{
    const struct lines_part *end = l->part + l->n;
    bool begun = false;
    size_t at = s->list->n_at, texts = 0;
    for (struct lines_part *p = l->part; p < end; p++) {
        p->n_at = 0;
        if (p->kind != LINES_MARK || p->level != s->level) continue;
        if (!begun) mark_begin(s->list, BACKDROP_DOTS, DOT, ACROSS * s->em);
        begun = true;
        const size_t before = s->list->n_at;
        outline_dot(s, &p->o);
        p->n_at = s->list->n_at - before;
    }
    for (const struct lines_part *p = l->part; begun && p < end; p++)
        for (size_t i = 0; p->kind == LINES_MARK && i < p->n_at; i++, at++)
            if (texts++ < LINES_TEXTS) name(s, lines_text(l, p), s->list->at[at]);
}
