/* fan: runs a worker on every slot, routes tasks to them, and merges their records. */
#include "base/base.h"
#include "coder/coder.h"
#include "fan/fan.h"
#include "patience/patience.h"
#include "proc/proc.h"

#include <string.h>
#include <unistd.h>

static const char text[] = "[-1h] [-S HOSTS [-T N] | -j SLOTS] [-t SECONDS] [-z on|off|auto]\n"
                           "           WORKER [ARGUMENT ...]\n"
                           "       fan -l [-1l] [-S HOSTS [-T N] | -j SLOTS] [WORKER\n"
                           "           [ARGUMENT ...]]";

/* At most one of the two may be given. */
static void find_hosts(struct hosts *h, const char *list, int slots)
{
    char err[HOSTS_ERR];
    if (list && slots) die(ST_USAGE, "-j %d: expected either -S or -j", slots);
    if (!list) hosts_here(h, slots ? slots : cores_available());
    else if (!hosts_read(h, list, err)) die(ST_USAGE, "%s", err);
}

/* The argument of -z. */
static enum fan_pack packing(const char *word)
{
    static const char *const words[] = {
        [FAN_PACK_AUTO] = "auto", [FAN_PACK_ON] = "on", [FAN_PACK_OFF] = "off"};
    for (enum fan_pack i = FAN_PACK_AUTO; i <= FAN_PACK_OFF; i++) {
        if (strcmp(word, words[i]) != 0) continue;
        if (i == FAN_PACK_ON && !coder_there())
            die(ST_USAGE, "-z on: built without libzstd, expected off or auto");
        return i;
    }
    die(ST_USAGE, "-z %s: expected on, off or auto", word);
}

int main(int argc, char **argv)
{
    struct hosts hosts;
    struct hosts_sent sent = {0};
    char err[HOSTS_ERR];
    struct fan_options o = {.hosts = &hosts, .silence_s = PATIENCE_SILENCE_US / 1e6};
    const char *list = NULL;
    int slots = 0, rack = 0;
    int listing = 0;
    prog_init(argv[0]);
    int opt;
    while ((opt = prog_getopt(argc, argv, "+1hj:lS:t:T:z:")) != -1) {
        switch (opt) {
        case '1': o.one_each = true; break;
        case 'h': usage(ST_OK, text);
        case 'j': slots = (int)opt_int(opt, optarg, 1, HOST_SLOTS_MAX); break;
        case 'l': listing++; break;
        case 'S': list = opt_text(opt, optarg); break;
        case 't': o.silence_s = opt_real(opt, optarg, .6, 1e6); break;
        case 'T': rack = (int)opt_int(opt, optarg, 1, FAN_MOST); break;
        case 'z': o.pack = packing(opt_text(opt, optarg)); break;
        default: usage(ST_USAGE, text);
        }
    }
    if (optind == argc && !listing) usage(ST_USAGE, text);
    if (rack && !list) die(ST_USAGE, "-T: expected -S with it");
    find_hosts(&hosts, list, slots);
    o.racks = rack > 0;
    if (rack && !hosts_racks(&hosts, (size_t)rack, err)) die(ST_USAGE, "%s", err);
    o.command = argv + optind;
    o.trips = listing > 1;
    o.sent = &sent;
    if (!hosts_send(&hosts, &sent, o.command, err)) die(ST_USAGE, "%s", err);
    int status = listing ? fan_list(&o) : fan_run(&o);
    hosts_free(&hosts);
    hosts_sent_free(&sent);
    return status;
}
