/*
 * image: pixel buffers; PNG (through libpng), PAM, PPM and PFM; metrics; assembly of pictures from
 * fragments.
 *
 * Pixels are linear light, premultiplied RGBA, float32, row 0 on top. In files, 8 bits hold sRGB
 * and 16 bits linear light (PNG marks it with gAMA 1). Alpha is written only if some pixel is not
 * opaque, and not premultiplied. PAM holds the same samples as PNG, uncompressed. PFM is float RGB,
 * bottom row first, without alpha.
 *
 * Files are untrusted: sizes are checked before memory is allocated, and all faults are returned as
 * text. The library keeps no state.
 */
#ifndef STORMRING_IMAGE_H
#define STORMRING_IMAGE_H

#include "base/base.h"
#include "task/task.h"

struct image {
    uint32_t w, h;
    float *rgba; /* 4 * w * h */
};

enum image_format { IMAGE_PNG, IMAGE_PAM, IMAGE_PFM };

#define IMAGE_ERR 256
/* Limit of pictures in files and in assembly: 4 GiB of pixels. */
#define IMAGE_PIXELS_MAX (UINT64_C(1) << 28)

void image_init(struct image *im, uint32_t w, uint32_t h); /* transparent black */
void image_free(struct image *im);
/* Chooses the format by suffix (.png .pam .pfm). False if it is none of them. */
bool image_format_of(const char *path, enum image_format *format);
/*
 * Reads a PNG (any kind), PAM, PPM, PGM or PFM, recognised by content; "-" is standard input. A PNG
 * with an sRGB chunk holds sRGB. With gAMA alone, its samples are a power of light, also that of
 * 1/2.2: POV-Ray and others write the sRGB chunk if they mean sRGB. A cICP goes before both, and
 * must say sRGB or linear light. Without any, and in PNM, samples of up to 8 bits hold sRGB, and
 * others linear light, but 16 bits with a profile are refused. Returns 0, or -1 with "what,
 * expected what" in err and nothing allocated.
 */
int image_read(const char *path, struct image *im, char err[IMAGE_ERR]);
/* Reads n bytes in memory. */
int image_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR]);
/* The same, but of a picture of size w x h only rows `first` to `end` - 1: the others stay
 * transparent black, and their memory is not touched. And what samples of more than 8 bits hold if
 * the file does not state it. */
enum image_deep { IMAGE_DEEP_LINEAR, IMAGE_DEEP_SRGB, IMAGE_DEEP_REFUSED };
struct image_part {
    uint32_t w, h, first, end;
    enum image_deep deep;
};
int image_decode_part(const unsigned char *p, size_t n, const struct image_part *part,
    struct image *im, char err[IMAGE_ERR]);
/*
 * Reads a PNG of at most `most` bytes, up to its end, into *b, without decoding its pixels. Checks
 * the header, and that all chunks are whole and their sums are right. Returns 0, or -1 as
 * image_read.
 */
int image_load_png(
    const char *path, size_t most, struct buf *b, uint32_t *w, uint32_t *h, char err[IMAGE_ERR]);
/* The same for the PNG at the begin of *n bytes in memory; sets *n to its bytes. */
int png_inspect(const unsigned char *p, size_t *n, uint32_t *w, uint32_t *h, char err[IMAGE_ERR]);
/* A picture that is read row by row, for pictures larger than memory. */
struct image_rows {
    uint32_t w, h;
    bool opaque; /* every alpha is at least 1 */
    /* Row y, in any order, 4 floats for each pixel; valid until the next call. NULL with errno: it
     * cannot be read. */
    const float *(*row)(const struct image_rows *rows, uint32_t y);
    void *ctx; /* for row */
};

struct image_rows image_rows_of(const struct image *im); /* valid as long as im */

/*
 * Backdrops: pictures under a picture, or over it, topmost first, composited row by row in linear
 * light. All have the width of the picture. The picture is at the top of the highest of them, and
 * lower ones are at its bottom. All zero at first.
 */
struct image_backs {
    struct image_back *back;
    int n, n_over; /* in all; over the picture */
    struct image_rows picture;
    float *line;
};
/* Adds the lowest one so far: a file, "-" for standard input, or, if numbered, a pattern for
 * image_name. Dies with status 2 if the file cannot be read. The name must stay. */
