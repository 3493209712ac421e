/*
 * A new directory for the files of a test, below TMPDIR or /tmp. A test that a mutant ends leaves it, so 50_mutants sets
 * TMPDIR.
 */
#ifndef STORMRING_TESTS_SCRATCH_H
#define STORMRING_TESTS_SCRATCH_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#define SCRATCH_BYTES 4096

static inline bool scratch_make(char dir[SCRATCH_BYTES])
{
    const char *base = getenv("TMPDIR");
    snprintf(dir, SCRATCH_BYTES, "%s/stormring-test-XXXXXX", base ? base : "/tmp");
    return mkdtemp(dir) != NULL;
}

#endif
