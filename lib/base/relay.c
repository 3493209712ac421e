/* relay: prints a line from another program as a message. */
#include "base/base.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void relay(const char *who, const char *text, size_t n)
{
    char name[256];
    struct buf b = {0};
    text_shown(name, sizeof name, who);
    for (size_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)text[i];
        if ((c >= ' ' && c <= '~') || c == '\t') buf_append(&b, &c, 1);
        else buf_printf(&b, "\\x%02x", c);
    }
    fprintf(stderr, "%s: %.*s\n", name, (int)buf_size(&b), (const char *)buf_data(&b));
    buf_free(&b);
}

void relay_line(const char *line)
{
    const size_t room = 4 * strlen(line) + 1;
    char *shown = xmalloc(room, 1);
    text_shown(shown, room, line);
    fprintf(stderr, "%s\n", shown);
    free(shown);
}
