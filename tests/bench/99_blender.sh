#!/bin/sh
# 99_blender: FRAMES frames of Blender's first scene, by Cycles with SAMPLES samples, on three test hosts (tests/README) of one
# slot: by `balance adaptive`, by GNU parallel with a frame for each host, as render farms do, and by Blender alone with all
# processors. Then both with the renderer of host2 killed after a second. The hosts share the cores of this machine.
hosts=$(cd "$(dirname "$0")/.." && pwd)/hosts
why=$("$hosts" check 2>&1) || { echo "99_blender: no test hosts: $why"; exit 0; }
[ -n "${TEST_HOSTS-}" ] || exec "$hosts" with 3 "$0" "$@"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
for program in blender parallel rsync; do command -v $program >/dev/null || stop "$program: not installed"; done
frames=${FRAMES:-4} samples=${SAMPLES:-64} size=${SIZE:-320x240}
blender -b -noaudio --factory-startup --python-expr "
import bpy
s = bpy.context.scene; r = s.render
r.engine, s.cycles.samples, r.resolution_x, r.resolution_y = 'CYCLES', $samples, ${size%x*}, ${size#*x}
r.image_settings.color_depth, s.cycles.use_adaptive_sampling, s.cycles.use_denoising = '16', False, False
r.image_settings.color_mode = 'RGB'
o = bpy.data.objects['Cube']; o.keyframe_insert('location', frame=1); o.location.x = 2; o.keyframe_insert('location', frame=$frames)
bpy.ops.wm.save_as_mainfile(filepath='$tmp/cube.blend')" >said 2>&1 || stop "$(tail -n 3 said)"

balance() { "$root/bin/balance" adaptive -S "$TEST_HOSTS/hosts" -s "$size" -k 16 -W "frames=1-$frames" -r log -o 'tiles%d.png' cube.blend; }
farm() {
	seq "$frames" | parallel --will-cite --retries 3 -S 1/host1,1/host2,1/host3 --basefile cube.blend --return 'farm000{}.png' --cleanup \
		"blender -b -noaudio --factory-startup -Y cube.blend -t 1 -o //farm#### -f {} && test -e farm000{}.png"
}
alone() { blender -b -noaudio --factory-startup -Y cube.blend -o "//alone#" -s 1 -e "$frames" -a; }
# timed NAME: elapsed seconds
timed() {
	rm -f log tiles*.png farm*.png
	begin=$(date +%s.%N)
	$1 >said 2>&1 || { tail -n 5 said >&2; stop "$1 failed"; }
	date +%s.%N | awk -v b="$begin" '{ printf "%.2f\n", $1 - b }'
}
# killed NAME: the same, with what renders on host2 killed
killed() {
	{
		until p=$("$hosts" pids host2 blender | head -n 1) && [ -n "$p" ]; do sleep .1; done
		sleep 1
		kill -9 "$p"
	} 2>/dev/null &
	timed "$1"
	wait
}
echo "cube, $size, $samples samples, $frames frames: three hosts of one slot, which share $("$root/tests/processors") processors"
for way in alone balance farm; do echo "  $way $(timed $way) s"; done
for way in balance farm; do echo "  $way, a renderer is killed: $(killed $way) s"; done
timed balance >/dev/null
for frame in $(seq "$frames"); do
	for way in tiles alone; do # a PNG of Blender does not state its curve
		partition "$size" | cropworker -g srgb cat "$tmp/$way$frame.png" | gather -k 16 -o $way.pfm || stop "$way$frame.png"
	done
	echo "  frame $frame: RMSE from Blender alone $(imgcmp tiles.pfm alone.pfm | awk '$1 == "rmse" { print $2 }')"
done
