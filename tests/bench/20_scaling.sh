#!/bin/sh
# 20_scaling: elapsed time of master-slave with two slots against the pipeline of one worker, on a frame of more than
# 10 s CPU; median of the ratios of 3 pairs. It wants two idle cores. What cannot be divided is measured beside it.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
pairs=3 size=2048x2048 options='-a 4'

spdgen gears >gears.nff || stop 'spdgen failed'
one="partition $size | rtworker $options gears.nff | gather -o one.png"
two="balance masterslave -j 2 -s $size -W '$options' -o two.png gears.nff"
i=0
while [ $i -lt $pairs ]; do
	one_s=$(wall_s "$one") || stop "failed: $one"
	two_s=$(wall_s "$two") || stop "failed: $two"
	cmp one.png two.png || stop 'the two pictures differ'
	echo "$one_s $two_s" | awk '{ print $1, $2, $2 / $1 }' | tee -a pairs >/dev/null
	i=$((i + 1))
done
parse_s=$(cpu_s 5 'rtworker -i gears.nff')
start_s=$(cpu_s 5 'partition 1x1 | rtworker gears.nff')
sh -c "partition $size | rtworker gears.nff" >frags || stop 'rtworker failed'
read_s=$(cpu_s 3 'gather -o gathered.pfm frags')
encode_s=$(cpu_s 3 'gather -o gathered.png frags')

echo 'one worker s   two slots s   ratio'
awk '{ printf "%12.2f  %12.2f  %6.3f\n", $1, $2, $3 }' pairs
echo "one: $one"
echo "two: $two"
echo "$parse_s $start_s $read_s $encode_s" | awk '{
	printf "serial part, CPU s: parse %.3f, build %.3f, assemble %.3f (overlaps with tracing), encode %.3f\n", $1, ($2 > $1 ? $2 - $1 : 0), $3, ($4 > $3 ? $4 - $3 : 0) }'
[ "$(nproc)" -ge 2 ] || echo 'this machine has one core: the ratio means nothing here'
report 'two slots / one worker' "$(median 3 <pairs)" '' 0.53
