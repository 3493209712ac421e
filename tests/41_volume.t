#!/bin/sh
# Volumes: vcworker alone, with every method, nested, and with vectors of every width gives the same bytes; several
# grids and several views in one stream; the input of StormView; refusals; restarts and kills; memory.
. "$(dirname "$0")/lib.sh"
# shellcheck disable=SC2154
. "$root/tests/marked.sh"

# grid PHASE: 24x18x7 nodes, uneven, y descending, a missing one
grid() {
	awk -v phase="$1" 'BEGIN {
		print "# vtk DataFile Version 3.0\nwind\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 24 18 7"
		print "X_COORDINATES 24 float"; for (i = 0; i < 24; i++) print i * (1 + .02 * i)
		print "Y_COORDINATES 18 float"; for (i = 17; i >= 0; i--) print i * (1 + .02 * i)
		print "Z_COORDINATES 7 float"; for (i = 0; i < 7; i++) print i * (1 + .1 * i)
		print "POINT_DATA 3024\nSCALARS wind float 1\nLOOKUP_TABLE default"
		for (k = 0; k < 7; k++) for (j = 0; j < 18; j++) for (i = 0; i < 24; i++)
			if (i == 5 && j == 5 && k == 3) print "nan"
			else print 30 + 20 * sin(i / 3 + k / 2 + phase) * cos(j / 4)
	}'
}
# spec FROM RESOLUTION
spec() {
	printf '%s\n' "from $1" 'at 14 10 3' 'up 0 0 1' 'angle 40' "resolution $2" 'light 9 -9 30' \
		'map 25 .2 .2 1 0' 'map 32 1 .5 0 .3' 'map 32 0 1 0 0' 'map 60 0 1 1 .2' 'iso 45 1 1 1 .5'
}
# Slices, one of them at a plane of the grid, in a box that ends within cells
boxed() { spec '30 -20 22' '48 40'; printf '%s\n' 'clip 2.2 1 .3 27.5 19 8.1' 'slice z 2.2 .7' 'slice x 13 .5' 'slice y 7.7 1'; }
grid 0 >a.vtk
grid 1 >b.vtk
spec '12 -30 25' '48 40' >one.spec
spec '44 -20 9' '48 40' >two.spec
spec '12 -30 25' '30 20' >small.spec
boxed >boxed.spec
size=48x40

# picture OUT GRID SPEC [OPTIONS]: one worker, no balancer
picture() { out=$1 of="$2 $3"; shift 3; partition $size | vcworker "$@" $of | gather -o "$out"; }
same() { ok "$1" cmp out.pam "$2"; rm -f out.pam; }
picture a1.pam a.vtk one.spec
like "alpha is kept" "$(head -n 7 a1.pam | tr '\n' ' ')" 'DEPTH 4 .*RGB_ALPHA'
picture a1.png a.vtk one.spec
is "alpha is kept in a PNG" "$(dd if=a1.png bs=1 skip=25 count=1 2>/dev/null | od -An -tu1 | tr -d ' ')" 6

