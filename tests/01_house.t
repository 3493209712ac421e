#!/bin/sh
# The style guide as a test: include arrows, sizes, banned calls; options, usage and man pages; wire labels;
# words. Each check prints file:line of what breaks it.
. "$(dirname "$0")/lib.sh"
cd "$root" || exit 3

# clean NAME: nothing was found, a line each in $found
found=$tmp/found
clean() { if [ -s "$found" ]; then fail "$1" "$(cat "$found")"; else pass "$1"; fi; }

# ---- which module may include which: a line a module, its own headers besides --------------------------------
cat >"$tmp/arrows" <<'END'
os
base os
geometry
patience
task base
coder base
wire coder task base
image task base os
eta wire image task base
log wire image task base os
stats base
table stats base
inference table stats base
scene geometry base
spd scene geometry base
simd base
mesh scene geometry image task base
trace simd scene geometry image task base os
html base
album html image task base
grid base os
spec grid geometry base
volume simd grid spec geometry task base
projection base
cf projection units grid base
voxel grid base
grib projection units grid base
units base
plane projection base
layer plane grid base
convert units grid image base
backdrop units plane grid spec geometry image base
paint backdrop units plane spec grid geometry base os
look geometry task base
window base
sched task patience base
sim sched stats task patience base
proc base os
crop proc image task base os
files base
job grid spec wire task base
hosts base
keep base
pipe keep proc wire task patience base os
fan pipe keep hosts proc wire coder task patience base
worker pipe proc wire image task patience base os
history eta wire task base
account history wire task stats base
view html account history log eta wire image task stats base os
verify log wire task base
drive sched pipe proc wire task patience base
viewer look window paint backdrop volume pipe proc job wire scene spec grid geometry image task patience base
END

awk '
FNR == NR { known[$1] = 1; for (i = 2; i <= NF; i++) may[$1, $i] = 1; next }
FNR == 1 { split(FILENAME, path, "/"); from = path[2]; if (!known[from]) print FILENAME ":1: module " from " is not in the table" }
/^[ \t]*#[ \t]*include[ \t]*"/ {
	split($0, part, "\""); split(part[2], to, "/")
	if (to[1] == from) next
	if (!known[to[1]]) print FILENAME ":" FNR ": " part[2] " is in no module"
	else if (!((from, to[1]) in may)) print FILENAME ":" FNR ": " from " may not include " to[1]
	else if (to[2] != to[1] ".h") print FILENAME ":" FNR ": " part[2] " is private to " to[1]
}' "$tmp/arrows" lib/*/*.[ch] >"$found"
clean 'modules include only what the table allows'

