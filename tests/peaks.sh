# Peaks of the memory and descriptors of the processes of a run, sampled some times a second. Read it after lib.sh:
#	measured LINE		runs a line of shell; leaves its status in $status
#	most PROGRAM kib|open|ms
#				prints the peak memory of one process of that name, in KiB, or of its open descriptors, or
#				its milliseconds of CPU time, without those of its children
# shellcheck shell=sh disable=SC2034,SC2154
peaks_mark=stormring-peaks-$$
# One process looks at all others: with a process for each look, hundreds of slots cost more than what they compute.
peaks_look() {
	exec perl -e '
		my ($mark, %most) = "MARK=$ARGV[0]\0";
		$SIG{TERM} = sub { print map { "$_ $most{$_}\n" } sort keys %most; exit };
		sub content { open my $file, "<:raw", $_[0] or return ""; local $/; <$file> // "" }
		sub most { my ($what, $n) = @_; $most{$what} = $n if $n > ($most{$what} // 0) }
		while (1) {
			for my $process (glob "/proc/[0-9]*") {
				("\0" . content("$process/environ")) =~ /\0\Q$mark\E/ or next;
				chomp(my $name = content("$process/comm"));
				most("$name open", scalar(() = glob "$process/fd/*"));
				most("$name ms", 10 * ($1 + $2)) if content("$process/stat") =~ /.*\)(?: \S+){11} (\d+) (\d+)/s;
				most("$name kib", $1) if content("$process/status") =~ /^VmHWM:\s*(\d+) kB/m;
			}
			select undef, undef, undef, .1;
		}' "$peaks_mark"
}
measured() {
	env MARK=$peaks_mark sh -c "$1" &
	peaks_run=$!
	(peaks_look) >"$tmp/.peaks" 2>/dev/null &
	status=0
	wait $peaks_run || status=$?
	kill $!
	wait $! 2>/dev/null
}
most() { awk -v name="$1" -v what="$2" '$1 == name && $2 == what { print n = $3 } END { if (!n) print 0 }' "$tmp/.peaks"; }
