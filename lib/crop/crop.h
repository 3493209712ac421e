/*
 * crop: draws a rectangle of a frame by running a command, and reads the picture that it writes.
 *
 * The command is a list of words, run without a shell. In each word these are replaced:
 *
 *     {x} {y} {w} {h}  the rectangle's left column, top row, width and height; counted from 0
 *     {x1} {y1}        its left column and top row, counted from 1
 *     {x2} {y2}        its last column and row, counted from 1
 *     {W} {H}          the frame's width and height
 *     {F}              the frame's number
 *     {i}              the first of the packed files
 *     {o}              a file that the command must write; without {o}, it writes to its stdout
 *
 * The picture is a PNG, PAM, PPM, PGM or PFM file, and has the size of the rectangle or of the
 * frame.
 *
 * A command runs in a process group of its own, below a keeper: a process that ends the group when
 * this process ends in any way. A command that leaves its group is not ended. Files of a run are in
 * one directory, which a janitor, a process of its own too, removes when this process has ended.
 * Keeper and janitor have names of their own, cropkeeper and cropclean, so that they outlive a
 * `pkill -9` of this program by its name.
 */
#ifndef STORMRING_CROP_H
#define STORMRING_CROP_H

#include "base/base.h"
#include "image/image.h"
#include "task/task.h"

#define CROP_ERR 256

struct crop_rect {
    uint32_t frame;            /* its number */
    uint32_t frame_w, frame_h; /* its size */
    uint32_t x, y, w, h;
};

/* ---- words.c ---- */

/* True if {name} occurs in a word. */
bool crop_uses(char *const words[], const char *name);
/* The words with everything replaced, NULL at the end, in memory that crop_words_free frees. `in`
 * and `out` are for {i} and {o}; NULL if these do not occur. */
char **crop_words(char *const words[], const struct crop_rect *at, const char *in, const char *out);
void crop_words_free(char **words);
/* The hash of all words, for jobs. */
void crop_words_hash(char *const words[], char hash[SHA256_TEXT]);

/* ---- janitor.c ---- */

/*
 * Makes an empty directory that only this user can enter, below TMPDIR or /tmp. It is removed, with
 * all that is in it, when this process has ended, even by SIGKILL. Call it once, while the process
 * has one thread. Returns the name, which stays valid; a failure ends the program with status 3.
 */
const char *crop_directory(void);
/* Removes the file or directory, with all that is in it; follows no link. 0, or -1 with errno. */
int crop_remove(const char *path);

/* ---- copy.c ---- */

/* Copies the directory, with the files and directories in it, to one beside it that is named after
 * this process. Returns its name, which the caller frees; a failure ends the program with status
 * 3. */
char *crop_copy(const char *path);
/* Removes the copies of that directory, of all processes. */
void crop_remove_copies(const char *path);

/* ---- confine.c ---- */

/* The version of the kernel's Landlock; 0 if it has none. */
int crop_landlock(void);
/*
 * From now on this process, and all that it starts, can write, make, rename and remove files only
 * below these directories; NULL ends the list. It can also write to /dev/null, /dev/zero and what
 * is open already, read all that it could read, and gets no new privilege by a setuid program.
 * `version` is at most crop_landlock's, and not 0. 0, or -1 with errno; then call _exit.
 */
int crop_confine(const char *const own[], int version);

/* ---- command.c ---- */

/* Where a command runs, and what it may write. */
struct crop_place {
    const char *directory; /* in which it runs; NULL: the current one */
    /* Its TMPDIR. It can write there and in `directory`, and nowhere else: the kernel must have
     * Landlock. NULL: no limit, and the TMPDIR of this process. */
    const char *own;
};
/*
 * Runs words in this place, with an empty standard input. Its standard
 * output, of at most `most` bytes, goes to *out; with out NULL it is dropped. Standard error is
 * shown only if the command fails: its last lines. Waits for the end of the command, and kills what
 * is left of its process group. Returns 0; -1 with the reason in err; or CROP_NOT_FOUND, likewise,
 * for status 127.
 */
#define CROP_NOT_FOUND (-127)
int crop_run(char *const words[], const struct crop_place *place, struct buf *out, size_t most,
    char err[CROP_ERR]);

/* ---- picture.c ---- */

/* What to run, and where. */
struct crop_command {
    char *const *words;
    const char *scratch;  /* a directory, in which each process gets one for its tasks' files */
    const char *files;    /* the directory in which to run; NULL: the current one */
    const char *first;    /* {i} */
    enum image_deep deep; /* what 16 bits that do not state their curve hold */
    bool confined;        /* it can write in these directories only */
};
/*
 * Draws the rectangle: the picture holds its pixels, or those of the frame. The caller frees it by
 * image_free. Returns 0; or as crop_run does, with nothing to free.
 */
int crop_draw(const struct crop_command *c, const struct crop_rect *at, struct image *picture,
    char err[CROP_ERR]);
/* The smallest rectangle of a frame of this size that has all pixels of the lattice; its frame is
 * 0. */
struct crop_rect crop_around(const struct lattice *at, uint32_t frame_w, uint32_t frame_h);
/* Copies pixels n0 .. n0+n of the lattice, which lie inside the rectangle, to rgba[4n]. */
void crop_pixels(const struct image *picture, const struct crop_rect *rect,
    const struct lattice *at, uint64_t n0, uint32_t n, float *rgba);

#endif
