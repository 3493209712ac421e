#!/bin/sh
# 10_trace: CPU seconds of a whole run of rtworker against POV-Ray's trace time alone, on one core, medians of 5 rounds.
# Ours is all of `partition | rtworker`: reading, building, tracing, writing fragments. POV-Ray's is the time that it
# reports for tracing, without parsing, bounding and writing; beside it the CPU time and wall time of its whole run, the
# RMSE between the two pictures without the worst 0.1 % of the pixels, and the number of pixels that differ by more than
# 1/255. These are all scenes of spdgen; SCENES='balls gears' takes fewer.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=5 size=512

ours="partition ${size}x$size | rtworker SCENE.nff"
pov="povray -V +WT1 +ISCENE.pov +Opov.ppm +W$size +H$size +FP16 File_Gamma=1 -A -D"
# Another tracer that reads NFF, if it is installed. Its pictures differ (light, materials, for gears nearly all), so the
# times cannot be compared directly; the difference is beside the time.
peer="tachyon SCENE.nff -res $size $size -numthreads 1 -raydepth 5 -shade_phong -o peer.ppm -format PPM48"
command -v tachyon >/dev/null || peer=''

of() { echo "$1" | sed "s/SCENE/$2/g"; } # COMMAND SCENE
# CPU seconds of tracing, from POV-Ray's log
pov_trace_s() { awk '/Trace Time/ { t = 1 } t && /CPU-seconds/ { sub(/.*with /, ""); print $1; found = 1; exit } END { exit !found }' "$1"; }

for s in ${SCENES:-$(spdgen -l | awk '!/^#/ { print $1 }')}; do
	spdgen $s >$s.nff || stop "spdgen $s failed"
	nff2pov -x 100 $s.nff >$s.pov || stop "nff2pov $s failed"
	often=$(times_for 0.5 "$(of "$ours" $s)")
	i=0
	while [ $i -lt $rounds ]; do
		cpu_s "$often" "$(of "$ours" $s)" >>$s.ours || stop "failed: $ours"
		# shellcheck disable=SC2154  # lib.sh sets pin
		wall_s "$pin $(of "$pov" $s) >pov.log 2>&1" >>$s.wall || stop "failed: $pov"
		pov_trace_s pov.log >>$s.trace || stop "POV-Ray said no trace time"
		cpu_s 1 "$(of "$pov" $s) 2>&1" >>$s.whole || stop "failed: $pov"
		[ -z "$peer" ] || cpu_s 1 "$(of "$peer" $s)" >>$s.peer 2>/dev/null || peer=''
		i=$((i + 1))
	done
	sh -c "$(of "$ours" $s)" | gather -o ours.pfm || stop "no picture of $s"
	imgcmp -d 0.001 -t 0.003922 ours.pfm pov.ppm >$s.differs
	echo "$s $(median 1 <$s.ours) $(median 1 <$s.trace) $(median 1 <$s.whole) $(median 1 <$s.wall)" \
		"$(awk '$1 == "rmse_kept" { rmse = $2 } $1 == "over" { over = $2 } END { print rmse, over }' $s.differs)" >>table
	[ -z "$peer" ] || echo "$s $(median 1 <$s.peer) $(imgcmp pov.ppm peer.ppm | awk '$1 == "rmse" { print $2 }')" >>peers
done

echo "CPU s ${size}x$size  ours whole  POV trace  POV whole  POV wall  ours/POV trace     RMSE   far"
awk '{ printf "%-13s  %10.3f %10.3f %10.3f %9.3f %15.2f %8.1e %5d\n", $1, $2, $3, $4, $5, $2 / $3, $6, $7 }' table
echo "ours: $ours"
echo "POV:  $pov"
if [ -n "$peer" ]; then
	echo "peer: $peer (Debian's $(tachyon 2>&1 | grep -o -m 1 'Version [0-9.]*' || echo build))"
	awk '{ printf "      %s: %.3f CPU s whole; its picture has an RMSE of %.2g from that of POV-Ray\n", $1, $2, $3 }' peers
fi
while read -r s ours_s trace_s rest; do
	report "$s, ratio to POV-Ray's trace time" "$(echo "$ours_s $trace_s" | awk '{ print $1 / $2 }')" '' 1
done <table
