# shellcheck shell=sh disable=SC2154  # balance, which reads this, sets them
# balance reads this for `balance view`: a window, in which all hosts render what is looked at.
slots='' hosts='' size='' lines=''
while getopts :hj:m:s:S: opt; do
	case $opt in [jmsS]) given "$opt" "$OPTARG" ;; esac
	case $opt in
	h) answer "$usage" ;;
	j) slots=$OPTARG ;; m) lines=$OPTARG ;; s) size=$OPTARG ;; S) hosts=$OPTARG ;;
	*) misused "$opt" "$OPTARG" ;;
	esac
done
shift $((OPTIND - 1))
[ $# -ge 1 ] || misused
for file; do [ -e "$file" ] && [ ! -d "$file" ] || fail "$file: is no file, expected grids and a specification, or scenes"; done
[ -z "$slots" ] || [ -z "$hosts" ] || fail "-j and -S: expected one of them"
there stormview "beside balance or on the PATH: make builds it where libsdl2-dev and libpango1.0-dev are"
case $lines in
none:) lines=/dev/null ;;
coasts:)
	there coastlines "beside balance or on the PATH"
	temporary=$(directory) && coastlines >"$temporary/coasts" && exec 7<"$temporary/coasts" || exit 3
	rm -r "$temporary"
	lines=/dev/fd/7
	;;
esac
case $(head -c 14 -- "$1" 2>/dev/null | tr '[:upper:]' '[:lower:]' | tr -d '\0') in
'# vtk datafile') renderer=vcworker ;;
*) renderer=rtworker ;;
esac
# On this machine each slot has a worker of its own: children of one are forked again for each view.
exec stormview ${lines:+-m "$lines"} ${size:+-s "$size"} -- "$@" \
	deal -q auto -e fan ${slots:+-j "$slots"} ${hosts:+-1 -S "$hosts"} "$renderer"
