/* pack: wraps files as state records. */
#include "base/base.h"
#include "files/files.h"
#include "wire/wire.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-h] scene|grid|spec|files FILE ...";

static enum rec_kind kind_named(const char *s)
{
    static const enum rec_kind kinds[] = {REC_SCENE, REC_GRID, REC_SPEC, REC_FILES};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(s, rec_name(kinds[i])) == 0) return kinds[i];
    die(ST_USAGE, "%s: expected scene, grid, spec or files", s);
}

/* Writes the record, and frees the body. */
static void put(enum rec_kind kind, const char *name, struct buf *body)
{
    struct buf record = {0};
    if (buf_size(body) > (size_t)WIRE_STATE_MAX)
        die(ST_USAGE, "%s: %zu bytes, expected at most %lld", name, buf_size(body),
            (long long)WIRE_STATE_MAX);
    wire_state(&record, kind, buf_data(body), buf_size(body));
    put_stdout(buf_data(&record), buf_size(&record));
    buf_free(body);
    buf_free(&record);
}

static void pack(enum rec_kind kind, const char *path)
{
    struct buf body = {0};
    if (read_file(path, &body) != 0) die(ST_USAGE, "%s:", path);
    put(kind, path, &body);
}

/* One record of all files. */
static void pack_files(char *const paths[], size_t n)
{
    struct buf body = {0};
    char err[ERR_BYTES];
    if (!files_pack(paths, n, &body, err)) die(ST_USAGE, "%s", err);
    put(REC_FILES, "files", &body);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    int opt;
    while ((opt = prog_getopt(argc, argv, "+h")) != -1)
        usage(opt == 'h' ? ST_OK : ST_USAGE, usage_text);
    if (argc - optind < 2) usage(ST_USAGE, usage_text);
    enum rec_kind kind = kind_named(argv[optind]);
    if (kind == REC_FILES) pack_files(argv + optind + 1, (size_t)(argc - optind - 1));
    else
        for (int i = optind + 1; i < argc; i++) pack(kind, argv[i]);
    close_stdout();
    return ST_OK;
}
