/*
 * stl: what libassimp takes wrong in an STL of bytes: anything behind the facets, and the colours
 * of Materialise Magics. There COLOR= in the header gives the colour of all facets, or MATERIAL=
 * does, which goes before; bit 15 is set in facets with that colour, and red is in the lowest bits.
 * VisCAM sets bit 15 in facets with a colour of their own, and has blue in the lowest bits; others
 * become grey, with an alpha, and here white.
 */
#include "mesh/mesh_int.h"

#include <string.h>
#include <strings.h>

#define HEADER 84 /* bytes: 80 of any kind, and the number of facets */
#define FACET 50  /* the last two are the colour */

static bool read_header(FILE *f, unsigned char header[HEADER], uint64_t *facets)
{
    rewind(f);
    if (fread(header, 1, HEADER, f) != HEADER) return false;
    const unsigned char *n = header + 80;
    *facets = n[0] | (uint64_t)n[1] << 8 | (uint64_t)n[2] << 16 | (uint64_t)n[3] << 24;
    return true;
}

/* What follows a word in the header, with four bytes at least; NULL: it is not there. */
static const unsigned char *behind(const unsigned char *header, const char *word)
{
    const size_t n = strlen(word);
    for (size_t i = 0; i + n + 4 <= 80; i++)
        if (memcmp(header + i, word, n) == 0) return header + i + n;
    return NULL;
}

/* True if bit 15 is set in some facets and not in others. Stands behind the facets. */
static bool has_bare(FILE *f, uint64_t facets)
{
    unsigned char b[FACET];
    bool is[2] = {false, false};
    if (fseek(f, HEADER, SEEK_SET) != 0) return false;
    while (facets-- && !(is[0] && is[1]) && fread(b, 1, FACET, f) == FACET) is[b[49] >> 7] = true;
    return is[0] && is[1];
}

/* The count of a text would be that of more bytes than a file may have. */
void mesh_stl_find(struct mesh *m, FILE *f)
{
    unsigned char header[HEADER];
    uint64_t facets;
    const char *suffix = strrchr(m->path, '.');
    if (!read_header(f, header, &facets) || !facets || fseek(f, 0, SEEK_END) != 0) return;
    const uint64_t size = (uint64_t)ftell(f), whole = HEADER + FACET * facets;
    const bool named = (suffix && strcasecmp(suffix, ".stl") == 0) ||
                       strncasecmp((const char *)header, "solid", 5) == 0;
    if (size < whole || (size > whole && !named)) return;
    const bool odd = size > whole || behind(header, "COLOR=") || has_bare(f, facets);
    m->stl = odd ? MESH_STL_ODD : MESH_STL_BYTES;
    m->lost_bytes = size - whole;
}

/* Colours that are all 0 are none. */
static bool has_colours(FILE *f, uint64_t facets)
{
    unsigned char b[FACET];
    while (facets-- && fread(b, 1, FACET, f) == FACET)
        if (b[48] || b[49]) return true;
    return false;
}

#define WHITE 0xffffU

static unsigned fifth(unsigned char byte) { return (byte * 31U + 127) / 255; }

void mesh_stl_copy(FILE *from, FILE *to)
{
    unsigned char header[HEADER], b[FACET];
    uint64_t facets;
    if (!read_header(from, header, &facets)) return;
    const unsigned char *all = behind(header, "MATERIAL="), *colour = behind(header, "COLOR=");
    if (!all) all = colour;
    const bool own = colour && has_colours(from, facets), bare = !colour && has_bare(from, facets);
    unsigned same = 0;
    if (colour) same = 0x8000 | fifth(all[0]) << 10 | fifth(all[1]) << 5 | fifth(all[2]);
    if (colour) header[colour - header - 1] = ' '; /* the = */
    fwrite(header, 1, HEADER, to);
    fseek(from, HEADER, SEEK_SET);
    while (facets-- && fread(b, 1, FACET, from) == FACET) {
        unsigned c = b[48] | (unsigned)b[49] << 8;
        if (own && !(c & 0x8000)) c = 0x8000 | (c & 31) << 10 | (c & 0x3e0) | (c >> 10 & 31);
        else if (colour) c = same;
        else if (bare && !(c & 0x8000)) c = WHITE;
        b[48] = (unsigned char)c, b[49] = (unsigned char)(c >> 8);
        fwrite(b, 1, FACET, to);
    }
}
