#!/bin/sh
# 73_srun: the time of a picture by srun, which buffers lines, beside that by srun -u, on two nodes of a Slurm cluster of
# this machine (tests/slurm), in turns. SIZE=1024x1024, medians of ROUNDS=5, from the command to the picture.
slurm=$(cd "$(dirname "$0")/.." && pwd)/slurm
why=$("$slurm" check 2>&1) || { echo "73_srun: no Slurm cluster: $why"; exit 0; }
[ -n "${TEST_SLURM-}" ] || exec "$slurm" with 2 "$0"
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
size=${SIZE:-1024x1024} rounds=${ROUNDS:-5}
spdgen gears >gears.nff || stop 'spdgen failed'
# hosts OPTION: prints a line for each node
hosts() { for n in n1 n2; do echo "$n via=\"srun -Q -N 1 -n 1 -c 1 --overlap -w %h $1 sh -c %c\""; done; }
hosts '' >lines
hosts -u >bytes
for _ in $(seq "$rounds"); do
	for way in lines bytes; do
		wall_s "salloc -Q -N 2 --exclusive balance interleaved -S $way -s $size -o $way.pfm gears.nff" >s || stop "$way failed"
		printf '%s ' "$(cat s)"
	done
	echo
done >all
cmp lines.pfm bytes.pfm || stop 'the pictures differ'
echo "srun $(median 1 <all) s, srun -u $(median 2 <all) s"
report 'srun / srun -u' "$(awk '{ print $1 / $2 }' all | median 1)" '' 2
