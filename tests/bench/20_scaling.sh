#!/bin/sh
# 20_scaling: elapsed time of master-slave with two slots against the pipeline of one worker, on a frame of more than 10
# s CPU; median of the ratios of 3 pairs, for a frame with many samples and for one with many pixels (105 MB of
# fragments). It needs two idle cores. Two things bound the ratio from below, and are measured beside it: the serial
# part, and the loss of the machine when both cores work (two hardware threads of one core, or other load), shown by two
# independent pipelines at once.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
pairs=3

spdgen gears >gears.nff || stop 'spdgen failed'
# measure SIZE WORKER-OPTIONS
measure() {
	size=$1 options=$2 i=0
	one="partition $size | rtworker $options gears.nff | gather -o one.png"
	two="balance masterslave -j 2 -s $size -W '$options' -o two.png gears.nff"
	both="{ $one; } & partition $size | rtworker $options gears.nff | gather -o other.png; wait"
	rm -f pairs
	while [ $i -lt $pairs ]; do
		one_s=$(wall_s "$one") || stop "failed: $one"
		two_s=$(wall_s "$two") || stop "failed: $two"
		both_s=$(wall_s "$both") || stop "failed: $both"
		cmp one.png two.png || stop 'the two pictures differ'
		echo "$one_s $two_s $both_s" | awk '{ print $1, $2, $2 / $1, $3, $3 / 2 / $1 }' >>pairs
		i=$((i + 1))
	done
	work_s=$(cpu_s 1 "$one")
	parse_s=$(cpu_s 20 'rtworker -i gears.nff')
	start_s=$(cpu_s 20 'partition 1x1 | rtworker gears.nff')
	sh -c "partition $size | rtworker gears.nff" >frags || stop 'rtworker failed'
	read_s=$(cpu_s 3 'gather -m frags')
	gather_s=$(cpu_s 3 'gather -o gathered.png frags')

	echo 'one worker s  two slots s   ratio   two at once s  half of it / one'
	awk '{ printf "%12.2f %12.2f  %6.3f %15.2f %17.3f\n", $1, $2, $3, $4, $5 }' pairs
	echo "one: $one"
	echo "two: $two"
	echo "$work_s $parse_s $start_s $read_s $gather_s" | awk '{
		printf "CPU s: %.2f in all; serial: parse %.3f, build %.3f, encode %.3f; besides, gather reads for %.3f\n",
			$1, $2, ($3 > $2 ? $3 - $2 : 0), ($5 > $4 ? $5 - $4 : 0), $4 }'
	echo "$("$root/tests/processors") cores: at best $(median 5 <pairs) of one worker's time is left for two on this machine"
	report "$size: two slots / one worker" "$(median 3 <pairs)" '' 0.53
}
measure 1024x1024 '-a 25'
measure 2560x2560 '-a 4'
