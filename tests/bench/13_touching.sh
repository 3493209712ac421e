#!/bin/sh
# 13_touching: surfaces of glass in one place, and ever farther apart: two boxes that share a face, of one glass and of two,
# straight and turned, and 2000 equal balls. rtworker and POV-Ray (at 100 times the size) against exact.c, a tracer in long
# double that meets the first of the surfaces in one place, and multiplies shadows by all. Percent of 64x64 pixels that are
# off by more than 1/255. Last: POV-Ray against exact -lo, which meets the last of them, and counts one in shadows.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
built exact
size=64x64
# scene NAME GAP: prints the scene; the numbers have 17 digits
scene() {
	awk -v name="$1" -v gap="$2" '
	function put(word, x, y, z, more,  u, v) {
		u = x * c - y * s; v = x * s + y * c
		printf "%s %.17g %.17g %.17g %s\n", word, u, v * c - z * s, v * s + z * c, more
	}
	function side(a, b, d, e) {
		print "p 4"; put("", x[a], y[a], z[a]); put("", x[b], y[b], z[b]); put("", x[d], y[d], z[d]); put("", x[e], y[e], z[e])
	}
	function box(lo, hi,  i) {
		for (i = 0; i < 8; i++) { x[i] = i % 2 ? hi : lo; y[i] = int(i / 2) % 2 ? .7 : -.7; z[i] = i > 3 ? 1 : -.5 }
		side(0, 1, 3, 2); side(4, 6, 7, 5); side(0, 4, 5, 1); side(2, 3, 7, 6); side(0, 2, 6, 4); side(1, 5, 7, 3)
	}
	BEGIN {
		turn = name ~ /turned/ ? .7 : 0; c = cos(turn); s = sin(turn)
		print "b .1 .2 .4\nv"; put("from", 3.1, -6.3, 3.7); put("at", .1, 0, .5); put("up", 0, 0, 1)
		print "angle 35\nhither 0\nresolution 64 64"; put("l", 5, -5, 8); put("l", -6, -4, 3)
		print "f 1 .8 .6 .8 .1 20 0 0\np 4"; put("", -5, -5, -1); put("", 5, -5, -1); put("", 5, 5, -1); put("", -5, 5, -1)
		print "f .9 .3 .2 .8 0 1 0 0"; put("s", .5, 3, 0, 1); put("s", -1.5, 2.5, .3, .8)
		print "f .8 .9 1 .1 .1 30 .8 1.5"
		if (name ~ /balls/) { for (i = 0; i < 2000; i++) put("s", 0, 0, .3, 1); exit }
		box(-1.2, 0)
		if (name ~ /two glasses/) print "f 1 .8 .7 .1 .1 30 .8 1.3"
		box(gap, 1.1)
	}'
}
off() { imgcmp -t 0.003922 "$1" "$2" | awk '$1 == "over_percent" { printf "%.1f", $2 }'; }
printf '%-28s %-6s %10s %10s %14s\n' scene gap rtworker POV-Ray 'POV-Ray / -lo'
while IFS='|' read -r name gaps; do
	for gap in $gaps; do
		scene "$name" "$gap" >scene.nff
		./exact $size scene.nff >first.pfm && ./exact -lo $size scene.nff >last.pfm || stop 'exact failed'
		partition $size | rtworker scene.nff | gather -o ours.pfm || stop 'rtworker failed'
		nff2pov -x 100 scene.nff >scene.pov
		povray -GA -V +WT1 +Iscene.pov +Opov.ppm +W64 +H64 +FP16 File_Gamma=1 -A -D >said 2>&1 || stop "$(tail -n 3 said)"
		printf '%-28s %-6s %10s %10s %14s\n' "$name" "$gap" "$(off ours.pfm first.pfm)" "$(off pov.ppm first.pfm)" \
			"$(off pov.ppm last.pfm)"
	done
done <<'END'
boxes of one glass|0 1e-12 1e-6 1e-4
boxes of two glasses|0 1e-12 1e-6 1e-4
boxes of two glasses, turned|0 1e-12 1e-6 1e-4
2000 balls|0
END
