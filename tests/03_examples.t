#!/bin/sh
# The EXAMPLES of every man page, and the commands of README.md. Those of a page run in one directory, in order, up to
# the first that fails. 05_tutorial.t runs the tutorial's, and checks what comes out as well.
. "$(dirname "$0")/lib.sh"
# shellcheck source=examples.sh
. "$root/tests/examples.sh"
try() { # PAGE
	rm -rf "$tmp/work" && mkdir "$tmp/work"
	examples "$root/$1" >"$tmp/script"
	grep -qv '^#' "$tmp/script" || { echo "$1: has no example that is run (lines beginning with \"\$ \")"; return; }
	(cd "$tmp/work" && timeout 1200 sh -e "$tmp/script") >"$tmp/said" 2>&1 </dev/null ||
		{ echo "$1: an example exits $?, after saying:"; tail -n 5 "$tmp/said"; }
}
# worked NAME PAGE
worked() {
	examples "$root/$2" >"$tmp/named"
	if lacking "$tmp/named"; then
		[ "$missing" = blender ] && [ -z "${NIGHT-}" ] || skip "$1" "$missing is not there" # it is large: for nights
		return
	fi
	is "$1" "$(try "$2")" ''
}
for page in "$root"/man/*.[1-9]; do
	page=${page#"$root/"}
	[ "$page" = man/stormring-tutorial.7 ] || worked "the examples of $(basename "$page") work" "$page"
done
worked 'the commands of README.md work' README.md
finish
