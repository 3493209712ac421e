/* The window, by SDL2. */
#include "window/window.h"

#include <SDL2/SDL.h>
#include <stdlib.h>

#define SIDE_LEAST 64

struct window {
    SDL_Window *window;
    SDL_Renderer *renderer;
    SDL_Texture *texture;
    int w, h;   /* of the texture */
    bool shift; /* is it down? By the keys before this event: SDL_GetModState knows later ones. */
    SDL_Scancode pressed; /* the last key */
    bool repeated;        /* it is held down */
};

static struct window *failed(struct window *w, char err[ERR_BYTES])
{
    err_set(err, "%s", SDL_GetError());
    window_close(w);
    return NULL;
}

/* Without a name, SDL would also take drivers that draw nowhere. */
static bool choose_driver(char err[ERR_BYTES])
{
    const bool wayland = getenv("WAYLAND_DISPLAY"), x11 = getenv("DISPLAY");
    if (!wayland && !x11) return err_set(err, "neither DISPLAY nor WAYLAND_DISPLAY is set");
    SDL_SetHint(SDL_HINT_VIDEODRIVER, x11 ? "x11" : "wayland");
    return true;
}

/* As large as asked, or as the screen allows. */
static void fit(int *w, int *h)
{
    SDL_Rect room;
    if (SDL_GetDisplayUsableBounds(0, &room) != 0) return;
    if (*w > room.w) *w = room.w;
    if (*h > room.h) *h = room.h;
}

/* The window may have less room than was asked for, or more. */
static void tell_size(const struct window *win)
{
    SDL_Event s = {.window = {.type = SDL_WINDOWEVENT, .event = SDL_WINDOWEVENT_SIZE_CHANGED}};
    SDL_GetWindowSize(win->window, &s.window.data1, &s.window.data2);
    SDL_PushEvent(&s);
}

struct window *window_open(const char *title, uint32_t w, uint32_t h, char err[ERR_BYTES])
{
    if (!choose_driver(err)) return NULL;
    struct window *win = xcalloc(1, sizeof *win);
    int width = (int)w, height = (int)h;
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    SDL_SetHint(SDL_HINT_RENDER_DRIVER, "software");
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) return failed(win, err);
    fit(&width, &height);
    win->window = SDL_CreateWindow(title, SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width,
        height, SDL_WINDOW_RESIZABLE);
    if (!win->window) return failed(win, err);
    SDL_SetWindowMinimumSize(win->window, SIDE_LEAST, SIDE_LEAST);
    win->renderer = SDL_CreateRenderer(win->window, -1, SDL_RENDERER_SOFTWARE);
    if (!win->renderer) return failed(win, err);
    SDL_StartTextInput();
    tell_size(win);
    return win;
}

void window_close(struct window *w)
{
    if (!w) return;
    if (w->texture) SDL_DestroyTexture(w->texture);
    if (w->renderer) SDL_DestroyRenderer(w->renderer);
    if (w->window) SDL_DestroyWindow(w->window);
    free(w);
    SDL_Quit();
}

/* ---- events --------------------------------------------------------------------------------- */

/* Keys that give no text. */
static bool take_key(const SDL_KeyboardEvent *k, struct window_event *e)
{
    static const struct {
        SDL_Keycode code;
        int key;
    } keys[] = {
        {SDLK_ESCAPE, WINDOW_ESCAPE},
        {SDLK_LEFT, WINDOW_LEFT},
        {SDLK_RIGHT, WINDOW_RIGHT},
        {SDLK_UP, WINDOW_UP},
        {SDLK_DOWN, WINDOW_DOWN},
        {SDLK_HOME, WINDOW_HOME},
        {SDLK_PAGEUP, WINDOW_PAGE_UP},
        {SDLK_PAGEDOWN, WINDOW_PAGE_DOWN},
        {SDLK_F1, WINDOW_F1},
        {SDLK_TAB, '\t'},
    };
    e->what = WINDOW_KEY;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (keys[i].code == k->keysym.sym) return e->key = keys[i].key, true;
    return false;
}

/* Other keys, in any layout. Letters that are not Latin, such as Cyrillic ones, count as those of a
 * US keyboard in their places. */
