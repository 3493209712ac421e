#!/bin/sh
# 87_volumes: the time of vcworker's pictures of fields that no test knows, all preparation included: beside VTK's
# fixed-point ray caster, by turns, and with light, attenuation and surfaces beside the plain map. Medians of ROUNDS.
# GRIDS='128x128x64 256x256x256' tests/bench/87_volumes.sh. Without VTK (python3-vtk9), its part is left out.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
rounds=${ROUNDS:-5} grids=${GRIDS:-128x128x64 256x256x256} vtk=/usr/bin/python3
built volume_bench
# shellcheck disable=SC2154  # lib.sh sets pin
cast() { $pin ./volume_bench cast "$1" "$2" "${3:-adaptive}"; }
# ratio NAME TARGET: of the two columns of `times`
ratio() { report "$1" "$(awk '{ print $1 / $2 }' times | median 1)" '' "$2"; }
# beside GRID LOOK OTHER TARGET: GRID with LOOK, as a part of the time with OTHER
beside() {
	for _ in $(seq "$rounds"); do echo "$(cast "$1" "$2") $(cast "$1" "$3")"; done >"$tmp/times"
	ratio "$1, $2 / $3" "$4"
}
# peer FIELD SIZE LOOK DISTANCE TARGET: the time as a part of VTK's, whose samples are DISTANCE apart
peer() {
	nodes=$(./volume_bench field "$1:$2" field) && ./volume_bench scene "$1:$2" "$3" >scene || stop "no field $1:$2"
	for _ in $(seq "$rounds"); do
		other=$($pin $vtk "$root/tests/bench/volume_vtk.py" field "$nodes" scene picture "$4") || stop 'VTK failed'
		echo "$(cast "$1:$2" "$3") ${other#* }"
	done >"$tmp/times"
	ratio "$1:$2, $3 / VTK" "$5"
}
for size in $grids; do
	for field in smooth noisy; do
		for extra in +light +fog +iso +light+fog+iso; do beside $field:"$size" smooth$extra smooth 3; done
	done
	$vtk -c 'import vtkmodules' 2>/dev/null || continue
	peer smooth "$size" smooth 1 .5
	peer smooth "$size" dense 1 .5
	peer sparse "$size" smooth 1 .5
	peer smooth "$size" .5 .05 .2
done
