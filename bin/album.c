/* album: writes pictures as one page of HTML, with sliders over times and views. */
#include "album/album.h"

#include <unistd.h>

struct options {
    const char *title; /* -t */
    const char *views; /* -v; NULL: by name */
};

static const char usage_text[] = "[-h] [-t TITLE] [-v VIEWS] PICTURE.png ...";

static struct options parse(int argc, char **argv)
{
    struct options o = {.title = "Album"};
    for (int c; (c = prog_getopt(argc, argv, "ht:v:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 't': o.title = opt_text(c, optarg); break;
        case 'v': o.views = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc == optind) usage(ST_USAGE, usage_text);
    return o;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct album album;
    struct buf page = {0};
    char err[ERR_BYTES];
    size_t n = (size_t)(argc - optind);
    bool good = o.views ? album_in_turn(&album, argv + optind, n, o.views, err)
                        : album_by_name(&album, argv + optind, n, err);
    if (!good || !album_load(&album, err)) die(ST_USAGE, "%s", err);
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
    close_stdout();
    return ST_OK;
}
