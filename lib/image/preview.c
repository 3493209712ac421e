/* preview: files of pictures that are not complete; see image.h. */
#include "image/image.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Previews take at most this share of the time, because gather does not read meanwhile. */
#define SHARE 0.1

void image_preview_start(struct image_preview *p, const struct image_out *out, double every_s)
{
    *p = (struct image_preview){.out = out, .every_us = (int64_t)(every_s * 1e6)};
    p->due_us = now_us() + p->every_us;
}

char *image_preview_name(const struct image_out *out, uint32_t frame)
{
    char *whole = image_out_name(out, frame);
    size_t n = strlen(whole), suffix = n - 4; /* all suffixes have three letters */
    char *name = xmalloc(n + sizeof ".partial", 1);
    snprintf(name, n + sizeof ".partial", "%.*s.partial%s", (int)suffix, whole, whole + suffix);
    free(whole);
    return name;
}

int image_preview_wait_ms(const struct image_preview *p, const struct assembly *a)
{
    if (!p->every_us || a->done_px == p->shown_px) return -1;
    int64_t left_us = p->due_us - now_us();
    return left_us > 0 ? (int)(left_us / 1000) + 1 : 0;
}

char *image_preview_put(struct image_preview *p, const struct assembly *a)
{
    char *failed = NULL;
    int64_t begin_us = now_us();
    for (uint32_t i = 0; i < a->n_frames && !failed; i++) {
        struct assembly_frame *f = a->frames[i];
        if (f->released || !f->pixels || f->shown_px == f->have.done) continue;
        char *name = image_preview_name(p->out, f->number);
        const struct image_rows rows = assembly_rows(f);
        if (image_out_put(p->out, f->number, name, &rows, f->job) != 0) failed = name;
        else free(name);
        f->shown_px = f->have.done;
    }
    int64_t now = now_us(), rest_us = (int64_t)((double)(now - begin_us) * (1 / SHARE - 1));
    p->due_us = now + (rest_us > p->every_us ? rest_us : p->every_us);
    p->shown_px = a->done_px;
    if (failed) p->every_us = 0;
    return failed;
}

void image_preview_remove(const struct image_preview *p, uint32_t frame)
{
    char *name = image_preview_name(p->out, frame);
    unlink(name);
    free(name);
}
