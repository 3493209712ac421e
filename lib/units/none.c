/* none: takes the place of udunits where libudunits2 is missing. */
#include "units/units.h"

#include <string.h>

bool units_linear(const char *from, const char *to, struct units_linear *l, char err[ERR_BYTES])
{
    *l = (struct units_linear){1, 0};
    return strcmp(from, to) == 0 ||
           err_set(err, "built without libudunits2-dev, expected '%.60s' to be '%.60s'", from, to);
}

static bool lacks(char *out, size_t room, char err[ERR_BYTES])
{
    if (room) *out = '\0';
    return err_set(err, "built without libudunits2-dev, expected no product of units");
}

bool units_product(
    const char *a, const char *b, int sign, char *out, size_t room, char err[ERR_BYTES])
{
    (void)a, (void)b, (void)sign;
    return lacks(out, room, err);
}

bool units_power(const char *unit, int power, char *out, size_t room, char err[ERR_BYTES])
{
    (void)unit, (void)power;
    return lacks(out, room, err);
}

bool units_date(double v, const char *unit, struct units_date *d)
{
    (void)v, (void)unit, (void)d;
    return false;
}
