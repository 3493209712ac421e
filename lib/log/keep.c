/* A run that is kept in a log: see log.h. */
#include "log/log.h"

int log_keep_open(struct log_keep *k, const char *path)
{
    *k = (struct log_keep){.file = {.fd = -1}, .trusted = true};
    if (!path) return 0;
    int failed = log_open(&k->file, path);
    k->trusted = !k->file.holds;
    return failed;
}

int log_keep_flush(struct log_keep *k) { return k->trusted ? log_flush(&k->file) : 0; }

bool log_keep_ignores(const struct log_keep *k, const struct record *r)
{
    return !k->trusted && !k->rereading && (r->kind == REC_FRAG || r->kind == REC_BEAT);
}

void log_keep_record(struct log_keep *k, const struct record *r)
{
    if (k->rereading) return;
    if (r->kind == REC_BYE && !rec_str(r, "why", k->why, sizeof k->why)) *k->why = '\0';
    if (r->kind != REC_BEAT) log_append(&k->file, r);
}

int log_keep_confirm(struct log_keep *k, struct intake *in, const struct record *r,
    const struct log_reader *reader, char why[LOG_WHY])
{
    if (!k->file.holds || k->rereading) return 0;
    intake_note(in, r);
    int refused = log_confirm(&k->past, &k->file, &in->origin, r, why);
    if (refused || k->trusted) return refused;
    const char *input = in->sources.input;
    k->rereading = true;
    int failed = log_reread(&k->file, in, reader);
    k->rereading = false;
    if (failed) return -1;
    log_sources_begin(&in->sources, input);
    k->trusted = true;
    return 0;
}

void log_keep_close(struct log_keep *k)
{
    log_past_free(&k->past);
    log_close(&k->file);
}
