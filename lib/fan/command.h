/* fan: the command lines that reach the hosts. */
#ifndef STORMRING_FAN_COMMAND_H
#define STORMRING_FAN_COMMAND_H

#include "fan/fan.h"
#include "fan/fan_host.h"

/* The command line of a worker with this number of slots, or of a rack. host_argv_free frees it. */
char **fan_command_line(const struct host *h, char *const *command, int slots);
/* The program that such a command runs there. */
const char *fan_first_word(const struct host *h, char *const *command);
/* The command line of the worker with which the others must agree. */
char **fan_reference_line(const struct fan_options *o);
/* The slots of a line: a node of a ring is one, whatever its worker has. */
int fan_numbers(const struct fan_options *o, const struct host *line);
/* The slot of a rack is lost: its next connection is to another host of the rack. */
void fan_succeed(const struct fan_options *o, struct fan_host *h);

#endif
