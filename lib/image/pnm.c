/*
 * pnm: the Netpbm formats: reads PAM (P7), PPM (P6) and PGM (P5), writes PAM. One picture per file.
 * Samples up to 255 hold sRGB, larger ones linear light, or what the reader says, as image.h
 * defines; Netpbm leaves this open.
 */
#include "image/codecs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct header {
    int64_t w, h, channels, max;
    size_t size; /* bytes of the header; the pixels start there */
};

/* Text being read; at <= n. */
struct text {
    const unsigned char *p;
    size_t n, at;
};

static bool blank(unsigned char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* Reads the next word after comments and blanks. False at the end, or if the word is too long. */
static bool word(struct text *t, char *out, size_t size)
{
    while (t->at < t->n && (blank(t->p[t->at]) || t->p[t->at] == '#')) {
        if (t->p[t->at] == '#')
            while (t->at < t->n && t->p[t->at] != '\n') t->at++;
        else t->at++;
    }
    size_t k = 0;
    while (t->at < t->n && !blank(t->p[t->at])) {
        if (k + 1 == size) return false;
        out[k++] = (char)t->p[t->at++];
    }
    out[k] = '\0';
    return k > 0 && t->at < t->n; /* every word of a header is followed by a blank */
}

static bool number(struct text *t, int64_t max, int64_t *out)
{
    char w[24];
    return word(t, w, sizeof w) && parse_int(w, 1, max, out);
}

/* CMYK has as many channels as RGB_ALPHA. */
static bool tuple_type(struct text *t)
{
    char type[24];
    return word(t, type, sizeof type) && strncmp(type, "CMYK", 4) != 0;
}

/* WIDTH 4, DEPTH 3, ... in any order until ENDHDR. Of TUPLTYPE only CMYK is refused: DEPTH
 * determines the channels. */
static bool pam_header(struct text *t, struct header *h)
{
    char key[24];
    while (word(t, key, sizeof key)) {
        bool ok = true;
        if (strcmp(key, "ENDHDR") == 0) return h->w && h->h && h->channels && h->max;
        if (strcmp(key, "WIDTH") == 0) ok = number(t, FRAME_SIDE_MAX, &h->w);
        else if (strcmp(key, "HEIGHT") == 0) ok = number(t, FRAME_SIDE_MAX, &h->h);
        else if (strcmp(key, "DEPTH") == 0) ok = number(t, 4, &h->channels);
        else if (strcmp(key, "MAXVAL") == 0) ok = number(t, 65535, &h->max);
        else if (strcmp(key, "TUPLTYPE") == 0) ok = tuple_type(t);
        else ok = false;
        if (!ok) return false;
    }
    return false;
}

static bool read_header(const unsigned char *p, size_t n, struct header *h)
{
    struct text t = {p, n, 2};
    *h = (struct header){0};
    if (p[1] == '7') {
        if (!pam_header(&t, h)) return false;
    } else {
        h->channels = p[1] == '6' ? 3 : 1;
        if (!number(&t, FRAME_SIDE_MAX, &h->w) || !number(&t, FRAME_SIDE_MAX, &h->h) ||
            !number(&t, 65535, &h->max))
            return false;
    }
    h->size = t.at + 1; /* one blank ends it */
    return true;
}

int pnm_decode(const unsigned char *p, size_t n, const struct image_part *part, struct image *im,
    char err[IMAGE_ERR])
{
    struct header h;
    if (!read_header(p, n, &h))
        return image_fail(err,
            "damaged P%c header, expected sides from 1 to %d, 1 to 4 channels, "
            "maximum 1 to 65535, no CMYK",
            p[1], FRAME_SIDE_MAX);
    uint32_t width = (uint32_t)h.w, height = (uint32_t)h.h;
    if (!image_size_ok(width, height, err)) return -1;
    size_t row = (size_t)(h.w * h.channels * (h.max > 255 ? 2 : 1)), all = row * height;
    if (n - h.size != all)
        return image_fail(err, "%zu bytes of pixels, expected %zu", n - h.size, all);
    struct sampler s;
    double curve;
    if (!sampler_curve(part, h.max > 255, &curve, err)) return -1;
    sampler_init(&s, (uint32_t)h.max, curve);
    image_init(im, width, height);
    bool ok = true;
    for (uint32_t y = 0; y < height && ok; y++)
        ok = !image_wants(part, im, y) || sampler_row(&s, p + h.size + row * y, (int)h.channels,
                                              width, im->rgba + (size_t)4 * width * y);
    sampler_free(&s);
    if (ok) return 0;
    image_free(im);
    return image_fail(err, "a sample above the maximum, expected at most %lld", (long long)h.max);
}

int pam_encode(FILE *f, const struct image_rows *rows, int bits)
{
    struct quantizer q;
    quantizer_init(&q, rows->opaque, bits);
    size_t row = quantizer_row_bytes(&q, rows->w);
    fprintf(f, "P7\nWIDTH %u\nHEIGHT %u\nDEPTH %d\nMAXVAL %d\nTUPLTYPE %s\nENDHDR\n", rows->w,
        rows->h, q.channels, bits == 8 ? 255 : 65535, q.channels == 4 ? "RGB_ALPHA" : "RGB");
    unsigned char *out = xmalloc(row, 1);
    bool ok = true;
    for (uint32_t y = 0; y < rows->h && ok; y++) {
        const float *rgba = rows->row(rows, y);
        if (rgba) quantizer_row(&q, rgba, rows->w, out);
        ok = rgba && fwrite(out, 1, row, f) == row;
    }
    int why = errno;
    free(out);
    errno = why;
    return ok ? 0 : -1;
}
