/* choose: which messages count, and by which keys those of one level and time differ. */
#include "grib/grib_int.h"

#include <stdlib.h>
#include <string.h>

/* In the order in which a message names them. */
static const char *const keys[GB_CHOICES] = {"number", "stepType", "stepRange", "dataType",
    "experimentVersionNumber", "dataDate", "dataTime", "derivedForecast", "percentileValue",
    "scaledValueOfLowerLimit", "scaledValueOfUpperLimit", "constituentType", "aerosolType",
    "stream", "centre", "generatingProcessIdentifier", "edition", "parameterCategory",
    "parameterNumber", "count"};

/* The value of a key. "count" is the number of the message in the file, from 1, as in the tools of
 * ecCodes. */
static void value_of(const codes_handle *h, size_t number, const char *key, char *out, size_t room)
{
    if (strcmp(key, "count") == 0) snprintf(out, room, "%zu", number + 1);
    else gb_text(h, key, out, room);
}

void gb_read_choices(const codes_handle *h, size_t number, struct gb_entry *e)
{
    for (int i = 0; i < GB_CHOICES; i++) value_of(h, number, keys[i], e->choice[i], GB_CHOICE);
}

/* True if the value is one of those, with / between; numbers are compared as such. */
static bool is_one_of(const char *value, const char *values)
{
    char *list = xstrdup(values), *rest = list, *word;
    double v, w;
    bool found = false;
    const bool number = parse_real(value, -GRID_MAX, GRID_MAX, &v);
    while (!found && (word = text_part(&rest, '/')) != NULL)
        found = strcmp(word, value) == 0 ||
                (number && parse_real(word, -GRID_MAX, GRID_MAX, &w) && fabs(v - w) <= 0);
    free(list);
    return found;
}

bool gb_counts(const codes_handle *h, size_t number, const struct gb_where *where, size_t n,
    struct gb_entry *e)
{
    char value[GB_TEXT];
    for (size_t i = 0; i < n; i++) {
        value_of(h, number, where[i].key, value, sizeof value);
        if (where[i].over) snprintf(e->member, sizeof e->member, "%.*s", GB_CHOICE - 1, value);
        else if (!is_one_of(value, where[i].values)) return false;
    }
    return true;
}

/* Appends the values that a key has in the stack, as KEY=A, B or C. */
static void list(const struct gb_stack *s, int key, struct buf *out)
{
    size_t many = 0;
    buf_printf(out, "%s=", keys[key]);
    for (size_t i = 0; i < s->n; i++) {
        size_t before = 0;
        while (before < i && strcmp(s->at[before].choice[key], s->at[i].choice[key]) != 0) before++;
        if (before < i || !*s->at[i].choice[key]) continue;
        if (++many > 6) break;
        buf_printf(out, "%s%s", many > 1 ? "|" : "", s->at[i].choice[key]);
    }
    if (many > 6) buf_printf(out, "|...");
}

bool gb_refuse(const struct gb_stack *s, const struct gb_entry *e, char err[ERR_BYTES])
{
    struct buf out = {0};
    int found = 0;
    for (int i = 0; i < GB_CHOICES && found < 3; i++) {
        const bool differs = strcmp(e->choice[i], e[-1].choice[i]) != 0;
        if (!differs || (found && i == GB_CHOICES - 1)) continue; /* the count differs always */
        buf_printf(&out, buf_size(&out) ? " or " : "");
        list(s, i, &out);
        found += *e->choice[i] && *e[-1].choice[i]; /* one without a value needs another key */
    }
    buf_append(&out, "", 1);
    err_set(err, "several fields at level %g of one time, expected one: -w %s%s", e->level,
        (const char *)buf_data(&out),
        strncmp((const char *)buf_data(&out), "number", 6) == 0 ? ", or number=mean or spread"
                                                                : "");
    buf_free(&out);
    return false;
}
