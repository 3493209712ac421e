/* Unknown keys of tasks: see tags.h. */
#include "drive/tags.h"

#include <stdlib.h>
#include <string.h>

#define KNOWN_WORDS 9 /* task F ID X Y W H SX SY */

/* Payload of a task. */
struct tag {
    char *text; /* "key=value ..."; owned */
};

static struct tag *tag_at(const struct tags *t, int32_t i) { return tasks_extra(&t->tasks, i); }

void tags_init(struct tags *t) { tasks_init(&t->tasks, sizeof(struct tag)); }

/* r's line from its first unknown key, without known keys; NULL: none. The caller frees it. */
static char *unknown_keys(const struct record *r)
{
    static const char *const known[] = {"to", "peer", NULL};
    struct buf line = {0};
    if (!memchr(r->line, '=', r->line_len)) return NULL;
    wire_forward(&line, r, known, NULL);
    line.data[line.len - 1 - WIRE_SEAL_BYTES] = '\0'; /* without its sum */
    const char *at = (const char *)buf_data(&line);
    for (int i = 0; at && i < KNOWN_WORDS; i++) {
        at = strchr(at, ' ');
        if (at) at++;
    }
    char *text = at ? xstrdup(at) : NULL;
    buf_free(&line);
    return text;
}

void tags_keep(struct tags *t, const struct record *r)
{
    char *text = unknown_keys(r);
    if (!text) return;
    tags_drop(t, &r->task);
    tag_at(t, tasks_add(&t->tasks, &r->task, 0))->text = text;
}

const char *tags_find(const struct tags *t, uint32_t frame, uint32_t id)
{
    int32_t i = tasks_find(&t->tasks, frame, id);
    return i < 0 ? NULL : tag_at(t, i)->text;
}

void tags_drop(struct tags *t, const struct task *task)
{
    int32_t i = tasks_find(&t->tasks, task->frame, task->id);
    if (i < 0) return;
    free(tag_at(t, i)->text);
    tasks_remove(&t->tasks, i);
}

void tags_free(struct tags *t)
{
    for (int32_t i = 0; i < t->tasks.cap; i++)
        if (t->tasks.at[i].live) free(tag_at(t, i)->text);
    tasks_free(&t->tasks);
}
