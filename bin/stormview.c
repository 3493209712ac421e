/* stormview: looks around in a grid or a scene, while a command renders. */
#include "base/base.h"
#include "task/task.h"
#include "viewer/viewer.h"

#include <unistd.h>

static const char usage_text[] = "[-h] [-e EVENTS] [-m LINES] [-o PREFIX] [-s WxH] [-t TIMES]\n"
                                 "                 GRID.vtk ... [SPEC] COMMAND [ARGUMENT ...]\n"
                                 "       stormview ... SCENE.nff ... [VIEW] COMMAND [ARGUMENT ...]";

int main(int argc, char **argv)
{
    struct viewer_options o = {.prefix = "stormview"};
    int w = 0, h = 0;
    prog_init(argv[0]);
    for (int c; (c = prog_getopt(argc, argv, "+e:hm:o:s:t:")) != -1;) switch (c) {
        case 'e': o.events = opt_text(c, optarg); break;
        case 'h': usage(ST_OK, usage_text);
        case 'm': o.lines = opt_text(c, optarg); break;
        case 'o': o.prefix = opt_text(c, optarg); break;
        case 's': opt_size(c, optarg, FRAME_SIDE_MAX, &w, &h); break;
        case 't': o.times = opt_text(c, optarg); break;
        default: usage(ST_USAGE, usage_text);
        }
    o.w = (uint32_t)w, o.h = (uint32_t)h;
    o.files = argv + optind;
    o.n_files = viewer_inputs(o.files);
    o.command = o.files + o.n_files;
    if (!o.n_files || !*o.command) usage(ST_USAGE, usage_text);
    const int status = viewer_run(&o);
    close_stdout();
    return status;
}
