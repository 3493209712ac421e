/* method: the names of the methods and the number that follows each. */
#include "volume/volume.h"

#include <string.h>

#define SUBSTEPS_MAX 1000000
#define TOLERANCE_MIN 1e-9

static const struct {
    const char *name;
    int most; /* maximum n, which must follow; 0: a tolerance may follow */
} methods[] = {
    [VOLUME_ADAPTIVE] = {"adaptive", 0},
    [VOLUME_DOUBLING] = {"doubling", 0},
    [VOLUME_TRAPEZOID] = {"trapezoid", SUBSTEPS_MAX},
    [VOLUME_GAUSS] = {"gauss", VOLUME_NODES_MAX},
};
#define METHODS (sizeof methods / sizeof *methods)
static const struct volume_options usual = VOLUME_OPTIONS_DEFAULT;

bool volume_method_parse(const char *s, struct volume_options *o, char err[ERR_BYTES])
{
    const char *colon = strchr(s, ':');
    size_t n = colon ? (size_t)(colon - s) : strlen(s), i = 0;
    while (i < METHODS && (strlen(methods[i].name) != n || memcmp(methods[i].name, s, n) != 0)) i++;
    if (i == METHODS || (methods[i].most && !colon)) {
        snprintf(err, ERR_BYTES, "adaptive[:E], doubling[:E], trapezoid:N or gauss:M");
        return false;
    }
    double tolerance = usual.tolerance;
    int64_t count = usual.n;
    if (methods[i].most && !parse_int(colon + 1, 1, methods[i].most, &count)) {
        snprintf(
            err, ERR_BYTES, "%s:N, an integer from 1 to %d", methods[i].name, methods[i].most);
        return false;
    }
    if (!methods[i].most && colon && !parse_real(colon + 1, TOLERANCE_MIN, 1, &tolerance)) {
        snprintf(err, ERR_BYTES, "%s:E, a number from %g to 1", methods[i].name, TOLERANCE_MIN);
        return false;
    }
    o->method = (enum volume_method)i;
    o->tolerance = tolerance;
    o->n = (int)count;
    return true;
}

bool volume_method_print(const struct volume_options *o, char text[VOLUME_METHOD])
{
    char number[32];
    if (methods[o->method].most) snprintf(number, sizeof number, "%d", o->n);
    else print_real(number, o->tolerance, 6);
    snprintf(text, VOLUME_METHOD, "%s:%s", methods[o->method].name, number);
    return o->method == usual.method && o->tolerance == usual.tolerance;
}
