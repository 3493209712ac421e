# shellcheck shell=sh disable=SC2034,SC2154  # balance, which reads this, uses and sets them
# balance reads this for -m, before the files: what is missing is said before anything is rendered.
# It uses $lines and $size of balance, and sets $backs and $front for its gather.
case $lines in
none:) ;;
coasts:) there coastlines "beside balance or on the PATH" ;;
*)
	if [ ! -f "$lines" ] || [ ! -r "$lines" ]; then
		fail "-m $lines: cannot be read, expected a file of lines, coasts: or none:"
	fi
	;;
esac
there gnuplot 'from the Debian package gnuplot-nox'
there backdrop "beside balance or on the PATH: built by make, or installed"

# draw_maps GRID ... SPEC ...: draws them while the workers render: one for each view of the same
# axes, and the caption of each picture. They are in a directory that is removed when the last
# process that has descriptor 9 ends, even by SIGKILL.
draw_maps() {
	maps=$(directory) && mkfifo "$maps/held" || exit 3
	{
		trap '' HUP INT TERM
		cat "$maps/held"
		rm -rf "$maps"
	} </dev/null >/dev/null 2>&1 4<&- 5>&- 6<&- &
	exec 9>"$maps/held"
	case $lines in
	coasts:)
		coastlines >"$maps/coasts" 4<&- 5>&- 6<&- 9>&- || exit
		lines=$maps/coasts
		;;
	none:) lines=/dev/null ;;
	esac
	backs=$(printf '%s\n' "$maps" | sed 's/%/%%/g') # a pattern
	! grep -q '^>[[:blank:]]*height[[:blank:]]' "$lines" || front=$backs/front-%d.png
	backdrop -o "$backs/map-%d.png" -c "$backs/caption-%d.png" ${front:+-f "$front"} -m "$lines" \
		${size:+-s "$size"} -- "$@" 4<&- 5>&- 9>&- || exit
}
