# The page of a chart: panels, legend, title and remarks, for gnuplot. chart(1) runs this with points.awk or bars.awk on the
# output of `tsvstat -p`. Each of these draws one kind of panel, and has these functions:
#   check()           refuses options that do not apply
#   take(p)           takes the row in $1 ... of panel p
#   prepare()         after the last row: changes plot_w, plot_h and per_row, sets the n_keys names in key_name
#   samples()         returns the remark on the number of samples
#   ranges_differ()   whether each panel has numbers at its axes
#   axes()            prints the axes that panels share
#   draw_panel(p)     prints panel p
#   key_look(i, x, y) prints the data of entry i of the legend, at x, y; returns its part of a plot command
# The caller sets type, log_axes, labels and pareto, and CHART_TITLE, CHART_X, CHART_Y and CHART_NAME in the environment.
function bad(what) {
	what = sprintf("%s:%d: %s", ENVIRON["CHART_NAME"], NR, what)
	gsub(/[[:cntrl:]]|\302[\200-\237]/, "?", what)
	print "chart: " what >"/dev/stderr"
	failed = 1
	exit 2
}
# s with blanks for control characters, and U+FFFD for bytes that are no UTF-8, such as half of a character: XML has neither.
function shown(s,    out) {
	gsub(/[[:cntrl:]]|\302[\200-\237]/, " ", s)
	gsub(/\357\277[\276\277]/, "\377", s)
	while (s != "")
		if (match(s, /^([ -~]|[\302-\337][\200-\277]|\340[\240-\277][\200-\277]|[\341-\354\356\357][\200-\277][\200-\277]|\355[\200-\237][\200-\277]|\360[\220-\277][\200-\277][\200-\277]|[\361-\363][\200-\277][\200-\277][\200-\277]|\364[\200-\217][\200-\277][\200-\277])+/)) {
			out = out substr(s, 1, RLENGTH)
			s = substr(s, RLENGTH + 1)
		} else { out = out "\357\277\275"; s = substr(s, 2) }
	return out
}
# Text between single quotes is left alone by gnuplot: no commands, no escapes. A quote itself goes between double ones.
function quoted(s) { s = shown(s); gsub(/\047/, "\047 . \"\047\" . \047", s); return "(\047" s "\047)" }
function max(a, b) { return a > b ? a : b }
function min(a, b) { return a < b ? a : b }
function log10(v) { return log(v) / log(10) }
function ceil(v) { return v > int(v) ? int(v) + 1 : int(v) }
function floor(v) { return -ceil(-v) }

# --- reading ---
BEGIN {
	FS = "\t"
	split("real replayed simulated", kind_order, " ")
}
/^#/ {
	if (match($0, /^# *[a-z]+: */)) {
		key = substr($0, 1, RLENGTH)
		gsub(/[^a-z]/, "", key)
		if (!(key in about)) about[key] = substr($0, RLENGTH + 1)
	}
	next
}
!headed { headed = 1; check(); next }
{
	kinds[$2] = 1
	if (!($1 in panel_of)) { panel_of[$1] = ++n_panels; panel_name[n_panels] = $1 }
	take(panel_of[$1])
}

