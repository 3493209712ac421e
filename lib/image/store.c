/* store: pixels in memory, or in a file with pages in memory: see store.h. */
#include "image/store.h"
#include "os/os.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RGBA_BYTES ((size_t)STORE_PAGE * 4 * sizeof(float))
#define SOURCE_BYTES ((size_t)STORE_PAGE * sizeof(uint16_t))
#define PAGE_BYTES (RGBA_BYTES + SOURCE_BYTES)

/* A place in memory for a page. */
struct slot {
    uint32_t page;
    bool full;    /* it has a page */
    bool used;    /* since the hand passed */
    bool changed; /* since it was read or written */
};

struct store {
    uint32_t w;
    uint64_t pixels;
    float *rgba; /* of all pixels, or slot by slot */
    uint16_t *source;

    /* of a store in a file */
    int fd; /* -1: all pixels are in memory */
    struct slot *slots;
    uint32_t n_slots, hand;
    uint32_t *slot_of; /* by page: the index of its slot, + 1; 0: none */
    bool *saved;       /* by page: it is in the file */
    float *row;        /* for store_row */
};

static uint64_t pages_of(uint64_t pixels) { return (pixels + STORE_PAGE - 1) / STORE_PAGE; }

uint64_t store_memory(uint32_t w, uint32_t h, bool in_file, uint32_t pages)
{
    uint64_t pixels = (uint64_t)w * h;
    if (!in_file) return pixels * (4 * sizeof(float) + sizeof(uint16_t));
    return (uint64_t)pages * (PAGE_BYTES + sizeof(struct slot)) +
           pages_of(pixels) * (sizeof(uint32_t) + sizeof(bool)) + (uint64_t)w * 4 * sizeof(float);
}

uint64_t store_disk(uint32_t w, uint32_t h) { return pages_of((uint64_t)w * h) * PAGE_BYTES; }

/* A file in `dir` without a name, with disk space for n bytes; -1 with errno. */
static int nameless(const char *dir, uint64_t n)
{
    struct buf name = {0};
    buf_printf(&name, "%s/stormring-pixels.XXXXXX", dir);
    buf_append(&name, "", 1);
    char *path = xstrdup((const char *)buf_data(&name));
    buf_free(&name);
    int fd = os_temporary(path), why = errno;
    if (fd >= 0) unlink(path);
    free(path);
    const int failed = fd < 0 ? 0 : posix_fallocate(fd, 0, (off_t)n);
    if (failed && failed != EINVAL && failed != EOPNOTSUPP && failed != ENOSYS) {
        why = failed;
        close(fd);
        fd = -1;
    }
    errno = why;
    return fd;
}

struct store *store_new(uint32_t w, uint32_t h, const char *dir, uint32_t pages)
{
    uint64_t pixels = (uint64_t)w * h, n = pages_of(pixels);
    int fd = dir ? nameless(dir, store_disk(w, h)) : -1;
    if (dir && fd < 0) return NULL;
    struct store *s = xcalloc(1, sizeof *s);
    *s = (struct store){.w = w, .pixels = pixels, .fd = fd};
    uint64_t room = dir ? (uint64_t)pages * STORE_PAGE : pixels;
    s->rgba = xcalloc(room, 4 * sizeof *s->rgba);
    s->source = xmalloc(room, sizeof *s->source);
    if (!dir) return s;
    s->n_slots = pages;
    s->slots = xcalloc(pages, sizeof *s->slots);
    s->slot_of = xcalloc(n, sizeof *s->slot_of);
    s->saved = xcalloc(n, sizeof *s->saved);
    s->row = xmalloc((size_t)w * 4, sizeof *s->row);
    return s;
}

void store_free(struct store *s)
{
    if (!s) return;
    if (s->fd >= 0) close(s->fd);
    free(s->rgba);
    free(s->source);
    free(s->slots);
    free(s->slot_of);
    free(s->saved);
    free(s->row);
    free(s);
}

