/* vol2vtk: converts a volume of another program to a rectilinear grid. */
#include "base/base.h"
#include "grid/grid.h"
#include "voxel/voxel.h"

#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-a] [-k INDEX|length] [-o FILE] [-u UNIT] FILE|- [ARRAY]\n"
                                 "       vol2vtk -l FILE|-\n"
                                 "       vol2vtk -h";

struct options {
    bool own, list;     /* -a, -l */
    bool chosen;        /* -k is there */
    uint64_t component; /* -k */
    const char *out;    /* -o; NULL: standard output */
    const char *unit;   /* -u; NULL: that of the file */
    const char *file, *array;
};

static uint64_t parse_component(const char *text)
{
    if (strcmp(text, "length") == 0) return VOXEL_LENGTH;
    return (uint64_t)opt_int('k', text, 0, INT32_MAX);
}

static struct options parse(int argc, char **argv)
{
    struct options o = {.own = false};
    for (int c; (c = prog_getopt(argc, argv, "ahk:lo:u:")) != -1;) switch (c) {
        case 'a': o.own = true; break;
        case 'h': usage(ST_OK, usage_text);
        case 'k': o.component = parse_component(optarg), o.chosen = true; break;
        case 'l': o.list = true; break;
        case 'o': o.out = opt_text(c, optarg); break;
        case 'u': o.unit = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    const int n = argc - optind;
    if (n < 1 || n > (o.list ? 1 : 2)) usage(ST_USAGE, usage_text);
    o.file = argv[optind];
    if (n > 1) o.array = argv[optind + 1];
    return o;
}

static void list(const struct voxel *v)
{
    for (size_t i = 0; i < voxel_arrays(v); i++) {
        const struct voxel_about a = voxel_array(v, i);
        printf("%s\t%s\t%ux%ux%u\t%s\t%llu\n", a.name, a.cells ? "cells" : "nodes", a.n[0], a.n[1],
            a.n[2], a.type, (unsigned long long)a.components);
    }
}

/* The array that is meant: the one with the name, or the only one. */
static size_t choose(const struct voxel *v, const struct options *o)
{
    struct buf names = {0};
    const size_t n = voxel_arrays(v), i = o->array ? voxel_find(v, o->array) : 0;
    if (i < n && (o->array || n == 1)) return i;
    for (size_t k = 0; k < n && buf_size(&names) < 150; k++)
        buf_printf(&names, "%s%s", k ? ", " : "", voxel_array(v, k).name);
    buf_append(&names, "", 1);
    if (o->array)
        die(ST_USAGE, "%s: %s: no such array, expected one of: %s", o->file, o->array,
            (const char *)buf_data(&names));
    die(ST_USAGE, "%s: %zu arrays, expected the name of one: %s", o->file, n,
        (const char *)buf_data(&names));
}

static void convert(const struct voxel *v, const struct options *o)
{
    char err[ERR_BYTES];
    struct grid g;
    struct buf title = {0}, b = {0};
    const size_t array = choose(v, o);
    const uint64_t components = voxel_array(v, array).components;
    if (components > 1 && !o->chosen)
        die(ST_USAGE, "%s: %s: %llu components, expected -k with one of them, or with length",
            o->file, voxel_array(v, array).name, (unsigned long long)components);
    if (!voxel_grid(v, array, o->component, o->own, &g, err)) die(ST_USAGE, "%s", err);
    voxel_title(v, &g, o->unit, o->own, &title);
    buf_append(&title, "", 1);
    grid_write(&g, (const char *)buf_data(&title), &b);
    grid_free(&g);
    if (!o->out) put_stdout_buf(&b);
    else if (outfile_put(o->out, buf_data(&b), buf_size(&b)) != 0) die(ST_SYSTEM, "%s:", o->out);
    buf_free(&title);
    buf_free(&b);
}

int main(int argc, char **argv)
{
    char err[ERR_BYTES];
    prog_init(argv[0]);
    const struct options o = parse(argc, argv);
    struct voxel *v = voxel_open(o.file, err);
    if (!v) die(ST_USAGE, "%s", err);
    if (o.list) list(v);
    else convert(v, &o);
    voxel_free(v);
    close_stdout();
    return ST_OK;
}