void image_backs_add(struct image_backs *b, const char *name, bool numbered);
/* Puts the uppermost ones that are as large as this picture under it, and frees them: they are at
 * the top with it, and not at the bottom. For files that were added without a number. */
void image_backs_blend(struct image_backs *b, struct image *over);
/* Adds the file, or the pattern if it has a %, that is the argument of option `-opt`, over the
 * picture or under it; dies with status 2 if it is bad. */
void image_opt_back(int opt, const char *name, bool over, struct image_backs *b);
void image_backs_free(struct image_backs *b);
/* Picture number `frame` with its backdrops, valid until the next call; the picture alone without
 * any, or if b is NULL. Dies with status 2 if a file cannot be read or has another width. */
struct image_rows image_backs_under(
    struct image_backs *b, uint32_t frame, const struct image_rows *over);

/* bits: 8 or 16 (PFM ignores it). job: NULL, or the hash for PNG's text chunk "Job". Returns 0, or
 * -1 with errno. */
int image_write(
    FILE *f, const struct image *im, enum image_format format, int bits, const char *job);
int image_write_rows(
    FILE *f, const struct image_rows *rows, enum image_format format, int bits, const char *job);

/* Writes a file that appears under its name only when complete. Returns 0, or -1 with errno and no
 * file left. */
int image_save(
    const char *path, const struct image *im, enum image_format format, int bits, const char *job);
int image_save_rows(const char *path, const struct image_rows *rows, enum image_format format,
    int bits, const char *job);

/* The sRGB transfer functions (IEC 61966-2-1). encode clamps to [0,1] (NaN: 0) and rounds to
 * nearest. */
uint8_t srgb_encode8(float linear);
float srgb_decode8(uint8_t v);

/*
 * Pixels for a screen, 0xffRRGGBB each (screen.c). Opaque pixels are those of an 8 bit PNG; others
 * are put over `back`, in linear light, or over black if it is NULL. image_screen_new never returns
 * NULL.
 */
struct image_screen;
struct image_screen *image_screen_new(void);
void image_screen_free(struct image_screen *s);
void image_screen_row(const struct image_screen *s, const float *rgba, const uint32_t *back,
    uint32_t n, uint32_t *out);

struct image_diff {
    double rmse;               /* over R, G, B, clamped to [0,1], linear */
    double rmse_kept;          /* the same without the worst `drop` fraction of pixels */
    double psnr_db;            /* 20 log10(1/rmse); INFINITY if rmse is 0 */
    double worst;              /* largest difference of a clamped component R, G, B or A */
    uint32_t worst_x, worst_y; /* the first such pixel */
    uint64_t pixels, dropped;  /* all pixels; pixels excluded from rmse_kept, rounded down */
    uint64_t over;      /* pixels with a clamped component that differs by more than tolerance */
    uint64_t differing; /* pixels that differ at all, not clamped, alpha included */
};
/* A fraction of n pixels, rounded down: .29 of 100 is 29, though .29 as a double is less. */
uint64_t image_share(double fraction, uint64_t n);
/* The caller checks that the sizes are equal. A NaN differs from every number by 1. */
void image_compare(const struct image *a, const struct image *b, double tolerance, double drop,
    struct image_diff *d);

/*
 * image_name returns the name of frame number `frame`: pattern with its one %d (%4d, %03d: width
 * below 100) replaced. "%%" stands for a percent sign. image_name_check tells whether a pattern is
 * valid and whether it numbers frames.
 */
enum image_naming { IMAGE_NAME_BAD, IMAGE_NAME_SINGLE, IMAGE_NAME_NUMBERED };
enum image_naming image_name_check(const char *pattern);
char *image_name(const char *pattern, uint32_t frame); /* the caller frees */
/* Calls file() for each file that is there and has such a name, if its number is in the last
 * component. */
typedef void (*image_name_file)(const char *name);
void image_name_each(const char *pattern, image_name_file file);
/* Dies with status 2 if a file of these names is an input (base.h): better now than at its turn. */
void image_name_keep(const char *pattern, uint32_t first, uint32_t last);

