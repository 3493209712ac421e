/* pack: wraps files as state records. */
#include "base/base.h"
#include "files/files.h"
#include "job/job.h"

#include <string.h>
#include <unistd.h>

#define REASON_MOST 40

static const char usage_text[] = "[-h] scene|grid|spec|view|files FILE ...\n"
                                 "       pack bye REASON";

static enum rec_kind kind_named(const char *s)
{
    static const enum rec_kind kinds[] = {REC_SCENE, REC_GRID, REC_SPEC, REC_VIEW, REC_FILES};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(s, rec_name(kinds[i])) == 0) return kinds[i];
    die(ST_USAGE, "%s: expected scene, grid, spec, view or files", s);
}

/* One record of all files. */
static void pack_files(char *const paths[], size_t n)
{
    struct buf body = {0};
    char err[ERR_BYTES];
    if (!files_pack(paths, n, &body, err)) die(ST_USAGE, "%s", err);
    job_put(REC_FILES, "files", &body);
}

/* The last record of a stream that ends early. */
static void put_bye(const char *why)
{
    struct buf b = {0};
    if (!*why || strlen(why) > REASON_MOST || why[strspn(why, "abcdefghijklmnopqrstuvwxyz-")])
        die(ST_USAGE, "bye %s: expected letters and -, at most %d", why, REASON_MOST);
    wire_bye(&b, why);
    put_stdout_buf(&b);
    buf_free(&b);
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    int opt;
    while ((opt = prog_getopt(argc, argv, "+h")) != -1)
        usage(opt == 'h' ? ST_OK : ST_USAGE, usage_text);
    if (argc - optind < 2) usage(ST_USAGE, usage_text);
    if (strcmp(argv[optind], "bye") == 0) {
        if (argc - optind > 2) usage(ST_USAGE, usage_text);
        put_bye(argv[optind + 1]);
        close_stdout();
        return ST_OK;
    }
    enum rec_kind kind = kind_named(argv[optind]);
    if (kind == REC_FILES) pack_files(argv + optind + 1, (size_t)(argc - optind - 1));
    else
        for (int i = optind + 1; i < argc; i++) job_put_file(kind, argv[i]);
    close_stdout();
    return ST_OK;
}
