/*
 * album: pictures in a table of views and times, and the page that shows them.
 *
 * Names and files are not trusted. Nothing here prints or dies. Call album_by_name or
 * album_in_turn, then album_load, then album_head, album_block for each picture, and album_foot.
 */
#ifndef STORMRING_ALBUM_H
#define STORMRING_ALBUM_H

#include "image/image.h"

/* Bytes of all pictures together: browsers hold a page of 4/3 of this. */
#define ALBUM_BYTES_MAX ((size_t)1 << 30)

struct album_picture {
    const char *path; /* the caller's */
    char *view, *time;
    struct buf png;
};

struct album {
    struct album_picture *pictures; /* view by view, and the times of each */
    size_t n_pictures, n_views, n_times;
    uint32_t w, h; /* pixels of each */
};

/*
 * Orders n >= 1 paths by their names. The last number of a file name is the time; the rest of the
 * path is the view, without the suffix and the directory that all paths have in common. Views and
 * times are in natural order. False with a message in err if a view lacks a time, or has it twice.
 * The caller frees the album, also then.
 */
bool album_by_name(struct album *a, char *const *paths, size_t n, char err[ERR_BYTES]);
/*
 * Orders n >= 1 paths by natural order alone: all views of time 0, then those of time 1, as
 * balance(1) numbers them. views: their number, or their names with commas between.
 */
bool album_in_turn(
    struct album *a, char *const *paths, size_t n, const char *views, char err[ERR_BYTES]);
/* Names the times of the table, in their order. False with a message in err if it has not n. */
bool album_name_times(struct album *a, char *const *names, size_t n, char err[ERR_BYTES]);
/* Reads the files: PNG of one size. */
bool album_load(struct album *a, char err[ERR_BYTES]);
void album_free(struct album *a);

/* Append parts of a page of HTML that needs no other file. It decodes only the picture it shows. */
void album_head(const struct album *a, const char *title, struct buf *out);
void album_block(const struct album *a, size_t i, struct buf *out);
void album_foot(struct buf *out);

#endif