/* Where a program puts its pictures. */
struct image_out {
    const char *pattern;       /* of their names; NULL: standard output */
    int bits;                  /* per sample of a PNG or PAM: 8 or 16 */
    struct image_backs *backs; /* with each picture; NULL: none */
    /* set by image_out_check */
    enum image_format format;
    enum image_naming naming;
};
/* Sets format and naming. Dies with status 2 if the pattern is bad, or with 3 if its directory is
 * not writable: better now than after hours of rendering. */
void image_out_check(struct image_out *o);
/* The name of picture number `frame`, or "standard output"; the caller frees. */
char *image_out_name(const struct image_out *o, uint32_t frame);
/* The directory for the pixels of large frames, which the caller frees: TMPDIR; else that of
 * picture number `frame`; for standard output /var/tmp. */
char *image_out_spill(const struct image_out *o, uint32_t frame);
/* Writes picture number `frame` with its backdrops under that name, with its job, if that is not
 * NULL. Returns 0, or -1 with errno. */
int image_out_put(const struct image_out *o, uint32_t frame, const char *name,
    const struct image_rows *rows, const char *job);
/* Parses 8 or 16, the argument of option `-opt`; dies with status 2 on other text. */
int image_opt_bits(int opt, const char *s);

/*
 * ---- assembly: pictures from fragments in any order, repeated or missing ----
 *
 * Call order: assembly_init; assembly_declare and assembly_commit for each record; the caller
 * writes each complete frame and then calls assembly_release; assembly_free. Pixels are committed
 * one by one. The first one is kept. A later one is counted, compared bit by bit and dropped. If
 * the two differ, a dispute records both sources. A frame's memory is allocated at its first
 * fragment. The pixels of a large frame are kept in a file, if the caller sets spill.dir.
 */
#define ASSEMBLY_NAME 64 /* bytes of a job's name, including the terminator */
#define ASSEMBLY_FRAMES_MAX (1 << 20)
#define ASSEMBLY_DISPUTES_MAX 64
#define ASSEMBLY_MEMORY_PX (1 << 24) /* pixels of the largest frame that is kept in memory */
#define ASSEMBLY_PAGES 3640          /* 128 MiB: the part of a larger frame that is in memory */

enum assembly_verdict {
    ASSEMBLY_TAKEN,      /* valid; its new pixels are stored */
    ASSEMBLY_UNDECLARED, /* the frame was not declared */
    ASSEMBLY_OUTSIDE,    /* the lattice is not inside the frame */
    ASSEMBLY_FOREIGN,    /* job or size differs from the frame's first declaration */
    ASSEMBLY_NO_ROOM,    /* a limit above, or the memory for open frames, is exhausted */
    ASSEMBLY_FAILED,     /* the file of the pixels cannot be made, read or written */
    ASSEMBLY_VERDICTS
};

struct assembly_frame {
    uint32_t number;
    char job[ASSEMBLY_NAME]; /* from the first declaration, which stands */
    struct store *pixels;    /* NULL: no fragment yet, released, or pixels not kept */
    struct coverage
        have;   /* bits NULL: no fragment yet, or released; w, h and done are always valid */
    bool clear; /* some alpha is below 1 */
    bool released;
    uint64_t again;    /* pixels that came more than once, and were compared */
    uint64_t late;     /* pixels that came again when the frame was closed: not compared */
    uint64_t shown_px; /* pixels in its last preview */
    uint32_t next_id;  /* for the caller: above every task id seen */
};

/* Two sources that sent different pixels. One of them is wrong. */
struct assembly_dispute {
    uint32_t frame;
    uint16_t first, second; /* the pixels of first are kept */
    uint64_t pixels;
    double worst; /* the largest difference, at x, y */
    uint32_t x, y;
};

/* Where the pixels of large frames are kept. */
struct assembly_spill {
    const char *dir;   /* the caller's; NULL: all frames are kept in memory */
    uint64_t above_px; /* frames of more pixels are large */
    uint32_t pages;    /* in memory, of each large frame */
};

struct assembly {
    struct assembly_frame **frames; /* sorted by number */
    uint32_t n_frames;
    bool keep_pixels;
    uint64_t room_bytes;         /* memory left for open frames */
    struct assembly_spill spill; /* may be set after assembly_init */
    int error;                   /* errno of the last ASSEMBLY_FAILED */
    struct assembly_frame
        *recent; /* the last released frame, kept so that late pixels are still compared */
    uint64_t declared_px, done_px;
    uint64_t refused[ASSEMBLY_VERDICTS];                     /* refused fragments by verdict */
    struct assembly_dispute disputes[ASSEMBLY_DISPUTES_MAX]; /* the first ones */
    uint32_t n_disputes;
    uint64_t differing; /* pixels of all disputes */
};

