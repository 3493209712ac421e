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
};

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

#endif
