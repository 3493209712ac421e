/* pack: wraps files as state records. */
#include "base/base.h"
#include "wire/wire.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-h] scene|grid|spec FILE ...";

static enum rec_kind kind_named(const char *s)
{
    static const enum rec_kind kinds[] = {REC_SCENE, REC_GRID, REC_SPEC};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(s, rec_name(kinds[i])) == 0) return kinds[i];
    die(ST_USAGE, "%s: expected scene, grid or spec", s);
}

static void pack(enum rec_kind kind, const char *path)
{
    struct buf body = {0}, record = {0};
    if (read_file(path, &body) != 0) die(ST_USAGE, "%s:", path);
    if (buf_size(&body) > (size_t)WIRE_STATE_MAX)
        die(ST_USAGE, "%s: %zu bytes, expected at most %lld", path, buf_size(&body),
            (long long)WIRE_STATE_MAX);
    wire_state(&record, kind, buf_data(&body), buf_size(&body));
    put_stdout(buf_data(&record), buf_size(&record));
    buf_free(&body);
    buf_free(&record);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    int opt;
    while ((opt = prog_getopt(argc, argv, "+h")) != -1)
        usage(opt == 'h' ? ST_OK : ST_USAGE, usage_text);
    if (argc - optind < 2) usage(ST_USAGE, usage_text);
    enum rec_kind kind = kind_named(argv[optind]);
    for (int i = optind + 1; i < argc; i++) pack(kind, argv[i]);
    close_stdout();
    return ST_OK;
}
