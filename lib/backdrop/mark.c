/* mark: the list of what is drawn, in the order of the script. */
#include "backdrop/drawing.h"

#include <stdlib.h>
#include <string.h>

static void begin(struct backdrop_list *l, enum backdrop_kind kind, uint32_t rgb, double width)
{
    l->mark = xgrown(l->mark, l->n_marks, sizeof *l->mark);
    l->mark[l->n_marks++] = (struct backdrop_mark){
        .kind = kind, .rgb = rgb, .width = width, .first = l->n_at, .text = buf_size(&l->text)};
}

void mark_begin(struct backdrop_list *l, enum backdrop_kind kind, uint32_t rgb, double width)
{
    const struct backdrop_mark *last = l->mark + l->n_marks - 1;
    if (!l->n_marks || last->kind != kind || last->rgb != rgb) begin(l, kind, rgb, width);
}

void mark_point(struct backdrop_list *l, double x, double y)
{
    l->at = xgrown(l->at, l->n_at, sizeof *l->at);
    l->at[l->n_at++] = (struct backdrop_at){x, y};
    l->mark[l->n_marks - 1].n++;
}

void mark_break(struct backdrop_list *l) { mark_point(l, (double)NAN, (double)NAN); }

void mark_rectangle(struct backdrop_list *l, enum backdrop_kind kind, uint32_t rgb,
    const double from[2], const double to[2])
{
    begin(l, kind, rgb, 1);
    mark_point(l, from[0], from[1]);
    mark_point(l, to[0], to[1]);
}

void mark_label(
    struct backdrop_list *l, const char *text, const double xy[2], int align, double turn)
{
    begin(l, BACKDROP_LABEL, 0, 0);
    l->mark[l->n_marks - 1].align = align;
    l->mark[l->n_marks - 1].turn = turn;
    l->mark[l->n_marks - 1].boxed = l->boxed;
    buf_append(&l->text, text, strlen(text) + 1);
    mark_point(l, xy[0], xy[1]);
}

void mark_shorten(struct backdrop_list *l, size_t n_at)
{
    l->mark[l->n_marks - 1].n -= l->n_at - n_at;
    l->n_at = n_at;
}

void mark_cut(struct backdrop_list *l, size_t n_marks)
{
    if (n_marks >= l->n_marks) return;
    l->n_at = l->mark[n_marks].first;
    l->text.len = l->mark[n_marks].text;
    l->n_marks = n_marks;
}

void backdrop_list_free(struct backdrop_list *l)
{
    free(l->mark);
    free(l->at);
    buf_free(&l->text);
    *l = (struct backdrop_list){.em = 0};
}
