/* input: the files that a run reads, so that none of its outputs replaces one. See base.h. */
#include "base/base.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct input {
    dev_t device;
    ino_t inode;
    char *path;       /* "-": standard input */
    const char *what; /* NULL: this place is free */
};
/* A hash table, at most half full: films have a grid for each of 100,000 pictures. */
static struct input *inputs;
static size_t places, n_inputs;

static bool is_standard(const char *path) { return strcmp(path, "-") == 0; }

static bool stat_regular(const char *path, struct stat *st)
{
    int failed = is_standard(path) ? fstat(STDIN_FILENO, st) : stat(path, st);
    return !failed && S_ISREG(st->st_mode);
}

/* The place of this file, or the free one for it. */
static struct input *place_of(dev_t device, ino_t inode)
{
    size_t at = (size_t)rng_u64(device, inode) & (places - 1);
    while (inputs[at].what && (inputs[at].device != device || inputs[at].inode != inode))
        at = (at + 1) & (places - 1);
    return &inputs[at];
}

/* False after the file was replaced: its inode may be that of another one. Standard input may be
 * closed by now. */
static bool is_there(const struct input *in)
{
    struct stat st;
    if (!in->what || is_standard(in->path)) return in->what != NULL;
    return stat_regular(in->path, &st) && st.st_dev == in->device && st.st_ino == in->inode;
}

static void grow(void)
{
    struct input *old = inputs;
    const size_t n = places;
    places = n ? 2 * n : 64;
    inputs = xcalloc(places, sizeof *inputs);
    for (size_t i = 0; i < n; i++)
        if (old[i].what) *place_of(old[i].device, old[i].inode) = old[i];
    free(old);
}

void input_add(const char *path, const char *what)
{
    struct stat st;
    if (!stat_regular(path, &st)) return;
    if (2 * n_inputs >= places) grow();
    struct input *in = place_of(st.st_dev, st.st_ino);
    if (is_there(in)) return;
    n_inputs += !in->what;
    free(in->path);
    *in = (struct input){st.st_dev, st.st_ino, xstrdup(path), what};
}

const char *input_is(const char *path)
{
    struct stat st;
    if (!places || !stat_regular(path, &st)) return NULL;
    const struct input *in = place_of(st.st_dev, st.st_ino);
    return is_there(in) ? in->what : NULL;
}

void input_keep(const char *path)
{
    const char *what = input_is(path);
    if (what) die(ST_USAGE, "%s: is also %s, expected another file", path, what);
}

int input_open(const char *path)
{
    int fd = is_standard(path) ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    if (fd >= 0) input_add(path, "an input");
    return fd;
}
