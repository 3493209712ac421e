/* viewer_int: what the files of viewer share. Private to lib/viewer. */
#ifndef STORMRING_VIEWER_INT_H
#define STORMRING_VIEWER_INT_H

#include "grid/grid.h"
#include "image/image.h"
#include "job/job.h"
#include "look/look.h"
#include "paint/paint.h"
#include "pipe/pipe.h"
#include "spec/spec.h"
#include "viewer/viewer.h"
#include "window/window.h"
#include "wire/wire.h"

/* ---- subject.c: what is looked at ----------------------------------------------------------- */

/* What the keys for surfaces move. */
enum surface { SURFACE_ISO, SURFACE_SLICE, SURFACE_CLIP };

struct subject {
    struct job job;
    bool scene;              /* it is one; else a grid */
    size_t at;               /* of the grids */
    struct grid grid;        /* that one */
    double least, most;      /* of its values */
    bool new_file;           /* the command has not got this grid or scene */
    struct spec spec;        /* what is chosen; of a scene only its view and size, */
    double hither;           /* and this */
    struct look_camera home; /* where the user came from */
    double light[3];         /* where it is when it is on */
    bool backed;             /* there is a background, unless the map or the axes are there */
    size_t surface;          /* the selected one, of those of the specification */
};

/* Loads what the files are. False with a message in err. */
bool subject_open(struct subject *s, const struct viewer_options *o, char err[ERR_BYTES]);
void subject_free(struct subject *s);
/* Takes another grid, by its number. False with a message in err, and nothing changes. */
bool subject_step(struct subject *s, size_t at, char err[ERR_BYTES]);
struct look_camera subject_camera(const struct subject *s);
/* Takes the text in b, if it is a specification or view, and frees b. */
bool subject_adopt(struct subject *s, struct buf *b, char err[ERR_BYTES]);
/* Each of these is refused, with false and a message in err, if the result is no specification. */
bool subject_aim(struct subject *s, const struct look_camera *c, char err[ERR_BYTES]);
bool subject_recolour(struct subject *s, const char *palette, char err[ERR_BYTES]);
bool subject_light(struct subject *s, char err[ERR_BYTES]); /* on or off */
/* Moves the selected surface by this part of its range; `said` names it and its place. */
bool subject_shift(struct subject *s, double part, char said[ERR_BYTES]);
void subject_select(struct subject *s, char said[ERR_BYTES]); /* the next surface */
void subject_text(const struct subject *s, struct buf *out);  /* the specification */
/* Appends the records of state that the command lacks. */
void subject_state(struct subject *s, struct down_queue *to);

/* ---- times.c: what was measured ------------------------------------------------------------- */

struct times {
    struct buf waiting;       /* int64_t each: inputs that no view has yet, */
    struct buf asked;         /* whose view is not shown coarsely, */
    struct buf rough;         /* and whose is not whole */
    struct buf coarse, whole; /* double each: microseconds until that */
    uint64_t inputs;
};
void times_input(struct times *t, int64_t at_us);
void times_view(struct times *t);
void times_coarse(struct times *t, int64_t now_us);
void times_whole(struct times *t, int64_t now_us);
/* A table, a line each: name and value. */
void times_write(const struct times *t, const struct look_counts *c, struct buf *out);
void times_free(struct times *t);

/* ---- events.c: recorded events -------------------------------------------------------------- */

enum recorded_what { RECORDED_INPUT, RECORDED_REST, RECORDED_PNG, RECORDED_SHOT };
struct recorded {
    enum recorded_what what;
    double ms; /* after the last rest, or the beginning */
    struct window_event event;
    char *name; /* of a file; owned */
};
struct events {
    struct recorded *at;
    size_t n, next;
    int64_t from_us; /* since when ms counts */
};
/* Reads the file. False with a message in err. */
bool events_load(struct events *e, const char *path, char err[ERR_BYTES]);
void events_free(struct events *e);

/* ---- the whole ------------------------------------------------------------------------------- */

struct viewer {
    const struct viewer_options *o;
    struct subject subject;
    struct look look;
    /* the command */
    struct child child;
    struct down_queue down;
    struct decoder from;
    bool greeted, ended; /* it said hello; its stream has ended */
    int32_t slots, lost; /* as hello says; of those, lost */
    uint32_t frame;      /* of the last view */
    char job[WIRE_JOB];  /* of the last view, "" before it is known */
    char why[24];        /* its bye */
    int64_t heard_us;
    float *rgba; /* room for the pixels of a fragment */
    /* the user */
    struct window *window; /* NULL: recorded events */
    struct events events;
    struct times times;
    bool changed;         /* the view, since it was asked for */
    bool quit;            /* the user has had enough */
    bool helps;           /* the controls are shown */
    bool mapped, framed;  /* the map; axes and labels */
    int palette;          /* of spec_palettes, the last one chosen */
    char *png;            /* a file to write when the picture is whole; owned */
    char said[ERR_BYTES]; /* the status line */
    int status;
    /* the screen */
    struct image_screen *screen;
    struct paint *paint;   /* NULL: a scene */
    struct buf help;       /* the controls */
    struct buf lines;      /* of the map, with NUL */
    struct spec viewed;    /* of the view that was asked for */
    /* Of the picture and the strip below it; what is behind, and what is over it, or NULL. */
    uint32_t *argb, *back, *front;
    uint32_t w, h, strip;
    int64_t shown_us, said_us;
    bool stale;     /* all is to be drawn, */
    bool backdated; /* with another back */
    bool texted;    /* there is text over the picture */
};

/* command.c */
bool command_start(struct viewer *v); /* false after a message */
/* Begins the view that is chosen. */
void command_view(struct viewer *v);
/* Gives tasks, and writes what the pipe takes. */
void command_feed(struct viewer *v);
void command_hear(struct viewer *v); /* after poll; until nothing more has come */
void command_end(struct viewer *v);

/* controls.c */
void controls_take(struct viewer *v, const struct window_event *e);
/* The key with this name; 0: there is none. */
int controls_key(const char *name);

/* show.c */
/* Loads the lines of the map. False with a message in err. */
bool show_open(struct viewer *v, char err[ERR_BYTES]);
/* Keeps the specification of the view that begins, for what is drawn behind it. */
void show_keep(struct viewer *v);
/* The height below a picture of this size, for the legend. */
uint32_t show_strip(const struct viewer *v, uint32_t w, uint32_t h);
/* Writes what is on the screen. False with errno. */
bool show_shot(struct viewer *v, const char *path);
void show_picture(struct viewer *v);
void show_status(struct viewer *v);
bool show_save(struct viewer *v, const char *path); /* the whole picture; false with errno */
void show_free(struct viewer *v);
/* Sets the status line. */
void viewer_say(struct viewer *v, const char *fmt, ...) PRINTF_LIKE(2, 3);
/* Says that the file was saved, or why not: by errno. */
void viewer_saved(struct viewer *v, const char *name, bool good);

#endif
