/* drawing: projection to pixels; labels; ticks. */
#include "backdrop/drawing.h"

void drawing_init(struct drawing *s, const struct backdrop *b, struct buf *out)
{
    const struct spec *spec = b->spec;
    *s = (struct drawing){.b = b, .out = out, .w = b->w, .h = b->h};
    s->camera = camera_new(v3_of(spec->from), v3_of(spec->at), v3_of(spec->up), spec->angle);
    for (int a = 0; a < 3; a++) {
        bool turned = a == 2 && spec->scale[a] < 0;
        uint32_t last = b->grid->n[a] - 1;
        s->lo[a] = b->grid->at[a][turned ? last : 0];
        s->hi[a] = b->grid->at[a][turned ? 0 : last];
    }
}

bool backdrop_project(const struct drawing *s, double x, double y, double z, double xy[2])
{
    const double *scale = s->b->spec->scale;
    const struct camera *c = &s->camera;
    struct vec3 d = v3_sub(v3(x * scale[0], y * scale[1], z * scale[2]), c->eye);
    double far = v3_dot(d, c->forward);
    if (far <= 1e-6 * v3_len(d)) return false;
    double half = v3_dot(c->up, c->up); /* half the frame's height at distance 1, squared */
    xy[0] = (s->w + s->h * v3_dot(d, c->right) / half / far) / 2;
    xy[1] = (s->h + s->h * v3_dot(d, c->up) / half / far) / 2;
    return true;
}

void backdrop_point(const struct drawing *s, double x, double y, double z)
{
    double xy[2];
    if (backdrop_project(s, x, y, z, xy)) buf_printf(s->out, "%.2f %.2f\n", xy[0], xy[1]);
    else buf_printf(s->out, "\n");
}

/* Writes text in single quotes, where gnuplot treats only a quote specially. */
static void quoted(const struct drawing *s, const char *text)
{
    buf_append(s->out, "'", 1);
    for (; *text; text++) {
        if (*text == '\'') buf_append(s->out, "'", 1);
        buf_append(s->out, (unsigned char)*text < ' ' ? " " : text, 1);
    }
    buf_append(s->out, "'", 1);
}

void backdrop_label(const struct drawing *s, const char *text, const double xy[2], const char *how)
{
    buf_printf(s->out, "set label ");
    quoted(s, text);
    buf_printf(s->out, " at %.2f,%.2f %s front noenhanced\n", xy[0], xy[1], how);
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