# A name that files share begins with its module's name, or with one of these words, which no other module has.
cat >"$tmp/prefixes" <<'END'
backdrop drawing lines mark outline
base buf clock close_stdout cpu_us die err hash64 input isa load_file now_us opt outfile parse print_float print_real prog
base parallel put_stdout read relay sha256 text usage utf8 version warn write_full xaligned xcalloc xgrown xmalloc xrealloc xstrdup
drive tags
eta progress
geometry camera portable_tan
grib gb
grid vtk
hosts host
image assembly pam pfm png pnm quantizer sampler srgb store
log intake
pipe blob down outlet silence stdout_private stream up
proc child cores_available groups signals status want_descriptors
scene corners nff points pov reader token tokens
sched blame cost deal gdc hub node pace pieces policy refuse set tournament
sim net tree
task chunk_at coverage cut frames lattice list tasks
trace bound bvh crossings items light media pending sah slabs tracer wave
viewer command controls events show subject times
volume cell crossing cubic ground lit map path skip_init slice walk
wire generation rec
END
objects=${BUILD:-build}
for source in lib/*/*.c; do
	object=$objects/${source#lib/} && object=${object%.c}.o
	[ ! -e "$object" ] || echo "$object"
done | xargs nm -g -A | awk -v from="$objects/" '{
	file = substr($1, length(from) + 1, index($1, ":") - length(from) - 1)
	sub(/[.]o$/, ".c", file)
	print "lib/" file, $(NF - 1), $NF
}' >"$tmp/externs"
[ -s "$tmp/externs" ] || echo "$objects has no objects" >"$tmp/externs"
awk '
FNR == NR { for (i = 2; i <= NF; i++) { may[$1, $i] = 1; if ($i in of && of[$i] != $1) print $i ": of " of[$i] " and of " $1; of[$i] = $1 } next }
$2 ~ /^[A-TV-Z]$/ {
	split($1, path, "/")
	module = path[2]; known = 0
	n = split($3, word, "_")
	prefix = word[1]
	for (i = 1; i <= n; i++) {
		if (i > 1) prefix = prefix "_" word[i]
		known = known || prefix == module || (module, prefix) in may
	}
	if (!known) print $1 ":1: " $3 " does not begin with " module ", nor with a word of its table"
}
NF < 3 || $1 !~ /^lib/' "$tmp/prefixes" "$tmp/externs" >"$found"
clean 'externs begin with the name of their module'

# Of two files one is above the other: no file calls one that calls it back, over whatever others. Those of a row may call
# each other. A node and its slots are one recursion: a slot that is free takes a step of the node, which starts the slot.
cat >"$tmp/circles" <<'END'
sim/node sim/slots
END
awk '
FNR == NR { for (i = 1; i <= NF; i++) together["lib/" $i ".c"] = FNR; next }
$2 != "U" && $2 ~ /^[A-Z]$/ { at[$3] = $1 }
{ line[++n] = $0 }
END {
	for (i = 1; i <= n; i++) {
		split(line[i], f, " ")
		if (f[2] == "U" && f[3] in at && at[f[3]] != f[1]) { calls[f[1], at[f[3]]] = 1; by[f[1], at[f[3]]] = f[3] }
		left[f[1]] = 1
	}
	do { # what calls none of those left, or is called by none of them, is in no circle
		gone = 0
		for (a in left) {
			out = into = 0
			for (b in left) { out += (a, b) in calls; into += (b, a) in calls }
			if (!out || !into) { delete left[a]; gone = 1 }
		}
	} while (gone)
	for (a in left) for (b in left) if ((a, b) in calls) reaches[a, b] = 1
	for (c in left) for (a in left) for (b in left) if ((a, c) in reaches && (c, b) in reaches) reaches[a, b] = 1
	for (a in left) for (b in left) if (a != b && (a, b) in calls && (b, a) in reaches) {
		if (!(a in together && b in together && together[a] == together[b])) print a ":1: calls " by[a, b] " of " b ", which calls it back"
		used[together[a]] = 1
	}
	for (a in together) if (!(together[a] in used)) print a ":1: is in a row of circles, and in no circle"
}' "$tmp/circles" "$tmp/externs" | sort >"$found"
clean 'no files call each other in a circle'

awk '/^[ \t]*#[ \t]*include[ \t]*"/ {
	split($0, part, "\""); split(part[2], to, "/")
	if (to[2] != to[1] ".h") print FILENAME ":" FNR ": " part[2] " is private to " to[1]
}' bin/*.c >"$found"
clean 'programs include public headers only'

# Times after which something counts as late or dead stand in one table.
grep -nE '^#define [A-Z_]*(LATE|SILEN|GRACE|BEAT|RETRY|PATIEN|HELLO|DEAD|GIVE_UP)[A-Z_]*_(US|MS|S|TIMES) ' lib/*/*.[ch] bin/*.c |
	grep -vE '^lib/(patience|sim)/' | grep -v 'PATIENCE_' >"$found"
clean 'patience is stated in lib/patience/patience.h'

# Where a C file includes it first, that file has shown it.
for dir in lib/*/; do
	module=${dir#lib/} && module=${module%/}
	[ "$module" != chart ] || continue # scripts
	[ -e "$dir$module.h" ] || { echo "$dir: has no $module.h"; continue; }
	awk -v header="\"$module/$module.h\"" 'FNR == 1 { seen = FILENAME !~ /c$/ } /^[ \t]*#[ \t]*include/ && !seen++ && $2 == header { found = 1; exit } END { exit !found }' "$dir"*.[ch] ||
		echo "#include \"$module/$module.h\"" | cc -std=c11 -D_GNU_SOURCE -Wall -Wextra -Werror -fsyntax-only -Ilib -x c - 2>&1
done >"$found"
clean 'every public header compiles alone'

# ---- sizes -------------------------------------------------------------------------------------------------
sources=$(ls lib/*/*.[ch] tests/oracles/*.[ch] bin/*.c tests/unit/*.c tests/fuzz/*.c)
scripts=$(grep -lE '^#!/bin/sh|shellcheck shell=sh' bin/* tests/* tests/fuzz/run tests/bench/* tests/experiments/* .ci/run 2>/dev/null)
# What awk, sort and others print and read is by the user's language, unless LC_ALL is set, which stormring.sh does.
{
	grep -q '^LC_ALL=C && export LC_ALL' bin/stormring.sh || echo 'bin/stormring.sh does not set LC_ALL'
	for script in $(printf '%s\n' "$scripts" | grep '^bin/' | grep -v '[.]sh$'); do
		grep -q '[.] "$here/stormring.sh"' "$script" || grep -HnE '\b(awk|bc|od|seq|sort) ' "$script"
	done
} >"$found"
clean 'numbers that scripts print have a point, in any language'
# Methods are run by virtual.sh, not spelled again. 50_policies and price compare options.
grep -nE -e '-q auto|-e -q|ring -e|-o sample|-u (fine|coarse)' tests/experiments/* tests/bench/[0-9]*.sh |
	grep -vE '^[^:]*:[0-9]+:#|/50_policies.sh:|/(37_)?price(.sh)?:|perf record' >"$found"
clean 'the cut and the rules of a method stand in its script only'
# shellcheck disable=SC2086  # lists of names without blanks
{
	awk 'length > 100 { print FILENAME ":" FNR ": " length " columns, expected at most 100" }' $sources >"$found"
	clean 'lines have at most 100 columns'
	awk 'FNR > 400 && !said[FILENAME]++ { print FILENAME ":401: expected at most 400 lines" }' lib/*/*.[ch] tests/oracles/*.[ch] bin/*.c >"$found"
	clean 'files have at most 400 lines'
	awk '/^{/ { begin = FNR } /^}/ && begin { if (FNR - begin > 71) print FILENAME ":" begin ": a function of " FNR - begin - 1 " lines, expected at most 70"; begin = 0 }' lib/*/*.[ch] tests/oracles/*.[ch] bin/*.c >"$found"
	clean 'functions have at most 70 lines'
	awk '/[ \t]$/ { print FILENAME ":" FNR ": blanks at the end of the line" }' $sources $scripts man/*.[1-9] lib/chart/* >"$found"
	clean 'lines do not end in blanks'
}

# A new member would be what the stack had: threads without a number took all processes of a machine.
awk 'FNR == 1 { body = 0 } /^{/ { body = 1 } /^}/ { body = 0 }
	body && /^ +struct [a-z]+_options [a-z]+;/ { print FILENAME ":" FNR ": expected = ..._OPTIONS_DEFAULT" }' tests/bench/*.c >"$found"
clean 'options in benches begin with their defaults'

# ---- the charts of the manual: what their notes say ----------------------------------------------------------
for chart in man/pictures/*.svg; do
	why=$(sed -n 's/.*<text>\(.*\)<\/text>.*/\1/p' "$chart" | awk '
		/; commit [0-9a-f]+(;|$)/ { clean = 1 }
		/^others took / && $3 > .1 { print "others took " $3 " processors;" }
		END { if (!clean) print "its commit is dirty or none;" }')
	[ -z "$why" ] || echo "$chart: $(echo "$why" | tr '\n' ' ')draw it again on an idle machine: make chart"
done >"$found"
clean 'charts of the manual are of a clean commit and an idle machine'

# ---- calls that are not made -------------------------------------------------------------------------------
# ban WHY ERE FILE ...: no call of these
ban() {
	why=$1 calls=$2
	shift 2
	grep -nE "(^|[^A-Za-z0-9_.>])($calls) *\\(" "$@" | grep -vE '^[^:]*:[0-9]+: *(/?\*|//)' >"$found"
	clean "$why"
}
lib=$(ls lib/*/*.[ch] tests/oracles/*.[ch])
# shellcheck disable=SC2046,SC2086
{
	ban 'no unchecked parsing, unbounded copying or hidden state' \
		'ato[ifl]|atoll|v?sprintf|strn?cpy|strn?cat|gets|[fs]?scanf|strtok|s?rand|s?random|[djlm]rand48|system|tmpnam|mktemp|alloca' $lib bin/*.c
	ban 'numbers are parsed in base, and in scene by its own rules' 'strto[a-z]+' \
		$(echo "$lib" | grep -vE '^lib/(base/number|scene/token|scene/pov_put)\.c$') bin/*.c
	ban 'memory comes from the allocators of base' '[mc]alloc|realloc|strn?dup|aligned_alloc' \
		$(echo "$lib" | grep -v '^lib/base/memory\.c$') bin/*.c
	ban 'the library exits only in die, and where its reader or display is gone' '_?exit|abort' \
		$(echo "$lib" | grep -vE '^lib/(base/message|crop/command|pipe/silence|proc/child|viewer/loop|worker/forks|worker/pulse|worker/session)\.c$')
}
# ---- the system ----------------------------------------------------------------------------------------------
# What C and POSIX.1-2008 lack is in lib/os, and in few files which are optional: see lib/README.md. A header of angle
# brackets is one of theirs, or a library's.
beyond='accept4|v?asprintf|basename|close_range|copy_file_range|daemon|dup3|epoll_[a-z0-9]+|eventfd|execvpe'
beyond="$beyond|fallocate|flock|get_nprocs|getopt_long|getrandom|inotify_[a-z0-9_]+|ioctl|madvise|mallo(pt|c_trim)|memfd_create|mem(mem|rchr)"
beyond="$beyond|mempcpy|mkostemps?|mremap|nftw|pidfd_[a-z_]+|pipe2|ppoll|prctl|p(read|write)v2?|qsort_r|rawmemchr|realpath"
beyond="$beyond|reallocarray|sched_[gs]etaffinity|signalfd|sigaltstack|sincos|splice|strcasestr|strchrnul|strlc(at|py)|strsep"
beyond="$beyond|strverscmp|syscall|timegm|timerfd_[a-z]+|usleep|wait[34]|le(16|32|64)toh|htole(16|32|64)"
headers='arpa/inet|ctype|dirent|errno|fcntl|float|inttypes|limits|math|poll|pthread|setjmp|signal|std(arg|bool|def|int|io|lib)'
headers="$headers|strings?|sys/(mman|resource|stat|statvfs|time|types|uio|utsname|wait)|time|unistd"
headers="$headers|png|zlib|zstd|netcdf|eccodes|udunits2|proj|archive(_entry)?|expat|jpeglib|gsl/gsl_(cdf|errno)|assimp/[A-Za-z]+|pango/pangocairo|SDL2/SDL|immintrin|cpuid|cmocka"
# shellcheck disable=SC2046,SC2086
{
	ours="$(printf '%s\n' $lib | grep -vE '^lib/(os/linux|crop/confine)\.c$') $(echo bin/*.c)"
	ban 'what only some systems have is in lib/os' "$beyond" $ours
	grep -nE '^[[:blank:]]*#[[:blank:]]*include[[:blank:]]*<' $ours | grep -vE "<($headers)\.h>" >"$found"
	clean 'headers are those of C, POSIX and the libraries'
	# lib/os/linux.c has what the rules look for.
	seen() { [ "$(grep -cE "(^|[^A-Za-z0-9_.>])($beyond) *\\(" $1)" -gt 9 ] && [ "$(grep include $1 | grep '<' | grep -cvE "<($headers)\\.h>")" -gt 4 ]; }
	ok 'these rules see the calls and headers of lib/os/linux.c' seen lib/os/linux.c
}
# Logs, copies for commands, and pixels that memory does not hold are no outputs that a user names.
# shellcheck disable=SC2086
{
	grep -nE 'O_WRONLY|O_RDWR|O_CREAT|O_TRUNC|\bcreat\(|mk[o]?stemps?\(|os_temporary\(|fopen\([^,]*, "[wa]' $lib bin/*.c |
		grep -vE '^lib/(base/(message|outfile)|crop/(command|copy)|files/archive|image/store|keep/keep|log/file|pipe/queue|hosts/send)\.c:|^lib/os/os\.[ch]:|:[0-9]+: *(/?\*)'
	for c in bin/*.c; do
		! grep -qE 'outfile_(open|put)|image_(save|out)|grid_file_cut|convert\(' "$c" || grep -qE 'input_(add|keep)|image_name_keep|convert\(' "$c" || echo "$c:1: does not ask whether an output is an input (base.h)"
	done
	for script in $(printf '%s\n' "$scripts" | grep '^bin/' | grep -v '^bin/protocol$'); do
		! grep -qE '^[[:blank:]]o\) |replace "' "$script" || grep -qE 'apart o|gather .* -i ' "$script" || echo "$script:1: does not ask whether an output is an input (apart)"
	done
} >"$found"
clean 'outputs are opened by base, and are no inputs'
# shellcheck disable=SC2046,SC2086
{
	# dash makes terminal escapes of words, and \\c cuts a message.
	grep -nE '\becho\b[^|;&)#]*[$`]' $(printf '%s\n' "$scripts" | grep '^bin/') tests/need tests/install | grep -vE '^[^:]*:[0-9]+:[[:space:]]*#' >"$found"
	clean 'scripts print text by printf, not by echo'
	others=$(echo "$lib" | grep -vE '^lib/(base/|eta/line\.c)') # and the progress line
	ban 'messages have one form' 'perror|v?errx?|v?warnx|v?syslog|psignal' $others bin/*.c
	grep -nw stderr $others bin/*.c | grep -vE ':[0-9]+: *(/?\*)|STDERR|/\*.*stderr' >"$found"
}
clean 'messages go through base'
for c in bin/*.c; do grep -q 'close_stdout()' "$c" || grep -q 'worker_run\|drive_\|fan_run' "$c" || echo "$c:1: stdout is not checked at the end"; done >"$found"
clean 'every program checks that its output was written'

# ---- options: getopt, usage and man page say the same --------------------------------------------------------
# ask NAME COMMAND ...: prints NAME with the status of a command, and with each line of its output and of its errors
ask() {
	asked=$1
	shift
	"$@" </dev/null >"$tmp/stdout" 2>"$tmp/stderr"
	echo "$asked status $?"
	sed "s|^|$asked stdout |" "$tmp/stdout"
	sed "s|^|$asked stderr |" "$tmp/stderr"
}
all=$(find bin/ -type f -perm -1 -exec basename {} \;)
for program in $all; do
	for option in -h --help --version; do ask "$program $option" "$program" $option; done
done >"$tmp/answers"
# Letters of getopt, and those of them that take an argument; of usage; and of the page
{
	# shellcheck disable=SC2046  # a word each
	awk 'function take(options, i, letter) {
		for (i = 1; i <= length(options); i++) {
			letter = substr(options, i, 1)
			if (letter ~ /[A-Za-z0-9]/) print "getopt", name, letter
			if (substr(options, i + 1, 1) == ":" && letter ~ /[A-Za-z0-9]/) print "argument", name, letter
		}
	}
	FNR == 1 { name = FILENAME; sub(/.*\//, "", name); sub(/[.]c$/, "", name); print "source", name, FILENAME }
	{ gsub(/" WORKER_OPTIONS/, "cf:\"") }
	match($0, /getopt\(argc, argv, "[^"]*"/) || match($0, /getopts [A-Za-z0-9:]+ /) { take(substr($0, RSTART, RLENGTH) ~ /"/ ? substr($0, RSTART + 20, RLENGTH - 21) : substr($0, RSTART + 8, RLENGTH - 9)) }
	' $(for p in bin/*; do case $p in *.c | *.sh) echo "$p" ;; *) [ -e "$p.c" ] || echo "$p" ;; esac; done)
	awk '$2 == "-h" && $3 == "stdout" {
		name = $1
		$1 = $2 = $3 = ""
		while (match($0, /[[ |]-[A-Za-z0-9]+/)) {
			for (i = RSTART + 2; i < RSTART + RLENGTH; i++) print "usage", name, substr($0, i, 1)
			$0 = substr($0, RSTART + RLENGTH)
		}
	}' "$tmp/answers"
	awk 'FNR == 1 { name = FILENAME; sub(/.*\//, "", name); sub(/[.]1$/, "", name); print "paged", name }
	taken { print "page", name, $2; taken = 0 }
	/^\.It Fl / { for (i = 3; i <= NF && length($i) == 1; i++) print "page", name, $i }
	/^\.It Xo/ { taken = 1 }' man/*.1
} | sort -u >"$tmp/letters"
programs=$(for p in bin/*; do case $p in bin/balance-* | *.sh) ;; *) p=${p##*/} && echo "${p%.c}" ;; esac; done | sort -u)
# shellcheck disable=SC2086  # a word each
{
	printf '%s\n' $programs | awk '
	function letters(kind, name, i, c, all, found) {
		all = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
		for (i = 1; i <= length(all); i++) if ((kind, name, c = substr(all, i, 1)) in has) found = found c
		return found
	}
	FNR == NR { has[$1, $2, $3]; if ($1 == "source") source[$2] = $3; paged[$2] = paged[$2] || $1 == "paged"; next }
	(options = letters("getopt", $1)) != letters("usage", $1) { print source[$1] ":1: getopt has \"" options "\", -h says \"" letters("usage", $1) "\"" }
	paged[$1] && options != letters("page", $1) { print "man/" $1 ".1:1: getopt has \"" options "\", the page \"" letters("page", $1) "\"" }
	' "$tmp/letters" -
	[ "$(grep -c '^argument' "$tmp/letters")" -gt 99 ] || echo 'options are not found in the sources'
} >"$found"
clean 'getopt, -h and man page name the same options'

version=$(sed -n 's/^#define STORMRING_VERSION "\(.*\)"/\1/p' lib/base/base.h)
awk -v version="$version" '
{ what = $1 " " $2; text = substr($0, length(what " " $3) + 2) }
$3 == "status" && $4 != 0 { print what ": exits " $4 }
$3 == "stderr" { print what ": says " text }
$3 == "stdout" && $2 != "--version" { said[$1, $2] = said[$1, $2] text "\n"; asked[$1] }
$3 == "stdout" && $2 == "--version" {
	expected = ($1 ~ /^protocol/ ? "protocol" : $1) " " version
	if (text != expected) print what ": says " text ", expected " expected
	versions[$1]
}
END {
	for (name in asked) {
		if (said[name, "-h"] != said[name, "--help"]) print name ": -h and --help differ"
		if (!(name in versions)) print name ": --version says nothing"
	}
}' "$tmp/answers" >"$found"
clean 'every program answers --help and --version'
for program in $all; do
	for option in -h --help --version; do
		"$program" $option 2>"$tmp/stderr" >/dev/full
		echo "$program $option status $?"
		sed "s|^|$program $option stderr |" "$tmp/stderr"
	done
done >"$tmp/answers"
# wrong STATUS ERE: of $tmp/answers, what has another status, an output, or not one line of errors that matches, with the option
# for @
wrong() {
	awk -v status="$1" -v ere="$2" '
	{ what = $1 " " $2; expected = ere; sub(/@/, $2, expected) }
	$3 == "status" { if ($4 != status) print what ": exits " $4 ", expected " status; seen[what] }
	$3 == "stdout" { print what ": says " $0 }
	$3 == "stderr" { text = $0; sub(/^[^ ]* [^ ]* stderr /, "", text); if (lines[what]++ || text !~ expected) print what ": says " text ", expected one line: " expected }
	END { for (what in seen) if (!(what in lines)) print what ": says nothing, expected one line" }' "$tmp/answers"
}
wrong 3 '^[a-z0-9-]*: standard output: ' >"$found"
clean '-h to a full disk exits 3, and one line says so'
for command in 'fan -j 1' deal ringctl 'ringctl -n'; do
	[ "$(PATH=$tmp:$PATH; printf '#!/bin/sh\necho said "$@"\n' >"$tmp/other"; chmod +x "$tmp/other"
		$command other --help </dev/null 2>&1 | grep -c usage)" = 0 ] || echo "$command: takes --help from its command"
done >"$found"
clean 'options of a command belong to the command'
# Each option that takes an argument finds the next option in its place: that is what is wrong, and one line says so.
for program in $all; do
	case $program in balance*) method=masterslave ;; *) method='' ;; esac
	case $program in balance-calibrate | balance-bricks | balance) ;; balance-*) continue ;; esac
	case $program in balance-calibrate | balance-bricks) method='' ;; esac
	taking=$(awk -v name="$program" '$1 == "argument" && $2 == name { print $3 }' "$tmp/letters")
	for option in $taking; do
		case $program,$option in balance*,W | job,W | simulate,[kq]) continue ;; esac # of a worker, of a method
		# shellcheck disable=SC2086  # none, or a word
		ask "$program -$option" timeout 10 "$program" $method -"$option" -h
	done
