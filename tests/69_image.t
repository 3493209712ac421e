#!/bin/sh
# The image of the static programs: its form. Podman loads and runs it.
. "$(dirname "$0")/lib.sh"
. "$root/tests/marked.sh"
static=${BIN%/bin}/static
# shellcheck disable=SC2154  # lib.sh sets root
[ "$BIN" != "$root/bin" ] || static=$root/build/static
needs "$static/rtworker" jq podman unshare
[ "$(id -u)" -eq 0 ] || { echo "1..0 # SKIP only root can run podman in this way"; exit 0; }
patient
ok 'it is packed' "$root/tests/image" image.tar 1.2 "$static"/*
ok 'it is packed again' "$root/tests/image" again.tar 1.2 "$static"/*
ok 'the same programs make the same image' cmp image.tar again.tar
ok 'it has less than 10 MB' [ "$(wc -c <image.tar)" -lt 10000000 ]

# Each part is named by its sum, and described by its size.
mkdir parts root && tar -x -f image.tar -C parts || exit 3
sums() { (cd parts/blobs/sha256 && sha256sum -- *) | awk '$1 != $2'; }
is 'every part has the name of its sum' "$(sums)" ''
# described FILE PATH: what is described there, if its size is right
described() {
	size=$(jq -r "$2.size" "$1") digest=$(jq -r "$2.digest" "$1")
	part=parts/blobs/sha256/${digest#sha256:}
	is "$2 has the size of its part" "$size" "$(wc -c <"$part")"
}
described parts/index.json '.manifests[0]'
manifest=$part
described "$manifest" .config
config=$part
described "$manifest" '.layers[0]'
is 'the configuration names the layer' "$(jq -r '.rootfs.diff_ids[0]' "$config")" "$digest"
tar -x -f "$part" -C root || exit 3
is 'the layer has the programs' "$(cd root && find . -type f | sort | tr '\n' ' ')" \
	"$(cd "$static" && printf './usr/bin/%s\n' * | sort | tr '\n' ' ')"
ok 'they are the same' diff -r "$static" root/usr/bin
run "$root/tests/image" no/such 1.2 "$static"/*
is 'where it cannot be written: exit 3' "$status" 3

# ---- podman ----------------------------------------------------------------------------------------
# Its files are here, it sees no control groups, and it sets the limits that this process has: test
# machines forbid more.
real=$(command -v podman)
mkdir bin && cat >bin/podman <<END2
#!/bin/sh
command=\$1
shift
[ "\$command" != run ] || set -- --network none --cgroups disabled \\
	--ulimit nofile=1024:1024 --ulimit nproc=4096:4096 "\$@"
exec unshare -m sh -c 'mount -t tmpfs none /sys/fs/cgroup; exec "\$@"' sh \\
	"$real" --root "$tmp/pods" --runroot "$tmp/pods.run" --storage-driver vfs \\
	--cgroup-manager cgroupfs --events-backend file "\$command" "\$@"
END2
chmod +x bin/podman
PATH=$tmp/bin:$PATH
page=$root/man/stormring-engines.7
run podman load -i image.tar
is 'podman loads it' "$status" 0
[ "$status" = 0 ] || { diag "$err"; finish; }
run podman run --rm stormring rtworker --version
is 'podman runs it' "$out" "$("$static/rtworker" --version)"
[ "$status" = 0 ] || { diag "$err"; finish; }

spdgen -s 2 gears >gears.nff
partition 96x80 | rtworker gears.nff | gather -o good.pfm
sed -n "s/\\\\(aq/'/g; s/\\\\e/\\\\/g; s/^box slots=8/box slots=2/p" "$page" >hosts
is 'the page has one line for containers' "$(wc -l <hosts)" 1
for words in 'interleaved -1' adaptive; do
	# shellcheck disable=SC2086  # words
	ok "$words in a container: exit 0" balance $words -S hosts -s 96x80 -o out.pfm gears.nff
	ok "$words in a container: the same picture" cmp out.pfm good.pfm
done
# podman removes a container when its command has ended.
idle() { [ -z "$(podman ps -aq)" ] && ! pgrep -f "$tmp/pods" >/dev/null; }
ok 'no container is left' await 30 idle
finish
