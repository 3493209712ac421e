# shellcheck shell=sh disable=SC2154  # here and temporary are set by the script that reads this
# Methods in virtual time. A method's own script runs, so that its cut and its rules stand there and nowhere else.
# balance-auto and the experiments read this, with a directory for files in $temporary.

# fits_path PROGRAM: refuses a directory that PATH cannot hold
fits_path() {
	case $temporary in *:*) ;; *) return 0 ;; esac
	say "$1: ${TMPDIR-}: has a colon, which PATH cannot hold, expected another TMPDIR"
	return 1
}
# shipped COMMAND METHOD WxH SLOTS LOG fan ARGUMENT ...: runs balance-METHOD. What it finds instead of
# deal, fan and ringctl gives its tasks to the command line COMMAND, to which simulate's METHOD is
# appended. `fan -l` prints the powers of its option -w; else those of the file table of that
# directory, which fan -l or fan -l -l has printed; else it knows none. $unit, if it is not empty,
# replaces the unit of the cut.
shipped() {
	fits_path "${0##*/}" || exit 2
	simulate=$1 script=$here/balance-$2
	shift 2
	[ -e "$temporary/bin/ringctl" ] || stand_ins "$temporary/bin" || exit 3
	programs=$here simulate=$simulate table=$temporary/table n_slots=$2 unit=${unit-} \
		PATH=$temporary/bin:$PATH "$script" "$@" </dev/null
}
stand_ins() {
	mkdir -p "$1" && cat >"$1/fan" <<-'END' && cat >"$1/partition" <<-'END' || return
		#!/bin/sh
		# Powers that were measured have a least one beside them. Without a worker, none is measured.
		powers() {
			shift
			while getopts :1j:S:t:z: option; do :; done
			case $simulate in
			*' -w '*) stated=${simulate##* -w } && printf '%s\n' "${stated%% *}" | tr , '\n' ;;
			*) if [ -e "$table" ]; then
				awk -F '\t' -v worker=$(($# >= OPTIND)) \
					'{ print (worker || NF < 5 || $5 == "-" ? $3 : "-") }' "$table"
			else seq "$n_slots" | sed 's/.*/-/'
			fi ;;
			esac | awk -v OFS='\t' '{ print NR - 1, "host", $1 }'
			exit
		}
		run='' hold=''
		case ${0##*/},${1-} in
		fan,-l) powers "$@" ;;
		fan,*) run=fan known=: ;;
		deal,*) run=deal known=:eq:t: ;;
		ringctl,*) run=ring known=:ep ;;
		esac
		# A worker with -c concentrates: it holds pixels back until deal asks for them.
		case "$run $* " in deal*' -c '*) hold=-c ;; esac
		[ "$run" = fan ] || while getopts "$known" option; do run="$run -$option ${OPTARG-}"; done
		exec $simulate $hold $run
	END
		#!/bin/sh
		words=$# at=0
		while [ $((at += 1)) -lt "$words" ]; do set -- "$@" "$1"; shift; done
		size=$1
		shift
		exec "$programs/partition" "$@" ${unit:+-u "$unit"} "$size"
	END
	chmod +x "$1/fan" "$1/partition" && ln -sf fan "$1/deal" && ln -sf fan "$1/ringctl"
}
