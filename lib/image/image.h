/*
 * image: pixel buffers; PNG (through libpng), PAM, PPM and PFM; metrics; assembly of pictures
 * from fragments.
 *
 * Pixels are linear light, premultiplied RGBA, float32, row 0 on top. Files: 8 bits hold sRGB,
 * 16 bits linear light (PNG says so by gAMA 1); alpha is written, not premultiplied, only where
 * some pixel is not opaque. PAM is as PNG without compression. PFM is float RGB, bottom row
 * first, and has no alpha.
 *
 * Files are untrusted: sizes are checked before memory is taken, and everything that can be
 * wrong in one comes back as text. The library keeps no state.
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
/* Larger pictures are refused, in files and in assembly: 4 GiB of pixels. */
#define IMAGE_PIXELS_MAX (UINT64_C(1) << 28)

void image_init(struct image *im, uint32_t w, uint32_t h); /* transparent black */
void image_free(struct image *im);
/* By suffix (.png .pam .pfm); false when it is none of them. */
bool image_format_of(const char *path, enum image_format *format);
/*
 * Reads a PNG (any kind), PAM, PPM, PGM or PFM, told apart by content; "-" is standard input.
 * PNG with an sRGB chunk, or 8 bits with gAMA 1/2.2, holds sRGB; with another gAMA that power;
 * with neither, and in PNM, 8 bits hold sRGB and 16 linear light. 0, or -1 with "what, expected
 * what" in err and nothing allocated.
 */
int image_read(const char *path, struct image *im, char err[IMAGE_ERR]);
/* The same from n bytes in memory. */
int image_decode(const unsigned char *p, size_t n, struct image *im, char err[IMAGE_ERR]);
/* bits 8 or 16 (PFM: ignored). job: NULL or the hash put in PNG's text chunk "Job". 0, or -1
 * with errno. */
int image_write(
    FILE *f, const struct image *im, enum image_format format, int bits, const char *job);

/* To a file that appears under its name only when whole. 0, or -1 with errno and nothing left
 * behind. */
int image_save(
    const char *path, const struct image *im, enum image_format format, int bits, const char *job);

/* The sRGB transfer functions (IEC 61966-2-1); encode clamps to [0,1] (NaN: 0) and rounds to
 * nearest. */
uint8_t srgb_encode8(float linear);
float srgb_decode8(uint8_t v);

struct image_diff {
    double rmse;               /* over R, G, B of pixels clamped to [0,1], linear */
    double rmse_kept;          /* the same without the worst `drop` fraction of pixels */
    double psnr_db;            /* 20 log10(1/rmse); INFINITY when equal */
    double worst;              /* largest difference of a clamped component, R G B A */
    uint32_t worst_x, worst_y; /* the first such pixel */
    uint64_t pixels, dropped;  /* all; those that rmse_kept leaves out, rounded down */
    uint64_t over;             /* pixels with a clamped component off by more than tolerance */
    uint64_t differing;        /* pixels that differ at all, not clamped, alpha included */
};
/* Sizes must be equal (the caller checks). A NaN differs from every number by 1. */
void image_compare(const struct image *a, const struct image *b, double tolerance, double drop,
    struct image_diff *d);

/*
 * The name of frame number `frame`: pattern with its one %d (%4d, %03d: width below 100) replaced.
 * image_name_check tells whether a pattern is valid ("%%" is a percent sign) and numbers frames.
 */
enum image_naming { IMAGE_NAME_BAD, IMAGE_NAME_SINGLE, IMAGE_NAME_NUMBERED };
enum image_naming image_name_check(const char *pattern);
char *image_name(const char *pattern, uint32_t frame); /* the caller frees */

/*
 * ---- assembly: pictures from fragments that come in any order, twice, or not at all ----
 *
 * Call order: init, then declare and commit as records come; a frame that is full is the
 * caller's to write and then to release; free. Pixels are committed one by one: the first
 * stands, a later one is counted, compared bit by bit, and dropped; where they differ, it is known
 * which two sources brought them. Memory for a frame is taken at its first fragment.
 */
