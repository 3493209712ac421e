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
# closed OPEN CLOSED NX: CLOSED has the values of OPEN, with the first value of each row again at its end. Bytes are compared,
# because a globe has a million values.
closed() {
	perl -e '
		my ($open, $closed) = map { block($_) } @ARGV[0, 1];
		my ($n, $want) = (4 * $ARGV[2], "");
		for (my $at = 0; $at < length $open; $at += $n) { $want .= substr($open, $at, $n) . substr $open, $at, 4 }
		die "the values differ\n" if $open eq "" || $closed ne $want;
		sub block {
			open my $file, "<:raw", $_[0] or die "$_[0]: $!\n";
			local $/;
			my $all = <$file>;
			$all =~ /^POINT_DATA (\d+)/m or die "$_[0]: has no values\n";
			substr $all, -4 * $1 - 1, 4 * $1;
		}' "$1" "$2" "$3"
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