done >"$tmp/answers"
wrong 2 ': @ -h: .*expected' >"$found"
clean 'an option in the place of an argument is refused in one line'
for program in $programs; do
	"$program" -'?' >"$tmp/stdout" 2>"$tmp/stderr"
	[ $? -eq 2 ] || echo "$program: an unknown option does not exit 2"
	[ ! -s "$tmp/stdout" ] || echo "$program: an unknown option writes to stdout"
done >"$found"
clean 'an unknown option is refused'

for method in bin/balance-*; do
	method=$(basename "$method")
	case $("$method" -h) in "usage: $(echo "$method" | sed -E 's/-(bricks|calibrate)/ \1/') [-h"*) ;; *) echo "$method: -h prints no usage" ;; esac
	[ "$("$method" 2>/dev/null; echo $?)" = 2 ] || echo "$method: without arguments it does not exit 2"
done >"$found"
clean 'methods print their usage'

# ---- man pages -----------------------------------------------------------------------------------------------
for program in $programs; do [ -e "man/$program.1" ] || echo "man/$program.1: is missing"; done >"$found"
clean 'every program has a man page'
for method in bin/balance-*; do
	page=man/$(basename "$method").1
	[ -e "$page" ] || echo "$page: is missing"
done >"$found"
clean 'every method has a man page'
for page in stormring.7 stormring-task.5 stormring-frag.5 stormring-hosts.5 stormring-nff.5 stormring-spec.5; do [ -e "man/$page" ] || echo "man/$page: is missing"; done >"$found"
clean 'stormring(7) and the formats have man pages'

