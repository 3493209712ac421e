/* name: names of numbered pictures. The pattern comes from the user, so it is parsed here and never
 * passed to printf. */
#include "image/image.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH_MAX 99

/* Length of %d, %4d, %03d at s ('%' included); 0 if there is none. */
static size_t number_at(const char *s, char *fill, int *width)
{
    size_t n = 1;
    *fill = s[n] == '0' ? '0' : ' ';
    if (s[n] == '0') n++;
    for (*width = 0; s[n] >= '0' && s[n] <= '9'; n++) {
        *width = *width * 10 + (s[n] - '0');
        if (*width > WIDTH_MAX) return 0;
    }
    return s[n] == 'd' ? n + 1 : 0;
}

enum image_naming image_name_check(const char *pattern)
{
    int numbers = 0, width;
    char fill;
    for (const char *s = pattern; *s;) {
        size_t n = 1;
        if (s[0] == '%' && s[1] == '%') n = 2;
        else if (s[0] == '%' && (n = number_at(s, &fill, &width)) > 0) numbers++;
        if (!n) return IMAGE_NAME_BAD;
        s += n;
    }
    if (numbers > 1) return IMAGE_NAME_BAD;
    return numbers ? IMAGE_NAME_NUMBERED : IMAGE_NAME_SINGLE;
}

static void put_number(struct buf *b, uint32_t v, char fill, int width)
{
    char digits[12];
    int n = snprintf(digits, sizeof digits, "%" PRIu32, v);
    while (width-- > n) buf_append(b, &fill, 1);
    buf_append(b, digits, (size_t)n);
}

char *image_name(const char *pattern, uint32_t frame)
{
    struct buf b = {0};
    for (const char *s = pattern; *s;) {
        char fill;
        int width;
        size_t n = s[0] == '%' ? number_at(s, &fill, &width) : 0;
        if (n) {
            put_number(&b, frame, fill, width);
            s += n;
        } else {
            buf_append(&b, s, 1);
            s += s[0] == '%' && s[1] == '%' ? 2 : 1;
        }
    }
    buf_append(&b, "", 1);
    char *name = xstrdup((const char *)buf_data(&b));
    buf_free(&b);
    return name;
}

/* ---- the files that have such names ---------------------------------------------------------- */

/* The number in a name that the pattern, without directories, makes; -1: it makes no such name. */
static int64_t number_in(const char *pattern, const char *name)
{
    char fill, digits[12];
    int width;
    size_t same = 0;
    int64_t v = -1;
    const char *number = pattern;
    for (; *number && (number[0] != '%' || number[1] == '%'); same++)
        number += number[0] == '%' ? 2 : 1;
    const size_t n = strlen(name), skip = number_at(number, &fill, &width);
    char *rest = image_name(number + skip, 0);
    if (same + strlen(rest) < n) {
        const char *end = name + n - strlen(rest), *at = name + same;
        while (at + 1 < end && (*at == ' ' || *at == '0')) at++;
        snprintf(digits, sizeof digits, "%.*s", (int)(end - at), at);
        if (end - at >= (ptrdiff_t)sizeof digits || !parse_int(digits, 0, UINT32_MAX, &v)) v = -1;
    }
    free(rest);
    if (v < 0) return -1;
    char *made = image_name(pattern, (uint32_t)v);
    bool is = strcmp(made, name) == 0;
    free(made);
    return is ? v : -1;
}

void image_name_each(const char *pattern, image_name_file file)
{
    const char *slash = strrchr(pattern, '/'), *base = slash ? slash + 1 : pattern;
    struct buf dir = {0};
    buf_printf(&dir, "%.*s", slash ? (int)(base - pattern) : 1, slash ? pattern : ".");
    buf_append(&dir, "", 1);
    char *in = image_name((const char *)buf_data(&dir), 0);
    DIR *d = image_name_check(base) == IMAGE_NAME_NUMBERED ? opendir(in) : NULL;
    for (const struct dirent *e; d && (e = readdir(d)) != NULL;) {
        const int64_t v = number_in(base, e->d_name);
        if (v < 0) continue;
        char *name = image_name(pattern, (uint32_t)v);
        file(name);
        free(name);
    }
    if (d) closedir(d);
    free(in);
    buf_free(&dir);
}

void image_name_keep(const char *pattern, uint32_t first, uint32_t last)
{
    for (uint64_t v = first; v <= last; v++) {
        char *name = image_name(pattern, (uint32_t)v);
        input_keep(name);
        free(name);
    }
}
