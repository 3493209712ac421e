/* Cutting a frame into tasks. */
#include "task/task.h"

#include <stdio.h>
#include <string.h>

/* NAME or NAME:N */
static bool parse_chunks(const char *s, const char *name, enum cut_unit unit, struct cut *cut)
{
    size_t len = strlen(name);
    int64_t n = 0;
    if (strncmp(s, name, len) != 0) return false;
    if (s[len] && (s[len] != ':' || !parse_int(s + len + 1, 1, UINT32_MAX, &n))) return false;
    *cut = (struct cut){.unit = unit, .w = (uint32_t)n};
    return true;
}

/* WxH or WxH:TASKS */
static bool parse_tile(const char *s, struct cut *cut)
{
    char size[32];
    int w, h;
    int64_t tasks = 0;
    const char *colon = strchr(s, ':');
    size_t len = colon ? (size_t)(colon - s) : strlen(s);
    snprintf(size, sizeof size, "%.*s", len < sizeof size ? (int)len : 0, s);
    if (!parse_size(size, FRAME_SIDE_MAX, &w, &h)) return false;
    if (colon && !parse_int(colon + 1, 1, CUT_TASKS_MOST, &tasks)) return false;
    *cut = (struct cut){
        .unit = CUT_TILE, .w = (uint32_t)w, .h = (uint32_t)h, .tasks = (uint32_t)tasks};
    return true;
}

bool cut_parse(const char *s, struct cut *cut)
{
    int64_t n;
    if (strcmp(s, "row") == 0) *cut = (struct cut){.unit = CUT_ROW};
    else if (strcmp(s, "scatter") == 0) *cut = (struct cut){.unit = CUT_SCATTER, .w = 1};
    else if (strcmp(s, "fine") == 0)
        *cut = (struct cut){.unit = CUT_FINE, .tasks = CUT_TASKS_A_SLOT};
    else if (strncmp(s, "fine:", 5) == 0 && parse_int(s + 5, 1, CUT_TASKS_MOST, &n))
        *cut = (struct cut){.unit = CUT_FINE, .tasks = (uint32_t)n};
    else if (strncmp(s, "coarse:", 7) == 0 && parse_int(s + 7, 1, UINT32_MAX, &n))
        *cut = (struct cut){.unit = CUT_COARSE, .w = (uint32_t)n, .tasks = CUT_TASKS_A_SLOT};
    else if (strncmp(s, "tile:", 5) == 0) return parse_tile(s + 5, cut);
    else if (strncmp(s, "run:", 4) == 0 && parse_int(s + 4, 1, UINT32_MAX, &n))
        *cut = (struct cut){.unit = CUT_RUN, .w = (uint32_t)n};
    else
        return parse_chunks(s, "guided", CUT_GUIDED, cut) ||
               parse_chunks(s, "factoring", CUT_FACTORING, cut);
    return true;
}

static uint32_t ceil_div(uint64_t a, uint64_t b) { return (uint32_t)((a + b - 1) / b); }

void cut_suit(struct cut *cut, uint32_t frame_w, uint32_t frame_h, int slots)
{
    uint64_t tasks = (uint64_t)cut->tasks * (uint32_t)slots;
    if (cut->unit == CUT_TILE) {
        while (cut_count(cut, frame_w, frame_h) < tasks && (cut->w > 1 || cut->h > 1)) {
            uint32_t *side = cut->w > cut->h ? &cut->w : &cut->h;
            *side = ceil_div(*side, 2);
        }
        return;
    }
    uint32_t run = (uint32_t)((uint64_t)frame_w * frame_h / tasks);
    if (cut->unit == CUT_COARSE) run = run > cut->w ? run : cut->w;
    else run = run < 1 ? 1 : run < frame_w ? run : frame_w;
    *cut = (struct cut){.unit = CUT_RUN, .w = run};
}

uint32_t cut_count(const struct cut *cut, uint32_t frame_w, uint32_t frame_h)
{
    uint64_t pixels = (uint64_t)frame_w * frame_h;
    switch (cut->unit) {
    case CUT_TILE: return ceil_div(frame_w, cut->w) * ceil_div(frame_h, cut->h);
    case CUT_RUN: return ceil_div(pixels, cut->w);
    case CUT_SCATTER: return (uint32_t)(cut->w < pixels ? cut->w : pixels);
    case CUT_GUIDED:
    case CUT_FACTORING: return cut->n;
    case CUT_FINE:
    case CUT_COARSE:
    case CUT_ROW: break;
    }
    return frame_h;
}

static uint32_t least(uint64_t a, uint64_t b) { return (uint32_t)(a < b ? a : b); }

struct task cut_task(const struct cut *cut, uint32_t frame_w, uint32_t frame_h, uint32_t id)
{
    uint64_t pixels = (uint64_t)frame_w * frame_h;
    struct lattice at = {0, id, frame_w, 1, 1, 1};
    if (cut->unit == CUT_TILE) {
        uint32_t across = ceil_div(frame_w, cut->w);
        at.x = id % across * cut->w;
        at.y = id / across * cut->h;
        at.w = least(cut->w, frame_w - at.x);
        at.h = least(cut->h, frame_h - at.y);
    } else if (cut->unit == CUT_RUN) {
        uint64_t start = (uint64_t)id * cut->w;
        at.x = (uint32_t)(start % frame_w);
        at.y = (uint32_t)(start / frame_w);
        at.w = least(cut->w, pixels - start);
    } else if (cut->unit == CUT_SCATTER) {
        uint32_t sets = least(cut->w, pixels);
        at = (struct lattice){id % frame_w, id / frame_w, ceil_div(pixels - id, sets), 1, sets, 1};
    } else if (cut->unit == CUT_GUIDED || cut->unit == CUT_FACTORING) {
        at = chunk_at(cut, frame_w, frame_h, id);
    }
    return (struct task){.frame = 0, .id = id, .at = at, .to = -1};
}
