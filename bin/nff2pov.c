/* nff2pov: converts an NFF scene to an equivalent POV-Ray 3.7 scene. */
#include "scene/scene.h"

#include <unistd.h>

static const char usage_text[] = "[-h] [-x FACTOR] [SCENE.nff|-]";

int main(int argc, char **argv)
{
    double scale = 1; /* factor of all lengths */
    prog_init(argv[0]);
    for (int c; (c = prog_getopt(argc, argv, "hx:")) != -1;) switch (c) {
        case 'h': usage(ST_OK, usage_text);
        case 'x': scale = opt_real(c, optarg, 1e-9, 1e9); break;
        default: usage(ST_USAGE, usage_text);
        }
    if (argc - optind > 1) usage(ST_USAGE, usage_text);
    const char *path = optind < argc ? argv[optind] : "-";

    struct buf text = {0};
    struct scene scene;
    char err[SCENE_ERR];
    if (read_file(path, &text) != 0) die(ST_USAGE, "%s:", path);
    const char *name = path[0] == '-' && !path[1] ? "stdin" : path;
    if (nff_read(name, (const char *)buf_data(&text), buf_size(&text), &scene, err) != 0)
        die(ST_USAGE, "%s", err);

    pov_write(stdout, &scene, scale);
    close_stdout();
    uint32_t which;
    bool clips = scene_hither_clips(&scene, &which);
    if (clips)
        warn("%s: hither %g may hide part of primitive %u, and POV-Ray's camera hides nothing: "
             "expected a smaller hither",
            name, scene.view.hither, which + 1);
    uint32_t refused = pov_refused(&scene, scale, &which);
    if (refused)
        warn("%s:%u: POV-Ray refuses this cone%s, less than %g high: expected a larger -x", name,
            nff_line((const char *)buf_data(&text), buf_size(&text), which),
            refused > 1 ? " and others" : "", POV_CONE_MIN);
    buf_free(&text);
    scene_free(&scene);
    return clips || refused ? ST_PARTIAL : ST_OK;
}
