# For tests that run the commands of man pages. Read it after lib.sh.
# shellcheck shell=sh disable=SC2154

# examples FILE: in literal displays of EXAMPLES (in README: in code blocks), the lines that begin with "$ ", with the
# here-documents and continuation lines that belong to them: a script. Its comments mark the other parts of the page: "#step TITLE"
# for a subsection, "#run" before a command, "#shows LINE" for another line of a display, "#file NAME" for a .Pa, "#end" for
# the end of a display.
examples() {
	awk -v mark="'" '
	FILENAME ~ /\.md$/ && /^```/ { shown = !shown; if (!shown) print "#end"; next }
	/^\.Sh / { section = $0 }
	section == ".Sh EXAMPLES" && /^\.Ss / { print "#step " substr($0, 5) }
	section == ".Sh EXAMPLES" && /^\.Pa / { print "#file " $2 }
	/^\.Bd -literal/ && section == ".Sh EXAMPLES" { shown = 1; next }
	/^\.Ed/ { if (shown) print "#end"; shown = 0 }
	!shown { next }
	{ gsub(/\\e/, "\\"); gsub(/\\\(aq/, mark); gsub(/\\&/, ""); gsub(/\\-/, "-") }
	here != "" { print; if ($0 == here) here = ""; next }
	/^\$ / || more {
		if (sub(/^\$ /, "")) print "#run"
		print; more = /\\$/
		if (match($0, /<<-?[^ ;|&)]+/)) { here = substr($0, RSTART + 2, RLENGTH - 2); gsub("[-\"" mark "]", "", here) }
		next
	}
	{ print "#shows " $0 }' "$1"
}

# lacking FILE: its commands need $missing, which is not there
lacking() {
	grep -v '^#' "$1" >"$tmp/.named"
	while read -r lacking_command lacking_need; do
		! grep -qw "$lacking_command" "$tmp/.named" || there "$lacking_need" || return 0
	done <<-END
		chart gnuplot
		chart tsvstat
		protocol tsvstat
		tsvstat tsvstat
		gnuplot gnuplot
		none: gnuplot
		coasts: gnuplot
		coasts: /usr/share/gmt-gshhg
		backdrop gnuplot
		povray povray
		blendworker blender
		gs gs
		coastlines /usr/share/gmt-gshhg
		nc2vtk nc2vtk
		grib2vtk grib2vtk
		vol2vtk vol2vtk
		mesh2nff mesh2nff
		glmark2 /usr/share/glmark2/models
		ncdump ncdump
		coastlines ncdump
		ncarg /usr/share/ncarg/data
		ferret-vis /usr/share/ferret-vis/data
		jq jq
		proj proj
		ffmpeg ffmpeg
	END
	return 1
}
