/* vtk_type: the number types of VTK legacy files and their BINARY form. */
#include "grid/vtk_type.h"

#include <string.h>

const struct vtk_type vtk_types[VTK_TYPES] = {
    {"float", 4, FORM_REAL}, {"double", 8, FORM_REAL}, {"char", 1, FORM_SIGNED},
    {"signed_char", 1, FORM_SIGNED}, {"unsigned_char", 1, FORM_UNSIGNED}, {"short", 2, FORM_SIGNED},
    {"unsigned_short", 2, FORM_UNSIGNED}, {"int", 4, FORM_SIGNED},
    {"unsigned_int", 4, FORM_UNSIGNED},
    {"long", 8, FORM_SIGNED}, /* 4 bytes if written on Windows; the file is then too short */
    {"unsigned_long", 8, FORM_UNSIGNED}, {"vtktypeint64", 8, FORM_SIGNED},
    {"vtktypeuint64", 8, FORM_UNSIGNED},
    {"vtkidtype", 4, FORM_SIGNED}, /* VTK writes it as 32 bits */
};

double vtk_decode(const unsigned char *p, struct vtk_type t)
{
    uint64_t u = 0, sign = 0;
    for (int i = 0; i < t.size; i++) {
        u = u << 8 | p[i];
        sign = i ? sign << 8 : 0x80;
    }
    if (t.form == FORM_UNSIGNED) return (double)u;
    if (t.form == FORM_SIGNED)
        return u & sign ? -(double)((sign - 1 - (u & (sign - 1))) + 1) : (double)u;
    double d;
    float f;
    uint32_t low = (uint32_t)u;
    memcpy(&f, &low, sizeof f);
    memcpy(&d, &u, sizeof d);
    return t.size == sizeof f ? (double)f : d;
}