#define ASSEMBLY_NAME 64 /* bytes of a job's name, terminator included */
#define ASSEMBLY_FRAMES_MAX (1 << 20)
#define ASSEMBLY_DISPUTES_MAX 64

enum assembly_verdict {
    ASSEMBLY_TAKEN,      /* valid; whatever of it was new is in */
    ASSEMBLY_UNDECLARED, /* nobody declared this frame */
    ASSEMBLY_OUTSIDE,    /* the lattice is not inside the frame */
    ASSEMBLY_FOREIGN,    /* of another job, or size, than the frame's first declaration */
    ASSEMBLY_NO_ROOM,    /* a limit above was met, or the open frames' memory */
    ASSEMBLY_VERDICTS
};

struct assembly_frame {
    uint32_t number;
    char job[ASSEMBLY_NAME]; /* of the first declaration, which stands */
    struct image picture;    /* rgba NULL: no fragment yet, released, or pixels are not kept */
    uint16_t *source;        /* of each pixel, where they are kept */
    struct coverage
        have; /* bits NULL: no fragment yet, or released; w, h and done are always right */
    bool released;
    uint64_t again;   /* pixels that came again */
    uint32_t next_id; /* for the caller: above any task's id seen */
};

/* Two sources that sent different pixels: one of them is wrong. */
struct assembly_dispute {
    uint32_t frame;
    uint16_t first, second; /* the first one's pixels stand */
    uint64_t pixels;
    double worst; /* the largest difference, at */
    uint32_t x, y;
};

struct assembly {
    struct assembly_frame **frames; /* by number */
    uint32_t n_frames;
    bool keep_pixels;
    uint64_t room_bytes; /* left for open frames */
    struct assembly_frame
        *recent; /* the last released, kept so that late pixels are still compared */
    uint64_t declared_px, done_px;
    uint64_t refused[ASSEMBLY_VERDICTS]; /* fragments, by verdict */
    struct assembly_dispute disputes[ASSEMBLY_DISPUTES_MAX]; /* the first ones */
    uint32_t n_disputes;
    uint64_t differing; /* pixels, of all disputes */
};

/* keep_pixels false: only which pixels are there. The open frames, and the last whole one,
 * together hold at most most_bytes: 18 1/8 bytes a pixel, or 1/8. */
void assembly_init(struct assembly *a, bool keep_pixels, uint64_t most_bytes);
void assembly_free(struct assembly *a);
/* NULL when it was not declared. */
struct assembly_frame *assembly_find(const struct assembly *a, uint32_t number);
/* Frame `number` is of this size and job, whose name is cut to its length. The first declaration of
 * a frame stands. */
enum assembly_verdict assembly_declare(
    struct assembly *a, uint32_t number, uint32_t w, uint32_t h, const char *job);
/* source: any number that tells the caller whose pixels these are. rgba (NULL where pixels are not
 * kept): 4 floats a pixel, in the lattice's order. */
enum assembly_verdict assembly_commit(struct assembly *a, uint32_t number, const char *job,
    uint16_t source, const struct lattice *at, const float *rgba);
/* The frame was written: its memory goes back (when the next one is released). */
void assembly_release(struct assembly *a, struct assembly_frame *f);
/* Every pixel of every frame, and one frame at least. */
bool assembly_whole(const struct assembly *a);
/* A copy of what is there of f; the caller's to free. */
void assembly_coverage(const struct assembly_frame *f, struct coverage *copy);
/* Pixels that came again with the same bits, over all frames. */
uint64_t assembly_again(const struct assembly *a);
/* "3072 of 262144 pixels missing: rows 5, 13, 20-31, ..." */
#define ASSEMBLY_TEXT 256
void assembly_missing_text(const struct assembly_frame *f, char out[ASSEMBLY_TEXT]);

#endif