if there mandoc groff; then
	for page in man/*.[1-9]; do mandoc -T lint -W warning "$page"; done >"$found"
	clean 'mandoc warns of nothing'
	# It warns where a list's cell is wider than its column, and comes out one word below the other.
	for page in man/*.[1-9]; do groff -z -Tascii -mdoc -rLL=80n "$page" 2>&1; done >"$found"
	clean 'groff warns of nothing at 80 columns'
else
	skip 'the form of pages' "$missing is not there"
fi
awk '
function check(i) { for (i = 1; i <= n; i++) if (!(want[i] in has)) print page ":1: has no section " want[i] }
FNR == 1 { check(); split("", has); page = FILENAME; n = split("NAME,DESCRIPTION,EXAMPLES,SEE ALSO" (page ~ /1$/ ? ",SYNOPSIS,EXIT STATUS" : ""), want, ",") }
/^\.Sh / { has[substr($0, 5)] }
END { check() }' man/*.[1-9] >"$found"
clean 'every page has its sections'
awk '$0 == ".Sh EXAMPLES" { within = 1; next } /^\.Sh/ { within = 0 }
within && last == ".Ed" && /^[A-Z]/ { print FILENAME ":" FNR ": no .Pp before this paragraph" } { last = $0 }' man/*.[1-9] >"$found"
clean 'examples of a page are separate paragraphs'
awk '/^\.Xr / { print FILENAME, FNR, $2 "." $3 }' man/*.[1-9] | while read -r page line to; do
	case $to in stormring* | balance*) [ -e "man/$to" ] ;; *) [ -e "man/$to" ] || [ ! -e "bin/${to%.1}.c" ] ;; esac ||
		echo "$page:$line: man/$to is missing"
done >"$found"
awk '/^\.Xr .* [1-9] , [a-z]/ { print FILENAME ":" FNR ": one .Xr has one page, expected a line for each" }' man/*.[1-9] >>"$found"
clean 'pages refer to pages that exist'
for page in man/*.[1-9]; do
	name=${page#man/}
	[ "$name" = stormring.7 ] || echo "Xr ${name%.*} ${name##*.}"
done >"$tmp/names"
awk 'FNR == NR { text = text "\n" $0; next } !index(text, $0) { print "man/stormring.7:1: does not name " $2 "." $3 }' man/stormring.7 "$tmp/names" >"$found"
clean 'stormring(7) names every page'

# ---- wire labels: names of records and keys are the same in code and in the pages of section 5 -----------------
# In the pages, records are `.It Ic NAME ...`, keys `.It Cm KEY Ns = ...`.
pages='man/stormring-task.5 man/stormring-frag.5'
# shellcheck disable=SC2086
{
	sed -nE 's/^ *\[REC_[A-Z]+\] = \{"([a-z]+)".*/\1/p' lib/wire/decode.c | sort >"$tmp/code"
	cat $pages 2>&1 | sed -nE 's/^\.It Ic ([a-z]+).*/\1/p' | sort -u >"$tmp/pages"
	diff "$tmp/code" "$tmp/pages" | sed -n 's/^</lib\/wire knows, the pages do not: /p; s/^>/the pages know, lib\/wire does not: /p' >"$found"
	clean 'the pages name the records that lib/wire knows'
	wire='lib/wire/*.c lib/worker/*.c lib/drive/*.c lib/fan/*.c lib/pipe/*.c lib/history/*.c'
	{
		cat $wire bin/*.c | grep -oE '(rec_(key|is|int|real|str)\(&?r, |has_key\(r, )"[a-z_]+"' | grep -oE '[a-z_]+"$' | tr -d '"'
		cat $wire | grep -oE '[" ][a-z_]+=[%:"]' | tr -d '" =%:'
	} | sort -u >"$tmp/code"
	cat $pages 2>&1 | sed -nE 's/^\.It Cm ([a-z_]+) Ns =.*/\1/p' | sort -u >"$tmp/pages"
	diff "$tmp/code" "$tmp/pages" | sed -n 's/^</the code has, the pages do not: /p; s/^>/the pages have, the code does not: /p' >"$found"
	clean 'the pages name the keys that the code reads and writes'
}

