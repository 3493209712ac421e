/* The options of a worker, and what its -i prints. */
#include "job/job.h"

#include <stdlib.h>
#include <string.h>

#define BLANKS " \t\n"

char **job_words(const char *options, size_t *n)
{
    const size_t room = strlen(options) / 2 + 2; /* of words */
    char **words = xcalloc(1, room * sizeof *words + strlen(options) + 1);
    char *at = memcpy(words + room, options, strlen(options) + 1);
    for (*n = 0; *(at += strspn(at, BLANKS));) {
        words[(*n)++] = at;
        at += strcspn(at, BLANKS);
        if (*at) *at++ = '\0';
    }
    return words;
}

bool job_words_check(
    const struct job *j, const char *options, char *const *words, char err[ERR_BYTES])
{
    const char *before = "";
    for (; *words; before = *words++) {
        const char *w = *words;
        if (strncmp(w, "-s", 2) == 0)
            return err_set(err, "%s: expected the size with -s before -W", options);
        if (strncmp(w, "-j", 2) == 0)
            return err_set(err, "%s: expected the slots with -j before -W", options);
        if (!job_foreign(j) || strchr("-+", *w) || strchr(w, '=')) continue;
        if (*before == '-' && before[strlen(before) - 1] == 'f') continue; /* -f PIXELS */
        return err_set(err, "%s: expected options of %s%s or NAME=VALUE", w, job_worker(j),
            j->what == JOB_POV ? ", +WORD" : "");
    }
    return true;
}

/* Reads up to 3 numbers. Returns how many there are; 0: there is something else. */
static int numbers(const char *text, int64_t to[3])
{
    size_t n;
    char **words = job_words(text, &n);
    bool good = n <= 3;
    for (size_t i = 0; good && i < n; i++) good = parse_int(words[i], 0, UINT32_MAX, &to[i]);
    free(words);
    return good ? (int)n : 0;
}

bool job_frames_take(struct job_frames *f, const char *line)
{
    static const char frame[] = "frame ", job[] = "job=";
    int64_t of[3] = {0};
    if (strncmp(line, frame, sizeof frame - 1) == 0) {
        int n = numbers(line + sizeof frame - 1, of);
        if (n < 2 || !of[0]) return false;
        memcpy(f->of, of, sizeof of);
        if (n < 3) f->of[2] = f->n;
        return true;
    }
    if (strncmp(line, job, sizeof job - 1) != 0 || !f->of[0]) return false;
    wire_frame(&f->text, (uint32_t)f->of[2], (uint32_t)f->of[0], (uint32_t)f->of[1], line);
    f->of[0] = 0;
    f->n++;
    return true;
}
