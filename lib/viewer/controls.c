/* The controls: one table for what a user can do, for the help, and for recorded events. */
#include "viewer/viewer_int.h"

#include <string.h>
#include <sys/stat.h>

#define ARROW (5 / 180.) /* of half a turn */
#define NOTCH 1.1        /* of the distance, for a notch of the wheel or a key */
#define STEP .005        /* of the range of a surface, */
#define STRIDE .05       /* and a long one */

struct act {
    struct viewer *v;
    const struct window_event *e;
    double x, y; /* of the row */
};

/* ---- the camera ------------------------------------------------------------------------------ */

static void aim(struct viewer *v, struct look_camera c)
{
    char err[ERR_BYTES];
    if (!subject_aim(&v->subject, &c, err)) viewer_say(v, "%s", err);
    else v->changed = true;
}

static struct look_camera camera(const struct act *a) { return subject_camera(&a->v->subject); }
/* Pixels as a part of the frame's height. */
static double part(const struct act *a, double px) { return px / a->v->subject.spec.h; }

static void turn(const struct act *a)
{
    aim(a->v, look_turn(camera(a), part(a, a->e->dx), part(a, a->e->dy)));
}

static void move(const struct act *a)
{
    aim(a->v, look_move(camera(a), part(a, a->e->dx), part(a, a->e->dy)));
}

static void turn_by_key(const struct act *a) { aim(a->v, look_turn(camera(a), a->x, a->y)); }
static void zoom(const struct act *a) { aim(a->v, look_zoom(camera(a), pow(NOTCH, -a->e->dy))); }
static void zoom_by_key(const struct act *a) { aim(a->v, look_zoom(camera(a), pow(NOTCH, a->x))); }
static void home(const struct act *a) { aim(a->v, a->v->subject.home); }

static void centre(const struct act *a)
{
    const struct spec *s = &a->v->subject.spec;
    aim(a->v, look_centre(camera(a), part(a, a->e->x - s->w / 2.), part(a, a->e->y - s->h / 2.)));
}

/* ---- colours, surfaces, light, files --------------------------------------------------------- */

static void recolour(struct viewer *v, int palette)
{
    char err[ERR_BYTES];
    const char *name = spec_palettes[palette];
    v->palette = palette;
    if (!subject_recolour(&v->subject, name, err)) viewer_say(v, "%s", err);
    else viewer_say(v, "palette %s", name), v->changed = true;
}

static void palette(const struct act *a)
{
    const int n = a->e->key - '1';
    if (n < SPEC_N_PALETTES) recolour(a->v, n);
    else viewer_say(a->v, "palettes are 1 to %d", SPEC_N_PALETTES);
}

static void next_palette(const struct act *a)
{
    recolour(a->v, (a->v->palette + 1) % SPEC_N_PALETTES);
}

static void shift(const struct act *a)
{
    char said[ERR_BYTES];
    if (subject_shift(&a->v->subject, a->x, said)) a->v->changed = true;
    viewer_say(a->v, "%s", said);
}

static void next_surface(const struct act *a)
{
    char said[ERR_BYTES];
    subject_select(&a->v->subject, said);
    viewer_say(a->v, "%s", said);
}

static void light(const struct act *a)
{
    char err[ERR_BYTES];
    if (!subject_light(&a->v->subject, err)) viewer_say(a->v, "%s", err);
    else a->v->changed = true;
}

static void step(const struct act *a)
{
    struct subject *s = &a->v->subject;
    char err[ERR_BYTES];
    const size_t n = s->job.subjects, at = (s->at + n + (size_t)(a->x < 0 ? n - 1 : 1)) % n;
    if (n == 1) viewer_say(a->v, "there is one file");
    else if (!subject_step(s, at, err)) viewer_say(a->v, "%s", err);
    else {
        viewer_say(a->v, "%s", s->job.path[at]);
        a->v->changed = true;
    }
}

/* ---- files ----------------------------------------------------------------------------------- */

