#!/bin/sh
# 29_auto: the CPU time in which balance auto decides, with all processes that it starts, and what it says. Slots of powers
# 1/3 to 3, near and far. A table replaces those of fan -l -l, so that no workers are started there.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"

built cpu
mkdir bin && ln -s "$root"/bin/* bin/ && rm bin/fan bin/balance-auto && cp "$root/bin/balance-auto" bin/ || exit 3
cat >bin/fan <<'END'
#!/bin/sh
[ "$1 $2" != '-l -l' ] || exec cat table
exec "$FAN" "$@"
END
chmod +x bin/fan || exit 3
export FAN="$root/bin/fan"
spdgen -s 2 gears >gears.nff && pack scene gears.nff >state || exit 3
# decides SLOTS MS SAMPLES: samples of a pixel, by which a picture is slow
decides() {
	seq "$1" | awk -v OFS='\t' -v trip="$2" '{ p = 10 ^ (($1 * .618) % 1) / 3; print NR - 1, "host" NR, p, 2 * trip, p }' >table
	# shellcheck disable=SC2154  # lib.sh sets pin
	s=$($pin ./cpu "bin/balance-auto 512x512 $1 /dev/null fan -j $1 rtworker -a $3 <state 2>said >chosen") || { cat said; exit 3; }
	report "$1 slots at $2 ms, $3 samples: CPU" "$s" ' s' $(($1 > 64 ? 3 : 1))
	cat said
}
for ms in .5 85; do for n in 14 37 64 300 1000; do decides $n $ms 16; done; done
decides 14 .5 1024
