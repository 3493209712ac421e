#!/bin/sh
# damage.sh [LOGS [STREAMS [SEED]]]: one seeded fault in each of LOGS logs and of STREAMS streams of live runs. The
# picture is the same, or the status is not 0 and a message gives the reason.
. "$(dirname "$0")/../lib.sh"
logs=${1:-$(soaked 10000)} streams=${2:-$(soaked 10000)} seed=${3:-${FIRST:-$(date +%s)}}
diag "seed $seed"
ok "$logs logs from seed $seed on" env FAULTS="$logs" FIRST="$seed" "$root/build/unit/test_faults"
# Two at a time: they mostly wait.
half=$((streams / 2))
FAULTS=$half FIRST=$seed "$root/tests/57_damage.t" >one &
FAULTS=$half FIRST=$((seed + half)) "$root/tests/57_damage.t" >two
status=$?
wait $! || status=$?
is "$streams streams from seed $seed on" $status 0
diag "$(cat one two)"
finish
