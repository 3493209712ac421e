#!/bin/sh
# A grid four times as large as the memory of each worker, on three hosts: the whole grid fails, bricks give its picture,
# and each brick goes over the network once.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; $ of the shells on the hosts
want_hosts=3
. "$(dirname "$0")/hosts.sh"

# 96 MiB of float, which are 24 MiB in the file: 192 x 256 x 512 nodes of one byte each
nx=192 ny=256 nz=512 limit_kib=24576
{
	printf '# vtk DataFile Version 3.0\nwaves\nBINARY\nDATASET RECTILINEAR_GRID\nDIMENSIONS %d %d %d\n' $nx $ny $nz
	for axis in X:$nx Y:$ny Z:$nz; do
		printf '%s_COORDINATES %s short\n' "${axis%:*}" "${axis#*:}"
		perl -e 'print pack("n*", 0 .. $ARGV[0] - 1), "\n"' "${axis#*:}"
	done
	printf 'POINT_DATA %d\nSCALARS v unsigned_char 1\nLOOKUP_TABLE default\n' $((nx * ny * nz))
	perl -e '
		my ($nx, $ny, $nz) = @ARGV;
		my @row = map { my $p = $_; pack "C*", map { 100 + 60 * sin(($_ + $p) / 20) } 0 .. $nx - 1 } 0 .. 125;
		for my $k (0 .. $nz - 1) { print join "", map { $row[($_ + 2 * $k) % 126] } 0 .. $ny - 1 }' $nx $ny $nz
} >large.vtk
printf '%s\n' 'from -300 -500 700' 'at 96 128 256' 'up 0 0 1' 'angle 45' 'resolution 60 48' 'map 120 1 .2 0 .004' \
	'map 160 1 1 0 .02' 'iso 80 .2 .4 1 .3' 'light 900 -900 900' 'attenuation .0005' >large.spec

for host in host1 host2 host3; do
	hosts run $host mv /home/render/bin/vcworker /home/render/bin/vcworker.unlimited
	printf '#!/bin/sh\nulimit -v %d && exec "$0.unlimited" "$@"\n' $limit_kib | put $host /home/render/bin/vcworker
done
# sent: prints the bytes that went to the hosts
sent() { awk '$1 == "hub:" { print $10 }' /proc/net/dev; }

run timeout 600 balance adaptive -S "$TEST_HOSTS/hosts" -o no.pam large.vtk large.spec
is 'no worker has the memory for the whole grid' "$([ "$status" -ne 0 ] && [ ! -e no.pam ] && echo refused)" refused
like 'they say so' "$err" '^host[123]: vcworker.unlimited: frame 0: grid: out of memory: needs about'
ok 'cut' gridcut -m 4 -o brick-%02d.vtk large.vtk
before=$(sent)
run balance bricks -z off -S "$TEST_HOSTS/hosts" -k 16 -o bricks.pam brick-*.vtk large.spec
is 'in bricks: exit 0' "$status" 0
[ "$status" -eq 0 ] || diag "$err"
bytes=$(($(sent) - before)) floats=$(cat brick-*.vtk | wc -c)
diag "$(ls brick-*.vtk | wc -l) bricks of $floats bytes; $bytes bytes sent"
ok 'each brick goes over the network once' [ "$((bytes > floats && bytes < floats * 5 / 4))" = 1 ]
balance adaptive -j 1 -k 16 -o whole.pam large.vtk large.spec
run imgcmp -t .0001 whole.pam bricks.pam
like 'the picture is that of the whole grid' "$status $out" '^0 '
diag "$(echo "$out" | grep -E 'rmse|worst')"
finish
