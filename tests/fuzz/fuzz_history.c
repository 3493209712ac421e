/*
 * Whatever the log: its tables agree with each other, every pixel that is there is found again, and
 * reading from a file tells no more than reading in memory, where bodies are not summed at first.
 * Frames too large for a search of many inputs are left alone.
 */
#include "history/history.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define PIXELS_MOST (1 << 18) /* of all frames */

#define MUST(x)                                                                                    \
    do {                                                                                           \
        if (!(x)) fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #x), abort();   \
    } while (0)

/* Of the frames that are found, with bodies summed or not. */
static uint64_t pixels_of(unsigned char *p, size_t n, bool unsummed)
{
    struct decoder d = wire_over(p, n);
    struct record r;
    uint64_t pixels = 0;
    d.upward = true;
    d.unsummed = unsummed;
    for (enum wire_result got; (got = wire_next(&d, &r)) != WIRE_MORE;)
        if (got == WIRE_RECORD && r.kind == REC_FRAME) pixels += (uint64_t)r.frame_w * r.frame_h;
    return pixels;
}

static void check_tables(const struct history *h)
{
    uint64_t pixels = 0, have = 0;
    for (size_t i = 0; i < h->n_dones; i++) {
        const struct history_done *d = &h->dones[i];
        MUST(d->run >= 0 && (size_t)d->run < h->n_runs && d->slot >= 0);
        MUST((size_t)d->slot < h->n_slots && d->before < (int32_t)i && d->before >= -1);
        MUST(d->pixels <= d->sent && d->try >= 1 && d->cpu_us >= 0);
        MUST(i == 0 || d->run >= h->dones[i - 1].run);
        pixels += d->pixels;
    }
    for (size_t i = 0; i < h->n_frames; i++) {
        have += h->frames[i].have.done;
        MUST(history_frame_of(h, h->frames[i].number) == &h->frames[i]);
    }
    MUST(pixels <= have);
    for (size_t i = 0; i < h->n_runs; i++) MUST(h->runs[i].slots >= 1);
}

static void check_pixels(struct history *h)
{
    for (size_t k = 0; k < h->n_frags; k++) {
        struct history_frag *frag = &h->frags[k];
        const struct history_frame *f = history_frame_of(h, frag->frame);
        MUST(f && lattice_valid(&frag->at, f->w, f->h));
        MUST(frag->bytes == lattice_count(&frag->at) * WIRE_PIXEL_BYTES);
        struct history_frag *same = history_frag_at(h, f, &frag->at);
        MUST(same && same <= frag && memcmp(&same->at, &frag->at, sizeof frag->at) == 0);
        history_frag_intact(frag);
    }
    for (size_t i = 0; i < h->n_frames; i++) {
        const struct history_frame *f = &h->frames[i];
        for (uint64_t p = 0; p < (uint64_t)f->w * f->h; p++) {
            struct history_place at = history_place_of(h, f, p);
            MUST((at.frag >= 0) == coverage_has(&f->have, p));
            if (at.frag < 0) continue;
            const struct history_frag *frag = &h->frags[at.frag];
            MUST(frag->frame == f->number && at.n < lattice_count(&frag->at));
            MUST(lattice_pixel(&frag->at, f->w, at.n) == p);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    unsigned char *copy = xmalloc(size + 1, 1);
    memcpy(copy, data, size);
    if (pixels_of(copy, size, true) + pixels_of(copy, size, false) <= PIXELS_MOST) {
        struct history over = {0}, read = {0};
        char err[HISTORY_ERR];
        history_read_bytes(&over, copy, size);
        check_tables(&over);
        check_pixels(&over);
        int fd = memfd_create("log", MFD_CLOEXEC);
        MUST(fd >= 0 && write_full(fd, data, size) == 0 && lseek(fd, 0, SEEK_SET) == 0);
        MUST(history_read(&read, fd) == 0);
        close(fd);
        check_tables(&read);
        if (over.bad && !over.refused)
            MUST(read.n_dones == over.n_dones && read.n_frags == over.n_frags);
        history_same(&over, &read, err);
        history_free(&over);
        history_free(&read);
    }
    free(copy);
    return 0;
}
