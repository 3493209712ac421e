/* drawing: projection to pixels; labels; ticks. */
#include "backdrop/drawing.h"

#include <string.h>

#define GAP .2         /* em: beside numbers of the legend, which stand in a row */
#define SCALE_LEAST .4 /* of the font, in small pictures */

/* As in backdrop_project, with all that does not depend on the point. */
static void set_map(struct drawing *s)
{
    const double *scale = s->b->spec->scale, half = v3_dot(s->camera.up, s->camera.up);
    const struct vec3 axes[] = {v3_scale(s->camera.right, s->h / half),
        v3_scale(s->camera.up, s->h / half), s->camera.forward};
    for (int i = 0; i < 3; i++) {
        s->map[i][0] = axes[i].x * scale[0];
        s->map[i][1] = axes[i].y * scale[1];
        s->map[i][2] = axes[i].z * (s->z * scale[2]) - v3_dot(axes[i], s->camera.eye);
    }
}

void drawing_init(struct drawing *s, const struct backdrop *b)
{
    const struct spec *spec = b->spec;
    *s = (struct drawing){.b = b, .w = b->w, .h = b->h};
    s->em = BACKDROP_FONT * fmax(SCALE_LEAST, fmin(s->h / 720, s->w / 1080));
    int rows = spec->n_knots && spec->n_isos && !spec->n_colours ? 2 : 1;
    s->strip = ceil((BACKDROP_MARGIN + rows * BACKDROP_ROW + 1 + BACKDROP_LINE) * s->em);
    s->camera = camera_new(v3_of(spec->from), v3_of(spec->at), v3_of(spec->up), spec->angle);
    for (int a = 0; a < 3; a++) {
        bool turned = a == 2 && spec->scale[a] < 0;
        uint32_t last = a == 2 && b->grid->flat ? 0 : b->grid->n[a] - 1;
        s->lo[a] = b->grid->at[a][turned ? last : 0];
        s->hi[a] = b->grid->at[a][turned ? 0 : last];
    }
}

void drawing_raise(struct drawing *s, int level, double z)
{
    s->level = level;
    s->z = z;
    set_map(s);
    drawing_bound(s);
}

bool backdrop_project(const struct drawing *s, double x, double y, double z, double xy[2])
{
    const double *scale = s->b->spec->scale;
    const struct camera *c = &s->camera;
    struct vec3 d = v3_sub(v3(x * scale[0], y * scale[1], z * scale[2]), c->eye);
    double far = v3_dot(d, c->forward);
    if (!(far > 1e-6 * v3_len(d))) return false; /* a NaN, too */
    double half = v3_dot(c->up, c->up); /* half the frame's height at distance 1, squared */
    xy[0] = (s->w + s->h * v3_dot(d, c->right) / half / far) / 2;
    xy[1] = (s->h + s->h * v3_dot(d, c->up) / half / far) / 2;
    return true;
}

double drawing_longest(const struct drawing *s, int axis)
{
    const double *scale = s->b->spec->scale;
    const int other = 1 - axis;
    return fmax(s->hi[axis] - s->lo[axis],
        (s->hi[other] - s->lo[other]) * fabs(scale[other] / scale[axis]));
}

void drawing_point(const struct drawing *s, double x, double y, double z)
{
    double xy[2];
    if (backdrop_project(s, x, y, z, xy)) mark_point(s->list, xy[0], xy[1]);
    else mark_break(s->list);
}

bool drawing_in_front(const struct drawing *s, int axis, int side)
{
    const double *scale = s->b->spec->scale;
    double here = (side ? s->hi : s->lo)[axis] * scale[axis];
    double there = (side ? s->lo : s->hi)[axis] * scale[axis];
    return here > there ? s->b->spec->from[axis] > here : s->b->spec->from[axis] < here;
}

