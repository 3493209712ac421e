/* options: the options that all converters share. */
#include "convert/convert.h"
#include "image/image.h"

#include <string.h>

void convert_option(
    struct convert_options *o, int letter, const char *argument, const char *usage_text)
{
    switch (letter) {
    case 'c': o->round = true; break;
    case 'h': usage(ST_OK, usage_text);
    case 'l': o->list = true; break;
    case 'o': o->out = opt_text(letter, argument); break;
    case 'r':
        o->roll = true;
        o->from = opt_real(letter, argument, -360, 360);
        break;
    case 't':
        o->every = strcmp(argument, "all") == 0;
        if (!o->every) o->time = (size_t)opt_int(letter, argument, 0, UINT32_MAX);
        break;
    case 'u': o->unit = opt_text(letter, argument); break;
    case 'Z': o->standard = true; /* fallthrough */
    case 'z': o->heights = true; break;
    default: usage(ST_USAGE, usage_text);
    }
}

void convert_operands(struct convert_options *o, int n, char **operand, const char *usage_text)
{
    if (n != 2 - o->list) usage(ST_USAGE, usage_text);
    o->file = operand[0];
    o->what = operand[1];
    enum image_naming naming = o->out ? image_name_check(o->out) : IMAGE_NAME_SINGLE;
    if (naming == IMAGE_NAME_BAD) die(ST_USAGE, "-o %s: expected one %%d in it at most", o->out);
    if (o->every && naming != IMAGE_NAME_NUMBERED)
        die(ST_USAGE, "-t all: expected -o with %%d in the name");
}

enum convert_over convert_over_of(const char *word)
{
    return strcmp(word, "mean") == 0     ? CONVERT_MEAN
           : strcmp(word, "spread") == 0 ? CONVERT_SPREAD
                                         : CONVERT_ONE;
}
