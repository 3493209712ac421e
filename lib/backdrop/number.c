/*
 * number: lines with a text, such as isobars. The text is written along the line in a gap, where
 * the line is straight, nearly level, and no other text is in the way.
 */
#include "backdrop/lines.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH 1.0
#define PAD .5       /* em: of the gap beside the text */
#define SHORT 2.5    /* gaps: shorter pieces have no text */
#define EVERY 60.0   /* em: a long piece has a text in each such part */
#define TEXTS 8      /* at most as many in a piece */
#define TRIES 24     /* places in such a part */
#define STRAIGHT .92 /* least distance between the ends of a gap, in its length */
#define LEVEL 2.0    /* degrees: less is not turned, because turned text is blurred */
#define STEEP .15    /* what an upright text counts, in the same unit */

/* A piece of a line in pixels. */
struct path {
    const struct backdrop_at *at;
    double *along; /* from the first point to each one */
    size_t n;
};
struct gap {
    double from, to; /* along the path */
};
/* A text that has its place; labels follow all lines in the list. */
struct written {
    const char *text;
    double xy[2], turn;
};
struct writer {
    const struct drawing *s;
    struct written *done; /* LINES_TEXTS of them */
    size_t n_done;
};

static struct backdrop_at point_at(const struct path *p, double along)
{
    size_t low = 0, high = p->n - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (p->along[middle] <= along) low = middle;
        else high = middle;
    }
    const double length = p->along[high] - p->along[low];
    const double f = length > 0 ? (along - p->along[low]) / length : 0;
    const struct backdrop_at a = p->at[low], b = p->at[high];
    return (struct backdrop_at){a.x + f * (b.x - a.x), a.y + f * (b.y - a.y)};
}

/* How good a gap is; negative: it is not straight enough. */
static double worth(const struct path *p, struct gap g)
{
    const struct backdrop_at a = point_at(p, g.from), b = point_at(p, g.to);
    const double chord = hypot(b.x - a.x, b.y - a.y), part = chord / (g.to - g.from);
    return part < STRAIGHT ? -1 : part - STEEP * fabs(b.y - a.y) / chord;
}

/* Writes the text in the gap. False if something is in the way, or the picture ends. */
static bool write_in(struct writer *w, const struct path *p, struct gap g, const char *text)
{
    const struct backdrop_at a = point_at(p, g.from), b = point_at(p, g.to);
    double turn = atan2(b.y - a.y, b.x - a.x);
    if (turn > M_PI / 2) turn -= M_PI;
    if (turn <= -M_PI / 2) turn += M_PI;
    if (fabs(turn) < LEVEL * M_PI / 180) turn = 0;
    const double wide = backdrop_text_width(w->s, text), high = BACKDROP_TEXT_HIGH * w->s->em;
    const double c = fabs(cos(turn)), s = fabs(sin(turn));
    const double x = (a.x + b.x) / 2, y = (a.y + b.y) / 2;
    const double dx = (wide * c + high * s) / 2, dy = (wide * s + high * c) / 2;
    const struct label_box box = {x - dx, x + dx, y - dy, y + dy};
    if (drawing_reserve(w->s, &box) != LABEL_PLACED) return false;
    w->done[w->n_done++] = (struct written){text, {x, y}, turn * 180 / M_PI};
    return true;
}

/* Finds a gap of this length for the text in a part of the path, the best one that is free. */
static bool find_gap(struct writer *w, const struct path *p, struct gap part, double length,
    const char *text, struct gap *found)
{
    double value[TRIES], step = (part.to - part.from - length) / (TRIES - 1);
    for (int i = 0; i < TRIES; i++)
        value[i] = worth(p, (struct gap){part.from + i * step, part.from + i * step + length});
    for (int best; w->n_done < LINES_TEXTS;) {
        best = 0;
        for (int i = 1; i < TRIES; i++)
            if (value[i] > value[best]) best = i;
        if (!(value[best] >= 0)) return false;
        *found = (struct gap){part.from + best * step, part.from + best * step + length};
        if (write_in(w, p, *found, text)) return true;
        value[best] = -1;
    }
    return false;
}

