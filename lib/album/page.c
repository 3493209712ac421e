/*
 * The page of an album: see album.h. Each picture except the first is text in base64 that the
 * browser neither runs nor decodes. The script decodes the one that the sliders point to.
 */
#include "album/album.h"
#include "html/html.h"

#include <inttypes.h>
#include <string.h>

/* The hash lets this script run and no other; 32_album.t compares it. */
static const char begin[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
    "style-src 'unsafe-inline'; "
    "script-src 'sha256-DhpZujlE6wDfefT15zjr/Wj/2S9UCblObfKLzxGEBME='\">\n";

static const char style[] =
    "<style>\n"
    ":root{color-scheme:light dark}\n"
    "body{font:15px/1.4 system-ui,sans-serif;margin:0 auto;padding:0 1rem 1rem;max-width:90rem}\n"
    "h1{font-size:1.25rem;margin:.6rem 0;overflow-wrap:anywhere}\n"
    "figure{margin:0;container-type:inline-size}\n"
    "figcaption{font-size:.85rem;overflow-wrap:anywhere}\n"
    "#frame{--fit:min(100cqw,1px*var(--w),75vh*var(--w)/var(--h));--wide:var(--fit)*var(--zoom);"
    "--high:var(--wide)*var(--h)/var(--w);width:min(100cqw,var(--wide));"
    "height:min(75vh,var(--high));overflow:auto;outline-offset:2px}\n"
    "img{display:block;width:calc(var(--wide));height:calc(var(--high));"
    "background:repeating-conic-gradient(#8884 0 25%,#0000 0 50%) 0 0/16px 16px}\n"
    "fieldset{border:0;margin:.6rem 0 0;padding:0}\n"
    "fieldset div{display:grid;grid-template-columns:4rem minmax(0,1fr) minmax(3rem,12rem) 7rem;"
    "gap:0 .75rem;align-items:center;min-height:2.4rem}\n"
    "input{width:100%;margin:0}\n"
    "output{overflow-wrap:anywhere;font-variant-numeric:tabular-nums}\n"
    "button{font:inherit;padding:.25rem 0}\n"
    "p{font-size:.85rem;margin:.4rem 0}\n"
    "@media(max-width:40rem){fieldset div{grid-template-columns:3.2rem minmax(0,1fr) 5.5rem}"
    "fieldset output{grid-column:2}fieldset button{grid-column:3;grid-row:1}}\n"
    "</style>\n";

static const char script[] =
    "\n'use strict';\n"
    "const find = id => document.getElementById(id);\n"
    "const frame = find('frame'), time = find('time'), view = find('view');\n"
    "const zoom = find('zoom'), rate = find('rate'), across = time || view;\n"
    "const blocks = document.querySelectorAll('script[type=\"image/png\"]');\n"
    "let picture = frame.querySelector('img'), shown = blocks[0], busy, playing, timer;\n"
    "const first = picture.src;\n"
    "\n"
    "function wanted() {\n"
    "  const t = time ? +time.value : 0, times = time ? +time.max + 1 : 1;\n"
    "  return blocks[(view ? +view.value : 0) * times + t];\n"
    "}\n"
    "// The picture stays until the next one is decoded.\n"
    "async function load() {\n"
    "  while (shown !== wanted()) {\n"
    "    const block = wanted(), next = new Image();\n"
    "    next.src = block === blocks[0] ? first : 'data:image/png;base64,' + block.textContent;\n"
    "    next.alt = block.dataset.alt;\n"
    "    next.draggable = false;\n"
    "    await next.decode().catch(() => {});\n"
    "    picture.replaceWith(next);\n"
    "    picture = next;\n"
    "    shown = block;\n"
    "    document.querySelector('figcaption').textContent = block.dataset.file;\n"
    "  }\n"
    "}\n"
    "function say(slider, text) {\n"
    "  if (!slider) return;\n"
    "  slider.parentNode.querySelector('output').value = text;\n"
    "  slider.setAttribute('aria-valuetext', text);\n"
    "}\n"
    "function update() {\n"
    "  say(time, wanted().dataset.time);\n"
    "  say(view, wanted().dataset.view);\n"
    "  say(zoom, Math.round(100 * zoom.value) + ' %');\n"
    "  say(rate, rate && rate.value + ' a second');\n"
    "  busy = busy || load().finally(() => { busy = null; });\n"
    "}\n"
    "// The point in the middle of the frame stays there.\n"
    "function magnify() {\n"
    "  const f = frame, x = (f.scrollLeft + f.clientWidth / 2) / f.scrollWidth;\n"
    "  const y = (f.scrollTop + f.clientHeight / 2) / f.scrollHeight;\n"
    "  f.style.setProperty('--zoom', zoom.value);\n"
    "  f.scrollLeft = x * f.scrollWidth - f.clientWidth / 2;\n"
    "  f.scrollTop = y * f.scrollHeight - f.clientHeight / 2;\n"
    "}\n"
    "function step() {\n"
    "  if (busy) return;\n"
    "  playing.value = +playing.value < +playing.max ? +playing.value + 1 : 0;\n"
    "  update();\n"
    "}\n"
    "function play(slider) {\n"
    "  clearInterval(timer);\n"
    "  playing = slider;\n"
    "  if (playing) timer = setInterval(step, 1000 / rate.value);\n"
    "  for (const b of document.querySelectorAll('button')) {\n"
    "    b.textContent = (b.value === slider?.id ? 'Pause ' : 'Play ') + b.value + 's';\n"
    "  }\n"
    "}\n"
    "function toggle(slider) { play(slider === playing ? null : slider); }\n"
    "\n"
    "document.forms[0].oninput = event => {\n"
    "  if (event.target === zoom) magnify();\n"
    "  if (event.target === rate) play(playing);\n"
    "  update();\n"
    "};\n"
    "document.forms[0].onclick = event => {\n"
    "  if (event.target.type === 'button') toggle(find(event.target.value));\n"
    "};\n"
    "const keys = {\n"
    "  ArrowLeft: [across, -1], ArrowRight: [across, 1],\n"
    "  ArrowDown: [view, -1], ArrowUp: [view, 1],\n"
    "  '-': [zoom, -1], '+': [zoom, 1], ' ': [across, 0],\n"
    "};\n"
    "onkeydown = event => {\n"
    "  const [slider, by] = keys[event.key] || [];\n"
    "  if (event.target !== document.body) return;\n"
    "  if (event.ctrlKey || event.altKey || event.metaKey) return;\n"
    "  if (!slider) return;\n"
    "  event.preventDefault();\n"
    "  if (by) slider.stepUp(by); else toggle(slider);\n"
    "  if (slider === zoom) magnify();\n"
    "  update();\n"
    "};\n"
    "frame.onpointermove = event => {\n"
    "  if (event.pointerType !== 'mouse' || !(event.buttons & 1)) return;\n"
    "  frame.scrollBy(-event.movementX, -event.movementY);\n"
    "};\n"
    "document.querySelector('fieldset').disabled = false;\n"
    "update();\n";

/* What a picture shows, in words: its view and its time if there are several of them, or else
 * its file. */
static void put_alt(const struct album *a, const struct album_picture *p, struct buf *out)
{
    if (a->n_views > 1 || (a->n_times > 1 && p->view[0])) {
        html_word(out, p->view);
        if (a->n_times > 1) buf_printf(out, ", ");
    }
    if (a->n_times > 1) {
        buf_printf(out, "time ");
        html_word(out, p->time);
    }
    if (a->n_pictures == 1) html_word(out, p->path);
}

/* A slider with its label and its value; of: what a button plays, or NULL. */
static void put_row(struct buf *out, const char *id, const char *label, const char *range,
    const char *value, bool button)
{
    buf_printf(out,
        "<div><label for=\"%s\">%s</label><input type=\"range\" id=\"%s\" %s>"
        "<output for=\"%s\">",
        id, label, id, range, id);
    html_word(out, value);
    buf_printf(out, "</output>");
    if (button) buf_printf(out, "<button type=\"button\" value=\"%s\">Play %ss</button>", id, id);
    buf_printf(out, "</div>\n");
}

static void put_choice(
    struct buf *out, const char *id, const char *label, size_t n, const char *value)
{
    char range[64];
    snprintf(range, sizeof range, "min=\"0\" max=\"%zu\" value=\"0\"", n - 1);
    if (n > 1) put_row(out, id, label, range, value, true);
}

void album_head(const struct album *a, const char *title, struct buf *out)
{
    const struct album_picture *first = a->pictures;
    buf_append(out, begin, sizeof begin - 1);
    buf_printf(out, "<title>");
    html_word(out, title);
    buf_printf(out, "</title>\n");
    buf_append(out, style, sizeof style - 1);
    buf_printf(out, "</head><body>\n<h1>");
    html_word(out, title);
    buf_printf(out,
        "</h1>\n<figure>\n<div id=\"frame\" tabindex=\"0\" role=\"group\" aria-label=\"Picture\" "
        "style=\"--w:%" PRIu32 ";--h:%" PRIu32 ";--zoom:1\"><img draggable=\"false\" alt=\"",
        a->w, a->h);
    put_alt(a, first, out);
    buf_printf(out, "\" src=\"data:image/png;base64,");
    html_base64(out, buf_data(&first->png), buf_size(&first->png));
    buf_printf(out, "\"></div>\n<figcaption>");
    html_word(out, first->path);
    buf_printf(out, "</figcaption>\n</figure>\n<form autocomplete=\"off\"><fieldset disabled>\n");
    put_choice(out, "time", "Time", a->n_times, first->time);
    put_choice(out, "view", "View", a->n_views, first->view);
    put_row(out, "zoom", "Zoom", "min=\"1\" max=\"8\" step=\"0.25\" value=\"1\"", "100 %", false);
    if (a->n_pictures > 1)
        put_row(out, "rate", "Speed", "min=\"1\" max=\"25\" value=\"4\"", "4 a second", false);
    buf_printf(out, "</fieldset></form>\n<p>Keys: ");
    if (a->n_pictures > 1) buf_printf(out, "left and right, space to play; ");
    if (a->n_views > 1 && a->n_times > 1) buf_printf(out, "up and down for views; ");
    buf_printf(out, "+ and &minus; to zoom. Drag a zoomed picture to move it.</p>\n"
                    "<noscript><p>Without scripts, this page shows its first picture only.</p>"
                    "</noscript>\n");
}

void album_block(const struct album *a, size_t i, struct buf *out)
{
    const struct album_picture *p = a->pictures + i;
    buf_printf(out, "<script type=\"image/png\" data-file=\"");
    html_word(out, p->path);
    buf_printf(out, "\" data-view=\"");
    html_word(out, p->view);
    buf_printf(out, "\" data-time=\"");
    html_word(out, p->time);
    buf_printf(out, "\" data-alt=\"");
    put_alt(a, p, out);
    buf_printf(out, "\">");
    if (i > 0) html_base64(out, buf_data(&p->png), buf_size(&p->png));
    buf_printf(out, "</script>\n");
}

void album_foot(struct buf *out)
{
    buf_printf(out, "<script>");
    buf_append(out, script, sizeof script - 1);
    buf_printf(out, "</script>\n</body></html>\n");
}