# ---- the same bytes ------------------------------------------------------------------------------------------
# The other methods: below, as the first of several pictures.
balance masterslave -j 3 -o out.pam a.vtk one.spec
same masterslave a1.pam
balance adaptive -j 2 -s 150x40 -r log -o out.pam a.vtk one.spec
ok 'adaptive: tiles' grep -aq '^frag [0-9]* [0-9]* [0-9]* [0-9]* 8 8 ' log
size=150x40 && picture wide.pam a.vtk one.spec && size=48x40
same "adaptive: tiles, and rows" wide.pam
printf '%s\n' ': slots=2' 'other via="sh -c %c"' >hosts
balance ds -S hosts -o out.pam a.vtk one.spec
same "ds on two hosts" a1.pam
balance masterslave -j 2 -s 30x20 -o out.pam a.vtk one.spec
size=30x20 && picture s.pam a.vtk one.spec && size=48x40
same "balance masterslave with another size" s.pam
state() { pack grid a.vtk; pack spec one.spec; partition "$@" $size; }
state -u tile:7x5 | deal fan -j 2 deal fan -j 2 vcworker | gather -o out.pam
same "deal fan -j 2 deal fan -j 2" a1.pam
{ pack spec one.spec; partition -u run:97 $size; } | deal -q 2 fan -j 2 vcworker -c -f 17 a.vtk - | gather -o out.pam
same "the grid a file, the specification a record" a1.pam
state -n 3 | ringctl fan -j 3 ringctl -n vcworker | gather -o out.pam
same "a ring" a1.pam
picture boxed.pam a.vtk boxed.spec
# A second field and a ground in the same file
{
	printf '%s\n' '# vtk DataFile Version 3.0' hills ASCII 'DATASET RECTILINEAR_GRID' 'DIMENSIONS 9 8 1'
	echo 'X_COORDINATES 9 float'; seq 0 4 32
	echo 'Y_COORDINATES 8 float'; seq 0 3 21
	printf '%s\n' 'Z_COORDINATES 1 float' 0 'POINT_DATA 72' 'SCALARS h float' 'LOOKUP_TABLE default'
	awk 'BEGIN { for (i = 0; i < 72; i++) print 1.5 + 1.5 * sin(i) }'
} >hills.vtk
cat a.vtk b.vtk hills.vtk >all.vtk
{ cat boxed.spec; printf '%s\n' 'ground 0 .1 .3 .1' 'ground 3 .8 .8 .7' 'attenuation .01'; } >ground.spec
{ cat ground.spec; printf '%s\n' 'colour 20 0 0 1' 'colour 40 1 0 0'; } >second.spec
for look in ground second; do
	picture $look.pam all.vtk $look.spec
	balance adaptive -j 2 -z off -o out.pam all.vtk $look.spec
	same "adaptive, $look" $look.pam
	{ partition -u run:37 $size; } | vcworker -f 5 all.vtk $look.spec | gather -o out.pam
	same "runs, $look" $look.pam
done
# Moved by whole circles: 360 degrees in four columns, from 180 on, under a grid from -6 on
earth() {
	printf '%s\n' '# vtk DataFile Version 3.0' 's [K]; x lon [degrees_east]' ASCII 'DATASET RECTILINEAR_GRID'
	echo "DIMENSIONS $1 2 1" "X_COORDINATES $1 float $2 Y_COORDINATES 2 float 0 21 Z_COORDINATES 1 float 0"
	echo "POINT_DATA $((2 * $1)) SCALARS h float LOOKUP_TABLE default $3 $3"
}
sed '2s/.*/a [K]; x lon [degrees_east]/' a.vtk >east.vtk
{ cat east.vtk; earth 4 '180 270 360 450' '1 2 3 2.5'; } >turned.vtk
{ cat east.vtk; earth 3 '-90 0 90' '2 3 2.5'; } >straight.vtk
for grid in turned straight; do picture $grid.pam $grid.vtk ground.spec; done
ok 'a ground is moved by whole circles' cmp turned.pam straight.pam
{ cat east.vtk; earth 4 '180 181 182 183' '1 2 3 2.5'; } >lost.vtk
run vcworker -i lost.vtk ground.spec ground.spec
like 'a ground elsewhere: a remark, once' "$status $err" '^0 vcworker: lost.vtk: the ground is below 0 % of the grid: x 180 to 183 .*$'
is 'none where it is below' "$(vcworker -i turned.vtk ground.spec 2>&1 >/dev/null)" ''
is 'the second field is seen' "$(cmp -s ground.pam second.pam && echo same)" ''
run balance adaptive -j 1 -o out.pam a.vtk ground.spec
like 'a ground that is not there' "$status $err" '^2 vcworker: ground.spec: ground lines and a grid without ground, expected'
{ pack grid a.vtk; pack spec second.spec; partition 8x8; } >unfit
run vcworker - - <unfit
like 'nor a second field' "$status $err" '^2 vcworker: colour lines and a grid of one field, expected'
balance gdc -j 3 -o out.pam a.vtk boxed.spec
same "gdc, a box and slices" boxed.pam
{ partition -u run:37 $size; } | vcworker -f 5 a.vtk boxed.spec | gather -o out.pam
same "runs, a box and slices" boxed.pam
is 'a box hides a part' "$(cmp -s boxed.pam a1.pam && echo same)" ''
for isa in sse2 avx2 avx512; do
	if vcworker -x $isa -i a.vtk one.spec >/dev/null 2>&1; then
		picture out.pam a.vtk one.spec -x $isa
		same "vectors of $isa" a1.pam
		picture out.pam a.vtk boxed.spec -x $isa
		same "vectors of $isa, a box and slices" boxed.pam
		picture out.pam all.vtk ground.spec -x $isa
		same "vectors of $isa, a ground" ground.pam
	else skip "vectors of $isa" "this processor has none"
	fi