static void put(const struct writer *w, const struct path *p, const struct gap *gap, size_t n)
{
    struct backdrop_list *l = w->s->list;
    size_t i = 0;
    for (const struct gap *end = gap + n; gap < end; gap++) {
        for (; p->along[i] < gap->from; i++) mark_point(l, p->at[i].x, p->at[i].y);
        const struct backdrop_at a = point_at(p, gap->from), b = point_at(p, gap->to);
        mark_point(l, a.x, a.y);
        mark_break(l);
        mark_point(l, b.x, b.y);
        while (i < p->n && p->along[i] <= gap->to) i++;
    }
    for (; i < p->n; i++) mark_point(l, p->at[i].x, p->at[i].y);
    mark_break(l);
}

static void piece(struct writer *w, const struct path *p, const char *text)
{
    const double em = w->s->em, length = backdrop_text_width(w->s, text) + 2 * PAD * em;
    const double all = p->along[p->n - 1];
    struct gap gap[TEXTS];
    size_t n = 0;
    if (*text && all > SHORT * length) {
        const double each = fmax(EVERY * em, SHORT * length);
        const int parts = (int)fmax(1, fmin(TEXTS, all / each));
        const double part = all / parts;
        for (int i = 0; i < parts; i++)
            if (find_gap(w, p, (struct gap){i * part, (i + 1) * part}, length, text, &gap[n])) n++;
    }
    put(w, p, gap, n);
}

/* Puts the points, which the list had, again, in pieces. */
static void pieces(struct writer *w, const struct backdrop_at *at, size_t n, const char *text)
{
    struct path p = {.along = xmalloc(n, sizeof *p.along)};
    for (size_t i = 0; i < n; i += p.n + 1) {
        p.at = at + i;
        p.along[0] = 0;
        for (p.n = 0; i + p.n < n && !isnan(p.at[p.n].x); p.n++)
            if (p.n)
                p.along[p.n] = p.along[p.n - 1] +
                               hypot(p.at[p.n].x - p.at[p.n - 1].x, p.at[p.n].y - p.at[p.n - 1].y);
        if (p.n > 1) piece(w, &p, text);
    }
    free(p.along);
}

static void write_part(struct writer *w, const struct lines_part *part, const char *text)
{
    struct backdrop_list *l = w->s->list;
    const size_t first = l->n_at;
    outline_stroke(w->s, &part->o);
    const size_t n = l->n_at - first;
    if (!n || !*text) return;
    struct backdrop_at *at = xmalloc(n, sizeof *at);
    memcpy(at, l->at + first, n * sizeof *at);
    mark_shorten(l, first);
    pieces(w, at, n, text);
    free(at);
}

/* Large lines first: their texts have the first choice of a place. */
static int by_size(const void *a, const void *b)
{
    const struct lines_part *const *p = a, *const *q = b;
    const double x = fmax((*p)->o.hi.x - (*p)->o.lo.x, (*p)->o.hi.y - (*p)->o.lo.y);
    const double y = fmax((*q)->o.hi.x - (*q)->o.lo.x, (*q)->o.hi.y - (*q)->o.lo.y);
    if (x != y) return x < y ? 1 : -1;
    return *p < *q ? -1 : 1;
}

void lines_write(const struct drawing *s, const struct backdrop_lines *l)
{
    const struct lines_part **part = xcalloc(l->n + 1, sizeof *part);
    struct writer w = {.s = s, .done = xcalloc(LINES_TEXTS, sizeof *w.done)};
    size_t n = 0;
    for (size_t i = 0; i < l->n; i++)
        if (l->part[i].kind == LINES_TEXT && l->part[i].level == s->level) part[n++] = &l->part[i];
    qsort(part, n, sizeof(void *), by_size);
    if (n) mark_begin(s->list, BACKDROP_NUMBERED, NUMBERED, WIDTH);
    for (size_t i = 0; i < n; i++) write_part(&w, part[i], lines_text(l, part[i]));
    for (size_t i = 0; i < w.n_done; i++)
        mark_label(s->list, w.done[i].text, w.done[i].xy, 0, w.done[i].turn);
    free(w.done);
    free(part);
}
