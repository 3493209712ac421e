/*
 * mtl: lines of an MTL that libassimp takes wrong: words in another case; d -halo; aniso and
 * anisor, which Blender writes, and which it refuses; models of illumination, of which it knows 0
 * to 2; -s and -o of base colours, which it passes over. Here they stand before the picture's name.
 */
#include "mesh/mesh_int.h"

#include <string.h>
#include <strings.h>

#define FRAME '|' /* before and behind the numbers that stand before the name of a picture */

static size_t word_of(const char *line) { return strcspn(line, " \t\r\n"); }
static size_t blanks_of(const char *line) { return strspn(line, " \t"); }

/* Takes a word that is a number, and the blanks behind it. */
static bool take_real(const char **line, double *out)
{
    char word[32];
    const size_t n = word_of(*line);
    if (!n || n >= sizeof word) return false;
    snprintf(word, sizeof word, "%.*s", (int)n, *line);
    if (!parse_real(word, -1e9, 1e9, out)) return false;
    *line += n + blanks_of(*line + n);
    return true;
}

/* The options of map_Kd behind the word. Appends others than -s, -o and -t to text. */
static const char *take_options(const char *line, char text[MESH_LEAD], double by[4])
{
    double past;
    while (*line == '-' && line[1] && !strchr(" \t\r\n", line[1])) {
        const size_t n = word_of(line), used = strlen(text);
        const int words = strncmp(line, "-mm", n) == 0 ? 3 : 2;
        const char *next = line + n + blanks_of(line + n);
        if (n == 2 && strchr("sot", line[1])) {
            double *to = line[1] == 's' ? by : line[1] == 'o' ? by + 2 : &past;
            for (int i = 0; i < 3 && take_real(&next, i < 2 && to != &past ? to + i : &past);) i++;
        } else {
            for (int i = 1; i < words; i++) next += word_of(next), next += blanks_of(next);
            snprintf(text + used, MESH_LEAD - used, "%.*s", (int)(next - line), line);
        }
        line = next;
    }
    return line;
}

static size_t take_map(const char *line, size_t from, char lead[MESH_LEAD])
{
    double by[4] = {1, 1, 0, 0};
    char text[MESH_LEAD] = "";
    const char *name = take_options(line + from, text, by);
    const bool moved = by[0] != 1 || by[1] != 1 || by[2] != 0 || by[3] != 0;
    if (name == line + from || !*name) return 0;
    int n = snprintf(lead, MESH_LEAD, "map_Kd %s", text);
    if (moved && n < MESH_LEAD)
        n += snprintf(lead + n, MESH_LEAD - (size_t)n, "%c%.9g %.9g %.9g %.9g%c", FRAME, by[0],
            by[1], by[2], by[3], FRAME);
    if (n < MESH_LEAD) return (size_t)(name - line);
    *lead = '\0';
    return 0;
}

size_t mesh_mtl_line(const char *line, size_t at, size_t n, char lead[MESH_LEAD])
{
    static const char *const words[] = {"Ka", "Kd", "Ks", "Ke", "Ns", "Ni", "d", "Tr", "Tf",
        "illum", "newmtl", "map_Ka", "map_Kd", "map_Ks", "map_Ke", "map_Ns", "map_d", "aniso",
        "anisor"};
    size_t i = 0;
    const size_t all = sizeof words / sizeof *words, next = at + n + blanks_of(line + at + n);
    while (i < all && (n != strlen(words[i]) || strncasecmp(line + at, words[i], n) != 0)) i++;
    if (i == all) return 0;
    const char *word = words[i];
    const size_t map = strcmp(word, "map_Kd") == 0 ? take_map(line, next, lead) : 0;
    if (map) return map;
    if (strncmp(word, "aniso", 5) == 0) return snprintf(lead, MESH_LEAD, "#"), next;
    if (strcmp(word, "illum") == 0 && line[next] >= '0' && line[next] <= '9') {
        const bool matt = line[next] < '2' && word_of(line + next) == 1;
        if (!matt && line[next] == '2') return 0;
        snprintf(lead, MESH_LEAD, "illum %d", matt ? 0 : 2);
        return next + word_of(line + next);
    }
    const bool halo = strcmp(word, "d") == 0 && strncmp(line + next, "-halo", 5) == 0;
    if (!halo && memcmp(line + at, word, n) == 0) return 0;
    snprintf(lead, MESH_LEAD, "%s", word);
    return halo ? next + 5 : at + n;
}

bool mesh_mtl_frame(char *name, double by[4])
{
    char *from = strchr(name, FRAME), *to = from ? strchr(from + 1, FRAME) : NULL;
    if (!to) return false;
    const char *text = from + 1;
    *to = '\0';
    for (int i = 0; i < 4; i++)
        if (!take_real(&text, &by[i])) return false;
    memmove(from, to + 1, strlen(to + 1) + 1);
    return true;
}