# ---- seeds: a fuzz target starts from each kind that its reader knows ------------------------------------------
# unseeded TARGET ERE KIND ...: prints the kinds without a seed, which has a match of ERE with the kind in the place of @
unseeded() {
	target=$1 ere=$2
	shift 2
	[ $# -gt 1 ] || echo "$target: the kinds are not found in the sources"
	for kind; do
		LC_ALL=C grep -aiqE "$(printf '%s\n' "$ere" | sed "s/@/$kind/")" "tests/fuzz/corpus/$target"/* || echo "$target: no seed has $kind"
	done
}
# rows FILE FROM [ERE]: the names in the table of FILE that begins where FROM matches, each behind a brace
rows() { sed -n "/$2/,/;/p" "$1" | grep -oE "${3-}[{]\"[^\"]+\"" | cut -d '"' -f 2; }
# The first two bytes of a record's seed say how it is fed.
# shellcheck disable=SC2046  # a word each
{
	unseeded record '^(..)?@( |$)' $(rows lib/wire/decode.c '^} grammar')
	unseeded spec '^@ ' $(rows lib/spec/spec.c '= {"from"' '= ')
	unseeded nff '(^| )@( |$)' $(rows lib/scene/nff_read.c '^} entities')
	unseeded grid ' @( 1)?$' $(rows lib/grid/vtk_type.c '^const struct vtk_type')
	unseeded command '^(..)?@( |$)' hello up gone frame frag fail bye 'done' beat drain
	unseeded image '^@' P5 P6 P7 PF Pf
	for type in 0 2 3 4 6; do
		for seed in tests/fuzz/corpus/image/*.png; do od -An -tu1 -j25 -N1 "$seed"; done | grep -qw "$type" || echo "image: no PNG of type $type"
	done
} >"$found"
clean 'the corpora have a seed for every kind of record, word, entity, number and picture'

# ---- prose: plain English, about files that exist --------------------------------------------------------------
find lib bin tests man scenes -type f | sed 's,.*/,,' | sort -u >"$tmp/there"
# Of C files the comments are read, with END behind each file's last one.
prose='README.md CHANGELOG.md lib/README.md tests/README tests/bench/RESULTS.md man/*.[1-9]'
comments='lib/*/*.[ch] tests/oracles/*.[ch] bin/*.c tests/unit/*.[ch] tests/fuzz/*.[ch] tests/bench/*.c tests/*.c'
# shellcheck disable=SC2086
awk '
function say(text) { if (text !~ /^[ \t]*$/) print FILENAME ":" FNR ": " text }
FILENAME !~ /[.][ch]$/ { say($0); next }
{
	rest = $0; text = ""
	while (rest != "") {
		if (within) {
			end = index(rest, "*/")
			text = text " " (end ? substr(rest, 1, end - 1) : rest)
			rest = end ? substr(rest, end + 2) : ""
			within = !end
		} else if ((begin = index(rest, "/*")) > 0) {
			rest = substr(rest, begin + 2)
			within = 1
		} else rest = ""
	}
	say(text)
}' $prose $comments >"$tmp/prose"
awk 'FNR == NR { there[$1] = 1; next }
{
	place = $1
	while (match($0, /[A-Za-z0-9_]*[a-z0-9_][a-z0-9_][.][ch]([^A-Za-z0-9_]|$)/)) {
		name = substr($0, RSTART, RLENGTH)
		$0 = substr($0, RSTART + RLENGTH)
		sub(/[^A-Za-z0-9_]$/, "", name)
		if (!(name in there) && name !~ /NAME/ && RSTART > 0) print place " " name " does not exist"
	}
}' "$tmp/there" "$tmp/prose" | grep -v '[.][ch]:[0-9]*: [a-z_]*[.][ch]: ' >"$found"
clean 'pages and comments name files that exist'
words='\b[Ww]ho(ever|m)?\b|\b[Ll]est\b|\bso many\b|\bof it[.;]|\b([Nn]o|[Aa]ny|[Ss]ome)body\b|comes? of (it|that)\b|\bin store\b|^[^ ]* What is\b|[.] What is\b'
words="$words"'|\ball the same\b|\bmay not\b|\bas far as\b|\bbut for\b|\banew\b|\b([Ff]ormer|[Ll]atter)(ly)?\b|\bsuffices?\b|which (is|are) th(at|ose) of\b|\b([Rr]espectively|[Hh]ence|[Ww]hilst)\b|\b([Tt]here|[Ww]here|[Hh]ere)(of|in|by|upon|from)\b'
# The first words are for people only; the others need a second reading. Messages, comments of scripts, names of assertions
# and claims of experiments are prose as well.
# shellcheck disable=SC2086
{
	grep -noE '"[^"]*"' lib/*/*.[ch] bin/*.c
	grep -nE '^[[:space:]]*#|[[:space:]]# ' $scripts tests/soak/* tests/mutants/* tests/models/*
	grep -noE "(^|[[:space:]])(ok|is|like|skip|claim|put|summary=|paper=|stop|fail[ 0-9]*) ?('[^']*'|\"[^\"]*\")" $scripts tests/soak/*
} >>"$tmp/prose"
grep -E "$words" "$tmp/prose" | grep -vE '(people|users?|reader|somebody) who|times as far as' >"$found"
clean 'prose does without words that need a second reading'

# ---- the rest --------------------------------------------------------------------------------------------------
git ls-files 2>/dev/null | grep -E '\.(o|d|a|png|frags)$' | grep -vE '^(README|man|tests)' >"$found"
clean 'no built file is committed'
printf '%s\n' * | grep -vxE 'Makefile|bin|lib|man|scenes|tests|README\.md|CHANGELOG\.md|LICENSE|build|report|(gears|wind-.*)\.(png|frags)|stormring-.*\.tar\.gz' >"$found"
clean 'the top level has only the fixed names'
finish