static bool take_text(const char *text, SDL_Scancode pressed, struct window_event *e)
{
    const bool letter = pressed >= SDL_SCANCODE_A && pressed <= SDL_SCANCODE_Z;
    e->what = WINDOW_KEY;
    e->key = (unsigned char)*text;
    if (e->key > 0x7f && letter) e->key = 'a' + (int)(pressed - SDL_SCANCODE_A);
    return e->key >= ' ' && e->key < 0x7f;
}

static bool take_motion(const SDL_MouseMotionEvent *m, bool shift, struct window_event *e)
{
    const bool left = m->state & SDL_BUTTON_LMASK, right = m->state & SDL_BUTTON_RMASK;
    e->what = right || shift ? WINDOW_MOVE : WINDOW_DRAG;
    e->x = m->x, e->y = m->y;
    e->dx = m->xrel, e->dy = m->yrel;
    return left || right;
}

static bool take_window(const SDL_WindowEvent *w, struct window_event *e)
{
    switch (w->event) {
    case SDL_WINDOWEVENT_SIZE_CHANGED:
        e->what = WINDOW_SIZE;
        e->w = (uint32_t)w->data1;
        e->h = (uint32_t)w->data2;
        return true;
    case SDL_WINDOWEVENT_EXPOSED: e->what = WINDOW_STALE; return true;
    default: return false;
    }
}

static bool take(struct window *win, const SDL_Event *s, struct window_event *e)
{
    *e = (struct window_event){.what = WINDOW_CLOSE};
    switch (s->type) {
    case SDL_QUIT: return true;
    case SDL_KEYDOWN:
        e->repeated = win->repeated = s->key.repeat;
        win->shift = s->key.keysym.mod & KMOD_SHIFT;
        win->pressed = s->key.keysym.scancode;
        return take_key(&s->key, e);
    case SDL_KEYUP: win->shift = s->key.keysym.mod & KMOD_SHIFT; return false;
    case SDL_TEXTINPUT:
        e->repeated = win->repeated;
        return take_text(s->text.text, win->pressed, e);
    case SDL_MOUSEMOTION: return take_motion(&s->motion, win->shift, e);
    case SDL_MOUSEWHEEL:
        e->what = WINDOW_WHEEL;
        e->dy = s->wheel.y;
        return s->wheel.y != 0;
    case SDL_MOUSEBUTTONDOWN:
        e->what = WINDOW_DOUBLE;
        e->x = s->button.x, e->y = s->button.y;
        return s->button.button == SDL_BUTTON_LEFT && s->button.clicks == 2;
    case SDL_WINDOWEVENT: return take_window(&s->window, e);
    default: return false;
    }
}

bool window_next(struct window *w, struct window_event *e)
{
    for (SDL_Event s; SDL_PollEvent(&s);)
        if (take(w, &s, e)) return true;
    return false;
}

/* ---- pixels --------------------------------------------------------------------------------- */

static bool resize(struct window *win, int w, int h)
{
    if (win->texture && win->w == w && win->h == h) return true;
    if (win->texture) SDL_DestroyTexture(win->texture);
    win->texture = SDL_CreateTexture(
        win->renderer, SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STREAMING, w, h);
    if (win->texture) SDL_SetTextureBlendMode(win->texture, SDL_BLENDMODE_NONE);
    win->w = w, win->h = h;
    return win->texture;
}

void window_put(
    struct window *win, const uint32_t *argb, uint32_t w, uint32_t h, uint32_t first, uint32_t end)
{
    const SDL_Rect rows = {0, (int)first, (int)w, (int)(end - first)}, all = {0, 0, (int)w, (int)h};
    if (!resize(win, (int)w, (int)h)) return;
    SDL_UpdateTexture(win->texture, &rows, argb + (size_t)first * w, (int)(w * sizeof *argb));
    SDL_SetRenderDrawColor(win->renderer, 0, 0, 0, 255);
    SDL_RenderClear(win->renderer);
    SDL_RenderCopy(win->renderer, win->texture, NULL, &all);
    SDL_RenderPresent(win->renderer);
}

void window_title(struct window *w, const char *title) { SDL_SetWindowTitle(w->window, title); }

void window_size(struct window *win, uint32_t w, uint32_t h)
{
    int width = (int)w, height = (int)h;
    fit(&width, &height);
    SDL_SetWindowSize(win->window, width, height);
}
