/* off: whether the faces of an OFF have colours, which libassimp passes over. */
#include "mesh/mesh_int.h"

#include <stdlib.h>
#include <string.h>

/* The text of a line without its comment, and without blanks before it. */
static char *text_of(char *line)
{
    line[strcspn(line, "#\r\n")] = '\0';
    line += mesh_bytes_marked((const unsigned char *)line, strlen(line));
    return line + strspn(line, " \t");
}

/* What follows the first word, such as COFF; NULL: it is that of another format. In nOFF the number
 * of dimensions follows. */
static char *behind_word(char *text)
{
    text += strspn(text, "STCN4");
    return strncmp(text, "OFF", 3) == 0 ? text_of(text + 3) : NULL;
}

/* Takes the next word, and the blanks behind it; 0: it is no number. */
static int64_t take_number(char **text)
{
    int64_t n = 0;
    char *end = *text + strcspn(*text, " \t");
    char *rest = end + strspn(end, " \t");
    *end = '\0';
    parse_int(*text, 0, INT64_MAX, &n);
    *text = rest;
    return n;
}

/* A face: the number of its corners, their vertices, and then its colour. */
static bool is_painted(char *text)
{
    for (int64_t corners = take_number(&text); *text && corners; corners--) take_number(&text);
    return *text != '\0';
}

bool mesh_off_paints(FILE *f)
{
    char *line = NULL;
    size_t room = 0;
    int64_t vertices = 0;
    bool begun = false, counted = false, paints = false;
    while (!paints && getline(&line, &room, f) > 0) {
        char *text = text_of(line);
        if (*text && !begun) {
            if (!(text = behind_word(text))) break;
            begun = true;
        }
        if (!*text) continue;
        if (!counted) vertices = take_number(&text), counted = true;
        else if (vertices) vertices--;
        else paints = is_painted(text);
    }
    free(line);
    return paints;
}
