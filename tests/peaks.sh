# Peaks of the memory and descriptors of the processes of a run, sampled some times a second. Read it after lib.sh:
#	measured LINE		runs a line of shell; leaves its status in $status
#	most PROGRAM kib|open|ms
#				prints the peak memory of one process of that name, in KiB, or of its open descriptors, or
#				its milliseconds of CPU time, without those of its children
# shellcheck shell=sh disable=SC2034,SC2154
peaks_mark=stormring-peaks-$$
peaks_look() {
	# shellcheck disable=SC2046  # a process each
	set -- $(grep -lz "^MARK=$peaks_mark\$" /proc/[0-9]*/environ | sed 's,/environ$,,')
	for process; do
		name=$(cat "$process/comm") && echo "$name open $(set -- "$process"/fd/* && echo $#)"
		awk -v name="$name" '{ print name, "ms", 10 * ($14 + $15) }' "$process/stat"
		sed -n "s/^VmHWM:[[:space:]]*\([0-9]*\) kB/$name kib \1/p" "$process/status"
	done
}
measured() {
	: >"$tmp/.peaks"
	env MARK=$peaks_mark sh -c "$1" &
	peaks_run=$!
	while kill -0 $peaks_run; do peaks_look >>"$tmp/.peaks"; sleep .1; done 2>/dev/null
	status=0
	wait $peaks_run || status=$?
}
most() { awk -v name="$1" -v what="$2" '$1 == name && $2 == what && $3 > n { n = $3 } END { print n + 0 }' "$tmp/.peaks"; }
