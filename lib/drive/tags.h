/*
 * What a task record says beyond the grammar: keys that this version does not know are passed on
 * with their task, whatever the policy does with it. Tasks without any cost nothing.
 */
#ifndef STORMRING_TAGS_H
#define STORMRING_TAGS_H

#include "wire/wire.h"

struct tags {
    struct task_table tasks; /* those that have unknown keys */
    char **text;             /* by the table's index: "key=value ..." */
    int32_t room;
};
/* Keeps r's unknown keys, if any. */
void tags_keep(struct tags *t, const struct record *r);
/* NULL, or the keys of this task, good until it is dropped. */
const char *tags_find(const struct tags *t, uint32_t frame, uint32_t id);
void tags_drop(struct tags *t, const struct task *task);
void tags_free(struct tags *t);

#endif
