#!/bin/sh
# 97_povray: a scene by `balance adaptive`, by POV-Ray's own threads, and by GNU parallel, which runs POV-Ray on the bands
# of rows that `balance adaptive` begins with (joining them is not counted): seconds, and whether pictures are the same.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-3} size=${SIZE:-1280x960} slots=${SLOTS:-$("$root/tests/processors")}
scene=${SCENE:-/usr/share/doc/povray/examples/advanced/teapot/teapot.pov} words=${WORDS:-+A0.1 +AM2}
name=$(basename "$scene") width=${size%x*} height=${size#*x}
mkdir files bands
povworker -l "$scene" | xargs -d '\n' pack files | tail -n +2 | tar -C files -xf - 2>/dev/null || stop "$scene: cannot be unpacked"
export tmp name words width height
# one Y1 Y2: POV-Ray's picture of these rows
cat >one <<'END'
cd "$tmp/files" && povray "+I$name" -A +FN $words "+W$width" "+H$height" "+SR$1" "+ER$2" +WT1 -D "+O$tmp/bands/$1.png" 2>"$tmp/bands/$1.said"
END
# shellcheck disable=SC2086  # a word each
threads() { (cd files && povray "+I$name" -A +FN $words "+W$width" "+H$height" "+WT$("$root/tests/processors")" -D "+O$tmp/threads.png" 2>"$tmp/said"); }
adaptive() { rm -f log; balance adaptive -j "$slots" -s "$size" -W "$words" -r log -o adaptive.png "$scene"; }
gnu() { partition -u factoring -n "$slots" "$size" | awk '$1 == "task" { print $5 + 1, $5 + $7 }' | parallel --colsep ' ' -j "$slots" sh one '{1}' '{2}'; }
# timed NAME: elapsed seconds
timed() {
	begin=$(date +%s.%N)
	$1 >&2 || stop "$1 failed"
	date +%s.%N | awk -v b="$begin" '{ printf "%.3f\n", $1 - b }'
}
command -v parallel >/dev/null && ways='threads adaptive gnu' || ways='threads adaptive'
ways=${WAYS:-$ways}
for round in $(seq "$rounds"); do
	for way in $ways; do timed "$way" >>"$way.s" || stop "round $round"; done
done
echo "$name, $size, $words, $("$root/tests/processors") processors, $slots slots, medians of $rounds"
for way in $ways; do echo "  $way $(median 1 <"$way.s") s"; done
# CPU seconds, which the load of the machine hardly changes: tracing by POV-Ray's own count, and all of the tasks
awk '/CPU-seconds total/ { for (i = 2; i <= NF; i++) if ($i ~ /^CPU-/) s += $(i - 1) } END { printf "  threads: %.2f CPU seconds\n", s }' said
fragstat log | awk -F '\t' 'NR > 1 { s += $3 } END { printf "  adaptive: %.2f CPU seconds\n", s }'
fragstat -s log | awk '$1 == "tasks" || $1 == "busy_s" { v[$1] = $2 } END { printf "  adaptive: %d tasks, %.1f s on each\n", v["tasks"], v["busy_s"] / v["tasks"] }'
echo "  pixels of adaptive that differ from those of threads: $(imgcmp adaptive.png threads.png | awk '$1 == "differing" { print $2 }')"