/* By the widths of DejaVu Sans, which is wide. */
double backdrop_text_width(const struct drawing *s, const char *text)
{
    double em = 0;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if ((*c & 0xc0) == 0x80) continue; /* not the first byte of a character */
        em += *c >= 0xe3 || strchr("MWmw%@", *c)       ? 1
              : strchr(" .,:;|!\\'()[]{}ijlftI/-", *c) ? .4
              : *c >= 'A' && *c <= 'Z'                 ? .77
                                                       : .64;
    }
    return em * s->em;
}

static enum label check(const struct drawing *s, const struct label_box *box)
{
    const bool in_strip = s->labels->in_strip;
    if (box->x0 < 0 || box->x1 > s->w || box->y0 < (in_strip ? -s->strip : 0) ||
        box->y1 > (in_strip ? 0 : s->h))
        return LABEL_LEFT_OUT;
    const struct label_box *other = (const void *)buf_data(&s->labels->boxes);
    for (size_t i = 0; i < buf_size(&s->labels->boxes) / sizeof *other; i++)
        if (box->x0 < other[i].x1 && other[i].x0 < box->x1 && box->y0 < other[i].y1 &&
            other[i].y0 < box->y1)
            return i < s->labels->series ? LABEL_LEFT_OUT : LABEL_TOO_CLOSE;
    return LABEL_PLACED;
}

enum label drawing_reserve(const struct drawing *s, const struct label_box *box)
{
    enum label result = check(s, box);
    if (result == LABEL_PLACED) buf_append(&s->labels->boxes, box, sizeof *box);
    return result;
}

enum label backdrop_label(const struct drawing *s, const char *text, const double xy[2], int align)
{
    double wide = backdrop_text_width(s, text), x0 = xy[0] - wide * (align + 1) / 2;
    double half = BACKDROP_TEXT_HIGH * s->em / 2, gap = s->labels->in_strip ? GAP * s->em : 0;
    struct label_box box = {x0 - gap, x0 + wide + gap, xy[1] - half, xy[1] + half};
    enum label result = drawing_reserve(s, &box);
    if (result == LABEL_PLACED) mark_label(s->list, text, xy, align, 0);
    return result;
}

void backdrop_label_ticks(
    const struct drawing *s, const struct ticks *t, label_tick *label, const void *ctx)
{
    static const int strides[] = {1, 2, 5, 10, 20, 50, 0};
    struct buf *boxes = &s->labels->boxes;
    size_t before = boxes->len, n_marks = s->list->n_marks;
    s->labels->series = before / sizeof(struct label_box);
    for (const int *stride = strides; *stride; stride++) {
        bool close = false;
        for (int i = t->first; i <= t->last && !close; i++)
            close = i % *stride == 0 && label(s, ctx, i * t->step) == LABEL_TOO_CLOSE;
        if (!close) return;
        boxes->len = before; /* undo */
        mark_cut(s->list, n_marks);
    }
}

struct ticks backdrop_ticks(double lo, double hi, double step)
{
    double slack = 1e-9 * (hi - lo) / step;
    if (fmax(fabs(lo), fabs(hi)) / step > 1e9) return (struct ticks){step, 0, -1};
    return (struct ticks){step, (int)ceil(lo / step - slack), (int)floor(hi / step + slack)};
}

double backdrop_step(double range, int n)
{
    double least = range / n, step = pow(10, floor(log10(least)));
    return least <= step       ? step
           : least <= 2 * step ? 2 * step
           : least <= 5 * step ? 5 * step
                               : 10 * step;
}

double backdrop_degree_step(double range)
{
    static const double steps[] = {1, 2, 5, 10, 15, 30, 45, 60, 90};
    if (range <= 12) return backdrop_step(range, 12);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        if (range / steps[i] <= 12) return steps[i];
    return backdrop_step(range, 12);
}

void backdrop_degrees_text(char *out, size_t n, int axis, double v)
{
    if (axis == 0) v = remainder(v, 360);
    const char *side = v < 0 ? axis ? "S" : "W" : axis ? "N" : "E";
    bool neither = v == 0 || (axis == 0 && fabs(v) == 180);
    snprintf(out, n, "%.8g°%s", fabs(v), neither ? "" : side);
}
