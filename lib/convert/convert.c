/* From values to files. */
#include "convert/convert.h"
#include "image/image.h"

#include <stdlib.h>

static void put(const struct convert_options *o, size_t time, const struct buf *b)
{
    if (!o->out) {
        put_stdout(buf_data(b), buf_size(b));
        return;
    }
    char *path = image_name(o->out, (uint32_t)time);
    if (outfile_put(path, buf_data(b), buf_size(b)) != 0) die(ST_SYSTEM, "%s:", path);
    free(path);
}

static void convert_time(
    const struct convert_options *o, const struct converter *c, size_t time, struct grid *g)
{
    struct buf title = {0}, b = {0};
    c->values(c->ctx, time, g);
    c->describe(c->ctx, time, &title);
    buf_append(&title, "", 1);
    grid_write(g, (const char *)buf_data(&title), &b);
    put(o, time, &b);
    buf_free(&title);
    buf_free(&b);
}

void convert(const struct convert_options *o, const struct converter *c)
{
    struct grid g;
    size_t end = o->every ? c->times : o->time + 1;
    if (end > c->times || !c->times)
        die(ST_USAGE, "%s: %s: -t %zu: expected an index below %zu", o->file, c->what, o->time,
            c->times);
    c->axes(c->ctx, &g);
    snprintf(g.name, sizeof g.name, "%s", c->name);
    for (size_t time = o->every ? 0 : o->time; time < end; time++) convert_time(o, c, time, &g);
    grid_free(&g);
}
