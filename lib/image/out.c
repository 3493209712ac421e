/* out: where pictures go, numbered files or standard output; see image.h. */
#include "image/image.h"

#include <stdlib.h>
#include <string.h>

int image_opt_bits(int opt, const char *s)
{
    if (strcmp(s, "8") == 0) return 8;
    if (strcmp(s, "16") == 0) return 16;
    die(ST_USAGE, "-%c %s: expected 8 or 16", opt, s);
}

void image_out_check(struct image_out *o)
{
    o->naming = IMAGE_NAME_SINGLE;
    o->format = IMAGE_PNG;
    if (!o->pattern) return;
    if (!image_format_of(o->pattern, &o->format))
        die(ST_USAGE, "%s: unknown suffix, expected .png, .pam or .pfm", o->pattern);
    o->naming = image_name_check(o->pattern);
    if (o->naming == IMAGE_NAME_BAD)
        die(ST_USAGE,
            "%s: bad pattern, expected one %%d or %%03d at most, and %%%% for a percent sign",
            o->pattern);
    if (outfile_check(o->pattern) != 0) die(ST_SYSTEM, "%s:", o->pattern);
}

char *image_out_name(const struct image_out *o, uint32_t frame)
{
    return o->pattern ? image_name(o->pattern, frame) : xstrdup("standard output");
}

char *image_out_spill(const struct image_out *o, uint32_t frame)
{
    const char *chosen = getenv("TMPDIR");
    if (chosen && *chosen) return xstrdup(chosen);
    if (!o->pattern) return xstrdup("/var/tmp");
    char *name = image_out_name(o, frame), *slash = strrchr(name, '/');
    if (slash) {
        slash[slash == name] = '\0';
        return name;
    }
    free(name);
    return xstrdup(".");
}

int image_out_put(const struct image_out *o, uint32_t frame, const char *name,
    const struct image_rows *rows, const char *job)
{
    const struct image_rows all = image_backs_under(o->backs, frame, rows);
    if (o->pattern) return image_save_rows(name, &all, o->format, o->bits, job);
    int failed = image_write_rows(stdout, &all, o->format, o->bits, job);
    return failed || fflush(stdout) ? -1 : 0;
}
