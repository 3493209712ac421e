/*
 * cut: cuts a grid file into bricks, row by row, so that the grid may be larger than memory.
 *
 * A brick has the nodes of its own cells, and of one layer of cells around them. The layer tells a
 * ray on which side of an iso-surface it comes from the neighbour, and which brick has a ray within
 * a face: the upper one. Axes keep the direction that they have in the file.
 */
#include "grid/vtk_text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

struct grid_file {
    struct vtk_reader r;
    struct vtk_type type;
    struct grid g;
    void *map;
    size_t bytes;
};

/* Nodes of the file, from first to last, in the order of the file. */
struct brick {
    struct grid g; /* without values; its axes are as in the file */
    uint32_t first[3], last[3];
    struct outfile out;
    bool open;
};

struct grid_file *grid_file_open(const char *path, char err[ERR_BYTES])
{
    struct stat st;
    int fd = read_open(&path);
    struct grid_file *f = xcalloc(1, sizeof *f);
    f->map = MAP_FAILED;
    err[0] = '\0';
    if (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode))
        err_set(err, "%s: is a pipe or a device, expected a file", path);
    else if (st.st_size == 0) err_set(err, "%s: is empty, expected a grid", path);
    else {
        f->bytes = (size_t)st.st_size;
        f->map = mmap(NULL, f->bytes, PROT_READ, MAP_PRIVATE, fd, 0);
        if (f->map == MAP_FAILED) err_set(err, "%s: %s", path, strerror(errno));
    }
    close(fd);
    if (f->map != MAP_FAILED) {
        unsigned char *bytes = f->map;
        f->r = (struct vtk_reader){.bytes = bytes,
            .at = bytes,
            .end = bytes + f->bytes,
            .name = path,
            .err = err,
            .kept = bytes};
        if (vtk_head(&f->r, &f->g, &f->type)) return f;
    }
    grid_file_close(f);
    return NULL;
}

const struct grid *grid_file_grid(const struct grid_file *f) { return &f->g; }

/* Passes over the values of g. vtk_head has checked that a binary file has all of them. */
static bool pass_values(struct vtk_reader *r, struct vtk_type t, const struct grid *g)
{
    float *row = xmalloc(g->n[0], sizeof *row);
    bool good = true;
    if (r->binary) r->at += grid_node(g, 0, 0, g->n[2]) * t.size;
    for (uint64_t i = (uint64_t)g->n[1] * g->n[2]; !r->binary && good && i; i--)
        good = vtk_row(r, t, g->n[0], false, row);
    free(row);
    vtk_skip_metadata(r);
    return good;
}

bool grid_file_further(struct grid_file *f, char err[ERR_BYTES])
{
    struct vtk_reader r = f->r;
    struct vtk_type t = f->type;
    struct grid h = {0};
    r.err = err;
    bool good = pass_values(&r, t, &f->g);
    while (good && vtk_next_is(&r, "#")) {
        grid_free(&h);
        r.has[0] = r.has[1] = false;
        good = vtk_head(&r, &h, &t);
        if (good) vtk_name_further(&f->g, &h);
        good = good && pass_values(&r, t, &h);
    }
    grid_free(&h);
    return good && vtk_tail(&r);
}

void grid_file_close(struct grid_file *f)
{
    if (f->map != MAP_FAILED) munmap(f->map, f->bytes);
    grid_free(&f->g);
    free(f);
}

/* Sets the nodes and the axis of a brick: part i of n. */
static void place(const struct grid_file *f, int a, uint32_t i, uint32_t n, struct brick *b)
{
    const bool down = f->r.down[a];
    const uint32_t nodes = f->g.n[a], cells = nodes - 1;
    const uint32_t from = (uint32_t)((uint64_t)cells * i / n);
    const uint32_t to = (uint32_t)((uint64_t)cells * (i + 1) / n);
    b->first[a] = from ? from - 1 : 0;
    b->last[a] = to < cells ? to + 1 : cells;
    b->g.n[a] = b->last[a] - b->first[a] + 1;
    b->g.at[a] = xmalloc(b->g.n[a], sizeof *b->g.at[a]);
    for (uint32_t k = b->first[a]; k <= b->last[a]; k++)
        b->g.at[a][k - b->first[a]] = f->g.at[a][down ? cells - k : k];
    b->g.brick.own[a][down] = from - b->first[a];
    b->g.brick.own[a][!down] = to - b->first[a];
    b->g.brick.whole[a][0] = f->g.at[a][0];
    b->g.brick.whole[a][1] = f->g.at[a][cells];
}

