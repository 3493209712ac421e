/*
 * gltf: what only the JSON of a glTF says: extensions that libassimp passes over, the texture
 * coordinates that KHR_texture_transform chooses, and skins, without which the mesh rests as with
 * them, and with which libassimp may crash.
 */
#include "mesh/mesh_int.h"

#include <stdlib.h>
#include <string.h>

#define DEPTH 8         /* objects and lists within each other, of what is looked for */
#define GLTF_FLOAT 5126 /* the type of a component */
#define NAME 32         /* longer names are none of those that are looked for */

struct level {
    char name[NAME]; /* "": an element of a list */
    uint32_t n;      /* elements or members before this one */
    uint32_t set;    /* the number of texCoord; UINT32_MAX: none */
};

struct walk {
    FILE *f;
    uint64_t left; /* bytes of JSON */
    struct mesh *m;
    size_t depth;
    struct level at[DEPTH];
    char text[ERR_WORD], key[NAME]; /* the last string; the name of the next value */
    char *unread;
    uint32_t value;        /* of a number that is looked for, so far */
    uint32_t *types, *uvs; /* of accessors; accessors that are coordinates of textures */
    size_t n_types, n_uvs;
};

/* Stands at the JSON, and returns its length; 0: this is no glTF. */
static uint64_t find_json(FILE *f)
{
    unsigned char b[20];
    const size_t n = fread(b, 1, sizeof b, f);
    if (n == sizeof b && memcmp(b, "glTF", 4) == 0)
        return b[12] | (uint64_t)b[13] << 8 | (uint64_t)b[14] << 16 | (uint64_t)b[15] << 24;
    rewind(f);
    return memchr(b, '{', n < 4 ? n : 4) ? UINT64_MAX : 0;
}

static int next(struct walk *w)
{
    if (!w->left) return EOF;
    w->left--;
    return getc(w->f);
}

/* Extensions of glTF that may be required: libassimp reads them, or they change looks alone. */
static bool is_read(const char *extension)
{
    static const char *const begin[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
        "MSFT_texture_", "KHR_lights_punctual", "KHR_draco_mesh_compression", "KHR_xmp"};
    for (size_t i = 0; i < sizeof begin / sizeof *begin; i++)
        if (strncmp(extension, begin[i], strlen(begin[i])) == 0) return true;
    return false;
}

/* Those that may be used without being required, although other meshes are seen with them. */
static bool is_lost(const char *extension)
{
    return strcmp(extension, "EXT_mesh_gpu_instancing") == 0 ||
           strcmp(extension, "KHR_node_visibility") == 0;
}

static void take_string(struct walk *w)
{
    size_t n = 0;
    for (int c; (c = next(w)) != EOF && c != '"';) {
        if (c == '\\') c = next(w);
        if (n + 1 < sizeof w->text) w->text[n++] = (char)c;
    }
    w->text[n] = '\0';
    const char *list = w->depth == 2 ? w->at[1].name : "";
    if (strcmp(list, "extensionsUsed") == 0) w->m->lost_extensions += is_lost(w->text);
    const bool quantized = strcmp(w->text, "KHR_mesh_quantization") == 0;
    if ((quantized && strcmp(list, "extensionsUsed") == 0) ||
        (strcmp(list, "extensionsRequired") == 0 && !is_read(w->text)))
        err_word(w->unread, w->text, strlen(w->text));
}

static void enter(struct walk *w)
{
    if (w->depth < DEPTH) {
        struct level *l = &w->at[w->depth];
        *l = (struct level){.n = 0, .set = UINT32_MAX};
        memcpy(l->name, w->key, NAME);
    }
    w->depth++;
    *w->key = '\0';
}

/* The root, the list of scenes or of materials, one of them, pbrMetallicRoughness, and
 * baseColorTexture with its extensions. */
static void leave(struct walk *w)
{
    const struct level *at = w->at;
    struct mesh *m = w->m;
    if (w->depth == 7 && at[6].set != UINT32_MAX && strcmp(at[1].name, "materials") == 0 &&
        strcmp(at[4].name, "baseColorTexture") == 0 &&
        strcmp(at[6].name, "KHR_texture_transform") == 0) {
        m->sets = xgrown(m->sets, m->n_sets, sizeof *m->sets);
        m->sets[m->n_sets++] = (struct mesh_set){at[1].n, at[6].set};
    }
    if (w->depth == 2 && strcmp(at[1].name, "scenes") == 0) m->lost_scenes = at[1].n;
    if (w->depth) w->depth--;
}

static bool is_type(const struct walk *w)
{
    return w->depth == 3 && strcmp(w->key, "componentType") == 0 &&
           strcmp(w->at[1].name, "accessors") == 0;
}
static bool is_uv(const struct walk *w) { return strncmp(w->key, "TEXCOORD_", 9) == 0; }

/* Stands behind a value. */
static void end_value(struct walk *w)
{
    if (is_type(w)) {
        w->types = xgrown(w->types, w->n_types, sizeof *w->types);
        w->types[w->n_types++] = w->value;
    } else if (is_uv(w)) {
        w->uvs = xgrown(w->uvs, w->n_uvs, sizeof *w->uvs);
        w->uvs[w->n_uvs++] = w->value;
    }
    *w->key = '\0';
    w->value = 0;
}

static void take_digit(struct walk *w, uint32_t digit)
{
    if (w->value < 100000000 && (is_type(w) || is_uv(w))) w->value = w->value * 10 + digit;
    if (strcmp(w->key, "texCoord") != 0 || !w->depth || w->depth > DEPTH) return;
    uint32_t *set = &w->at[w->depth - 1].set;
    *set = *set < 1000 ? *set * 10 + digit : digit;
}

static void step(struct walk *w, int c)
{
    switch (c) {
    case '"': take_string(w); break;
    case ':':
        snprintf(w->key, NAME, "%.*s", NAME - 1, w->text);
        w->m->skins += strcmp(w->key, "skin") == 0;
        break;
    case '{':
    case '[': enter(w); break;
    case '}':
    case ']':
        end_value(w);
        leave(w);
        break;
    case ',':
        end_value(w);
        if (w->depth && w->depth <= DEPTH) w->at[w->depth - 1].n++;
        break;
    default:
        if (c >= '0' && c <= '9') take_digit(w, (uint32_t)(c - '0'));
    }
}

void mesh_gltf_read(struct mesh *m, FILE *f, char unread[ERR_WORD])
{
    struct walk w = {.f = f, .left = find_json(f), .m = m, .unread = unread};
    *unread = '\0';
    for (int c; (c = next(&w)) != EOF;) step(&w, c);
    for (size_t i = 0; i < w.n_uvs; i++)
        m->bad_coordinates |= w.uvs[i] < w.n_types && w.types[w.uvs[i]] != GLTF_FLOAT;
    free(w.types);
    free(w.uvs);
}

/* Gives the nodes' skins a name that libassimp does not know. */
void mesh_gltf_copy(FILE *from, FILE *to)
{
    char *part = NULL;
    size_t room = 0;
    ptrdiff_t n;
    const uint64_t json = find_json(from);
    const uint64_t end = json == UINT64_MAX ? json : 20 + json;
    uint64_t at = 0;
    rewind(from);
    for (; (n = getdelim(&part, &room, '"', from)) > 0; at += (uint64_t)n) {
        if (n == 5 && at < end && memcmp(part, "skin\"", 5) == 0) part[3] = 'N';
        fwrite(part, 1, (size_t)n, to);
    }
    free(part);
}
