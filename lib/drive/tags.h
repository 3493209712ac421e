/*
 * Unknown keys of task records. They are passed on with their task, whatever the policy does with
 * it. Tasks without unknown keys cost nothing.
 */
#ifndef STORMRING_TAGS_H
#define STORMRING_TAGS_H

#include "wire/wire.h"

struct tags {
    struct task_table tasks; /* tasks that have unknown keys */
};
void tags_init(struct tags *t);
/* Keeps r's unknown keys, if any. */
void tags_keep(struct tags *t, const struct record *r);
/* The keys of this task, valid until it is dropped; NULL: none. */
const char *tags_find(const struct tags *t, uint32_t frame, uint32_t id);
void tags_drop(struct tags *t, const struct task *task);
void tags_free(struct tags *t);

#endif