done
picture exact.pam a.vtk one.spec -m gauss:9
balance dc -j 2 -W '-m gauss:9' -o out.pam a.vtk one.spec
same "another integrator, and the same" exact.pam

# ---- many pictures -------------------------------------------------------------------------------------------
picture a2.pam a.vtk two.spec
picture b1.pam b.vtk one.spec
picture b2.pam b.vtk two.spec
size=30x20 && picture a3.pam a.vtk small.spec && size=48x40
# pictures NAME: f0.pam and the next ones are the expected pictures
pictures() {
	name=$1
	shift
	for expected; do ok "$name: $expected" cmp f$((at)).pam "$expected.pam"; at=$((at + 1)); done
	is "$name: no others" "$(ls f*.pam | wc -l)" $at
	rm -f f*.pam
}
for m in adaptive interleaved hybrid gdc gdc-published ss sc ds dc; do
	balance $m -j 3 -o f%d.pam a.vtk one.spec small.spec two.spec
	at=0 && pictures "$m, three views" a1 a3 a2
done
balance ds -j 2 -o f%d.pam a.vtk b.vtk one.spec
at=0 && pictures 'two grids' a1 b1
balance sc -j 2 -o f%d.pam a.vtk b.vtk one.spec two.spec
at=0 && pictures 'two grids, two views' a1 a2 b1 b2
balance ds -j 2 -s 30x20 -o f%d.pam a.vtk small.spec one.spec
at=0 && pictures 'all of one size' a3 s
balance ds -j 2 -r job.frags -o f%d.pam a.vtk one.spec two.spec
rm -f f*.pam
head -c $(($(wc -c <job.frags) * 3 / 5)) job.frags >torn
balance gdc -j 3 -r torn -o f%d.pam a.vtk one.spec two.spec 2>said
at=0 && pictures 'gone on with' a1 a2
balance ds -j 2 -r torn -o f%d.pam a.vtk one.spec two.spec
at=0 && pictures 'nothing left to do' a1 a2
run balance ds -j 2 -r torn -o f%d.pam a.vtk two.spec one.spec
like 'a log of other pictures is refused' "$status $err" '^2 .*other|another'

# ---- vcworker -i and -n ----------------------------------------------------------------------------------
run vcworker -i a.vtk one.spec small.spec
is '-i: sizes' "$(printf '%s\n' "$out" | grep frame | tr '\n' ' ')" 'frame 48 40 frame 30 20 '
job() { vcworker -i "$@" | sed -n 's/^job=//p'; }
is 'the job is of grid, specification and method' \
	"$({ job a.vtk one.spec; job b.vtk one.spec; job a.vtk two.spec; job -m gauss:9 a.vtk one.spec
		job -m adaptive:.1 a.vtk one.spec; } | sort -u | wc -l)" 5
is 'the job does not depend on vectors and fragments' "$(job -m adaptive -x sse2 -f 9 a.vtk one.spec)" "$(job a.vtk one.spec)"
run vcworker -n a.vtk one.spec
is '-n: all rays' "$(printf '%s\n' "$out" | awk '$1 == "rays" { print $2 + $3 }')" 1920
is '-n: its table' "$(printf '%s\n' "$out" | cut -f 1 | tr '\n' ' ')" \
	'quantity rays min_s max_s median_s mean_s sd_s cells samples most_cells '
