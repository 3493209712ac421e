/* fan: command lines of workers, also within a node of a ring, and below the head of a rack. */
#include "fan/command.h"

#include <stdlib.h>
#include <string.h>

/* The words of a command before its worker: those of a node of a ring. */
static size_t words_of_node(char *const *command)
{
    bool node = *command && command[1] && strcmp(command[0], "ringctl") == 0;
    return node && strcmp(command[1], "-n") == 0 && command[2] ? 2 : 0;
}

/* The command line with these words, NULL-ended, before word `at` of the command. */
static char **insert(const struct host *h, char *const *command, size_t at, char *const *more)
{
    size_t n = 0, m = 0;
    while (command[n]) n++;
    while (more[m]) m++;
    char **words = xcalloc(n + m + 1, sizeof *words);
    memcpy(words, command, at * sizeof *words);
    memcpy(words + at, more, m * sizeof *words);
    memcpy(words + at + m, command + at, (n - at) * sizeof *words);
    char **argv = host_argv(h, words);
    free(words);
    return argv;
}

/* A rack neither cuts nor copies tasks: a method without a policy would drop the results. */
char **fan_command_line(const struct host *h, char *const *command, int slots)
{
    char number[16], jobs[] = "-j";
    char deal[] = "deal", queue[] = "-q", one[] = "1";
    char fan[] = "fan", each[] = "-1", hosts[] = "-S";
    size_t at = words_of_node(command);
    if (!*command || (slots == 1 && !h->rack)) return host_argv(h, command);
    if (h->rack)
        return insert(
            h, command, at, (char *const[]){deal, queue, one, fan, each, hosts, h->rack, NULL});
    snprintf(number, sizeof number, "%d", slots);
    return insert(h, command, at + 1, (char *const[]){jobs, number, NULL});
}

const char *fan_first_word(const struct host *h, char *const *command)
{
    return h->rack && !words_of_node(command) ? "deal" : *command;
}

char **fan_reference_line(const struct fan_options *o)
{
    char name[] = ":", rack[] = ": slots=1\n";
    struct host here = {.name = name, .slots = 1, .rack = o->racks ? rack : NULL};
    return fan_command_line(&here, o->command, 1);
}

int fan_numbers(const struct fan_options *o, const struct host *line)
{
    return o->one_each && words_of_node(o->command) ? 1 : line->slots;
}

void fan_succeed(const struct fan_options *o, struct fan_host *h)
{
    const struct host *heir = host_heir(h->host);
    if (!heir) return;
    host_succeed(h->host, heir);
    host_argv_free(h->argv);
    h->argv = fan_command_line(h->host, o->command, 1);
    h->by_ssh = host_by_ssh(h->host);
    h->asked = h->told_queued = h->told_plain = false;
    h->jump = 0;
    if (h->failures < fan_host_heads(h)) h->said = FAN_QUIET; /* each gets a message of its own */
}
