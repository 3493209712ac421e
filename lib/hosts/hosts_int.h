/* hosts, shared by its files: table.c (the rows), name.c (names), hosts.c (files and lists),
 * engines.c (jobs), watch.c (files that change); launch.c (commands that reach hosts), word.c
 * (their words), way.c (other hosts between), racks.c (trees), send.c (programs for hosts that have
 * none). */
#ifndef STORMRING_HOSTS_INT_H
#define STORMRING_HOSTS_INT_H

#include "hosts/hosts.h"

/* Position in the text, and the place for errors. */
struct hosts_reader {
    const char *name; /* of the file */
    int line;         /* 0: no line */
    const char *at, *end;
    char *err;   /* HOSTS_ERR bytes */
    size_t done; /* hosts of earlier texts, whose names may come again */
    /* engines.c: the hosts by name, with open addressing: indices of the table of hosts, or -1. */
    struct hosts_names {
        int32_t *at;
        size_t room; /* 0, or a power of two, at least twice the number of hosts */
    } * names;
};

/* Writes "NAME:LINE: text" to r->err, and returns false. */
bool hosts_refuse(const struct hosts_reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* A new row with one slot. It is valid until the next call. */
struct host *hosts_add(struct hosts *h);
/* Copies a name that is one word for every shell, or refuses it. */
bool hosts_set_name(const struct hosts_reader *r, struct host *host, const char *name);
/* Appends ` KEY="VALUE"`, with quotes as a line has them. */
void hosts_put_key(struct buf *b, const char *key, const char *value);
/* Frees what a row has. */
void host_free(struct host *host);
/* Call when the host is complete: checks it, and counts its slots. */
bool hosts_count(const struct hosts_reader *r, struct hosts *h, const struct host *host);
/*
 * Appends the file r->name. It must be a regular file, because it is read more than once in a run
 * and others may have no end. Its size is limited because any file may be named by mistake.
 */
bool hosts_read_file(const struct hosts_reader *r, struct buf *text);
/* The version of the file now. */
struct hosts_version hosts_version(const char *file);
/*
 * If `arg` is `slurm:` or `pbs:`, adds the hosts of the job in which this process runs, and returns
 * true: *good is false if the job's variables or its file are refused.
 */
bool hosts_of_job(struct hosts_reader *r, struct hosts *h, const char *arg, bool *good);
/* The template of the command that reaches the host. */
const char *hosts_via(const struct host *h);
/* sh, which becomes the command of the template, by way of `by`. */
char **hosts_by_sh(const char *by, const char *via, const char *name, const char *remote);
/* Appends a word for the shell of a host, which may be like the Bourne shell, csh or fish. */
void hosts_add_word(struct buf *b, const char *word);
/*
 * A copy of a command without control characters: no quotes keep a newline in every shell. It
 * begins with sh, which restores the words there. NULL if the command has none. host_argv_free
 * frees it.
 */
char **hosts_plain_words(char *const worker[]);
/* bootstrap.sh, in one line, as bootstrap.sed makes it. */
extern const char hosts_bootstrap[];
/* Appends the command for the shell of a host that has no programs. */
void hosts_add_bootstrap(struct buf *b, const struct hosts_sent *sent, char *const worker[]);

#endif
