/*
 * window: one window on the screen: pixels are put there, and what the user does comes back. SDL2
 * draws it, by the processor alone; all of its calls are here. One window a process.
 */
#ifndef STORMRING_WINDOW_H
#define STORMRING_WINDOW_H

#include "base/base.h"

/* Keys that have no character; the others are their characters. */
enum window_key {
    WINDOW_ESCAPE = 27,
    WINDOW_LEFT = 256,
    WINDOW_RIGHT,
    WINDOW_UP,
    WINDOW_DOWN,
    WINDOW_HOME,
    WINDOW_PAGE_UP,
    WINDOW_PAGE_DOWN,
    WINDOW_F1
};

enum window_what {
    WINDOW_DRAG,   /* dx, dy pixels to the right and down, with the left button */
    WINDOW_MOVE,   /* the same with the right one, or with Shift */
    WINDOW_WHEEL,  /* dy notches, above 0: away from the user */
    WINDOW_DOUBLE, /* a double click at x, y */
    WINDOW_KEY,
    WINDOW_SIZE,  /* the window now has w x h pixels */
    WINDOW_STALE, /* its pixels were lost: show them again */
    WINDOW_CLOSE
};
struct window_event {
    enum window_what what;
    int key;
    bool repeated; /* the key is held down */
    double x, y, dx, dy;
    uint32_t w, h;
};

struct window;
/* Opens a window with room for w x h pixels, or as many as the screen has. NULL with a message in
 * err. */
struct window *window_open(const char *title, uint32_t w, uint32_t h, char err[ERR_BYTES]);
void window_close(struct window *w); /* NULL: nothing happens */
/* The next event that has come. False: there is none. Does not wait. */
bool window_next(struct window *w, struct window_event *e);
/* Shows rows first <= y < end of a picture of w x h pixels, 0xffRRGGBB each, from the window's
 * top left corner on. */
void window_put(
    struct window *win, const uint32_t *argb, uint32_t w, uint32_t h, uint32_t first, uint32_t end);
/* Asks for another size. */
void window_size(struct window *win, uint32_t w, uint32_t h);
void window_title(struct window *w, const char *title);

#endif
