/*
 * store: the pixels of one frame, each with its source. Private to lib/image.
 *
 * A frame is kept in memory, or in pages in a file without a name, of which the last used are in
 * memory. Pixels that were never set are transparent black.
 */
#ifndef STORMRING_IMAGE_STORE_H
#define STORMRING_IMAGE_STORE_H

#include "image/image.h"

#define STORE_PAGE 2048 /* pixels: 36 KiB */

struct store;

/* Pixels that lie together in memory. */
struct store_span {
    uint64_t first, end; /* pixels first .. end - 1 */
    float *rgba;         /* of `first`: 4 floats for each pixel */
    uint16_t *source;
};

/*
 * A frame in memory. With dir: in a file in that directory, which ends with the process, and with
 * at most `pages` pages in memory. Disk space for all pixels is reserved, if the file system can
 * do that. NULL with errno: the file cannot be made.
 */
struct store *store_new(uint32_t w, uint32_t h, const char *dir, uint32_t pages);
void store_free(struct store *s); /* NULL: nothing */
/* Finds the pixels around p. They are valid until the next call of a function with s. change: the
 * caller may set them. Returns 0, or -1 with errno: they cannot be read, or others not written. */
int store_at(struct store *s, uint64_t p, bool change, struct store_span *at);
/* Row y, or NULL with errno. Valid until the next call of a function with s. */
const float *store_row(struct store *s, uint32_t y);
/* Bytes of memory and of disk that such a store needs. */
uint64_t store_memory(uint32_t w, uint32_t h, bool in_file, uint32_t pages);
uint64_t store_disk(uint32_t w, uint32_t h);

#endif
