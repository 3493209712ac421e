/* ringctl: the GDC ring (global distributed control): its hub around a fan, or a node. */
#include "base/base.h"
#include "drive/drive.h"

#include <string.h>
#include <unistd.h>

#define LOSSES_MOST 1000000

static const char text[] = "[-ehp] [-l LOSSES] COMMAND [ARGUMENT ...]\n"
                           "       ringctl -n WORKER [ARGUMENT ...]";

struct options {
    struct sched_params params;
    bool node;      /* -n */
    bool published; /* -p: the rules as published */
    bool rules;     /* rules were given: nodes get them from the hub */
};

static void parse(struct options *o, int argc, char **argv)
{
    int opt;
    while ((opt = prog_getopt(argc, argv, "+ehl:np")) != -1) {
        switch (opt) {
        case 'e': o->params.endgame = o->rules = true; break;
        case 'h': usage(ST_OK, text);
        case 'l':
            o->params.losses = (int32_t)opt_int(opt, optarg, 1, LOSSES_MOST);
            o->rules = true;
            break;
        case 'n': o->node = true; break;
        case 'p': o->published = o->rules = true; break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc) usage(ST_USAGE, text);
    if (o->node && o->rules)
        die(ST_USAGE, "-n: expected no other option, because the hub sets them");
    if (o->published && (o->params.endgame || o->params.losses))
        die(ST_USAGE, "-p: expected no -e and no -l with it");
}

int main(int argc, char **argv)
{
    struct options o = {0};
    prog_init(argv[0]);
    parse(&o, argc, argv);
    const struct policy *policy = o.published ? &policy_published : &policy_ring;
    return drive_policy(o.node ? &policy_node : policy, &o.params, argv + optind);
}
