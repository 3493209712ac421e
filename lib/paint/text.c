/* text: layouts, and lines of text over a picture. */
#include "paint/pen.h"

#define EM 14.0      /* pixels */
#define EM_LEAST 6.0 /* smaller text cannot be read */
#define PAD .6       /* em: between the box, its text and the edge of the picture */
#define DARK .72     /* opacity of the box */

cairo_t *paint_pen(uint32_t *argb, uint32_t w, uint32_t h)
{
    if (w < 1 || h < 1 || w > 32767 || h > 32767) return NULL;
    cairo_surface_t *surface = cairo_image_surface_create_for_data(
        (unsigned char *)argb, CAIRO_FORMAT_ARGB32, (int)w, (int)h, 4 * (int)w);
    cairo_t *cr = cairo_create(surface);
    cairo_surface_destroy(surface);
    return cr;
}

bool paint_pen_free(cairo_t *cr)
{
    bool good = cairo_status(cr) == CAIRO_STATUS_SUCCESS;
    cairo_surface_flush(cairo_get_target(cr));
    cairo_destroy(cr);
    return good;
}

PangoLayout *paint_layout(void)
{
    PangoContext *context = pango_font_map_create_context(pango_cairo_font_map_get_default());
    PangoLayout *layout = pango_layout_new(context);
    g_object_unref(context);
    return layout;
}

void paint_layout_set(PangoLayout *layout, const char *text, double em)
{
    PangoFontDescription *font = pango_font_description_new();
    pango_font_description_set_family_static(font, "Sans");
    pango_font_description_set_absolute_size(font, em * PANGO_SCALE);
    pango_layout_set_font_description(layout, font);
    pango_font_description_free(font);
    char *valid = g_utf8_make_valid(text, -1);
    pango_layout_set_text(layout, valid, -1);
    g_free(valid);
}

bool paint_text(uint32_t *argb, uint32_t w, uint32_t h, const char *text, enum paint_place place)
{
    cairo_t *cr = paint_pen(argb, w, h);
    if (!cr) return false;
    PangoLayout *layout = paint_layout();
    int tw, th;
    double em = EM;
    paint_layout_set(layout, text, em);
    pango_layout_get_pixel_size(layout, &tw, &th);
    double fit = fmin(w / (tw + 4 * PAD * em), h / (th + 4 * PAD * em));
    if (fit < 1) {
        em = fmax(EM_LEAST, em * fit);
        paint_layout_set(layout, text, em);
        pango_layout_get_pixel_size(layout, &tw, &th);
    }
    const double pad = PAD * em, bw = tw + 2 * pad, bh = th + 2 * pad;
    const bool right = place == PAINT_TOP_RIGHT || place == PAINT_BOTTOM_RIGHT;
    const bool low = place == PAINT_BOTTOM_LEFT || place == PAINT_BOTTOM_RIGHT;
    const double x = right ? w - pad - bw : pad, y = low ? h - pad - bh : pad;
    cairo_rectangle(cr, x, y, bw, bh);
    cairo_set_source_rgba(cr, 0, 0, 0, DARK);
    cairo_fill(cr);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_move_to(cr, x + pad, y + pad);
    pango_cairo_show_layout(cr, layout);
    g_object_unref(layout);
    return paint_pen_free(cr);
}
