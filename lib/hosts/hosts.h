/*
 * hosts: which machines there are, and the command that starts a worker on each of them.
 * stormring-hosts(5) is the manual of the file.
 */
#ifndef STORMRING_HOSTS_H
#define STORMRING_HOSTS_H

#include "base/base.h"

#define HOSTS_SLOTS_MAX 4096 /* of all hosts together */
#define HOST_NAME_MOST 255   /* bytes of a host's name */
#define HOSTS_ERR 512

struct host {
    char *name, *via, *bin; /* via, bin: NULL where nothing is said */
    int slots;
    double power; /* of a slot; 0: nobody said */
};
struct hosts {
    struct host *at;
    size_t n;
    int slots;    /* of all */
    bool no_file; /* of one name, which could have been meant for a file's */
};
/*
 * Where `arg` is an existing file, its hosts, a line each; else those of a comma list. Slots are
 * numbered from 0 in this order. A lone name with a suffix that files have, and networks have not,
 * is not taken for a host. False with text in err, which begins with the place.
 */
bool hosts_read(struct hosts *h, const char *arg, char err[HOSTS_ERR]);
/* This machine alone. */
void hosts_here(struct hosts *h, int slots);
void hosts_free(struct hosts *h);
/* This machine: its commands are run as they are. */
bool host_is_here(const struct host *h);
/*
 * What to run here so that `worker` (NULL-ended) runs on the host: `worker` itself, or the host's
 * via with the worker as a command for the shell there. NULL-ended, freed by host_argv_free.
 */
char **host_argv(const struct host *h, char *const worker[]);
void host_argv_free(char **argv);

#endif
