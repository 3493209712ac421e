/*
 * imgcmp: compares two pictures.
 *
 * The exemplar of this project's programs: options go into one struct; main parses, opens, runs and
 * closes; functions called by main do not see argv.
 */
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#include "base/base.h"
#include "image/image.h"

struct options {
    double tolerance;  /* -t: permitted difference of a component, in [0,1] */
    double fraction;   /* -f: fraction of the pixels that may differ by more */
    double rmse_limit; /* -r: limit of rmse_kept */
    double drop;       /* -d: fraction of pixels excluded from rmse_kept */
    bool limit_over;   /* -t or -f was given */
    bool limit_rmse;   /* -r was given */
    bool quiet;        /* -q: print nothing */
    const char *path[2];
};

static const char usage_text[] = "[-hq] [-d DROP] [-f FRACTION] [-r RMSE] [-t TOLERANCE] A B";

static struct options parse(int argc, char **argv)
{
    struct options o = {.tolerance = 1.0 / 255, .drop = 0.001};
    for (int c; (c = prog_getopt(argc, argv, "d:f:hqr:t:")) != -1;) switch (c) {
        case 'd': o.drop = opt_real(c, optarg, 0, 1); break;
        case 'f': o.fraction = opt_real(c, optarg, 0, 1), o.limit_over = true; break;
        case 'h': usage(ST_OK, usage_text);
        case 'q': o.quiet = true; break;
        case 'r': o.rmse_limit = opt_real(c, optarg, 0, 1), o.limit_rmse = true; break;
        case 't': o.tolerance = opt_real(c, optarg, 0, 1), o.limit_over = true; break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != 2) usage(ST_USAGE, usage_text);
    o.path[0] = argv[optind];
    o.path[1] = argv[optind + 1];
    if (strcmp(o.path[0], "-") == 0 && strcmp(o.path[1], "-") == 0)
        die(ST_USAGE, "both pictures from standard input, expected one at most");
    return o;
}

static void open_picture(const char *path, struct image *im)
{
    char err[IMAGE_ERR];
    if (image_read(path, im, err) != 0) die(ST_USAGE, "%s: %s", path, err);
}

static void print(const struct options *o, const struct image *a, const struct image_diff *d)
{
    printf("size\t%" PRIu32 "x%" PRIu32 "\n", a->w, a->h);
    printf("rmse\t%.9g\n", d->rmse);
    printf("rmse_kept\t%.9g\n", d->rmse_kept);
    printf("dropped\t%" PRIu64 "\n", d->dropped);
    printf("psnr_db\t%.4f\n", d->psnr_db);
    printf("worst\t%.9g\n", d->worst);
    printf("worst_at\t%" PRIu32 ",%" PRIu32 "\n", d->worst_x, d->worst_y);
    printf("tolerance\t%.9g\n", o->tolerance);
    printf("over\t%" PRIu64 "\n", d->over);
    printf("over_percent\t%.6f\n", 100 * (double)d->over / (double)d->pixels);
    printf("differing\t%" PRIu64 "\n", d->differing);
}

static bool within(const struct options *o, const struct image_diff *d)
{
    if (!o->limit_over && !o->limit_rmse) return d->differing == 0;
    if (o->limit_over && d->over > image_share(o->fraction, d->pixels)) return false;
    return !o->limit_rmse || d->rmse_kept <= o->rmse_limit;
}

static int run(const struct options *o, const struct image *a, const struct image *b)
{
    if (a->w != b->w || a->h != b->h) {
        if (!o->quiet)
            warn("%s has %" PRIu32 "x%" PRIu32 " pixels, %s %" PRIu32 "x%" PRIu32
                 ": expected the same size",
                o->path[0], a->w, a->h, o->path[1], b->w, b->h);
        return ST_PARTIAL;
    }
    struct image_diff d;
    image_compare(a, b, o->tolerance, o->drop, &d);
    if (!o->quiet) print(o, a, &d);
    return within(o, &d) ? ST_OK : ST_PARTIAL;
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct image a, b;
    open_picture(o.path[0], &a);
    open_picture(o.path[1], &b);
    int status = run(&o, &a, &b);
    image_free(&a);
    image_free(&b);
    close_stdout();
    return status;
}
