/*
 * job: what the files of a run mean. They are one scene; or scenes and, after them, views, each
 * scene with each view; or grids and specifications in the same way; or a scene of POV-Ray or
 * Blender and files that it uses. A grid alone gets a specification of its own, the starter.
 * job(1) is the manual.
 *
 * job_first, job_of and job_starter read files. Of a file that cannot be read, its reader says so.
 */
#ifndef STORMRING_JOB_H
#define STORMRING_JOB_H

#include "base/base.h"
#include "wire/wire.h"

/* ---- what one file is (kind.c) -------------------------------------------------------------- */

#define JOB_FIRST 4096 /* bytes that tell */
/* Reads the first bytes of the file, up to JOB_FIRST. Returns their number; 0: there are none, or
 * it cannot be read. *size is the length of the file; 0: not known. */
size_t job_first(const char *path, unsigned char first[JOB_FIRST], uint64_t *size);
/* True if it is a VTK legacy file, which only a grid is. */
bool job_is_grid(const unsigned char *first, size_t n);
/* True if its first word is one of a view, as that of a specification may be. */
bool job_is_view(const unsigned char *first, size_t n);
/* True if it begins with the line `v` of a scene. */
bool job_is_scene(const unsigned char *first, size_t n);
/*
 * If no program that renders reads such a file, returns false with the rest of "FILE: ..." in err:
 * what it is, what was expected, and the program that reads it. Other files are taken for text.
 */
bool job_readable(const unsigned char *first, size_t n, uint64_t size, char err[ERR_BYTES]);

/* ---- what all of them are together (files.c) ------------------------------------------------ */

enum job_what { JOB_SCENE, JOB_GRIDS, JOB_POV, JOB_BLEND };
struct job {
    enum job_what what;
    char **path;     /* the caller's; scenes or grids, then views or specifications */
    size_t n;        /* of path */
    size_t subjects; /* scenes or grids; 0: a scene of another renderer */
    bool starter;    /* one grid alone */
};
/*
 * Returns false with "file: what, expected what" in err if these n files, at least one, are nothing
 * that can be rendered. "-" is standard input, which is a scene and alone. May change path[0], so
 * that no program takes the name of another renderer's scene for an option.
 */
bool job_of(struct job *j, char **path, size_t n, char err[ERR_BYTES]);
/* The program that renders it. */
const char *job_worker(const struct job *j);
/* True of a scene of POV-Ray or Blender, whose worker knows the files that it needs. */
bool job_foreign(const struct job *j);
/* The number of states: 1, or the number of pairs of scenes and views, or grids and specifications.
 * Frames of an animation of POV-Ray or Blender have one state. */
size_t job_states(const struct job *j);
/* State `at`: path[subject] as path[look] shows it, a view or a specification. A worker that has
 * the states before it needs only what is new. look is n, no file, of a starter, which is new; and
 * of a scene without views, where nothing is. */
struct job_state {
    size_t subject, look;
    bool new_subject, new_look;
};
struct job_state job_state(const struct job *j, size_t at);
/* Appends the specification of a grid alone, with a picture of w x h pixels; 0: as it is usual.
 * Returns false with a message in err. */
bool job_starter(const char *grid, uint32_t w, uint32_t h, struct buf *out, char err[ERR_BYTES]);

/* ---- state records on standard output (record.c) -------------------------------------------- */

/* Writes the body as a record, and frees it. Dies with status 2 if it is too long, and with 3 if it
 * cannot be written. `name` is for messages. */
void job_put(enum rec_kind kind, const char *name, struct buf *body);
/* The same for a file; "-": standard input. Dies with status 2 if it cannot be read. */
void job_put_file(enum rec_kind kind, const char *path);

/* ---- what the worker says of them (check.c) ------------------------------------------------- */

/* Splits the options of the worker at blanks: *n words, NULL at the end, in one piece of memory
 * that the caller frees. */
char **job_words(const char *options, size_t *n);
/* Returns false with "WORD: expected what" in err if one of the words of these options is none that
 * the worker may get. */
bool job_words_check(
    const struct job *j, const char *options, char *const *words, char err[ERR_BYTES]);

/* The frames that `-i` of a worker prints: `frame W H [F]`, then `job=HASH`. */
struct job_frames {
    struct buf text; /* records, `frame F W H job=HASH`; the caller frees it */
    uint32_t n;      /* frames so far */
    int64_t of[3];   /* the frame whose job comes next: W, H, F; W = 0: none */
};
/* Takes one line, without its end. Returns false if it says something else. */
bool job_frames_take(struct job_frames *f, const char *line);

#endif
