/*
 * hosts: the machines of a run, and the command that starts a worker on each. stormring-hosts(5)
 * describes the file.
 */
#ifndef STORMRING_HOSTS_H
#define STORMRING_HOSTS_H

#include "base/base.h"

#define HOSTS_SLOTS_MAX 1000000 /* of all hosts together */
#define HOST_SLOTS_MAX 4096     /* of one host */
#define HOSTS_MOST 100000
#define HOST_NAME_MOST 255 /* bytes of a host's name */
#define HOSTS_ERR 512
#define HOSTS_SENT_MOST 32 /* programs that one command names */

/* A static program, and those that hosts with send=auto get. */
struct hosts_program {
    char *name, sha256[SHA256_TEXT];
    struct buf bytes;
};
struct hosts_sent {
    struct hosts_program *at;
    size_t n;
};

struct host {
    char *name, *via, *bin; /* via, bin: NULL if not stated */
    int slots;
    double power;   /* of a slot; 0: not stated */
    double wait_s;  /* how long its launcher may queue a connection; 0: it has no queue */
    int tries;      /* connections in a row that may fail; 0: not stated */
    bool send;      /* it has no programs of its own */
    int nice;       /* of its workers, more than that of their parent */
    int64_t memory; /* bytes of addresses that each process of them may have; 0: not stated */
    const struct hosts_sent *sent; /* these are sent instead; NULL: not known yet */
    char *rack;           /* the lines of its rack, of which it is the head; NULL: it is no rack */
    struct host *members; /* of the rack, with its head, whose strings the row shares */
    size_t n_members, head;
    bool unusable;         /* a member: it cannot be the head */
    struct buf offer, way; /* the keys of its line; way: via, bin, send and wait */
    /* Its link, for simulate: one way, -1: not stated; each way, 0: not stated. */
    double latency_ms, bytes_per_s;
};
/* A version of a file; all 0: there is no file. */
struct hosts_version {
    int64_t device, number, bytes, written_ns, changed_ns;
};
struct hosts {
    char *file; /* the name of the file; NULL: a list */
    struct hosts_version version;
    struct host *at;
    size_t n;
    int slots;    /* over all hosts */
    bool no_file; /* a single name, which could have been meant for a file */
};
/*
 * Reads hosts from `arg`: `slurm:` or `pbs:` for those of the job around this process; the text of
 * a file, if it has a line end; an existing file, one host per line; else a comma list. Slots are
 * numbered from 0 in this order. A single name with a suffix of files, such as .txt, is refused.
 * False with text in err, which begins with the place. hosts_free frees *h after success.
 */
bool hosts_read(struct hosts *h, const char *arg, char err[HOSTS_ERR]);
/* The same from a file only, whether it exists or not. */
bool hosts_of_file(struct hosts *h, const char *name, char err[HOSTS_ERR]);
/*
 * Makes racks of at most n hosts each, in their order: a row of one slot for each rack. A host that
 * is this machine is a rack by itself. False with text in err if a rack has too many lines; the
 * caller frees *h in both cases.
 */
bool hosts_racks(struct hosts *h, size_t n, char err[HOSTS_ERR]);
/* The member after the head of a rack that may become it; NULL: none, or it is no rack. */
const struct host *host_heir(const struct host *rack);
/* Makes this member the head: another host is to be connected for the row. */
void host_succeed(struct host *rack, const struct host *heir);
/* This machine only, with `slots` slots. */
void hosts_here(struct hosts *h, int slots);
void hosts_free(struct hosts *h);
/* The power of each slot, which the caller frees. NULL if a host states none: *without names it. */
double *hosts_powers(const struct hosts *h, const char **without);
/*
 * Call before host_argv if hosts have send=auto: these will get the static programs that the words
 * of `worker` name. They are read into *sent, unless it has some already, and live as long as the
 * hosts. False with text in err if there are none. hosts_sent_free frees them.
 */
bool hosts_send(
    struct hosts *h, struct hosts_sent *sent, char *const worker[], char err[HOSTS_ERR]);
/* The program with this hash, or NULL. */
const struct hosts_program *hosts_program(const struct hosts_sent *sent, const char *sha256);
void hosts_sent_free(struct hosts_sent *sent);
/* True for this machine: commands are run as they are. */
bool host_is_here(const struct host *h);
/*
 * The command line to run here so that `worker` (NULL-ended) runs on the host, within the host's
 * limits: `worker` itself, or the host's `via` with the worker as a command for the remote shell.
 * NULL-ended; free it with host_argv_free.
 */
char **host_argv(const struct host *h, char *const worker[]);
void host_argv_free(char **argv);

#define HOST_LAUNCHER_MOST 64
/*
 * The first word of the command that reaches the host, such as "ssh", in `word`. False if this
 * machine has no such program. Only this word is looked up.
 */
bool host_launcher(const struct host *h, char word[HOST_LAUNCHER_MOST]);
/* True if that word is ssh, whose status tells its own failures from those of the command. */
bool host_by_ssh(const struct host *h);
/* The command of the host has the option of such a way itself. */
bool host_via_jumps(const struct host *h);
/* The command that prints ssh's settings for the host and, on standard error, the files that they
 * come from. It connects to nothing. Or NULL. Free it with host_argv_free. */
char **host_settings_argv(const struct host *h);
/* True if one of these files may send ssh through another host. `said` ends with a NUL. */
bool host_config_jumps(const char *said, size_t n);
/* The host or the command, in these settings, through which ssh connects. NULL: none. The caller
 * frees it. */
char *host_jump(const char *settings, size_t n);

/* ---- watch.c: a file that may change ---- */

struct hosts_watch {
    const char *file;           /* NULL: nothing to watch */
    struct hosts_version known; /* in use, or found bad */
    struct hosts_version last;  /* at the last look */
    int64_t look_us;            /* the next look is not before this time */
};
enum hosts_news { HOSTS_SAME, HOSTS_NEW, HOSTS_BAD };

/* Watches the file of h, which must stay. */
void hosts_watch_open(struct hosts_watch *w, const struct hosts *h);
/*
 * Looks at the file once a second. A new version counts when it did not change between two looks,
 * because it may be half written. HOSTS_NEW: it is in *h, which the caller frees; HOSTS_BAD: err
 * says what is wrong. Each version is returned once.
 */
enum hosts_news hosts_watch(
    struct hosts_watch *w, int64_t now_us, struct hosts *h, char err[HOSTS_ERR]);
/* True if both lines reach the same host in the same way, whatever their slots and power. */
bool host_same(const struct host *a, const struct host *b);

#endif
