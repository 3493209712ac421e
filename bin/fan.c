/* fan: runs a worker on every slot, routes tasks to them, merges what they say. */
#include "base/base.h"
#include "drive/drive.h"

#include <unistd.h>

#define SLOTS_MAX 4096

static void list_slots(int n)
{
    for (int k = 0; k < n; k++) printf("%d\t:\t1\n", k);
    close_stdout();
}

int main(int argc, char **argv)
{
    static const char text[] = "[-j SLOTS] [-t SECONDS] WORKER [ARGUMENT ...]\n"
                               "       fan -l [-j SLOTS]";
    struct fan_options o = {.silence_s = 3};
    bool list = false;
    prog_init(argv[0]);
    int opt;
    while ((opt = getopt(argc, argv, "+hj:lt:")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'j': o.slots = (int)opt_int(opt, optarg, 1, SLOTS_MAX); break;
        case 'l': list = true; break;
        case 't': o.silence_s = opt_real(opt, optarg, .6, 1e6); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (!o.slots) o.slots = cores_available();
    if ((optind == argc) != list) usage(ST_USAGE, text);
    if (list) {
        list_slots(o.slots);
        return ST_OK;
    }
    o.command = argv + optind;
    return drive_fan(&o);
}