ok '-n: in order' awk '{ v[$1] = $2 } END { exit !(v["min_s"] <= v["median_s"] && v["median_s"] <= v["max_s"]) }' "$tmp/.out"

# ---- StormView's own input, by its paper and by the file --------------------------------------------
if there nc2vtk /usr/share/ncarg/data/cdf/nc4uvt.nc; then
	ok 'the wind of nc4uvt.nc' sh -c 'nc2vtk /usr/share/ncarg/data/cdf/nc4uvt.nc "speed=hypot(U,V)" >wind.vtk'
	run vcworker -n wind.vtk "$root/scenes/stormview.spec"
	is "StormView's input: all 54549 rays hit the grid" "$(printf '%s\n' "$out" | grep rays)" "rays	54549	0"
	ok "StormView's input: no ray passes more than 18 cells" awk '$1 == "most_cells" { n = $2 } END { exit !(n >= 13 && n <= 18) }' "$tmp/.out"
else
	skip "StormView's own input" "$missing is not there"
fi
ok 'the light is off' grep -qx 'light off' "$root/scenes/stormview.spec"
like 'the contour is at 40 m/s' "$(grep -c '^map' "$root/scenes/stormview.spec") $(grep '^map 40 ' "$root/scenes/stormview.spec")" '^3 map 40 .* 40$'

# ---- kills -----------------------------------------------------------------------------------------------------
casting() { [ "$(program vcworker | wc -l)" -ge 3 ] && [ -n "$(program $stage)" ]; }
# There job waits for the file go before it writes state, so that it and partition are there to be killed.
all_in gated
rm gated/job
printf '#!/bin/sh\n[ "$1" = -i ] || until [ -e "%s/go" ]; do sleep .05; done\nexec "%s/bin/job" "$@"\n' "$tmp" "$root" >gated/job
chmod +x gated/job
for stage in gather balance job partition; do
	rm -f f*.pam go
	case $stage in gather | balance) : >go ;; esac
	PATH=$tmp/gated:$PATH env MARK=$mark balance ds -j 3 -s 400x300 -W '-m trapezoid:200000' -o f%d.pam a.vtk b.vtk one.spec two.spec 2>said &
	pid=$!
	await 20 casting
	victims=$(program $stage)
	[ $stage != balance ] || victims=$pid
	# shellcheck disable=SC2086
	kill -9 $victims
	: >go
	ok "kill -9 of $stage over several pictures: no process remains" await 2 none_alive
	end_all
	wait $pid 2>/dev/null
	is "kill -9 of $stage: no picture" "$(ls f*.pam* 2>/dev/null)" ''
done

# ---- a series that is killed and resumed ------------------------------------------------------------------
# A worker here keeps what it has of the fourth picture and later ones, except the first fragment. So a run writes three
# pictures, has a part of another, and cannot end before it is killed.
cat >three <<'END'
$| = 1;
while (defined(my $line = <STDIN>)) {
	my $body = '';
	read STDIN, $body, $1 + 1 if $line =~ / bytes=(\d+)/;
	next if $line =~ /^(done|frag) (\d+)/ && $2 > 2 && ($1 eq 'done' || $kept++);
	print $line, $body;
}
END
wrap vcworker kept <<END
'$root/bin/vcworker' "\$@" | perl '$tmp/three'
END
begun() { [ -e f1.pam ] && grep -aq '^frag 3 ' log; }
# killed NAME PREFIX FILE ...: kill -9 of the last stage, or of the whole group if PREFIX is -, after the second picture
killed() {
	name=$1 whom=$2
	shift 2
	rm -f log f*.pam
	# The pictures of one run, to compare with.
	balance ds -j 2 -W '-m trapezoid:50' -o whole%d.pam "$@"
	PATH=$tmp/kept:$PATH patience=600 setsid env MARK=$mark balance ds -j 3 -W '-m trapezoid:50' -r log -o f%d.pam "$@" 2>/dev/null &
	pid=$!
	await 20 begun
	kill -9 "$whom$pid" 2>/dev/null
	status=0
	wait $pid || status=$?
	is "$name: it was killed" $status 137
	ok "$name: no process remains" await 5 none_alive
	diag "$name: $(find . -name 'f*.pam' | wc -l) of $(find . -name 'whole*.pam' | wc -l) pictures were there"
	ok "$name: pictures were missing" [ "$(find . -name 'f*.pam' | wc -l)" -le 3 ]
	run balance ds -j 2 -W '-m trapezoid:50' -r log -o f%d.pam "$@"
	is "$name: the same command finishes it" "$status $(printf '%s' "$err" | grep -v 'damaged record')" '0 '
	same=0
	for picture in whole*.pam; do cmp -s "$picture" "f${picture#whole}" && same=$((same + 1)); done
	is "$name: the same pictures" "$same $(find . -name 'f*.pam' | wc -l)" \
		"$(find . -name 'whole*.pam' | wc -l) $(find . -name 'whole*.pam' | wc -l)"
	is "$name: no pixel came twice" "$(gather -P -o twice%d.pam log 2>&1 | grep -o '[0-9]* pixels came twice.*')" ''
	rm -f whole*.pam f*.pam twice*.pam
}
killed 'a grid for each picture' '' a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk one.spec
killed 'the whole group' - a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk a.vtk b.vtk one.spec
killed 'a specification for each picture' - a.vtk one.spec two.spec small.spec one.spec two.spec small.spec one.spec two.spec

