#!/bin/sh
# The program that hosts run before a worker whose program is sent (send=auto, stormring-hosts(5)). Arguments: the machine;
# HASH SIZE NAME for each program; --; the worker's command. Before the worker's hello it prints
#
#   stormring-send need HASH     then it reads this program, and no more, from standard input
#   stormring-send no REASON     this host cannot be used
#
# Both begin a line, whatever start-up files have printed before. fan/send.c answers.
#
# For any shell that is like the Bourne shell, and with the tools that busybox has. bootstrap.sed joins the lines by blanks,
# so each ends where a blank may follow. It has no apostrophe or backslash, and an exclamation mark only before a blank,
# because the login shell may be a csh.
# shellcheck disable=SC2166  # -a in tests: every shell here knows it
t=;
clean() { if [ "$t" ]; then rm -f "$t"; fi; };
no() { clean; trap - EXIT; echo; echo "stormring-send no $*"; exit 1; };
# If the system's own directories are missing in PATH, they are added.
m=$1 u=$(umask) c=; shift; umask 077; PATH=${PATH:+$PATH:}/usr/bin:/bin; export PATH;
w=$(uname -sm); [ "$w" = "$m" ] || no "it is $w, expected $m";
for p in chmod head id mkdir mktemp mv rm sha256sum; do
	command -v $p >/dev/null || no "it has no $p";
done;
case $XDG_CACHE_HOME in
	/*) c=$XDG_CACHE_HOME;;
	*) case $HOME in /?*) if [ -d "$HOME" ]; then c=$HOME/.cache; fi;; esac;;
esac;
d=${c:+$c/stormring}; d=${d:-/tmp/stormring-$(id -u)};
w=$(LC_ALL=C mkdir -p "$d" 2>&1) || no "$w";
# In /tmp another user may have been faster.
if [ -h "$d" -a -z "$c" ]; then no "$d: is a link"; fi;
# From here on the directory has the name that no link leads to: it may be exchanged.
w=$(cd -P "$d" && [ -O . ] && pwd -P) || no "$d: belongs to another user"; d=$w;
case $d in *:*) no "$d: expected a directory without a colon";; esac;
w=$(LC_ALL=C chmod 700 "$d" 2>&1) || no "$w";
good() { [ -f "$2" ] && case $({ sha256sum <"$2"; } 2>/dev/null) in "$1 "*) ;; *) false;; esac; };
until [ "$1" = -- ]; do
	f=$d/$1/$3;
	# The time of the file is that of its last use.
	if good "$1" "$f"; then touch "$f" 2>/dev/null; else
		if [ -e "$f" -a ! -f "$f" ]; then no "$f: is no file"; fi;
		w=$(LC_ALL=C mkdir -p "$d/$1" 2>&1) || no "$w";
		w=$(LC_ALL=C mktemp "$d/$1/new.XXXXXX" 2>&1) || no "$w";
		t=$w; trap clean EXIT; trap "exit 1" HUP INT TERM PIPE;
		echo; echo "stormring-send need $1";
		# If the link is cut, no end of input comes. Old versions of busybox have another timeout.
		w=; if timeout 9 true 2>/dev/null; then w="timeout $(($2 / 16384 + 60))"; fi;
		w=$({ LC_ALL=C $w head -c "$2" >"$t"; } 2>&1) || no "$d: $w";
		good "$1" "$t" || no "$d: $3 is damaged on arrival, or the disk is full";
		w=$(LC_ALL=C chmod 700 "$t" 2>&1 && LC_ALL=C mv -f "$t" "$f" 2>&1) || no "$w";
		trap - EXIT HUP INT TERM PIPE;
		# Parts from connections that were cut off a day ago or more, and programs not used for a month. Running programs do
		# not need their files. An empty directory goes a month later.
		find "$d/$1" -name "new.*" -mtime +0 -exec rm -f {} + 2>/dev/null;
		find "$d"/*/* -prune -type f -mtime +30 -exec rm -f {} + 2>/dev/null;
		find "$d"/* -prune -type d -mtime +30 -exec rmdir {} + 2>/dev/null;
	fi;
	w=$("$f" --version 2>&1 </dev/null) || case $? in
		126) no "$d: programs cannot be run there, as in a file system that is mounted noexec";;
		*) no "$f cannot be run: $w";;
	esac;
	PATH=$d/$1:$PATH; shift 3;
done;
shift; umask "$u"; exec "$@"
