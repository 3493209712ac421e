#!/bin/sh
# dist.sh: `make test` in what `make dist` packs, without git.
exec "$(dirname "$0")/../04_dist.t" all
