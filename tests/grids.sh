# For tests of programs that write grids. Read it after lib.sh; $converter is the name of the program.
# shellcheck shell=sh disable=SC2154
# coordinates X FILE: prints the big-endian doubles after the line X_COORDINATES
coordinates() {
	at=$(grep -abom 1 "^$1_COORDINATES [0-9]* double" "$2") || return
	from=${at%%:*} line=${at#*:}
	count=${line#* } count=${count% *}
	tail -c +$((from + ${#line} + 2)) "$2" | head -c $((8 * count)) | od -An -v -t f8 -w8 --endian=big
}
# values FILE: prints the last block of floats
values() {
	count=$(grep -am 1 '^POINT_DATA' "$1") && count=${count#* }
	tail -c $((4 * count + 1)) "$1" | head -c $((4 * count)) | od -An -v -t f4 -w4 --endian=big
}
# on_line COMMAND ...: prints the numbers of its output on one line
on_line() { "$@" | tr -s ' \n' ' ' | sed 's/^ //; s/ $//; s/-nan/nan/g'; }
# got ARGUMENTS: writes the grid to a.vtk, and prints its values
got() { "$converter" "$@" >a.vtk && on_line values a.vtk; }
# closed OPEN CLOSED NX: CLOSED has the values of OPEN, with the first value of each row again at its end
closed() {
	values "$1" >open.values
	values "$2" | awk -v nx="$3" '
		NR == FNR { want[n++] = $1; next }
		{
			row = int((FNR - 1) / (nx + 1)); x = (FNR - 1) % (nx + 1)
			if ($1 != want[row * nx + x % nx]) { print "value " FNR ": " $1; exit bad = 1 }
			seen++
		}
		END { exit bad || !n || seen != n / nx * (nx + 1) }' open.values -
}
# refused FILE VARIABLE MESSAGE: the converter refuses this with status 2 and this message
refused() {
	run "$converter" "$1" "$2"
	is "refused: $1 $2" "$status:$out" 2:
	like "refused: $1 $2: the message gives the reason" "$err" "^$converter: $1: .*$3"
}
# at_the_end FILE VARIABLE [ARGUMENTS] ...: assertions on usage, on bad ARGUMENTS, and on output that cannot be written
at_the_end() {
	good=$1 name=$2
	shift 2
	for bad in '' a '-l' '-l a b' '-t -1 a b' '-t x a b' '-t all a b' '-t all -o a.vtk a b' '-o %d%d a b' '-q a b' "$@"; do
		# shellcheck disable=SC2086  # a word each
		run "$converter" $bad
		is "refused: $converter $bad" "$status:$out" 2:
	done
	"$converter" "$good" "$name" >/dev/full 2>err
	is 'a full disk: exit 3' "$?" 3
	like 'a full disk: a message says so' "$(cat err)" "^$converter: standard output: No space left"
	run "$converter" -o no/such.vtk "$good" "$name"
	is 'a directory that does not exist: exit 3' "$status" 3
}
