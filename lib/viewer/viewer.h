/*
 * viewer: looks around in a grid or a scene, while a command renders: the loop of stormview. It
 * reads and writes files, starts the command, and blocks only in poll.
 */
#ifndef STORMRING_VIEWER_H
#define STORMRING_VIEWER_H

#include "base/base.h"

struct viewer_options {
    const char *events; /* a file of what a user does, in the place of a window; NULL: a window */
    const char *lines;  /* of the map, in the format of backdrop(1); NULL: none */
    const char *prefix; /* of the names of files that it writes */
    const char *times;  /* a file for what was measured; NULL: none */
    uint32_t w, h;      /* of the picture; 0: as the specification says */
    char **files;       /* grids, then at most one specification */
    size_t n_files;
    char **command; /* ends with NULL */
};

/* The number of words, from the first on, that are inputs: files that are no programs. */
size_t viewer_inputs(char *const *words);
/* Runs to the end, and prints the specification on standard output. Returns the exit status. */
int viewer_run(const struct viewer_options *o);
/* Appends what the controls are, lines of keys and what they do. */
void viewer_controls(struct buf *out);

#endif
