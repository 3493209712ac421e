/* voxel_int: what the readers of formats fill in. Private to lib/voxel. */
#ifndef STORMRING_VOXEL_VOXEL_INT_H
#define STORMRING_VOXEL_VOXEL_INT_H

#include "voxel/voxel.h"

enum voxel_form { VOXEL_SIGNED, VOXEL_UNSIGNED, VOXEL_REAL };
struct voxel_type {
    uint8_t size, form; /* size: bytes; 0: no type */
};

/* How numbers are in the file. */
enum voxel_packing {
    VOXEL_RAW,     /* as bytes */
    VOXEL_TEXT,    /* as words */
    VOXEL_HEX,     /* as two digits for each byte, and blanks */
    VOXEL_DEFLATE, /* packed by zlib or gzip, which their heads tell apart */
    VOXEL_BLOCKS   /* of VTK's XML files (blocks.c) */
};
struct voxel_source {
    const unsigned char *p;
    size_t n;
    uint8_t packing;
    bool big;      /* the most significant byte is first */
    uint64_t skip; /* bytes before the numbers; of VOXEL_DEFLATE, after unpacking */
    bool colours;  /* of VOXEL_TEXT: 0 to 1 stand for bytes from 0 to 255 */
    /* For messages: the file's name, if it is not the header's, and its first byte, so that a line
     * can be told; NULL: none. */
    const char *name;
    const unsigned char *file;
    /* For VOXEL_BLOCKS. */
    bool base64, packed; /* packed: by zlib */
    uint8_t word;        /* bytes of each number of the head */
};

/* The values of a part of the grid. */
struct voxel_part {
    struct voxel_source at;
    uint32_t first[3], n[3]; /* the first value on each axis, and how many */
};

struct voxel_array {
    char name[GRID_NAME];
    struct voxel_type type;
    struct voxel_source at;
    bool cells;
    uint64_t components;
    /* How many numbers further the next value is on each axis of the file; the next component. */
    uint64_t stride[3], component_stride;
    struct voxel_part *part; /* instead of `at`, if the values are in several pieces */
    size_t n_parts;
};

/* A file beside the header. */
struct voxel_file {
    char *name;
    struct buf bytes;
};

struct voxel {
    const char *name, *directory; /* for messages; see voxel_read */
    const unsigned char *bytes;
    size_t n_bytes;
    struct buf file, data; /* file: the bytes, if they are its own; data: those of another file */
    struct voxel_file *piece; /* files of pieces */
    size_t n_pieces;
    size_t line; /* for messages; 0: none */
    char *err;

    uint32_t n[3];                /* nodes along each axis of the file */
    double origin[3], step[3][3]; /* the first node; the step from a node to the next on axis i */
    double *at[3];                /* of a rectilinear grid: coordinates; then step does not count */
    double slope, offset;         /* a value is number * slope + offset */
    struct voxel_array *array;
    size_t n_arrays;
    struct voxel_array ghost[2];                    /* of VTK: bits of nodes, and of cells */
    char unit[GRID_NAME];                           /* of the values */
    char axis[3][GRID_NAME / 4], length[GRID_NAME]; /* names and unit of x, y and z */
};

/* Sets err to "file: what", or "file:line: what" in a header of lines. Returns false. */
bool voxel_fail(struct voxel *v, const char *fmt, ...) PRINTF_LIKE(2, 3);

/* ---- formats: each fills in v, or fails ------------------------------------------------------ */

bool voxel_read_nrrd(struct voxel *v);
bool voxel_read_meta(struct voxel *v);
bool voxel_read_nifti(struct voxel *v);
bool voxel_read_xml(struct voxel *v);
bool voxel_read_legacy(struct voxel *v);

/* ---- what they share ------------------------------------------------------------------------- */

/* An array whose components are beside one another, x fastest. It is at the end of v->array. */
struct voxel_array *voxel_add(
    struct voxel *v, const char *name, struct voxel_type type, uint64_t components, bool cells);
/* The numbers of a value, such as times, are one volume after the other. */
void voxel_slowest(const struct voxel *v, struct voxel_array *a);
/* Sets v->n[axis]. */
bool voxel_set_nodes(struct voxel *v, int axis, int64_t n);
/* Nodes, or cells, along an axis. */
uint32_t voxel_side(const struct voxel *v, bool cells, int axis);
/* All numbers of an array; 0: more than 2^40. */
uint64_t voxel_numbers(const struct voxel *v, const struct voxel_array *a);
/* Even axes along x, y and z, from 0 in steps of 1. */
void voxel_even(struct voxel *v);
/* Of a picture without a third axis: its step is one across both. */
void voxel_across(struct voxel *v);
/* Reads a file beside the header. */
bool voxel_beside(struct voxel *v, const char *name, struct buf *bytes);

/* The next line of the header as text, without its end and without blanks around it. NULL: there
 * is none, or *err is set because it is too long or holds a NUL. */
#define VOXEL_LINE 4096
char *voxel_line(struct voxel *v, size_t *at, char line[VOXEL_LINE]);
/* Reads exactly n numbers, between blanks. `what` is for the message. */
bool voxel_reals(struct voxel *v, const char *what, const char *text, size_t n, double *out);
/* Blanks around are cut off. */
char *voxel_trim(char *text);
/* The next word of n bytes at p from *at: its length; 0: none is left. A comma ends a word of
 * numbers. */
size_t voxel_word(const unsigned char *p, size_t n, bool numbers, size_t *at);
/* A number of a file of text, which may be nan or infinite. */
bool voxel_number(const unsigned char *word, size_t n, double *out);

/* Decodes a number. */
double voxel_decode(const unsigned char *p, struct voxel_type t, bool big);

/* The numbers of an array, in a row. */
struct voxel_row {
    const unsigned char *p;
    struct voxel_type type;
    bool big;
    struct buf own; /* the bytes, if they were unpacked; the caller frees it */
};
bool voxel_unpack(struct voxel *v, const struct voxel_source *s, struct voxel_type t,
    uint64_t count, struct voxel_row *row);
/* Notes that row->own holds doubles of this machine. */
void voxel_row_of_doubles(struct voxel_row *row);
/* The numbers of an array, whose pieces are joined. */
bool voxel_row(struct voxel *v, const struct voxel_array *a, struct voxel_row *row);
/* Unpacks zlib or gzip: passes over `skip` bytes, then appends `want` to out. Returns how many
 * there are. */
uint64_t voxel_inflate(
    const unsigned char *p, size_t n, uint64_t skip, uint64_t want, struct buf *out);
/* Appends `want` bytes of the blocks of VTK's XML files. */
bool voxel_blocks(struct voxel *v, const struct voxel_source *s, uint64_t want, struct buf *out);

#endif
