#!/bin/sh
# come.sh [RUNS [SEED]]: hosts join, leave, die and are cut off in RUNS seeded runs, six at a time. Each picture is whole and
# the same, and no process remains.
. "$(dirname "$0")/../lib.sh"
runs=${1:-$(soaked 60)} seed=${2:-${FIRST:-$(date +%s)}}
diag "seed $seed"
status=0
RUNS=$runs FIRST=$seed "$root/tests/69_chaos.t" >said || status=$?
is "$runs runs from seed $seed on" $status 0
diag "$(cat said)"
finish
