/* spec: what is wrong with a line. */
#include "spec/spec_int.h"

bool spec_fail(struct spec_reader *r, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    err_at(r->err, r->name, r->line, fmt, ap);
    va_end(ap);
    return false;
}