# ---- bad input -----------------------------------------------------------------------------------------------
# refused NAME ERE COMMAND ...
refused() { name=$1 ere=$2; shift 2; run timeout 800 "$@" </dev/null; like "$name" "$status $(printf '%s' "$err" | tr '\n' ' ')" "^2 $ere"; }
sed 's/^iso/fog/' one.spec >bad.spec
sed 's/^DIMENSIONS.*/DIMENSIONS 24 18 8/' a.vtk >bad.vtk
refused 'a bad specification' 'vcworker: bad.spec:11: line: first word is .fog., expected' vcworker a.vtk bad.spec
refused 'a bad grid' 'vcworker: bad.vtk:[0-9]+: .*, expected' vcworker bad.vtk one.spec
refused 'no such grid' 'vcworker: none: No such file' vcworker none one.spec
refused 'one file' 'usage: vcworker' vcworker a.vtk
refused '-i and -n' 'vcworker: -n: expected one of' vcworker -i -n a.vtk one.spec
refused '-i of records' 'vcworker: -i: expected GRID.vtk SPEC' vcworker -i
refused 'an unknown method' 'vcworker: -m simpson: expected adaptive' vcworker -m simpson a.vtk one.spec
refused 'gauss:0' 'vcworker: -m gauss:0: expected gauss:N, an integer from 1 to 64' vcworker -m gauss:0 a.vtk one.spec
refused 'balance: a bad specification' 'vcworker: bad.spec:11:' balance ds -o x-%d.png a.vtk one.spec bad.spec
refused 'balance: a bad grid behind a good one' 'vcworker: bad.vtk:' balance ds -o x-%d.png a.vtk bad.vtk one.spec
refused 'balance: no specification' 'job: b.vtk: is a grid' balance ds -o x.png a.vtk b.vtk
printf 'v\nfrom 0 0 1\n' >v.view
refused 'balance: a view with the line v of a scene' 'job: v.view: begins with `v` as a scene does, expected a view or a specification: the lines behind `v`, without it' \
	balance ds -o x.png "$root/scenes/boat.nff" v.view
refused 'balance: no grid' 'job: one.spec: is a view or a specification, expected a scene or a grid before it' balance ds -o x.png one.spec two.spec
refused 'balance: one name for two' 'job: 2 pictures, expected -o with %d' balance ds -o x.png a.vtk one.spec two.spec
ln -s one.spec one.png
refused 'balance: the picture over a specification' 'gather: one.png: is also an input' balance ds -o one.png a.vtk one.spec
refused 'balance -W -n' 'vcworker: -[in]: expected one of' balance ds -W -n -o x.png a.vtk one.spec
said() { { "$@" | timeout 800 vcworker >/dev/null; } 2>&1; }
like 'a task before any grid' "$(said partition 2x2)" 'no grid, expected a .grid. record before the first task'
like 'a task before its specification' "$({ pack grid a.vtk; partition 2x2; } | said cat)" 'no spec, expected'
like 'a scene' "$(said pack scene one.spec)" 'record .scene., expected .grid. or .spec.'
like 'a bad record' "$({ pack grid a.vtk; pack spec bad.spec; } | said cat)" 'vcworker: spec:11: line: first word'

