/* message: iterates over the messages of a file, and reads their keys. */
#include "grib/grib_int.h"

#include <errno.h>
#include <string.h>

static void say_nothing(const codes_context *c, int level, const char *text)
{
    (void)c, (void)level, (void)text; /* errors are returned as a status */
}

bool gb_open(const char *path, struct gb_file *in, char err[ERR_BYTES])
{
    *in = (struct gb_file){.f = fopen(path, "re")};
    if (!in->f) return err_set(err, "%s", strerror(errno));
    codes_context_set_logging_proc(codes_context_get_default(), say_nothing);
    codes_grib_multi_support_on(NULL);
    codes_grib_multi_support_reset_file(NULL, in->f);
    return true;
}

bool gb_next(struct gb_file *in, char err[ERR_BYTES])
{
    int status = 0;
    if (in->h) {
        codes_handle_delete(in->h);
        in->number++;
    }
    in->h = codes_grib_handle_new_from_file(NULL, in->f, &status);
    if (!status) return true;
    if (in->h) codes_handle_delete(in->h);
    in->h = NULL;
    return err_set(err, "message %zu: %s", in->number + 1, codes_get_error_message(status));
}

bool gb_open_at(const char *path, size_t number, struct gb_file *in, char err[ERR_BYTES])
{
    if (!gb_open(path, in, err)) return false;
    bool good = gb_next(in, err);
    while (good && in->h && in->number < number) good = gb_next(in, err);
    if (good && in->h) return true;
    if (good) err_set(err, "the file has changed, expected the same messages");
    gb_close(in);
    return false;
}

void gb_close(struct gb_file *in)
{
    if (in->h) codes_handle_delete(in->h);
    fclose(in->f);
}

void gb_text(const codes_handle *h, const char *key, char *out, size_t room)
{
    char text[256] = "";
    size_t n = sizeof text;
    if (codes_get_string(h, key, text, &n) != CODES_SUCCESS) text[0] = '\0';
    snprintf(out, room, "%.255s", text);
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 0x7f) *c = ' ';
}

long gb_long(const codes_handle *h, const char *key)
{
    long v = 0;
    return codes_get_long(h, key, &v) == CODES_SUCCESS ? v : 0;
}

double gb_real(const codes_handle *h, const char *key)
{
    double v = 0;
    return codes_get_double(h, key, &v) == CODES_SUCCESS ? v : (double)NAN;
}

/* An image whose y axis points to the south is turned by half a circle. */
static bool is_upside_down(const codes_handle *h)
{
    char kind[GB_TEXT];
    gb_text(h, "gridType", kind, GB_TEXT);
    return strcmp(kind, "space_view") == 0 &&
           fabs(gb_real(h, "orientationOfTheGridInDegrees")) == 180;
}

bool gb_runs_west(const codes_handle *h)
{
    return (gb_long(h, "iScansNegatively") != 0) != is_upside_down(h);
}

bool gb_runs_north(const codes_handle *h)
{
    return (gb_long(h, "jScansPositively") != 0) != is_upside_down(h);
}
