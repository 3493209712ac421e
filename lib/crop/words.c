/* words: the command's words, with the rectangle's numbers put in. */
#include "crop/crop.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* What may stand between braces. */
struct value {
    const char *name;
    uint32_t number;
    const char *text; /* instead of the number */
};

/* The value that begins at s, as in "{x1}rest"; NULL: none does. *n: its bytes. */
static const struct value *value_at(const char *s, const struct value *values, size_t *n)
{
    if (*s != '{') return NULL;
    for (const struct value *v = values; v->name; v++) {
        *n = strlen(v->name) + 2;
        if (strncmp(s + 1, v->name, *n - 2) == 0 && s[*n - 1] == '}') return v;
    }
    return NULL;
}

bool crop_uses(char *const words[], const char *name)
{
    const struct value values[] = {{name, 0, NULL}, {0}};
    size_t n;
    for (; *words; words++)
        for (const char *s = *words; (s = strchr(s, '{')) != NULL; s++)
            if (value_at(s, values, &n)) return true;
    return false;
}

static char *word(const char *s, const struct value *values)
{
    struct buf b = {0};
    size_t n;
    for (const struct value *v; *s; s += n)
        if ((v = value_at(s, values, &n)) == NULL) buf_append(&b, s, n = 1);
        else if (v->text) buf_append(&b, v->text, strlen(v->text));
        else buf_printf(&b, "%" PRIu32, v->number);
    buf_append(&b, "", 1);
    char *made = xstrdup((const char *)buf_data(&b));
    buf_free(&b);
    return made;
}

char **crop_words(char *const words[], const struct crop_rect *at, const char *in, const char *out)
{
    const struct value values[] = {
        {"x", at->x, NULL},
        {"y", at->y, NULL},
        {"w", at->w, NULL},
        {"h", at->h, NULL},
        {"x1", at->x + 1, NULL},
        {"y1", at->y + 1, NULL},
        {"x2", at->x + at->w, NULL},
        {"y2", at->y + at->h, NULL},
        {"W", at->frame_w, NULL},
        {"H", at->frame_h, NULL},
        {"F", at->frame, NULL},
        {"i", 0, in ? in : "{i}"},
        {"o", 0, out ? out : "{o}"},
        {0},
    };
    size_t n = 0;
    while (words[n]) n++;
    char **made = xcalloc(n + 1, sizeof *made);
    for (size_t i = 0; i < n; i++) made[i] = word(words[i], values);
    return made;
}

void crop_words_free(char **words)
{
    for (char **w = words; *w; w++) free(*w);
    free(words);
}

void crop_words_hash(char *const words[], char hash[SHA256_TEXT])
{
    struct buf all = {0};
    for (; *words; words++) buf_append(&all, *words, strlen(*words) + 1);
    sha256(buf_data(&all), buf_size(&all), hash);
    buf_free(&all);
}
