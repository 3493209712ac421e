#!/bin/sh
# 64 slots on eight hosts by ssh: the picture is complete and the same, and no slot is lost. The same with a reader that
# pauses for 5 s, and as a tree with one connection per host. Memory and descriptors of the stages on this machine are
# bounded.
want_hosts=8
. "$(dirname "$0")/../hosts.sh"
# shellcheck disable=SC2154  # hosts.sh sets it
. "$tests/peaks.sh"
# bounded NAME PROGRAM kib|open LIMIT
bounded() { ok "$1: $2 has at most $4 $3 ($(most "$2" "$3"))" [ "$(most "$2" "$3")" -le "$4" ]; }
# load NAME "OPTIONS SIZE" READER COMMAND
load() {
	partition "${2##* }" | rtworker tetra.nff | gather -o good.pfm
	start=$(now_ms)
	measured "{ pack scene tetra.nff; partition $2; } | $4 2>said | { $3; gather -o out.pfm; }"
	# shellcheck disable=SC2154  # peaks.sh sets it
	# A loaded machine connects some slots too late for their work.
	is "$1: exit 0, and no other word" "$status$(grep -v 'slots never connected$' said)" 0
	ok "$1: the same picture, after $(($(now_ms) - start)) ms" cmp out.pfm good.pfm
	bounded "$1" fan kib 32768
	# 8 connections to each host are made at a time, which have a standard error as well.
	bounded "$1" fan open $((3 * 64 + 16))
	bounded "$1" deal kib 32768
	bounded "$1" deal open 16
}


spdgen -s 2 tetra >tetra.nff
# shellcheck disable=SC2154
sed 's/slots=[0-9]*/slots=8/' "$TEST_HOSTS/hosts" >many.hosts
is '64 slots' "$(fan -l -S many.hosts | wc -l)" 64
for h in 1 2 3 4 5 6 7 8; do hosts run host$h sh -c 'ln -s /home/render/bin/* /usr/local/bin'; done
# With shares in advance the picture is complete only if every slot has done its share.
load '64 slots, dealt in advance' '-n 64 512x512' true 'fan -S many.hosts rtworker -'
load '64 slots' 2048x2048 true 'deal fan -S many.hosts rtworker -'
load '64 slots, a reader that pauses for 5 s' 1024x1024 'sleep 5' 'deal fan -S many.hosts rtworker -'
load 'a tree of 64 slots' 512x512 true "deal -q 16 fan -S $TEST_HOSTS/hosts deal fan -j 8 rtworker -"
finish
