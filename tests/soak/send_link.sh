#!/bin/sh
# Programs that are sent over a slow link: that takes longer than a host may be silent otherwise. If the cable is out
# meanwhile, nothing remains on the host after the time that such a link takes, and a minute.
want_hosts=1
. "$(dirname "$0")/../hosts.sh"
# shellcheck disable=SC2154  # hosts.sh sets them
needs "$root/build/static/rtworker"
sed 's/ bin=.*/ send=auto/' "$TEST_HOSTS/hosts" >send.hosts
spdgen -s 2 tetra >tetra.nff
partition 32x32 | rtworker tetra.nff | gather -o good.pfm
{ pack scene tetra.nff; partition 32x32; } >job.task
# there: prints what is on the host
there_is() { hosts run host1 find /root/.cache -type f; }

hosts link host1 400kbit
timeout 30 fan -S send.hosts rtworker - <job.task >frags 2>said &
await 60 grep -q 'is sent' said
await 10 sh -c "[ \"\$('$tests/hosts' run host1 find /root/.cache -name 'new.*' -size +200k | wc -l)\" = 1 ]"
hosts link host1 down
wait
is 'a cut in the middle: the host has a part' "$(there_is | sed 's,.*/,,; s,new[.].*,new,')" new
start=$(now_ms)
gone() { [ -z "$(there_is)" ]; }
ok "after a while the part is gone" await 300 gone
diag "after $((($(now_ms) - start) / 1000)) s; expected at most $(($(wc -c <"$root/build/static/rtworker") / 16384 + 60)) s"
is 'no process remains but sshd' "$(for p in sh dash head timeout rtworker; do hosts pids host1 $p; done)" ''

hosts link host1 up
hosts link host1 400kbit
start=$(now_ms)
deal fan -S send.hosts rtworker - <job.task 2>said | gather -o out.pfm
diag "a run that sends the worker at 400 kbit/s: $((($(now_ms) - start) / 1000)) s"
ok 'at 400 kbit/s: the same picture' cmp out.pfm good.pfm
is 'at 400 kbit/s: the worker is sent once, and no connection fails' "$(sed 's/ is sent.*/ is sent/' said)" 'fan: host1: rtworker is sent'
hosts link host1 up
finish
