/* table: the contents of a file as a table with aligned columns. */
#include "convert/convert.h"

#include <string.h>

static const char *const head[CONVERT_COLUMNS] = {
    "name", "shape", "units", "range", "times", "description"};

/* Appends the cells, each with its NUL. Tabs and the like would break a column. */
void convert_table_row(struct convert_table *t, const char *const cell[CONVERT_COLUMNS])
{
    for (int i = 0; i < CONVERT_COLUMNS; i++) {
        const char *text = cell[i] && cell[i][0] ? cell[i] : "-";
        size_t n = strlen(text);
        if (n > t->width[i]) t->width[i] = n;
        buf_append(&t->cells, text, n + 1);
    }
}

void convert_table_refused(struct convert_table *t, const char *name, const char *why)
{
    buf_printf(&t->refused, "# %s\t%s\n", name, why);
}

static void put_row(const struct convert_table *t, const char *const cell[CONVERT_COLUMNS])
{
    for (int i = 0; i < CONVERT_COLUMNS - 1; i++) {
        size_t least = strlen(head[i]), width = t->width[i] > least ? t->width[i] : least;
        printf("%-*s  ", (int)width, cell[i]);
    }
    printf("%s\n", cell[CONVERT_COLUMNS - 1]);
}

void convert_table_print(struct convert_table *t)
{
    if (buf_size(&t->cells)) put_row(t, head);
    while (buf_size(&t->cells)) {
        const char *cell[CONVERT_COLUMNS], *at = (const char *)buf_data(&t->cells), *from = at;
        for (int i = 0; i < CONVERT_COLUMNS; i++, at += strlen(at) + 1) cell[i] = at;
        put_row(t, cell);
        buf_consume(&t->cells, (size_t)(at - from));
    }
    fwrite(buf_data(&t->refused), 1, buf_size(&t->refused), stdout); /* close_stdout checks it */
    buf_free(&t->cells);
    buf_free(&t->refused);
}

void convert_range_add(struct convert_range *r, const struct grid *g)
{
    size_t nodes = grid_node(g, 0, 0, g->n[2]);
    for (size_t i = 0; i < nodes; i++) {
        double v = (double)g->value[i];
        if (isnan(v)) continue;
        if (!r->any || v < r->lo) r->lo = v;
        if (!r->any || v > r->hi) r->hi = v;
        r->any = true;
    }
}

const char *convert_range_text(const struct convert_range *r, char text[CONVERT_TEXT])
{
    snprintf(text, CONVERT_TEXT, r->any ? "%.6g to %.6g" : "all missing", r->lo, r->hi);
    return text;
}
