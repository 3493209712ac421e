#!/bin/sh
# povworker on three hosts, which have POV-Ray and not the scene: the same picture as POV-Ray's here, also when the worker of
# a host is killed.
want_hosts=3
. "$(dirname "$0")/hosts.sh"
# shellcheck disable=SC2154  # lib.sh sets them
needs povray
run pack files "$0"
case $err in *'without libarchive'*) echo "1..0 # SKIP pack was built without libarchive"; exit 0 ;; esac
echo '#declare paint = pigment { rgb <1, .5, .2> };' >paint.inc
cat >ball.pov <<'END'
#version 3.7;
#include "paint.inc"
global_settings { assumed_gamma 1 }
camera { location -4 * z look_at 0 right x * image_width / image_height }
light_source { <3, 5, -5> rgb 1 }
sphere { 0, 1 pigment { paint } finish { phong 1 } }
END
pov_ray +Iball.pov +W48 +H36 -A +FN -D +Oalone.png >said 2>&1 || diag "$(tail -n 3 said)"
# POV-Ray waits on the hosts until one of them was hit.
for h in host1 host2 host3; do
	put $h /home/render/bin/povray <<'END'
#!/bin/sh
until [ -e /home/render/go ]; do sleep .1; done
exec /usr/bin/povray "$@"
END
done
balance adaptive -S "$TEST_HOSTS/hosts" -s 48x36 -r job.log -o got.png ball.pov 2>said &
busy() { [ -n "$("$root/tests/hosts" pids host2 povray)" ]; }
ok 'a host is at work' await 30 busy
for p in $("$root/tests/hosts" pids host2 cropworker); do kill -9 "$p" && break; done
for h in host1 host2 host3; do hosts run $h touch /home/render/go; done
wait $!
is 'a worker is killed: exit 0' $? 0
is 'the same picture' "$(imgcmp got.png alone.png | grep differing)" 'differing	0'
gone() { ! busy; }
ok 'no renderer remains on the host' await 10 gone
finish
