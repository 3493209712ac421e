/*
 * html: untrusted text and bytes in a web page.
 */
#ifndef STORMRING_HTML_H
#define STORMRING_HTML_H

#include "base/base.h"

/*
 * Appends n bytes as text, for an element or for an attribute in quotes. Control characters except
 * newlines, and bytes that are no UTF-8, become U+FFFD: XML has neither.
 */
void html_text(struct buf *out, const char *s, size_t n);
void html_word(struct buf *out, const char *s);
/* Appends n bytes in base64 (RFC 4648), in one line. */
void html_base64(struct buf *out, const unsigned char *p, size_t n);

#endif
