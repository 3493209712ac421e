#!/bin/sh
# Pictures larger than memory: their pixels are in a file without a name. prlimit(1) bounds the address space of gather.
# tests/soak/poster.sh has 30000x30000 pixels.
. "$(dirname "$0")/lib.sh"
# shellcheck source=marked.sh
. "$root/tests/marked.sh"
cp "$root/tests/ball.nff" .
TMPDIR=$tmp/pixels && mkdir pixels && export TMPDIR
worker='rtworker -a 1 ball.nff'

if [ -n "${NIGHT-}" ]; then
	run sh -c "partition 8000x8000 | $worker | prlimit --as=200000000 gather -o a.png"
	is '8000x8000 in 200 MB: exit 0, and no message' "$status:$err" 0:
	rm a.png
fi

# A little more than 2^24 pixels, which memory does not hold. Rows are compared with the fragments: of RGBA, bottom row last.
size=4100x4100
partition $size | $worker >rows.frags
run prlimit --as=200000000 gather -o rows.pfm rows.frags
is "$size, rows: exit 0, and no message" "$status:$err" 0:
cat >rows.pl <<'END'
my ($pfm, $w, $h) = @ARGV;
open my $p, '<:raw', $pfm or die; binmode STDIN;
my $head = length "PF\n$w $h\n-1.0\n"; my $rows = 0;
while (my $line = <STDIN>) {
	my ($n) = $line =~ / bytes=(\d+)/ or next;
	read STDIN, my $body, $n; read STDIN, my $end, 1;
	my (undef, undef, undef, $x, $y) = split ' ', $line;
	next if $y % 97;
	(my $rgb = $body) =~ s/(.{12}).{4}/$1/gs;
	seek $p, $head + 12 * (($h - 1 - $y) * $w + $x), 0; read $p, my $there, length $rgb;
	die "row $y differs\n" if $rgb ne $there; $rows++;
}
print "$rows\n";
END
is "$size: the rows are those of the fragments" "$(perl rows.pl rows.pfm 4100 4100 <rows.frags)" 43
gather -o rows.png rows.frags

# in random order
partition -u tile:512x512 $size | awk '{ print (NR > 1) rand() "\t" $0 }' | sort | cut -f 2- >tiles.task
run sh -c "$worker <tiles.task | prlimit --as=200000000 gather -o tiles.png"
is "$size, tiles in random order: exit 0, and no message" "$status:$err" 0:
ok "$size, tiles in random order: the same bytes" cmp rows.png tiles.png

# The log of a run that was cut, and the whole run again: half of the pixels come twice.
head -n 40 tiles.task | $worker >log
head -c $(($(wc -c <log) - 1000)) log >cut.log
run sh -c "$worker <tiles.task | prlimit --as=200000000 gather -P -r cut.log -o resumed.png"
is "$size, a log continued: exit 0" "$status" 0
like "$size, a log continued: pixels came twice, and were equal" "$err" 'gather: [0-9]+ pixels came twice$'
ok "$size, a log continued: the same bytes" cmp rows.png resumed.png
rm -f log cut.log resumed.png tiles.png

# Another worker's pixels differ. The first stand.
sed 's/^b .*/b 0.078 0.361 0.754/' ball.nff >other.nff
{
	cat rows.frags
	partition $size | sed -n '1p; 4000p' | rtworker -a 1 other.nff |
		env LC_ALL=C sed "s/ job=[0-9a-f]*/$(grep -am1 -o ' job=[0-9a-f]*' rows.frags)/" | "$root/tests/seal"
} >twice.frags 2>/dev/null
run sh -c 'prlimit --as=200000000 gather -o twice.png <twice.frags'
is "$size, other pixels: exit 1" "$status" 1
like "$size, other pixels: a message names both" "$err" "frame 0: [0-9]+ pixels of a worker .* and of a worker .* differ, most at [0-9]+,3998, by"
ok "$size, other pixels: the first stand" cmp rows.png twice.png
rm -f twice.frags twice.png

# Killed: nothing under the name, and no file.
mkfifo pipe
MARK=$mark gather -o killed.png <pipe &
pid=$!
exec 3>pipe
head -c 100000000 rows.frags >&3
kill -9 $pid
exec 3>&-
wait $pid 2>/dev/null
is 'killed: no picture, and no file of pixels' "$(echo pixels/* killed*)" 'pixels/* killed*'
finish
