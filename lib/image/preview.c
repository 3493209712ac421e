/* preview: files of pictures that are not complete; see image.h. */
#include "image/image.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Previews take at most this share of the time, because gather does not read meanwhile. */
#define SHARE 0.1

void image_preview_start(struct image_preview *p, const struct image_out *out, double every_s)
{
    *p = (struct image_preview){.out = out, .every_us = (int64_t)(every_s * 1e6)};
    p->due_us = now_us() + p->every_us;
}

char *image_preview_name(const char *whole)
{
    size_t n = strlen(whole), suffix = n - 4; /* all suffixes have three letters */
    char *name = xmalloc(n + sizeof ".partial", 1);
    snprintf(name, n + sizeof ".partial", "%.*s.partial%s", (int)suffix, whole, whole + suffix);
    return name;
}

static char *name_of(const struct image_preview *p, const struct assembly_frame *f)
{
    char *whole = image_out_name(p->out, f->number), *name = image_preview_name(whole);
    free(whole);
    return name;
}

/* False if a file that no gather wrote would be lost: a picture of another width, or without a job.
 */
static bool may_replace(
    const struct image_preview *p, const char *name, const struct assembly_frame *f)
{
    static const char job[] = "tEXtJob";
    char begin[1024], size[64];
    struct stat st;
    if (stat(name, &st) != 0 || !S_ISREG(st.st_mode)) return true;
    int fd = open(name, O_RDONLY | O_CLOEXEC);
    ssize_t n = fd < 0 ? 0 : read(fd, begin, sizeof begin);
    if (fd >= 0) close(fd);
    if (p->out->format == IMAGE_PNG) return n > 0 && text_find(begin, (size_t)n, job, sizeof job);
    int bytes = snprintf(size, sizeof size,
        p->out->format == IMAGE_PAM ? "P7\nWIDTH %" PRIu32 "\n" : "PF\n%" PRIu32 " ", f->have.w);
    return n >= bytes && memcmp(begin, size, (size_t)bytes) == 0;
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
        char *name = name_of(p, f);
        const struct image_rows rows = assembly_rows(f);
        bool may = f->shown_px || may_replace(p, name, f);
        if (!may) errno = EEXIST;
        if (!may || image_out_put(p->out, f->number, name, &rows, f->job) != 0) failed = name;
        else free(name);
        if (!failed) f->shown_px = f->have.done;
    }
    int64_t now = now_us(), rest_us = (int64_t)((double)(now - begin_us) * (1 / SHARE - 1));
    p->due_us = now + (rest_us > p->every_us ? rest_us : p->every_us);
    p->shown_px = a->done_px;
    if (failed) p->every_us = 0;
    return failed;
}

void image_preview_remove(const struct image_preview *p, const struct assembly_frame *f)
{
    char *name = name_of(p, f);
    if (f->shown_px || may_replace(p, name, f)) unlink(name);
    free(name);
}