/* The first name that nothing has: also no file that cannot be opened. */
static void name_file(struct viewer *v, const char *kind, char name[ERR_BYTES])
{
    struct stat st;
    int n = 0;
    do snprintf(name, ERR_BYTES, "%s-%d%s", v->o->prefix, ++n, kind);
    while (lstat(name, &st) == 0 && n < 99999);
}

static void save_text(struct viewer *v, const char *kind)
{
    char name[ERR_BYTES];
    struct buf b = {0};
    name_file(v, kind, name);
    subject_text(&v->subject, &b);
    viewer_saved(v, name, outfile_put(name, buf_data(&b), buf_size(&b)) == 0);
    buf_free(&b);
}

static void save_spec(const struct act *a) { save_text(a->v, ".spec"); }
static void save_key(const struct act *a) { save_text(a->v, ".key"); }

static void save_png(const struct act *a)
{
    char name[ERR_BYTES];
    name_file(a->v, ".png", name);
    if (a->v->png) return; /* the one before waits for its picture */
    a->v->png = xstrdup(name);
    viewer_say(a->v, "%s when the picture is whole", name);
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void help(const struct act *a)
{
    a->v->helps = !a->v->helps;
    a->v->stale = true;
}

/* A background would hide them. */
static void toggle(struct viewer *v, bool *what)
{
    struct subject *s = &v->subject;
    if (s->scene) {
        viewer_say(v, "a scene has no map and no axes");
        return;
    }
    *what = !*what;
    const bool backed = s->backed && !v->mapped && !v->framed;
    if (backed != s->spec.backed) v->changed = true;
    s->spec.backed = backed;
    v->stale = v->backdated = true;
}
static void axes(const struct act *a)
{
    const struct spec *s = &a->v->subject.spec;
    toggle(a->v, &a->v->framed);
    if (a->v->window) window_size(a->v->window, s->w, s->h + show_strip(a->v, s->w, s->h));
}
static void map(const struct act *a) { toggle(a->v, &a->v->mapped); }
static void quit(const struct act *a) { a->v->quit = true; }

/* The strip of the legend is a part of the window. */
static void resize(const struct act *a)
{
    struct spec *s = &a->v->subject.spec;
    const uint32_t most = SPEC_RESOLUTION_MAX, w = a->e->w < most ? a->e->w : most;
    const uint32_t strip = show_strip(a->v, w, s->h);
    const uint32_t h = a->e->h > strip ? a->e->h - strip : 1;
    if (w == s->w && h == s->h) return;
    s->w = w, s->h = h < most ? h : most;
    a->v->changed = true;
}

static void redraw(const struct act *a) { a->v->stale = true; }

/* ---- the table ------------------------------------------------------------------------------- */

static const struct control {
    const char *input, *does; /* for the help; NULL: the row before says it */
    enum window_what what;
    int first, last; /* keys */
    void (*act)(const struct act *a);
    double x, y;
} controls[] = {
    {"drag", "turn", WINDOW_DRAG, 0, 0, turn, 0, 0},
    {"right drag, Shift drag", "move", WINDOW_MOVE, 0, 0, move, 0, 0},
    {"wheel", "come closer, go back", WINDOW_WHEEL, 0, 0, zoom, 0, 0},
    {"double click", "bring the point to the centre", WINDOW_DOUBLE, 0, 0, centre, 0, 0},
    {"arrows", "turn", WINDOW_KEY, WINDOW_LEFT, WINDOW_LEFT, turn_by_key, -ARROW, 0},
    {NULL, NULL, WINDOW_KEY, WINDOW_RIGHT, WINDOW_RIGHT, turn_by_key, ARROW, 0},
    {NULL, NULL, WINDOW_KEY, WINDOW_UP, WINDOW_UP, turn_by_key, 0, -ARROW},
    {NULL, NULL, WINDOW_KEY, WINDOW_DOWN, WINDOW_DOWN, turn_by_key, 0, ARROW},
    {"+ -", "come closer, go back", WINDOW_KEY, '+', '+', zoom_by_key, -1, 0},
    {NULL, NULL, WINDOW_KEY, '=', '=', zoom_by_key, -1, 0},
    {NULL, NULL, WINDOW_KEY, '-', '-', zoom_by_key, 1, 0},
    {"Home", "the first view", WINDOW_KEY, WINDOW_HOME, WINDOW_HOME, home, 0, 0},
    {"1 to 5", "a palette: " SPEC_PALETTES, WINDOW_KEY, '1', '9', palette, 0, 0},
    {"Tab", "the next palette", WINDOW_KEY, '\t', '\t', next_palette, 0, 0},
    {"n", "select the next iso, slice or clip plane", WINDOW_KEY, 'n', 'n', next_surface, 0, 0},
    {", .", "move it", WINDOW_KEY, ',', ',', shift, -STEP, 0},
    {NULL, NULL, WINDOW_KEY, '.', '.', shift, STEP, 0},
    {"[ ]", "move it far", WINDOW_KEY, '[', '[', shift, -STRIDE, 0},
    {NULL, NULL, WINDOW_KEY, ']', ']', shift, STRIDE, 0},
    {"space, Page Down", "the next file", WINDOW_KEY, ' ', ' ', step, 1, 0},
    {NULL, NULL, WINDOW_KEY, WINDOW_PAGE_DOWN, WINDOW_PAGE_DOWN, step, 1, 0},
    {"Page Up", "the file before", WINDOW_KEY, WINDOW_PAGE_UP, WINDOW_PAGE_UP, step, -1, 0},
    {"l", "light on, off", WINDOW_KEY, 'l', 'l', light, 0, 0},
    {"m", "map on, off", WINDOW_KEY, 'm', 'm', map, 0, 0},
    {"a", "axes and legend on, off", WINDOW_KEY, 'a', 'a', axes, 0, 0},
    {"s", "save the specification", WINDOW_KEY, 's', 's', save_spec, 0, 0},
    {"p", "save the picture", WINDOW_KEY, 'p', 'p', save_png, 0, 0},
    {"v", "save a key view for views(1)", WINDOW_KEY, 'v', 'v', save_key, 0, 0},
    {"F1 ?", "this help", WINDOW_KEY, WINDOW_F1, WINDOW_F1, help, 0, 0},
    {NULL, NULL, WINDOW_KEY, '?', '?', help, 0, 0},
    {"Escape", "end, and print the specification", WINDOW_KEY, WINDOW_ESCAPE, WINDOW_ESCAPE, quit,
        0, 0},
    {NULL, NULL, WINDOW_CLOSE, 0, 0, quit, 0, 0},
    {NULL, NULL, WINDOW_SIZE, 0, 0, resize, 0, 0},
    {NULL, NULL, WINDOW_STALE, 0, 0, redraw, 0, 0},
};
#define CONTROLS (sizeof controls / sizeof *controls)

void controls_take(struct viewer *v, const struct window_event *e)
{
    for (size_t i = 0; i < CONTROLS; i++) {
        const struct control *c = &controls[i];
        if (c->what != e->what || e->key < c->first || e->key > c->last) continue;
        const bool steps = c->x != 0 || c->y != 0; /* as long as the key is held */
        if (e->repeated && !steps) return;
        c->act(&(struct act){v, e, c->x, c->y});
        return;
    }
}

int controls_key(const char *name)
{
    static const struct {
        const char *name;
        int key;
    } named[] = {{"left", WINDOW_LEFT}, {"right", WINDOW_RIGHT}, {"up", WINDOW_UP},
        {"down", WINDOW_DOWN}, {"home", WINDOW_HOME}, {"pageup", WINDOW_PAGE_UP},
        {"pagedown", WINDOW_PAGE_DOWN}, {"f1", WINDOW_F1}, {"escape", WINDOW_ESCAPE}, {"tab", '\t'},
        {"space", ' '}};
    for (size_t i = 0; i < sizeof named / sizeof *named; i++)
        if (strcmp(named[i].name, name) == 0) return named[i].key;
    return name[0] > ' ' && name[0] < 0x7f && !name[1] ? name[0] : 0;
}

void viewer_controls(struct buf *out)
{
    for (size_t i = 0; i < CONTROLS; i++)
        if (controls[i].input)
            buf_printf(out, "%s%s: %s", i ? "\n" : "", controls[i].input, controls[i].does);
}
