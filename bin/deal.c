/* deal: hands out tasks on demand, around a command. */
#include "base/base.h"
#include "drive/drive.h"

#include <string.h>
#include <unistd.h>

#define DEPTH_MOST 1000000
#define LOSSES_MOST 1000000
#define LEAST_MOST_S 86400

int main(int argc, char **argv)
{
    static const char text[] =
        "[-eh] [-l LOSSES] [-q DEPTH|auto] [-t SECONDS] COMMAND [ARGUMENT ...]";
    struct sched_params p = {0};
    prog_init(argv[0]);
    int opt;
    while ((opt = prog_getopt(argc, argv, "+ehl:q:t:")) != -1) {
        switch (opt) {
        case 'e': p.endgame = true; break;
        case 'h': usage(ST_OK, text);
        case 'l': p.losses = (int32_t)opt_int(opt, optarg, 1, LOSSES_MOST); break;
        case 'q':
            if (strcmp(optarg, "auto") == 0) p.depth = SCHED_DEPTH_AUTO;
            else p.depth = (int32_t)opt_int(opt, optarg, 0, DEPTH_MOST);
            break;
        case 't': p.least_us = 1e6 * opt_real(opt, optarg, 0, LEAST_MOST_S); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc) usage(ST_USAGE, text);
    return drive_policy(&policy_deal, &p, argv + optind);
}
