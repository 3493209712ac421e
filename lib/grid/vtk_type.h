/* vtk_type: the number types of VTK legacy files. Private to lib/grid. */
#ifndef STORMRING_GRID_VTK_TYPE_H
#define STORMRING_GRID_VTK_TYPE_H

#include "base/base.h"

enum form { FORM_SIGNED, FORM_UNSIGNED, FORM_REAL };
struct vtk_type {
    const char *name;
    uint8_t size; /* bytes in BINARY */
    uint8_t form;
};
#define VTK_TYPES 14
extern const struct vtk_type vtk_types[VTK_TYPES];

/* Decodes a big-endian number of a BINARY file. */
double vtk_decode(const unsigned char *p, struct vtk_type t);
/* Writes the lowest `size` bytes of a number, the highest first. */
static inline void put_big_endian(unsigned char *to, uint64_t bits, int size)
{
    for (int i = 0; i < size; i++) to[i] = (unsigned char)(bits >> 8 * (size - 1 - i));
}

#endif