/* Writes the part of a row that is in the brick. Returns 0, or -1 with errno. */
static int put_row(struct brick *b, const float *row, uint32_t j, uint32_t k, struct buf *text)
{
    if (j < b->first[1] || j > b->last[1] || k < b->first[2] || k > b->last[2]) return 0;
    grid_write_values(row + b->first[0], b->g.n[0], text);
    if (j == b->last[1] && k == b->last[2]) buf_append(text, "\n", 1);
    size_t n = buf_size(text);
    bool written = fwrite(buf_data(text), 1, n, b->out.f) == n;
    buf_consume(text, n);
    return written ? 0 : -1;
}

static int fail(char err[ERR_BYTES], const char *path)
{
    err_set(err, "%s: %s", path, strerror(errno));
    return ST_SYSTEM;
}

static int copy_rows(
    struct grid_file *f, struct brick *b, uint32_t n, char *const *path, float *row)
{
    int status = ST_OK;
    struct buf text = {0};
    for (uint32_t k = 0; k < f->g.n[2]; k++)
        for (uint32_t j = 0; j < f->g.n[1] && status == ST_OK; j++) {
            if (!vtk_row(&f->r, f->type, f->g.n[0], false, row)) status = ST_USAGE;
            for (uint32_t i = 0; i < n && status == ST_OK; i++)
                if (put_row(&b[i], row, j, k, &text) != 0) status = fail(f->r.err, path[i]);
        }
    if (status == ST_OK && !vtk_tail(&f->r)) status = ST_USAGE;
    for (uint32_t i = 0; i < n && status == ST_OK; i++)
        if (fflush(b[i].out.f) != 0) status = fail(f->r.err, path[i]);
    buf_free(&text);
    return status;
}

static int open_brick(struct grid_file *f, struct brick *b, const char *path)
{
    struct buf head = {0};
    if (outfile_open(&b->out, path) != 0) return fail(f->r.err, path);
    b->open = true;
    snprintf(b->g.name, sizeof b->g.name, "%s", f->g.name);
    grid_write_head(&b->g, f->g.title, &head);
    size_t n = buf_size(&head);
    int status = fwrite(buf_data(&head), 1, n, b->out.f) == n ? ST_OK : fail(f->r.err, path);
    buf_free(&head);
    return status;
}

int grid_file_cut(
    struct grid_file *f, const uint32_t parts[3], char *const *path, char err[ERR_BYTES])
{
    const uint32_t n = parts[0] * parts[1] * parts[2];
    struct brick *all = xcalloc(n, sizeof *all);
    float *row = xmalloc(f->g.n[0], sizeof *row);
    int status = ST_OK;
    f->r.err = err;
    for (uint32_t i = 0; i < n && status == ST_OK; i++) {
        const uint32_t part[3] = {i % parts[0], i / parts[0] % parts[1], i / parts[0] / parts[1]};
        all[i].g.brick.is = true;
        for (int a = 0; a < 3; a++) place(f, a, part[a], parts[a], &all[i]);
        status = open_brick(f, &all[i], path[i]);
    }
    if (status == ST_OK) status = copy_rows(f, all, n, path, row);
    for (uint32_t i = 0; i < n; i++) {
        if (all[i].open && status != ST_OK) outfile_discard(&all[i].out);
        else if (all[i].open && outfile_commit(&all[i].out) != 0) status = fail(err, path[i]);
        grid_free(&all[i].g);
    }
    free(row);
    free(all);
    return status;
}
