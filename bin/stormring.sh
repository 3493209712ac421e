# shellcheck shell=sh disable=SC2154  # usage and here are set by the script that reads this
# Every script reads this first, with its usage in $usage and its own directory in $here. It has the options and checks
# that all programs share; programs in C have them in lib/base/option.c.
[ ! -d /dev/fd ] || [ -e /dev/fd/2 ] || exec 2>/dev/null # mawk fails where standard error is closed
LC_ALL=C && export LC_ALL # so that awk and others read and write numbers with a point in every locale
# Names of files and what files say may have control characters, which a terminal obeys, and echo makes more of backslashes.
# printable: standard input, with ? for control characters except line ends, as those of C1 are in UTF-8
printable() { awk '{ gsub(/[[:cntrl:]]|\302[\200-\237]/, "?"); print }'; }
# say MESSAGE: prints it to standard error, in one line
say() { printf %s "$1" | tr '\n' '?' | printable >&2; }
# misused [OPT LETTER]: says what getopts has found in OPT, if it was called, prints the usage, and exits
misused() {
	case ${1-} in
	:) say "${0##*/}: option requires an argument -- '$2'" ;;
	?) say "${0##*/}: invalid option -- '$2'" ;;
	esac
	printf '%s\n' "$usage" >&2
	exit 2
}
# answer TEXT: prints TEXT and exits
answer() {
	{ printf '%s\n' "$1"; } 2>/dev/null || { say "${0##*/}: standard output: cannot be written"; exit 3; }
	exit 0
}
# asked WORD: answers -h, --help and --version
asked() {
	case $1 in
	-h | --help) answer "$usage" ;;
	--version) version=$("$here/fan" --version) || exit; answer "${0##*/} ${version#* }" ;;
	esac
}
# given LETTER VALUE: refuses the argument of an option if it is empty or looks like the next option
given() {
	case $1,$2 in
	?,) refused="-$1: is empty, expected a value" ;;
	s,[0-9]*x[0-9]*) return ;; # the worker checks the numbers
	s,*) refused="-s $2: expected WxH, such as 512x512" ;;
	?,-[A-Za-z] | ?,--help | ?,--version) refused="-$1 $2: expected a value, not an option; for a file of that name write ./$2" ;;
	*) return ;;
	esac
	say "${0##*/}: $refused"
	exit 2
}
# worker_option LETTER: takes an option of povworker or blendworker, with its OPTARG, into what, worker and size
# shellcheck disable=SC2034  # they are read there
worker_option() {
	case $1 in [fjs]) given "$1" "$OPTARG" ;; esac
	case $1 in
	h) answer "$usage" ;;
	[cw]) worker="$worker -$1" ;;
	[fj]) worker="$worker -$1 $OPTARG" ;;
	[il]) [ $what = run ] || fail "-$1: expected one of -i and -l, once"; what=$1 ;;
	s) size=$OPTARG ;;
	*) misused "$1" "$OPTARG" ;;
	esac
}
# unfit SAID MESSAGE [STATUS]: prints what a worker said without its usage, or MESSAGE if it said no more; exits with 2, or
# with 3 if that is its status
unfit() {
	said=$(printf '%s\n' "$1" | grep -v '^usage:\|^   ')
	printf '%s\n' "${said:-$2}" | printable >&2
	[ "${3-2}" -eq 3 ] || exit 2
	exit 3
}
# directory: makes a directory for temporary files and prints its name, an absolute one
directory() {
	case ${TMPDIR-} in
	*'
'*) ;; # a name with a line end would be taken for the lines of a hosts file
	*) made=$(mktemp -d 2>/dev/null) && (CDPATH='' cd -- "$made" && pwd) && return ;;
	esac
	say "${0##*/}: ${TMPDIR:-/tmp}: cannot make a directory there, expected TMPDIR to name a writable directory, no line end in its name" >&2
	exit 3
}
# apart OPTION FILE INPUT ...: refuses the file of an option if it is one of these inputs, by any name
apart() {
	letter=$1 aim=$2
	shift 2
	[ -f "$aim" ] || return 0
	for read_too; do
		# shellcheck disable=SC3013  # dash has -ef
		[ ! "$aim" -ef "$read_too" ] || {
			say "${0##*/}: -$letter $aim: is also an input, expected another file"
			exit 2
		}
	done
}
# replace FILE: puts standard input there when all of it has come; into a device, a pipe or an open descriptor at once. A link
# stays, and the file that it leads to is replaced.
replace() {
	case $([ ! -L "$1" ] || echo link),$1 in
	link,* | ,/dev/* | ,/proc/*)
		for to in 1 2 3 4 5 6 7 8 9; do
			# shellcheck disable=SC3013  # dash has -ef
			[ ! "$1" -ef "/dev/fd/$to" ] || { cat >&"$to"; return; }
		done
		;;
	esac
	[ ! -e "$1" ] || [ -f "$1" ] || [ -d "$1" ] || { cat >"$1"; return; } # a device or a pipe
	to=$(readlink -f -- "$1") && [ ! -d "$to" ] && part=$(mktemp -- "$to.XXXXXX" 2>/dev/null) || return
	{ cat >"$part" && chmod "$(printf %o $((0666 & ~0$(umask))))" "$part" && mv -f -- "$part" "$to"; } 2>/dev/null && return
	rm -f -- "$part"
	return 1
}
# pack_all NAMES: the record of these files, a line each
pack_all() {
	IFS='
'
	# shellcheck disable=SC2086  # a word for each line
	pack files $1
}
# host_lines HOSTS: the hosts of a file or a list, which fan has accepted: a line each, as in a hosts file. A directory may have
# the name of a host.
host_lines() {
	if [ -f "$1" ]; then LC_ALL=C sed "1s/^$(printf '\357\273\277')//" -- "$1" | grep -v '^[[:space:]]*\(#.*\)*$'
	else printf '%s\n' "$1" | tr , '\n' | sed -E 's,^([0-9]+)/(.*),\2 slots=\1,'
	fi | sed 's/^[[:blank:]]*//'
}
asked "${1-}"
trap '' XFSZ # so that a file at its size limit is a write error, which is reported
# With too few descriptors, a shell takes programs for missing and cannot print a message.
# shellcheck disable=SC3045,SC2016  # dash and bash have ulimit -n; the $0 is of the inner shell
case $(ulimit -n) in
[0-9] | [12][0-9]) exec sh -c 'printf "%s\n" "$0: expected a limit of 30 open files or more (ulimit -n)" >&2; exit 3' "${0##*/}" ;;
esac
