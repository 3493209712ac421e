/*
 * Words for the login shell of a host. Within single quotes csh and tcsh replace `!`, and fish
 * takes a backslash for a quote; outside of them a backslash quotes both in every shell. A newline
 * needs a backslash within the quotes of csh, which other shells keep: so it travels as an octal
 * number.
 */
#include "hosts/hosts_int.h"

#include <string.h>

/* For sh. It has no byte that csh or fish change within single quotes. */
static const char restore[] =
    "for w do shift; w=$(printf %b. \"$w\"); set -- \"$@\" \"${w%.}\"; done; exec \"$@\"";

void hosts_add_word(struct buf *b, const char *word)
{
    static const char outside[] = "!\\'";
    if (!strpbrk(word, outside) && *word != '%') { /* fish replaces %self */
        buf_word(b, word);
        return;
    }
    while (*word) {
        size_t n = strcspn(word, outside);
        if (n) buf_append(b, "'", 1);
        buf_append(b, word, n);
        if (n) buf_append(b, "'", 1);
        word += n;
        for (; *word && strchr(outside, *word); word++) buf_printf(b, "\\%c", *word);
    }
}

static bool is_control(char c) { return (c > 0 && c < ' ') || c == 127; }

static bool has_control(const char *word)
{
    while (*word && !is_control(*word)) word++;
    return *word;
}

/* The word as printf(1) reads it for %b. */
static char *numbered(const char *word)
{
    struct buf b = {0};
    for (; *word; word++) {
        if (is_control(*word) || *word == '\\') buf_printf(&b, "\\0%03o", (unsigned)*word);
        else buf_append(&b, word, 1);
    }
    buf_append(&b, "", 1);
    return (char *)b.data;
}

char **hosts_plain_words(char *const worker[])
{
    static const char *const first[] = {"sh", "-c", restore, "sh"};
    const size_t before = sizeof first / sizeof *first;
    size_t n = 0;
    bool any = false;
    for (; worker[n]; n++) any |= has_control(worker[n]);
    if (!any) return NULL;
    char **words = xcalloc(before + n + 1, sizeof *words);
    for (size_t i = 0; i < before; i++) words[i] = xstrdup(first[i]);
    for (size_t i = 0; i < n; i++) words[before + i] = numbered(worker[i]);
    return words;
}
