/*
 * nff_read: reads NFF (E. Haines, NFF.TXT 3.1): a stream of tokens. Each entity is a letter and its
 * numbers, with any line breaks. Differs in: view, lights and background may come anywhere; a
 * material may be missing; the words of a view may come in any order. A light has a colour if a
 * number follows its position, because no entity begins with a number.
 */
#include "scene/prim.h"

#include <stdlib.h>
#include <string.h>

static bool read_background(struct reader *r)
{
    if (r->background_line)
        return reader_fail(
            r, "a second background, expected only the one at line %u", r->background_line);
    r->background_line = r->t.line;
    return reader_rgb(r, "background colour", r->s->background);
}

static bool read_light(struct reader *r)
{
    struct scene *s = r->s;
    struct light l = {.own_colour = false};
    if (!reader_point(r, "light's position", &l.pos)) return false;
    size_t n = token_peek(&r->t);
    if (n && strchr("0123456789+-.", r->t.at[0]) && r->t.at[0]) {
        double rgb[3];
        if (!reader_rgb(r, "light's colour", rgb)) return false;
        l.r = rgb[0], l.g = rgb[1], l.b = rgb[2];
        l.own_colour = true;
    }
    s->lights = reader_grown(s->lights, s->n_lights, &r->room_lights, sizeof l);
    s->lights[s->n_lights++] = l;
    return true;
}

/* Besides the primitives. */
static const struct entity {
    char word[NFF_WORD_MAX + 1];
    bool (*read)(struct reader *);
} entities[] = {
    {"v", reader_view}, {"b", read_background}, {"l", read_light}, {"f", reader_material}};
#define ENTITIES (sizeof entities / sizeof *entities)

static bool is_word(const char *word, const char *at, size_t n)
{
    return strlen(word) == n && memcmp(word, at, n) == 0;
}

static const struct prim_row *find_prim(const char *word, size_t n)
{
    for (int i = 0; i < PRIM_KINDS; i++)
        if (is_word(scene_prims[i]->word, word, n)) return scene_prims[i];
    return NULL;
}

static const struct entity *find_entity(const char *word, size_t n)
{
    for (size_t i = 0; i < ENTITIES; i++)
        if (is_word(entities[i].word, word, n)) return &entities[i];
    return NULL;
}

bool nff_is_entity(const char *word, size_t n)
{
    return find_prim(word, n) || find_entity(word, n);
}

static bool fail_entity(struct reader *r)
{
    char words[(NFF_WORD_MAX + 1) * (ENTITIES + PRIM_KINDS) + sizeof "one of"] = "one of";
    size_t n = strlen(words);
    for (size_t i = 0; i < ENTITIES + PRIM_KINDS; i++)
        n += (size_t)snprintf(words + n, sizeof words - n, " %s",
            i < ENTITIES ? entities[i].word : scene_prims[i - ENTITIES]->word);
    return reader_fail_token(r, "entity", words);
}

static bool read_entity(struct reader *r, size_t n)
{
    const struct prim_row *p = find_prim(r->t.at, n);
    const struct entity *e = p ? NULL : find_entity(r->t.at, n);
    if (!p && !e) return fail_entity(r);
    if (r->s->n_prims >= NFF_COUNT_MAX || r->s->n_lights >= NFF_COUNT_MAX)
        return reader_fail(r, "more entities than %u", NFF_COUNT_MAX);
    token_take(&r->t, n);
    return p ? p->read(r) : e->read(r);
}

bool reader_entities(struct reader *r)
{
    for (size_t n; (n = token_peek(&r->t)) != 0;)
        if (!read_entity(r, n)) return false;
    return true;
}

void nff_share_light(struct scene *s)
{
    for (uint32_t i = 0; i < s->n_lights; i++) {
        struct light *l = &s->lights[i];
        if (!l->own_colour) l->r = l->g = l->b = 1 / sqrt(s->n_lights);
    }
}

static bool read_all(struct reader *r)
{
    reader_add_material(r, &NFF_MATERIAL_DEFAULT);
    if (!reader_entities(r)) return false;
    if (!r->view_line) return reader_fail(r, "the file ends without a view, expected a 'v'");
    nff_share_light(r->s);
    return true;
}

int nff_read(const char *name, const char *text, size_t n, struct scene *s, char err[SCENE_ERR])
{
    struct reader r = {.name = name, .err = err, .s = s};
    *s = (struct scene){0};
    err[0] = '\0';
    tokens_init(&r.t, text, n);
    bool ok = read_all(&r);
    free(r.material_slot);
    if (!ok) scene_free(s);
    return ok ? 0 : -1;
}

uint32_t nff_line(const char *text, size_t n, uint32_t i)
{
    struct tokens t;
    tokens_init(&t, text, n);
    for (size_t len; (len = token_peek(&t)) > 0; token_take(&t, len))
        if (find_prim(t.at, len) && i-- == 0) return t.line;
    return t.line;
}
