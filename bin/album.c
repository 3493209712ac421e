/* album: writes pictures as one page of HTML, with sliders over times and views. */
#include "album/album.h"
#include "backdrop/backdrop.h"
#include "job/job.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

struct options {
    const char *title; /* -t */
    const char *views; /* -v; NULL: by name */
    char **grids, **pictures;
    size_t n_grids, n_pictures;
};

static const char usage_text[] = "[-h] [-t TITLE] [-v VIEWS] [GRID.vtk ...] PICTURE.png ...";

static bool is_grid(const char *path)
{
    unsigned char first[JOB_FIRST];
    uint64_t size;
    struct stat st;
    if (stat(path, &st) != 0 || !S_ISREG(st.st_mode)) return false; /* a pipe is read once */
    return job_is_grid(first, job_first(path, first, &size));
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.title = "Album"};
    for (int c; (c = prog_getopt(argc, argv, "ht:v:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 't': o.title = opt_text(c, optarg); break;
        case 'v': o.views = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    o.grids = xcalloc((size_t)argc, sizeof *o.grids);
    o.pictures = xcalloc((size_t)argc, sizeof *o.pictures);
    for (int i = optind; i < argc; i++)
        if (is_grid(argv[i])) o.grids[o.n_grids++] = argv[i];
        else o.pictures[o.n_pictures++] = argv[i];
    if (!o.n_pictures) usage(ST_USAGE, usage_text);
    return o;
}

static int by_name(const void *a, const void *b)
{
    return text_order(*(char *const *)a, *(char *const *)b);
}

/* The times of the grids replace those of the names. */
static bool take_times(struct album *a, const struct options *o, char err[ERR_BYTES])
{
    if (!o->n_grids) return true;
    char text[BACKDROP_TIME], **name = xcalloc(o->n_grids, sizeof *name);
    qsort(o->grids, o->n_grids, sizeof *o->grids, by_name);
    bool good = true;
    for (size_t i = 0; i < o->n_grids && good; i++) {
        struct grid_file *f = grid_file_open(o->grids[i], err);
        if (!(good = f != NULL)) break;
        backdrop_time(grid_file_grid(f)->title, text);
        name[i] = xstrdup(text);
        good = *text || err_set(err, "%s: its title has no time, expected one", o->grids[i]);
        grid_file_close(f);
    }
    good = good && album_name_times(a, name, o->n_grids, err);
    for (size_t i = 0; i < o->n_grids; i++) free(name[i]);
    free(name);
    return good;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct album album;
    struct buf page = {0};
    char err[ERR_BYTES];
    bool good = o.views ? album_in_turn(&album, o.pictures, o.n_pictures, o.views, err)
                        : album_by_name(&album, o.pictures, o.n_pictures, err);
    if (!good || !take_times(&album, &o, err) || !album_load(&album, err)) die(ST_USAGE, "%s", err);
    album_head(&album, o.title, &page);
    put_stdout_buf(&page);
    for (size_t i = 0; i < album.n_pictures; i++) {
        album_block(&album, i, &page);
        put_stdout_buf(&page);
    }
    album_foot(&page);
    put_stdout_buf(&page);
    buf_free(&page);
    album_free(&album);
    free(o.grids);
    free(o.pictures);
    close_stdout();
    return ST_OK;
}
