/*
 * nff_material: materials of an NFF scene. Equal materials share an index, because many writers
 * repeat the same `f` before every polygon. Users that group by material (one mesh per material)
 * rely on this.
 */
#include "scene/reader.h"

#include <stdlib.h>
#include <string.h>

#define SHINE_MAX 1e9
#define IOR_MIN 1e-3
#define IOR_MAX 1e3

static uint32_t *slot_of(struct reader *r, const struct material *m)
{
    uint32_t mask = r->n_slots - 1, i = (uint32_t)hash64(HASH64_INIT, m, sizeof *m) & mask;
    while (
        r->material_slot[i] && memcmp(&r->s->materials[r->material_slot[i] - 1], m, sizeof *m) != 0)
        i = (i + 1) & mask;
    return &r->material_slot[i];
}

/* Keeps the table at most half full. */
static void grow_slots(struct reader *r)
{
    if (r->n_slots / 2 > r->s->n_materials) return;
    free(r->material_slot);
    r->n_slots = r->n_slots ? 4 * r->n_slots : 64;
    r->material_slot = xcalloc(r->n_slots, sizeof *r->material_slot);
    for (uint32_t i = 0; i < r->s->n_materials; i++) *slot_of(r, &r->s->materials[i]) = i + 1;
}

void reader_add_material(struct reader *r, const struct material *m)
{
    struct scene *s = r->s;
    grow_slots(r);
    uint32_t *slot = slot_of(r, m);
    if (!*slot) {
        if (s->n_materials == r->room_materials) {
            r->room_materials = r->room_materials ? 2 * r->room_materials : 4;
            s->materials = xrealloc(s->materials, r->room_materials, sizeof *s->materials);
        }
        s->materials[s->n_materials] = *m;
        *slot = ++s->n_materials;
    }
    r->material = *slot - 1;
}

bool reader_material(struct reader *r)
{
    struct material m;
    double rgb[3];
    if (!reader_rgb(r, "colour", rgb) || !reader_real(r, "Kd", 0, COLOUR_MAX, &m.kd) ||
        !reader_real(r, "Ks", 0, COLOUR_MAX, &m.ks) ||
        !reader_real(r, "Shine", 0, SHINE_MAX, &m.shine) ||
        !reader_real(r, "transmittance", 0, 1, &m.t))
        return false;
    /* The index of an opaque material is unused, and 0 in most files. */
    if (!reader_real(r, "index of refraction", m.t > 0 ? IOR_MIN : 0, IOR_MAX, &m.ior))
        return false;
    /* x + 0 turns -0 into 0, so that equal materials have equal bytes. */
    m.r = rgb[0] + 0, m.g = rgb[1] + 0, m.b = rgb[2] + 0;
    m.kd += 0, m.ks += 0, m.shine += 0, m.t += 0, m.ior += 0;
    reader_add_material(r, &m);
    return true;
}
