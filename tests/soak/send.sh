#!/bin/sh
# A minimal Debian 13 as a host, with nothing installed: static programs are sent to it once, as root and as a user
# without a home directory, and give the same pixels by every method.
. "$(dirname "$0")/../lib.sh"
# shellcheck disable=SC2154  # lib.sh sets them
needs mmdebstrap "$root/build/static/rtworker"
[ "$(id -u)" = 0 ] || { echo '1..0 # SKIP it needs root'; exit 0; }
mmdebstrap --variant=minbase trixie debian >made 2>&1 || { echo "1..0 # SKIP mmdebstrap: $(tail -n 1 made)"; exit 0; }
like 'it is Debian 13' "$(cat debian/etc/debian_version)" '^13'

# host NAME USER: within mount and process namespaces of its own
cat >enter <<'END2'
#!/bin/sh
exec setpriv --pdeathsig KILL unshare -m -p --fork --kill-child sh -c '
	mount -t proc proc "$1/debian/proc" && mount --bind /dev/null "$1/debian/dev/null" &&
	exec chroot --userspec="$2" "$1/debian" /usr/bin/env -i HOME="$3" /bin/sh -c "$4"' sh "${0%/*}" "$@"
END2
chmod +x enter
[ -e debian/dev/null ] || touch debian/dev/null
echo "root slots=2 send=auto via=\"$tmp/enter root /root %c\"" >root.hosts
echo "nobody slots=2 send=auto via=\"$tmp/enter nobody:nogroup /nonexistent %c\"" >nobody.hosts

spdgen -s 2 gears >gears.nff
size=96x96
partition $size | rtworker gears.nff | gather -o good.pfm
for user in root nobody; do
	for method in $(balance -h | sed -n 's/^methods: *//p'); do
		rm -f out.pfm
		run balance "$method" -S $user.hosts -s $size -o out.pfm gears.nff
		ok "$user, $method: the same picture" cmp out.pfm good.pfm
		printf '%s\n' "$err" >>said.$user
	done
	is "$user: each program is sent once" "$(grep -o '[a-z]* is sent' said.$user | sort | tr '\n' ,)" \
		'ringctl is sent,rtworker is sent,'
done
is 'a user without a home directory has them in /tmp' "$(find debian/tmp/stormring-65534 -name rtworker | wc -l)" 1
finish