/* keep_pixels false: records only which pixels arrived. The open frames and the last complete one
 * together hold at most most_bytes of memory: 18 1/8 bytes per pixel, or 1/8 without pixels. A
 * large frame with a file takes 1/8 byte per pixel and 128 MiB. */
void assembly_init(struct assembly *a, bool keep_pixels, uint64_t most_bytes);
void assembly_free(struct assembly *a);
/* NULL if the frame was not declared. */
struct assembly_frame *assembly_find(const struct assembly *a, uint32_t number);
/* Declares the size and job of frame `number`; the job's name is cut at ASSEMBLY_NAME. The first
 * declaration of a frame stands. */
enum assembly_verdict assembly_declare(
    struct assembly *a, uint32_t number, uint32_t w, uint32_t h, const char *job);
/* source: any number by which the caller identifies the sender. rgba: 4 floats per pixel, in
 * lattice order; NULL if pixels are not kept. */
enum assembly_verdict assembly_commit(struct assembly *a, uint32_t number, const char *job,
    uint16_t source, const struct lattice *at, const float *rgba);
/* The picture of a frame with pixels: missing ones are transparent. Valid until f changes. */
struct image_rows assembly_rows(const struct assembly_frame *f);
/* Makes *to, at most `side` pixels wide and high, of a frame with pixels: each pixel is the mean of
 * k x k, of which missing ones are transparent. False with errno: they cannot be read. */
bool assembly_small(const struct assembly_frame *f, uint32_t side, struct image *to);
/* Bytes on disk for the pixels of a frame of this size that is kept in a file. */
uint64_t assembly_disk(uint32_t w, uint32_t h);
/* Call after the frame was written. Its memory is freed when the next frame is released. */
void assembly_release(struct assembly *a, struct assembly_frame *f);
/* True if every pixel of every frame is there, and there is at least one frame. */
bool assembly_whole(const struct assembly *a);
/* Copies the coverage of f; the caller frees the copy. */
void assembly_coverage(const struct assembly_frame *f, struct coverage *copy);
/* Pixels that came again with the same bits, over all frames, before their frame was closed. */
uint64_t assembly_again(const struct assembly *a);
/* "3072 of 262144 pixels missing: rows 5, 13, 20-31, ..." */
#define ASSEMBLY_TEXT 256
void assembly_missing_text(const struct assembly_frame *f, char out[ASSEMBLY_TEXT]);

/*
 * ---- previews: files of pictures that are not complete ----
 *
 * The preview of OUT.png is OUT.partial.png, so OUT.png is complete whenever it exists. Missing
 * pixels are transparent, in PFM black. Call image_preview_put when image_preview_wait_ms is 0.
 */
struct image_preview {
    const struct image_out *out; /* with a pattern */
    int64_t every_us;            /* 0: none are written */
    int64_t due_us;              /* when the next one is */
    uint64_t shown_px;           /* pixels of all frames at the last one */
};
void image_preview_start(struct image_preview *p, const struct image_out *out, double every_s);
/* The name, or pattern, of the preview of such a picture; the caller frees it. */
char *image_preview_name(const char *whole);
/* Time until the next preview; -1: no pixel has come since the last one. */
int image_preview_wait_ms(const struct image_preview *p, const struct assembly *a);
/*
 * Writes each incomplete frame with new pixels, as image_save does. The next preview is due
 * every_us later, or when previews have taken a tenth of the time. Returns NULL; or with errno the
 * name of a file that could not be written, which the caller frees. No preview is due after that.
 * A file of that name that is no preview is not replaced: EEXIST. A preview of an earlier run is
 * a picture as gather writes it: of that width, and a PNG has a job.
 */
char *image_preview_put(struct image_preview *p, const struct assembly *a);
/* Removes the preview of this picture, also that of an earlier run. */
void image_preview_remove(const struct image_preview *p, const struct assembly_frame *f);

#endif
