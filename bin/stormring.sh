# shellcheck shell=sh disable=SC2154  # usage and here are set by the script that reads this
# Each script reads this first, with its usage in $usage and its own directory in $here: what all programs answer.
# Those in C have it from lib/base/option.c.
LC_ALL=C && export LC_ALL # awk and others write and read numbers with a point, whatever the user's language
# answer TEXT: all that was asked for
answer() {
	{ printf '%s\n' "$1"; } 2>/dev/null || { echo "${0##*/}: standard output: cannot be written" >&2; exit 3; }
	exit 0
}
# asked WORD: answers it, if it is one of these
asked() {
	case $1 in
	-h | --help) answer "$usage" ;;
	--version) version=$("$here/fan" --version) || exit; answer "${0##*/} ${version#* }" ;;
	esac
}
# given LETTER VALUE: that option's argument is none where it looks like the next option
given() {
	case $1,$2 in
	?,) refused="-$1: is empty, expected a value" ;;
	s,[0-9]*x[0-9]*) return ;; # the worker says what it refuses of these
	s,*) refused="-s $2: expected WxH, such as 512x512" ;;
	?,-[A-Za-z] | ?,--help | ?,--version) refused="-$1 $2: expected a value, not an option; of a file's name write ./$2" ;;
	*) return ;;
	esac
	echo "${0##*/}: $refused" >&2
	exit 2
}
# directory: prints the name of a new one for temporary files
directory() {
	mktemp -d 2>/dev/null && return
	echo "${0##*/}: ${TMPDIR:-/tmp}: no directory can be made there, expected TMPDIR to name one where it can" >&2
	exit 3
}
asked "${1-}"
trap '' XFSZ # that a file may grow no more is an error of write, which is reported
# A shell that lacks descriptors takes programs for missing, and cannot even say that itself.
# shellcheck disable=SC3045,SC2016  # dash and bash have -n; a script for another shell
case $(ulimit -n) in
[0-9] | [12][0-9]) exec sh -c 'echo "$0: expected a limit of 30 open files or more (ulimit -n)" >&2; exit 3' "${0##*/}" ;;
esac
