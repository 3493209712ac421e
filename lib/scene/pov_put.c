/* pov_put: numbers, points and materials for POV-Ray. */
#include "scene/prim.h"

#include <stdlib.h>

/* Writes the shorter of 15 and 17 digits that reads back as v. */
void pov_real(struct pov *o, const char *lead, double v)
{
    char text[32];
    snprintf(text, sizeof text, "%.15g", v);
    if (strtod(text, NULL) != v) snprintf(text, sizeof text, "%.17g", v);
    fputs(lead, o->f);
    fputs(text, o->f);
}

void pov_vec(struct pov *o, const char *lead, struct vec3 v)
{
    fputs(lead, o->f);
    pov_real(o, "<", v.x);
    pov_real(o, ",", v.y);
    pov_real(o, ",", v.z);
    putc('>', o->f);
}

void pov_point(struct pov *o, const char *lead, struct vec3 v)
{
    pov_vec(o, lead, v3_scale(v, o->scale));
}

void pov_material(struct pov *o, uint32_t i)
{
    const struct material *m = &o->s->materials[i];
    fprintf(o->f, " texture { M%u }", i);
    if (m->t > 0) {
        pov_real(o, " interior { ior ", m->ior);
        fputs(" }", o->f);
    }
    fputs(" }\n", o->f);
}
