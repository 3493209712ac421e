/*
 * blend: composites pictures over one another, in linear light.
 *
 * Pixels are premultiplied, so "over" is a + (1 - alpha) b (T. Porter, T. Duff, "Compositing
 * digital images", SIGGRAPH 1984).
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/base.h"
#include "image/image.h"

struct options {
    const char *out; /* -o; NULL: PNG on standard output */
    enum image_format format;
    int bits;       /* -k */
    double *ground; /* -b: linear red, green and blue behind all pictures; NULL: none */
    char **path;    /* topmost first */
    int n;
};

static const char usage_text[] =
    "[-h] [-b R,G,B] [-k 8|16] [-o OUT.png|.pam|.pfm] PICTURE ... [BACKDROP]";

static double *take_ground(const char *s)
{
    size_t n;
    double *ground = opt_reals('b', s, 0, 1e6, &n);
    if (n != 3) die(ST_USAGE, "-b %s: expected red, green and blue, such as 0,0,.2", s);
    return ground;
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.bits = 8, .format = IMAGE_PNG};
    for (int c; (c = prog_getopt(argc, argv, "b:hk:o:")) != -1;) switch (c) {
        case 'b': o.ground = take_ground(optarg); break;
        case 'h': usage(ST_OK, usage_text);
        case 'k': o.bits = image_opt_bits(c, optarg); break;
        case 'o': o.out = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    o.path = argv + optind;
    o.n = argc - optind;
    if (o.n < 1) usage(ST_USAGE, usage_text);
    if (o.out && !image_format_of(o.out, &o.format))
        die(ST_USAGE, "-o %s: expected a name that ends in .png, .pam or .pfm", o.out);
    int piped = 0;
    for (int i = 0; i < o.n; i++) input_add(o.path[i], "an input");
    if (o.out) input_keep(o.out);
    for (int i = 0; i < o.n; i++) piped += strcmp(o.path[i], "-") == 0;
    if (piped > 1) die(ST_USAGE, "two pictures from standard input, expected one at most");
    return o;
}

static void open_picture(const char *path, struct image *im)
{
    char err[IMAGE_ERR];
    if (image_read(path, im, err) != 0) die(ST_USAGE, "%s: %s", path, err);
}

static void put_ground(struct image *a, const double rgb[3])
{
    for (size_t p = 0; p < (size_t)a->w * a->h; p++) {
        float *top = a->rgba + 4 * p;
        for (int c = 0; c < 3; c++) top[c] += (1 - top[3]) * (float)rgb[c];
        top[3] = 1;
    }
}

static void write_picture(const struct options *o, const struct image *im)
{
    int failed = o->out ? image_save(o->out, im, o->format, o->bits, NULL)
                        : image_write(stdout, im, o->format, o->bits, NULL);
    if (failed) die(ST_SYSTEM, "%s:", o->out ? o->out : "standard output");
}

int main(int argc, char **argv)
{
    prog_init(argv[0]);
    struct options o = parse(argc, argv);
    struct image over, all;
    struct image_backs backs = {.n = 0};
    open_picture(o.path[0], &over);
    for (int i = 1; i < o.n; i++) {
        image_backs_add(&backs, o.path[i], false);
        image_backs_blend(&backs, &over); /* so that pictures of one size need little memory */
    }
    const struct image_rows one = image_rows_of(&over);
    const struct image_rows rows = image_backs_under(&backs, 0, &one);
    image_init(&all, rows.w, rows.h);
    for (uint32_t y = 0; y < all.h; y++)
        memcpy(all.rgba + 4 * (size_t)all.w * y, rows.row(&rows, y), 4 * sizeof(float) * all.w);
    image_backs_free(&backs);
    image_free(&over);
    if (o.ground) put_ground(&all, o.ground);
    free(o.ground);
    write_picture(&o, &all);
    image_free(&all);
    close_stdout();
    return ST_OK;
}
