/* drawing: points to pixels; labels; ticks. */
#include "backdrop/drawing.h"

static struct vec3 vec(const double a[3]) { return v3(a[0], a[1], a[2]); }

/* The camera is that of lib/volume/view.c. */
void drawing_init(struct drawing *s, const struct backdrop *b, struct buf *out)
{
    const struct spec *spec = b->spec;
    double half = tan(spec->angle * 3.14159265358979323846 / 360);
    struct vec3 forward = v3_unit(v3_sub(vec(spec->at), vec(spec->from)));
    struct vec3 right = v3_unit(v3_cross(forward, vec(spec->up)));
    *s = (struct drawing){.b = b, .out = out, .w = b->w, .h = b->h, .eye = vec(spec->from)};
    s->forward = forward;
    s->right = v3_scale(right, 1 / half);
    s->up = v3_scale(v3_cross(right, forward), 1 / half);
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
    struct vec3 d = v3_sub(v3(x * scale[0], y * scale[1], z * scale[2]), s->eye);
    double far = v3_dot(d, s->forward);
    if (far <= 1e-6 * v3_len(d)) return false;
    xy[0] = (s->w + s->h * v3_dot(d, s->right) / far) / 2;
    xy[1] = (s->h + s->h * v3_dot(d, s->up) / far) / 2;
    return true;
}

void backdrop_point(const struct drawing *s, double x, double y, double z)
{
    double xy[2];
    if (backdrop_project(s, x, y, z, xy)) buf_printf(s->out, "%.2f %.2f\n", xy[0], xy[1]);
    else buf_printf(s->out, "\n");
}

/* Between single quotes, where gnuplot takes nothing but a quote for more than it is. */
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
    buf_printf(s->out, " at %.2f,%.2f %s noenhanced\n", xy[0], xy[1], how);
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
