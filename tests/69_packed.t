#!/bin/sh
# Slow links: records of slots on other machines are packed, and the pixels, the logs and the events are as without.
# The other machines are commands on this one, which count the bytes that pass.
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
finish