# --- the page, in pixels ---
function write(what, space, x, y, align, size, colour) {
	printf "set label %s at %s %.9g,%.9g %s font %s textcolor rgb 0x%s front\n", quoted(what), space,
		x, y, align, quoted("," size), colour
}
function block(name, text) { printf "$%s << END_OF_DATA\n%sEND_OF_DATA\n", name, text }
function window(left, bottom, w, h) { # in pixels from the lower left corner
	printf "set lmargin at screen %.6f; set rmargin at screen %.6f\n", left / width, (left + w) / width
	printf "set bmargin at screen %.6f; set tmargin at screen %.6f\n", bottom / height, (bottom + h) / height
}
# The legend is drawn as a picture of its own below the panels, so that it hides no data.
function legend(    i, x, y, text) {
	print "unset label; unset title; unset xlabel; unset ylabel"
	print "unset border; unset tics; unset logscale; unset grid"
	window(0, foot, width, legend_h)
	printf "set xrange [0:%d]; set yrange [0:%d]\n", width, legend_h
	for (i = 1; i <= n_keys; i++) {
		x = (width - legend_w * legend_columns) / 2 + (i - 1) % legend_columns * legend_w
		y = legend_h - 11 - int((i - 1) / legend_columns) * 19
		write(key_name[i], "first", x + 46, y, "left", 12, "000000")
		text = text key_look(i, x, y)
	}
	print "plot " substr(text, 3)
}
function with_unit(name, unit) { return unit == "1" ? name : name " (" unit ")" }
function named(option, key, other) {
	return ENVIRON[option] != "" ? ENVIRON[option] : key in about ? about[key] : other
}
function layout(    i) {
	plot_w = n_panels > 1 ? 380 : 560
	plot_h = n_panels > 1 ? 340 : 380
	per_row = n_panels == 4 ? 2 : min(3, n_panels)
	left = 78
	gap_x = ranges_differ() ? 60 : 22
	gap_y = 90
	top = n_panels > 1 ? 62 : 42
	for (i in kinds) n_kinds++
	prepare()
	width = left + per_row * plot_w + (per_row - 1) * gap_x + 20
	collect_remarks()
	foot = 14 * n_remarks + 10
	legend_w = longest_key * 7.1 + 62
	legend_columns = max(1, min(n_keys, int((width - 20) / legend_w)))
	legend_columns = ceil(n_keys / ceil(n_keys / legend_columns)) # no row much shorter than the others
	legend_h = ceil(n_keys / legend_columns) * 19 + 6
	height = top + plot_h + (ceil(n_panels / per_row) - 1) * (plot_h + gap_y) + 52 + legend_h + foot
}
# The window of panel p, and its title if there are several.
function open_panel(p,    row, col) {
	row = int((p - 1) / per_row)
	col = (p - 1) % per_row
	window(left + col * (plot_w + gap_x), height - top - plot_h - row * (plot_h + gap_y), plot_w, plot_h)
	if (n_panels > 1) print "set title " quoted(panel_name[p]) " font \",13\" offset 0,-0.6"
}
function headline(    i, kind, title) {
	for (i = 1; i <= 3; i++) if (kind_order[i] in kinds) kind = kind (kind ? " and " : "") kind_order[i]
	title = named("CHART_TITLE", "title", n_panels > 1 ? "" : panel_name[1])
	title = title (title ? " " : "") "(" kind ")"
	write(title, "screen", 0.5, 1 - 18 / height, "center", 15, "000000")
}
# The lines at the foot, from the top down: what to know, and what made the numbers. A remark has up to three.
function remark(text,    most, lines, k) {
	most = int(width / 5.6)
	for (lines = 1; lines < 3 && length(text) > most; lines++) {
		for (k = most; k > 1 && substr(text, k, 1) != " "; k--) { }
		if (k == 1) break
		remarks[++n_remarks] = substr(text, 1, k)
		text = substr(text, k + 1)
	}
	if (text != "") remarks[++n_remarks] = length(text) > most ? substr(text, 1, most - 3) "..." : text
}
function collect_remarks(    recipe, key, keys, i) {
	remark(about["note"])
	if ("reference" in about) remark("reference: " about["reference"])
	if ("others" in about) remark("others " about["others"])
	remark(samples())
	split("command machine commit seed", keys, " ")
	for (i = 1; (key = keys[i]); i++) {
		if (!(key in about)) continue
		recipe = recipe (recipe ? "; " : "") (key == "command" ? "" : key " ") about[key]
	}
	remark(recipe)
}
function footer(    i) {
	for (i = 1; i <= n_remarks; i++)
		write(remarks[i], "screen", 14 / width, (foot - 14 * i + 3) / height, "left", 10, "606060")
}
function terminal() {
	if (type == "svg") printf "set terminal svg size %d,%d", width, height
	else printf "set terminal pngcairo size %d,%d fontscale 1.15 linewidth 1.5 pointscale 1.5",
		width * 1.5, height * 1.5
	print " noenhanced font \"sans-serif,12\" background rgb \"#ffffff\""
}
END {
	if (failed) exit 2
	layout()
	x_title = with_unit(named("CHART_X", "x", "x"), x_unit)
	y_title = with_unit(named("CHART_Y", "y", "y"), y_unit)
	terminal()
	print "set output output_name; set multiplot; unset key; set tics nomirror scale 0.6"
	print "set border lc rgb 0x404040 lw 0.8; set grid lc rgb 0xe4e4e4 lt 1 lw 0.6 dt solid"
	axes()
	for (p = 1; p <= n_panels; p++) draw_panel(p)
	legend()
	print "unset label"
	headline()
	footer()
	window(0, 0, width, height)
	print "set xrange [0:1]; set yrange [0:1]; plot NaN; unset multiplot"
}
