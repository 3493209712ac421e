/* vtk_write: writes a grid as a VTK legacy file: RECTILINEAR_GRID, BINARY. */
#include "grid/vtk_text.h"

#include <string.h>

static void put_title(struct buf *b, const char *title)
{
    for (size_t i = 0; i < GRID_TITLE - 1 && title[i]; i++) {
        char c = title[i] == '\n' || title[i] == '\r' ? ' ' : title[i];
        buf_append(b, &c, 1);
    }
}

/* Writes a name as one word. Bytes that would end or break it become %XX, as in VTK. */
static void put_name(struct buf *b, const char *name)
{
    for (; *name; name++) {
        unsigned char c = (unsigned char)*name;
        if (c <= ' ' || c > '~' || c == '"' || c == '%') buf_printf(b, "%%%02X", c);
        else buf_append(b, &c, 1);
    }
}

static void put_doubles(struct buf *b, const double *at, uint32_t n)
{
    unsigned char *to = buf_reserve(b, n * sizeof(double));
    for (uint32_t i = 0; i < n; i++) {
        uint64_t bits;
        memcpy(&bits, &at[i], sizeof bits);
        put_big_endian(to + i * sizeof bits, bits, sizeof bits);
    }
    b->len += n * sizeof(double);
    buf_append(b, "\n", 1);
}

/* The arrays of a brick. VTK keeps them as data of the whole file. */
static void put_brick(struct buf *b, const struct grid *g)
{
    double bounds[2][6];
    for (int a = 0; a < 3; a++)
        for (int end = 0; end < 2; end++) {
            bounds[0][2 * a + end] = g->brick.whole[a][end];
            bounds[1][2 * a + end] = g->at[a][g->brick.own[a][end]];
        }
    buf_printf(b, "FIELD FieldData 2\n");
    for (int i = 0; i < 2; i++) {
        buf_printf(b, "%s 6 1 double\n", vtk_brick_names[i]);
        put_doubles(b, bounds[i], 6);
    }
}

void grid_write_head(const struct grid *g, const char *title, struct buf *b)
{
    buf_printf(b, "# vtk DataFile Version 3.0\n");
    put_title(b, title);
    buf_printf(b, "\nBINARY\nDATASET RECTILINEAR_GRID\n");
    if (g->brick.is) put_brick(b, g);
    buf_printf(b, "DIMENSIONS %u %u %u\n", g->n[0], g->n[1], g->n[2]);
    for (int a = 0; a < 3; a++) {
        buf_printf(b, "%c_COORDINATES %u double\n", "XYZ"[a], g -> n[a]);
        put_doubles(b, g->at[a], g->n[a]);
    }
    buf_printf(b, "POINT_DATA %zu\nSCALARS ", grid_node(g, 0, 0, g->n[2]));
    put_name(b, *g->name ? g->name : "scalars");
    buf_printf(b, " float 1\nLOOKUP_TABLE default\n");
}

void grid_write_values(const float *value, size_t n, struct buf *b)
{
    unsigned char *to = buf_reserve(b, n * sizeof(float));
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &value[i], sizeof bits);
        put_big_endian(to + i * sizeof bits, bits, sizeof bits);
    }
    b->len += n * sizeof(float);
}

void grid_write(const struct grid *g, const char *title, struct buf *b)
{
    grid_write_head(g, title, b);
    grid_write_values(g->value, grid_node(g, 0, 0, g->n[2]), b);
    buf_append(b, "\n", 1);
}