# ---- memory: one copy of the grid as float, and 10 % ------------------------------------------------------------------
perl -e 'binmode STDOUT; my @n = (256, 256, 200);
	print "# vtk DataFile Version 3.0\nbig\nBINARY\nDATASET RECTILINEAR_GRID\nDIMENSIONS @n\n";
	for my $a (0 .. 2) { print qw(X Y Z)[$a], "_COORDINATES $n[$a] float\n", pack("f>*", 0 .. $n[$a] - 1), "\n" }
	print "POINT_DATA 13107200\nSCALARS s float 1\nLOOKUP_TABLE default\n";
	print pack("f>*", map { 40 + $_ % 7 } 0 .. 65535) for 1 .. 200' >big.vtk
# peak NAME TASK KIB VCWORKER-OPERANDS: asserts the peak memory until TASK of the input on descriptor 8 is done. How much of
# the program's file is in memory is the kernel's choice, so that is left out.
peak() {
	name=$1 last=$2 most=$3
	shift 3
	rm -f in said && mkfifo in
	vcworker "$@" <in >said &
	worker=$!
	exec 9>in
	cat <&8 >&9
	tries=0
	until grep -aq "done $last " said || [ $((tries += 1)) -gt 600 ]; do sleep .1; done
	kb=$(awk '/^VmHWM/ { n += $2 } /^RssFile/ { n -= $2 } END { print n }' /proc/$worker/status)
	exec 9>&-
	wait $worker
	ok "$name: $kb KiB for $most" [ "$kb" -le $((most * 11 / 10)) ]
}
peak 'a file' '0 19' 51200 big.vtk small.spec 8<<END
$(partition 30x20)
END
# Rays within the plane y = 1.4, where one of the cells of the face has no values.
cat >face.vtk <<'END'
# vtk DataFile Version 3.0
face
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 3 3 3
X_COORDINATES 3 double
0 1 2
Y_COORDINATES 3 double
.4 1.4 2.4
Z_COORDINATES 3 double
0 1 2
POINT_DATA 27
SCALARS s float 1
LOOKUP_TABLE default
1 1 1 1 1 1 nan nan nan
1 1 1 1 1 1 nan nan nan
1 1 1 1 1 1 nan nan nan
END
for from in '9 1.4 .7' '-9 1.4 .7'; do
	printf '%s\n' "from $from" 'at 0 1.4 .7' 'up 0 0 1' 'angle 30' 'resolution 9 3' 'map 0 1 0 0 1' 'map 2 1 0 0 1' >face.spec
	{ cat face.spec; echo 'clip -9 -9 -9 9 9 9'; } >wide.spec
	partition 9x3 | vcworker -m gauss:9 face.vtk face.spec | gather -o exact.pfm
	for of in face wide; do
		partition 9x3 | vcworker face.vtk $of.spec | gather -o in.pfm
		ok "rays in a face from $from, $of: in the same cells by every method" imgcmp -t 1e-5 in.pfm exact.pfm
	done
done

mkfifo stream
{ pack grid big.vtk; pack spec small.spec; partition 30x20; } >stream &
peak 'a record' '0 19' 51200 - - 8<stream
{ pack spec small.spec; for f in 0 1 2 3; do pack grid big.vtk; partition -F $f 30x20; done; } >stream &
peak 'four, one after the other: two at a time' '3 19' 102400 - - 8<stream
{ pack grid big.vtk; for f in 0 1 2 3; do pack spec small.spec; partition -F $f 30x20; done; } >stream &
peak 'four views of one, and what says of two where nothing is seen' '3 19' 53248 - - 8<stream
finish
