#!/bin/sh
# Slow links: records of slots on other machines are packed, and the pixels, the logs and the events are as without.
# The other machines are commands on this one, which count the bytes that pass.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
fan -l -z on >said 2>&1 || { echo "1..0 # SKIP $(cat said)"; exit 0; }
spdgen -s 2 gears >gears.nff
partition 192x192 | rtworker gears.nff | gather -o good.pfm

# link NAME COMMAND: runs COMMAND, and keeps what passes
cat >./link <<'END'
#!/bin/sh
tee -a "$1.down" | sh -c "$2" | tee -a "$1.up"
END
chmod +x link
printf '%s\n' 'a slots=2 via="./link %h %c"' 'b via="./link %h %c"' >hosts
passed() { cat ./*."$1" | wc -c; }
# packed DIRECTION: how many packed records passed
packed() { cat ./*."$1" | grep -ac ' plain=[0-9]*'; }

# ---- every method ------------------------------------------------------------------------------------------------
methods=$(balance -h | sed -n 's/^methods: *//p')
for method in $methods; do
	for z in off on; do
		rm -f ./*.up ./*.down out.pfm job.log
		run balance "$method" -z $z -S hosts -s 192x192 -o out.pfm -r job.log gears.nff
		is "$method -z $z: exit 0" "$status" 0
		ok "$method -z $z: the same picture" cmp out.pfm good.pfm
		[ $z = on ] || { up=$(passed up) down=$(passed down) plain=$(packed up); continue; }
		is "$method: nothing is packed with -z off" "$plain" 0
		ok "$method: at most .6 of the bytes come up" [ $((10 * $(passed up))) -le $((6 * up)) ]
		ok "$method: at most .6 of the bytes go down" [ $((10 * $(passed down))) -le $((6 * down)) ]
		is "$method: no log has a packed record" "$(grep -ac ' plain=[0-9]' job.log)" 0
	done
done

# ---- what packs ----------------------------------------------------------------------------------------------------
job() { pack scene gears.nff; partition 192x192; }
# states: says which connection has the state twice, or tasks without it. One that comes late ends between the two.
states() {
	for link in ./*.down; do
		had=$(grep -ac ' plain=[0-9]*' "$link")
		[ "$had" = 1 ] || [ "$had:$(grep -ac '^task ' "$link")" = 0:0 ] || echo "$link: $had"
	done
}
# packs NAME COMMAND ...: the command renders job.task over links that keep what passes, which is packed
job >job.task
packs() {
	name=$1
	shift
	rm -f ./*.up ./*.down out.pfm
	"$@" <job.task 2>said | gather -o out.pfm 2>>said
	ok "$name: the same picture" cmp out.pfm good.pfm
	is "$name: no message" "$(grep -v 'slots never connected$' said)" ''
	ok "$name: pixels are packed" [ "$(packed up)" -gt 150 ]
	is "$name: state is packed, once for each connection that got tasks" "$(states)" ''
}
sed 's/"$1.down"/"$1.$$.down"/; s/"$1.up"/"$1.$$.up"/' link >each && chmod +x each
sed 's,/link,/each,' hosts >each.hosts
packs 'a worker for each slot' deal fan -z on -S each.hosts rtworker -
packs 'a worker for each host' deal fan -z on -1 -S each.hosts rtworker -
packs 'a tree' deal -q 4 fan -z on -S each.hosts deal fan -j 2 rtworker -
packs 'a tree without an inner policy' deal fan -z on -S each.hosts fan -j 2 rtworker -
packs 'pixels that are held back' deal fan -z on -S each.hosts rtworker -c -
# A link that delays each piece by 20 ms is slower than any coder.
cat >late <<'END'
#!/bin/sh
exec perl -e 'while (sysread STDIN, $_, 65536) { select undef, undef, undef, .02; syswrite STDOUT, $_ }'
END
printf '%s\n' '#!/bin/sh' './late | ./each "$1" "$2" | ./late' >slow
chmod +x late slow
sed 's,/link,/slow,' hosts >slow.hosts
packs 'a slow link, without -z' deal fan -S slow.hosts rtworker -
rm -f ./*.up ./*.down
deal fan -z on -j 2 rtworker - <job.task | tee local.frags | gather -o out.pfm
is 'nothing is packed on this machine' "$(cmp out.pfm good.pfm; grep -ac ' plain=' local.frags)" 0

# A binary grid is packed by words.
perl -e '
	print "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET RECTILINEAR_GRID\nDIMENSIONS 30 20 10\n";
	for ("X 30", "Y 20", "Z 10") { my ($axis, $n) = split; print "${axis}_COORDINATES $n float\n", pack("f>*", 0 .. $n - 1), "\n" }
	print "POINT_DATA 6000\nSCALARS t float 1\nLOOKUP_TABLE default\n", pack("f>*", map { 280 + 9 * sin $_ * $_ } 1 .. 6000), "\n"' >grid.vtk
printf '%s\n' 'from 60 -50 40' 'at 15 10 5' 'up 0 0 1' 'angle 35' 'resolution 96 64' 'map 275 .1 .4 .9 0' 'map 289 .9 .3 .1 .8' >spec
balance masterslave -j 2 -o good-grid.pfm grid.vtk spec
rm -f ./*.up ./*.down
balance masterslave -z on -S hosts -o out.pfm grid.vtk spec
ok 'a grid: the same picture' cmp out.pfm good-grid.pfm
touch a.down b.down
ok 'a grid: it is packed by words' grep -aq '^grid .* plain=[0-9]* words=4 sum=' a.down b.down

# ---- what is refused -----------------------------------------------------------------------------------------------
rm -f ./*.up
balance masterslave -z on -S hosts -s 192x192 -o out.pfm gears.nff
cat ./*.up >both.frags
run gather -o none.pfm both.frags
like 'a packed record in a log is damage' "$status:$err" '^1:.*packed body, expected plain ones here'
run fan -z maybe -j 1 rtworker - </dev/null
is '-z with another word' "$status:$err" '2:fan: -z maybe: expected on, off or auto'

# ---- a host without libzstd ------------------------------------------------------------------------------------------
mkdir old
cp "$root/build/libstormring.a" old.a && ar d old.a zstd.o &&
	cc -std=c11 -D_GNU_SOURCE -O -I"$root/lib" -c -o none.o "$root/lib/coder/none.c" && ar r old.a none.o 2>said
for program in fan rtworker; do
	ok "$program is built without libzstd" \
		cc -std=c11 -D_GNU_SOURCE -O -ffp-contract=off -I"$root/lib" -o old/$program "$root/bin/$program.c" old.a -lpng -lz -lm
done
printf '%s\n' "old slots=2 via=\"./link %h %c\" bin=$tmp/old" 'new via="./link %h %c"' >old.hosts
for z in on auto; do
	rm -f ./*.up ./*.down out.pfm
	deal fan -z $z -S old.hosts rtworker - <job.task 2>said | gather -o out.pfm
	ok "-z $z, a host without libzstd: the same picture" cmp out.pfm good.pfm
	is "-z $z, a host without libzstd: it gets and sends plain records" "$(cat old.up old.down 2>/dev/null | grep -ac ' plain=')" 0
	said=''
	[ $z = auto ] || said='fan: old: sends plain pixels: its worker was built without libzstd'
	is "-z $z, a host without libzstd: messages" "$(grep -v 'slots never connected$' said)" "$said"
done
run old/fan -z on -j 1 rtworker - </dev/null
is '-z on without libzstd' "$status:$err" '2:fan: -z on: built without libzstd, expected off or auto'
rm -f ./*.up ./*.down out.pfm
deal old/fan -S old.hosts rtworker - <job.task | gather -o out.pfm
is 'a fan without libzstd has plain records' "$(cmp out.pfm good.pfm; cat ./*.up ./*.down | grep -ac ' plain=')" 0
finish