/* Reads the page of slot i, or writes it. Returns 0, or -1 with errno. */
static int transfer(struct store *s, uint32_t i, bool out)
{
    off_t from = (off_t)(s->slots[i].page * PAGE_BYTES);
    unsigned char *part[2] = {(unsigned char *)(s->rgba + (size_t)i * STORE_PAGE * 4),
        (unsigned char *)(s->source + (size_t)i * STORE_PAGE)};
    for (size_t done = 0; done < PAGE_BYTES;) {
        const bool first = done < RGBA_BYTES;
        unsigned char *at = first ? part[0] + done : part[1] + (done - RGBA_BYTES);
        const size_t n = (first ? RGBA_BYTES : PAGE_BYTES) - done;
        ssize_t k = out ? pwrite(s->fd, at, n, from + (off_t)done)
                        : pread(s->fd, at, n, from + (off_t)done);
        if (k < 0 && errno == EINTR) continue;
        if (k == 0) errno = EIO; /* the file was cut */
        if (k <= 0) return -1;
        done += (size_t)k;
    }
    return 0;
}

/*
 * A slot for another page, by the clock algorithm (F. J. Corbato, "A paging experiment with the
 * Multics system", 1968). Returns false with errno if the page there cannot be written.
 */
static bool make_free(struct store *s, uint32_t *free_slot)
{
    for (;; s->hand = (s->hand + 1) % s->n_slots) {
        struct slot *slot = &s->slots[s->hand];
        if (!slot->full) break;
        if (slot->used) {
            slot->used = false;
            continue;
        }
        if (slot->changed && transfer(s, s->hand, true) != 0) return false;
        if (slot->changed) s->saved[slot->page] = true;
        s->slot_of[slot->page] = 0;
        slot->full = false;
        break;
    }
    *free_slot = s->hand;
    s->hand = (s->hand + 1) % s->n_slots;
    return true;
}

/* The slot of a page, which is read if it has none. Returns false with errno. */
static bool find_slot(struct store *s, uint32_t page, uint32_t *at)
{
    if (s->slot_of[page]) {
        *at = s->slot_of[page] - 1;
        return true;
    }
    if (!make_free(s, at)) return false;
    s->slots[*at] = (struct slot){.page = page};
    if (!s->saved[page]) memset(s->rgba + (size_t)*at * STORE_PAGE * 4, 0, RGBA_BYTES);
    else if (transfer(s, *at, false) != 0) return false;
    s->slots[*at].full = true;
    s->slot_of[page] = *at + 1;
    return true;
}

int store_at(struct store *s, uint64_t p, bool change, struct store_span *at)
{
    *at = (struct store_span){.end = s->pixels, .rgba = s->rgba, .source = s->source};
    if (s->fd < 0) return 0;
    uint32_t page = (uint32_t)(p / STORE_PAGE), slot;
    if (!find_slot(s, page, &slot)) return -1;
    s->slots[slot].used = true;
    s->slots[slot].changed |= change;
    at->first = (uint64_t)page * STORE_PAGE;
    if (s->pixels > at->first + STORE_PAGE) at->end = at->first + STORE_PAGE;
    at->rgba += (size_t)slot * STORE_PAGE * 4;
    at->source += (size_t)slot * STORE_PAGE;
    return 0;
}

const float *store_row(struct store *s, uint32_t y)
{
    uint64_t p = (uint64_t)y * s->w, end = p + s->w;
    if (s->fd < 0) return s->rgba + 4 * p;
    for (float *to = s->row; p < end;) {
        struct store_span at;
        if (store_at(s, p, false, &at) != 0) return NULL;
        uint64_t n = (at.end < end ? at.end : end) - p;
        memcpy(to, at.rgba + 4 * (p - at.first), n * 4 * sizeof *to);
        to += 4 * n;
        p += n;
    }
    return s->row;
}
