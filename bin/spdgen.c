/* spdgen: writes a scene of the Standard Procedural Databases as NFF. */
#include "spd/spd.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage_text[] = "[-h] [-p DIGITS] [-s SIZE] [-V balanced|imbalanced] NAME\n"
                                 "       spdgen -l [-s SIZE]";

struct options {
    int size;        /* 0: the scene's own default */
    int digits;      /* significant digits of the numbers written */
    bool imbalanced; /* the imbalanced view instead of SPD's */
    bool list;
};

/* -h: the usage and the scenes. */
static _Noreturn void help(void)
{
    struct buf text = {0};
    buf_printf(&text, "%s\n\nNAME, its size by default:", usage_text);
    for (size_t i = 0; i < spd_n_scenes; i++)
        buf_printf(
            &text, "\n  %-8s %2d  %s", spd_scenes[i].name, spd_scenes[i].size, spd_scenes[i].what);
    buf_append(&text, "", 1);
    usage(ST_OK, (const char *)buf_data(&text));
}

static bool is_imbalanced(const char *name)
{
    if (strcmp(name, "balanced") == 0) return false;
    if (strcmp(name, "imbalanced") == 0) return true;
    die(ST_USAGE, "-V %s: expected balanced or imbalanced", name);
}

static int checked_size(const struct spd_scene *scene, int size)
{
    int max = spd_size_max(scene);
    if (size > max) die(ST_USAGE, "-s %d: %s goes up to size %d", size, scene->name, max);
    return size ? size : scene->size;
}

static void list_scenes(int size)
{
    printf("# name size primitives formula\n");
    for (size_t i = 0; i < spd_n_scenes; i++) {
        const struct spd_scene *scene = &spd_scenes[i];
        int s = size ? size : scene->size;
        if (s > spd_size_max(scene)) continue;
        printf(
            "%s %d %llu %s\n", scene->name, s, (unsigned long long)scene->count(s), scene->formula);
    }
}

int main(int argc, char **argv)
{
    struct options opt = {.digits = NFF_DIGITS_SPD};
    prog_init(argv[0]);
    for (int c; (c = prog_getopt(argc, argv, "hlp:s:V:")) != -1;) switch (c) {
        case 'h': help();
        case 'l': opt.list = true; break;
        case 'p': opt.digits = (int)opt_int(c, optarg, NFF_DIGITS_SPD, NFF_DIGITS_MAX); break;
        case 's': opt.size = (int)opt_int(c, optarg, 1, SPD_SIZE_MAX); break;
        case 'V': opt.imbalanced = is_imbalanced(optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind != !opt.list) usage(ST_USAGE, usage_text);
    if (opt.list) list_scenes(opt.size);
    else {
        const struct spd_scene *scene = spd_find(argv[optind]);
        if (!scene)
            die(ST_USAGE, "%s: no such scene, expected one that spdgen -l lists", argv[optind]);
        if (opt.imbalanced && scene->imbalanced_deg == 0)
            die(ST_USAGE, "-V imbalanced: %s has no such view, expected balanced", scene->name);
        struct nff_out out = {stdout, opt.digits};
        spd_write(scene, &out, checked_size(scene, opt.size), opt.imbalanced);
    }
    close_stdout();
    return ST_OK;
}
