/*
 * vtk_text: what every part of a VTK legacy file is read with: words, counts, names and numbers,
 * and messages that say where. Private to lib/volume.
 */
#ifndef STORMRING_VOLUME_VTK_TEXT_H
#define STORMRING_VOLUME_VTK_TEXT_H

#include "grid/grid.h"
#include "grid/vtk_type.h"

struct vtk_reader {
    const unsigned char *bytes, *at, *end; /* at .. end is unread */
    const char *name;                      /* stands in messages */
    char *err;                             /* ERR_BYTES bytes */
    bool binary;
    bool down[3];        /* this axis descends in the file */
    unsigned char *kept; /* to here pages were given back; NULL: none are */
    size_t line;         /* that begins what is kept, from 0 */
};

/* Line ends in p .. end. */
size_t vtk_lines(const unsigned char *p, const unsigned char *end);

/* Those that return bool: false with the message in r->err, but vtk_next_is and vtk_take. */
bool vtk_fail(struct vtk_reader *r, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* "WHAT is 'the next word', expected EXPECTED", or that the file ends there. */
bool vtk_fail_word(struct vtk_reader *r, const char *what, const char *expected);
/* To the next word; its length, 0 at the end of the file. */
size_t vtk_peek(struct vtk_reader *r);
/* Is it this one, in any case? vtk_take reads it if it is; vtk_expect fails if not. */
bool vtk_next_is(struct vtk_reader *r, const char *word);
bool vtk_take(struct vtk_reader *r, const char *word);
bool vtk_expect(struct vtk_reader *r, const char *what, const char *word);
bool vtk_count(struct vtk_reader *r, const char *what, uint64_t min, uint64_t max, uint64_t *v);
bool vtk_type(struct vtk_reader *r, struct vtk_type *t);
/* The name of an array, as much of it as there is room for; %XX is a byte. */
bool vtk_name(struct vtk_reader *r, char name[GRID_NAME]);
/* `count` numbers of this type follow; true when the bytes for them are there. */
bool vtk_begin_numbers(struct vtk_reader *r, const char *what, struct vtk_type t, uint64_t count);
/* A number as text, one that this type can hold; of reals "nan", as printf writes it, is one. */
bool vtk_text(struct vtk_reader *r, const char *what, struct vtk_type t, double *v);
/* After vtk_begin_numbers. NaN is left to the caller; others are in range. */
bool vtk_number(struct vtk_reader *r, const char *what, struct vtk_type t, double *v);
/* What VTK appends to an array: lines up to an empty one. */
void vtk_skip_metadata(struct vtk_reader *r);

#endif
