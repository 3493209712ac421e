/* deal: hands out tasks on demand around a command. */
#include "base/base.h"
#include "drive/drive.h"

#include <unistd.h>

int main(int argc, char **argv)
{
    static const char text[] = "[-q DEPTH] COMMAND [ARGUMENT ...]";
    struct sched_params p = {0};
    prog_init(argv[0]);
    int opt;
    while ((opt = getopt(argc, argv, "+hq:")) != -1) {
        switch (opt) {
        case 'h': usage(ST_OK, text);
        case 'q': p.depth = (int32_t)opt_int(opt, optarg, 0, 1000000); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc) usage(ST_USAGE, text);
    return drive_policy(&policy_deal, &p, argv + optind);
}
