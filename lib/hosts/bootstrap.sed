# Makes a C file of bootstrap.sh: one string, in one line, without comments. In quotes, too, a csh reads apostrophes,
# backslashes and exclamation marks before words in its own way, so they are refused.
1i\
#include "hosts/hosts_int.h"\
const char hosts_bootstrap[] =
$a\
;
/^[[:blank:]]*#/d
/![^ ]/s/^/'/
/['\\]/c\
#error "bootstrap.sh: a line with an apostrophe, a backslash or an exclamation mark before a word, expected none"
s/^[[:blank:]]*//
$!s/$/ /
s/"/\\"/g
s/.*/"&"/
