/*
 * vtk_text: reads words, counts, names and numbers of VTK legacy files, with messages that give the
 * line. Private to lib/grid.
 */
#ifndef STORMRING_GRID_VTK_TEXT_H
#define STORMRING_GRID_VTK_TEXT_H

#include "grid/grid.h"
#include "grid/vtk_type.h"

struct vtk_reader {
    const unsigned char *bytes, *at, *end; /* at .. end is unread */
    const char *name;                      /* for messages */
    char *err;                             /* ERR_BYTES bytes */
    bool binary;
    bool down[3];        /* this axis descends in the file */
    unsigned char *kept; /* pages before this were returned; NULL: none were, and none may be */
    size_t line;         /* line number of `kept`, from 0 */
    bool has[2];         /* the file has this array of a brick (vtk_brick.c) */
    double bounds[2][6]; /* its numbers: x from and to, y, z */
};

extern const char *const vtk_brick_names[2];
/* Reads `count` numbers as the array of a brick with that name. Returns false for any other name,
 * without reading. *good is false if there is a message in r->err. */
bool vtk_brick_array(
    struct vtk_reader *r, const char *name, struct vtk_type t, uint64_t count, bool *good);
/* Sets g->brick from these arrays, if the file has them. The axes are known and ascend. */
bool vtk_brick(struct vtk_reader *r, struct grid *g);
/* Reads everything before the values, and their type. (vtk_read.c) */
bool vtk_head(struct vtk_reader *r, struct grid *g, struct vtk_type *t);
/* Notes the names of h as those of the ground of g, or of its second field. (vtk_read.c) */
void vtk_name_further(struct grid *g, const struct grid *h);
/* Moves a ground, or a second field, by whole circles to the longitudes of g, if both are in
 * degrees. A ground of the whole globe then covers g; a second field gets the columns of g, if it
 * has one at each of these longitudes. Otherwise nothing changes. (circle.c) */
void grid_turn_ground(struct grid *ground, const struct grid *g);
void grid_turn_second(struct grid *h, const struct grid *g);
/* Reads n values, a row of the file, as they come or from the last to the first. Returns pages that
 * were read, if there are any to return. */
bool vtk_row(struct vtk_reader *r, struct vtk_type t, uint32_t n, bool down, float *row);
/* Reads what may follow the values: nothing. */
bool vtk_tail(struct vtk_reader *r);

/* Number of line ends in p .. end. */
size_t vtk_lines(const unsigned char *p, const unsigned char *end);

/* Functions that return bool: false with the message in r->err, except vtk_next_is and vtk_take. */
bool vtk_fail(struct vtk_reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* Fails with "WHAT is 'the next word', expected EXPECTED", or reports the end of the file. */
bool vtk_fail_word(struct vtk_reader *r, const char *what, const char *expected);
/* Advances to the next word and returns its length; 0 at the end of the file. */
size_t vtk_peek(struct vtk_reader *r);
/* These compare the next word, ignoring case. vtk_take consumes it if equal. vtk_expect fails if it
 * differs. */
bool vtk_next_is(struct vtk_reader *r, const char *word);
bool vtk_take(struct vtk_reader *r, const char *word);
bool vtk_expect(struct vtk_reader *r, const char *what, const char *word);
bool vtk_count(struct vtk_reader *r, const char *what, uint64_t min, uint64_t max, uint64_t *v);
bool vtk_type(struct vtk_reader *r, struct vtk_type *t);
/* Reads the name of an array, cut at GRID_NAME. %XX stands for a byte. */
bool vtk_name(struct vtk_reader *r, char name[GRID_NAME]);
/* Prepares for `count` numbers of this type. True if enough bytes follow. */
bool vtk_begin_numbers(struct vtk_reader *r, const char *what, struct vtk_type t, uint64_t count);
/* Reads a number as text, within the range of the type. Reals may be "nan". */
bool vtk_text(struct vtk_reader *r, const char *what, struct vtk_type t, double *v);
/* Call after vtk_begin_numbers. The number is NaN, which the caller must handle, or in range. */
bool vtk_number(struct vtk_reader *r, const char *what, struct vtk_type t, double *v);
/* Skips the metadata that VTK appends to an array: lines up to an empty one. */
void vtk_skip_metadata(struct vtk_reader *r);

/* Skips the strings of an array. ASCII: a line each. BINARY: each behind its length, whose first
 * two bits say how many bytes that has. */
bool vtk_skip_strings(struct vtk_reader *r, uint64_t count);

#endif
