/* option: parsing of command lines, shared by all programs. */
#include "base/base.h"
#include "os/os.h"

#include <ctype.h>
#include <string.h>
#include <unistd.h>

static void complain(const char *word, const char *letters)
{
    const char *letter = optopt < 0x7f && isalnum(optopt) ? strchr(letters, optopt) : NULL;
    if (strncmp(word, "--", 2) == 0 && !letter) warn("unrecognized option '%s'", word);
    else if (!letter) warn("invalid option -- '%c'", optopt);
    else if (letter[1] == ':') warn("option requires an argument -- '%c'", optopt);
    else warn("option '%s' doesn't allow an argument", word);
}

int prog_getopt(int argc, char **argv, const char *letters)
{
    opterr = 0; /* getopt would print what it does not know as it is */
    int opt = os_getopt(argc, argv, letters);
    if (opt == OS_VERSION) version();
    if (opt == '?') complain(argv[optind - 1], letters);
    return opt;
}

const char *opt_text(int opt, const char *s)
{
    if (!*s) die(ST_USAGE, "-%c: is empty, expected a value", opt);
    bool option = s[0] == '-' && isalpha((unsigned char)s[1]) && !s[2];
    if (option || strcmp(s, "--help") == 0 || strcmp(s, "--version") == 0)
        die(ST_USAGE, "-%c %s: expected a value, not an option; for a file of that name write ./%s",
            opt, s, s);
    return s;
}
