/* Untrusted text and bytes in a web page: see html.h. */
#include "html/html.h"

#include <string.h>

void html_text(struct buf *out, const char *s, size_t n)
{
    for (size_t i = 0, k; i < n; i += k) {
        k = utf8_shown(s + i, n - i);
        switch (s[i]) {
        case '<': buf_printf(out, "&lt;"); break;
        case '>': buf_printf(out, "&gt;"); break;
        case '&': buf_printf(out, "&amp;"); break;
        case '"': buf_printf(out, "&quot;"); break;
        case '\'': buf_printf(out, "&#39;"); break;
        case '\n': buf_append(out, "\n", k = 1); break;
        default:
            if (k) buf_append(out, s + i, k);
            else buf_append(out, "\xef\xbf\xbd", 3), k = 1; /* U+FFFD */
        }
    }
}

void html_word(struct buf *out, const char *s) { html_text(out, s, strlen(s)); }

void html_base64(struct buf *out, const unsigned char *p, size_t n)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    buf_reserve(out, n / 3 * 4 + 4);
    for (size_t i = 0; i < n; i += 3) {
        uint32_t v = (uint32_t)p[i] << 16;
        if (i + 1 < n) v |= (uint32_t)p[i + 1] << 8;
        if (i + 2 < n) v |= p[i + 2];
        char four[4] = {digit[v >> 18], digit[v >> 12 & 63], i + 1 < n ? digit[v >> 6 & 63] : '=',
            i + 2 < n ? digit[v & 63] : '='};
        buf_append(out, four, 4);
    }
}
