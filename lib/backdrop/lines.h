/* lines: lines and areas, read from text and kept. Private to lib/backdrop. */
#ifndef STORMRING_BACKDROP_LINES_H
#define STORMRING_BACKDROP_LINES_H

#include "backdrop/outline.h"

enum lines_kind {
    LINES_OPEN,
    LINES_LAND,
    LINES_WATER,
    LINES_GLOBE, /* this one and the next two have no points */
    LINES_PLANE,
    LINES_HEIGHT,
    LINES_TEXT,
    LINES_MARK
};

#define LINES_HEIGHTS 100
struct lines_part {
    struct outline o;
    enum lines_kind kind;
    bool seen;   /* an area, in the last picture; others always */
    bool bare;   /* an area without its outline, which other parts are */
    size_t text; /* where its text or name begins, for LINES_TEXT and LINES_MARK */
    size_t n_at; /* of LINES_MARK: its points in the last picture */
    int level;   /* 0: on the map; otherwise at height[level - 1] */
};
struct backdrop_lines {
    struct lines_part *part; /* grown by xgrown */
    size_t n;
    struct buf text;       /* each ends with a byte 0 */
    struct lines_part now; /* being read */
    bool flat, globe;      /* on a plane; all lines from here on are on the globe */
    int level;             /* likewise */
    struct plane *plane;   /* NULL: not known, or not flat: no_plane says why not */
    char no_plane[BACKDROP_ERR];
    double height[LINES_HEIGHTS];
    int n_heights;
    double z[2]; /* the heights of the grid */
    char no_height[BACKDROP_ERR];
};
static inline const char *lines_text(const struct backdrop_lines *l, const struct lines_part *p)
{
    return (const char *)buf_data(&l->text) + p->text;
}

/* That on which the lines are; NULL: not known, or the map is in degrees. */
const struct plane *lines_plane(const struct backdrop_lines *l);
/* These take what is at the level of s. Adds the areas to the list; later areas cover earlier ones.
 */
void lines_fill(const struct drawing *s, struct backdrop_lines *l);
/* Adds lines, and outlines of the areas that lines_fill found visible, to the list's last mark. */
void lines_stroke(const struct drawing *s, const struct backdrop_lines *l);
/* Adds a disc for each point of a mark, and its name where there is room. (place.c) */
void lines_mark(const struct drawing *s, struct backdrop_lines *l);
/* Adds lines with a text, and the text in gaps of them. (number.c) */
void lines_write(const struct drawing *s, const struct backdrop_lines *l);
#define LINES_TEXTS 1000 /* in a picture: more cannot be read */

#endif
