#!/bin/sh
# Kept state: a host that has had a scene is sent its hash in the next run. The pixels are the same,
# whatever is in the directory of the host. Hosts are commands on this machine, which count bytes.
# shellcheck disable=SC2154,SC2016  # lib.sh sets them; scripts for others
. "$(dirname "$0")/lib.sh"
# Without libzstd no link is measured.
fan -l -z on >said 2>&1 || { echo "1..0 # SKIP $(cat said)"; exit 0; }
patient
spdgen -s 2 gears >gears.nff
hash=$(sha256sum <gears.nff | cut -d ' ' -f 1)
partition 32x32 | rtworker gears.nff | gather -o good.pfm
{ pack scene gears.nff; partition 32x32; } >job.task

# via NAME COMMAND: runs COMMAND with a cache of its own; down.NAME has what it was sent
cat >via <<'END'
#!/bin/sh
name=$1
shift
tee -a "down.$name" | XDG_CACHE_HOME=$PWD/cache.$name sh -c "$1"
END
chmod +x via
for name in a b c; do mkdir cache.$name; done
echo 'a slots=2 via="./via %h %c"' >one.hosts
printf '%s via="./via %%h %%c"\n' a b c >hosts
file=stormring/state/$hash
# renders NAME COMMAND ...: the command gives the picture; `down` has what hosts were sent, and
# `kept` the number of states of which they had the bytes
export until=true # the input ends when this is true
renders() {
	name=$1
	shift
	rm -f down.* out.pfm
	run sh -c '{
			cat job.task
			wait=300
			until eval "$until" || [ $((wait -= 1)) -eq 0 ]; do sleep .1; done
		} | "$@" - 2>said | gather -o out.pfm' sh "$@"
	is "$name: the same picture" "$status $err $(cmp out.pfm good.pfm 2>&1)" '0  '
	kept=$(cat down.* 2>/dev/null | grep -ac '^scene .* kept=')
	whole=$(cat down.* 2>/dev/null | grep -a '^scene ' | grep -vc ' kept=')
}

# ---- once ---------------------------------------------------------------------------------------
renders 'first run' deal fan -1 -S one.hosts rtworker
is 'first run: the scene is sent' "$whole $kept" '1 0'
ok 'first run: it is kept' cmp "cache.a/$file" gears.nff
is 'first run: nothing else is kept' "$(find cache.a -type f)" "cache.a/$file"
is 'only the user can read it' "$(find cache.a/* -printf '%m ')" '700 700 600 '
renders 'second run' deal fan -1 -S one.hosts rtworker
is 'second run: the hash is sent' "$whole $kept" '0 1'
ok 'second run: no more than 4000 bytes' [ "$(wc -c <down.a)" -lt 4000 ]
renders 'a worker for each slot' fan -S one.hosts rtworker
is 'a worker for each slot: two hashes' "$whole $kept" '0 2'
renders 'plain links' deal fan -z off -1 -S one.hosts rtworker
is 'plain links: a link that is not measured has whole states' "$whole $kept" '1 0'
cp cache.a/$file other
renders 'on this machine' deal fan -j 2 rtworker
is 'on this machine nothing is kept' "$(find cache.a -newer other -type f)" ''

# ---- kept files are checked ---------------------------------------------------------------
printf x | dd of="cache.a/$file" bs=1 seek=5000 conv=notrunc 2>/dev/null
renders 'a damaged file' deal fan -1 -S one.hosts rtworker
like 'a damaged file: a message says so' "$(cat said)" \
	"^a: rtworker: standard input: state $(printf %.16s "$hash")\.\.\. is not kept here any more, or was damaged$"
is 'a damaged file: then the scene is sent' "$whole $kept" '1 1'
ok 'a damaged file: it is replaced' cmp "cache.a/$file" gears.nff
mkdir elsewhere
mv cache.a/stormring/state elsewhere/state
ln -s "$PWD/elsewhere/state" cache.a/stormring/state
renders 'a link' deal fan -1 -S one.hosts rtworker
is 'a link is not followed' "$whole $kept" '1 0'
rm cache.a/stormring/state
run rtworker - <<END
scene crc=1 bytes=70000 kept=../../etc/passwd

frame 0 8 8
END
like 'a name that is no hash' "$status $err" \
	'^3 rtworker: standard input: state ../../etc/passwd... is not kept here'

# ---- a tree -------------------------------------------------------------------------------------
rm -rf cache.?/*
export until='[ -e cache.a/$file ] && [ -e cache.b/$file ] && [ -e cache.c/$file ]' file
renders 'racks' fan -T 2 -S hosts rtworker
is 'racks: this machine sends the scene to each head' "$(cat down.a down.c | grep -ac '^scene ')" 2
is 'racks: the head sends it to the other host' "$(grep -ac '^scene ' down.b)" 1
is 'racks: each host keeps it' "$(ls cache.?/$file | wc -l)" 3
until='grep -aqs "^scene " down.b'
renders 'racks, again' fan -T 2 -S hosts rtworker
is 'racks, again: only hashes are sent' "$whole $kept" '0 3'
rm -rf cache.b/*
renders 'racks, a new host' fan -T 2 -S hosts rtworker
is 'racks, a new host: its head has the scene' \
	"$(grep -a '^scene ' down.b | grep -vc kept=) $(grep -ac ' kept=' down.a)" '1 1'
finish
