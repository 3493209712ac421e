# Panels of points: lines through medians or means with what they vary by, told apart by colour, by shape and by dash
# (methods.awk), so that a chart reads without colour too. See page.awk.
function check() { }
# --- reading: the columns of `tsvstat -p` ---
function take(p,    line, setting, i, l, q) {
	line = $3
	if (i = index($3, "@")) { line = substr($3, 1, i - 1); setting = substr($3, i + 1) }
	if (!((line, $2) in line_of)) {
		line_of[line, $2] = ++n_lines
		line_name[n_lines] = line
		line_kind[n_lines] = $2
	}
	l = line_of[line, $2]
	q = ++n_points
	point_panel[q] = p
	point_line[q] = l
	point_name[q] = setting
	x_mid[q] = $4 + 0; x_low[q] = $5 + 0; x_high[q] = $6 + 0; x_unit = $7
	y_mid[q] = $8 + 0; y_low[q] = $9 + 0; y_high[q] = $10 + 0; y_unit = $11
	n_samples[q] = $12 + 0
	y_least[q] = $13 + 0; y_most[q] = $14 + 0
	best[q] = $15
	# A line runs through its settings as they come, and otherwise from the left to the right.
	i = ++n_order[p, l]
	for (; setting == "" && i > 1 && x_mid[order[p, l, i - 1]] > x_mid[q]; i--) order[p, l, i] = order[p, l, i - 1]
	order[p, l, i] = q
}
# The axis reaches no further than samples do: what is not known of a mean is no reason to show the others small.
function prepare(    q, l) {
	if (log_axes == "" && about["log"] ~ /^(x|y|xy)$/) log_axes = about["log"]
	if (about["front"] == "marked") pareto = 1
	for (q = 1; q <= n_points; q++) {
		if (log_axes ~ /y/ && y_low[q] <= 0) y_low[q] = y_least[q]
		reach_low[q] = max(y_least[q], y_low[q])
		reach_high[q] = min(y_most[q], y_high[q])
		most = max(most, n_samples[q])
		least = q == 1 ? n_samples[q] : min(least, n_samples[q])
		if (x_low[q] < x_high[q] || y_low[q] < y_high[q]) varies[point_panel[q], point_line[q]] = 1
	}
	if (about["limit"] ~ /^[-+.0-9]/) limit = about["limit"] + 0
	if (limit != "" && log_axes ~ /y/ && limit <= 0) limit = ""
	take_looks()
	for (l = 1; l <= n_lines; l++) {
		key_name[l] = line_name[l] (n_kinds > 1 ? " (" line_kind[l] ")" : "")
		longest_key = max(longest_key, length(key_name[l]))
	}
	n_keys = n_lines
	if (pareto) add_key("Pareto front", 100)
	if (limit != "") {
		sub(/^[^ ]* */, "", about["limit"])
		add_key(about["limit"], 101)
	}
}
function add_key(name, style) {
	key_name[++n_keys] = name
	key_style[n_keys] = style
	longest_key = max(longest_key, length(name))
}
function samples(    what) {
	what = "one sample each"
	if (most > 1) what = (about["level"] != "" ? "means, with bands of " 100 * about["level"] " % confidence, of " : "medians of ") \
		(most > least ? "up to " : "") most " samples" (about["outliers"] == "left out" ? " without outliers" : "")
	return what (pareto ? "; Pareto front: nothing measured is better in both" : "")
}
# The front of panel p, sorted by x.
function find_front(p,    q, i) {
	for (q = 1; q <= n_points; q++) {
		if (point_panel[q] != p || !best[q]) continue
		on_front[q] = 1
		for (i = ++n_front[p]; i > 1 && x_mid[front[p, i - 1]] > x_mid[q]; i--) front[p, i] = front[p, i - 1]
		front[p, i] = q
	}
}

# --- axes ---
# Sets from[a] and to[a] of axis a from the smallest and the largest value on it.
function axis(a, lo, hi, is_log,    pad) {
	logarithmic[a] = is_log
	if (is_log) { lo = log10(lo); hi = log10(hi) }
	else if (lo > 0 && lo < (ranges_differ() ? .25 : .4) * hi) lo = 0
	pad = hi > lo ? (hi - lo) * 0.06 : is_log ? 0.3 : max(hi < 0 ? -hi : hi, 1) * 0.1
	from[a] = lo == 0 && !is_log ? 0 : lo - pad
	to[a] = hi + pad
	if (!is_log) return
	from[a] = exp((from[a] > -307 ? from[a] : lo) * log(10)) # no room where numbers end
	to[a] = exp((to[a] < 307 ? to[a] : hi) * log(10))
}
# Those of all panels, or of panel p if each has its own.
function find_axes(p,    q, n, x0, x1, y0, y1) {
	for (q = 1; q <= n_points; q++) {
		if (ranges_differ() && point_panel[q] != p) continue
		x0 = n++ ? min(x0, x_low[q]) : x_low[q]; x1 = n > 1 ? max(x1, x_high[q]) : x_high[q]
		y0 = n > 1 ? min(y0, reach_low[q]) : reach_low[q]; y1 = n > 1 ? max(y1, reach_high[q]) : reach_high[q]
	}
	axis("x", x0, x1, log_axes ~ /x/)
	axis("y", limit != "" ? min(y0, limit) : y0, limit != "" ? max(y1, limit) : y1, log_axes ~ /y/)
	printf "set xrange [%.17g:%.17g]; set yrange [%.17g:%.17g]\n", from["x"], to["x"], from["y"], to["y"]
}
function ranges_differ() { return about["ranges"] == "own" }
function axes(    i) {
	styles()
	for (i = 1; i <= length(log_axes); i++) print "set logscale " substr(log_axes, i, 1)
}
# Where panel p has points, if x was chosen, not measured, and has few values; their names, where there is room for them.
function x_ticks(p,    q, i, n, at, room, end, name, text, left_out) {
	for (q = 1; q <= n_points; q++) {
		if (ranges_differ() && point_panel[q] != p) continue
		if (point_name[q] != "") return ticks("x")
		for (i = 1; i <= n && at[i] != x_mid[q]; i++) { }
		if (i > n) insert(at, ++n, x_mid[q])
		if (n > 14) return ticks("x")
	}
	end = -99
	for (i = 1; i <= n; i++) {
		name = number(at[i])
		room = length(name) * 3.6 + 3
		q = place("x", at[i], plot_w)
		if (q - room < end) name = ""
		else end = q + room
		text = text (i > 1 ? ", " : "") quoted(name) sprintf(" %.17g", at[i])
		left_out += name == ""
	}
	return left_out > 2 ? ticks("x") : "set xtics (" text ")"
}
# gnuplot names the decades only; a short range needs numbers between them.
function ticks(a,    k, i, n, digit, text, decades, step) {
	if (!logarithmic[a]) return "set " a "tics autofreq; set format " a " \047%g\047"
	decades = log10(to[a]) - log10(from[a])
	step = decades > 8 ? ceil(decades / 8) : 1
	n = split(decades < .6 ? "1 1.5 2 3 4 5 6 7 8 9" : decades < 1.2 ? "1 2 3 5 7" : decades < 3.2 ? "1 2 5" : "1", digit, " ")
	for (k = step * floor(log10(from[a]) / step); k <= log10(to[a]); k += step)
		for (i = 1; i <= n; i++) text = text (text ? ", " : "") tick(digit[i], k)
	return "set " a "tics (" text ")"
}
function tick(digit, k) { return sprintf("\047%s\047 %ge%d", number((digit "e" k) + 0), digit, k) }
# 1e5, not 100000 or 1e+05; 1e-4, not 0.0001.
function number(v,    name, size) {
	name = sprintf("%.0e", v)
	size = v < 0 ? -v : v
	if (name + 0 != v || size == 0 || size >= 1e-3 && size < 1e5) return sprintf("%.10g", v)
	sub(/e[+]0*/, "e", name); sub(/e-0*/, "e-", name)
	return name
}
function place(a, v, pixels) { # how far v is along the axis, in pixels
	if (logarithmic[a]) return (log(v) - log(from[a])) / (log(to[a]) - log(from[a])) * pixels
	return (v - from[a]) / (to[a] - from[a]) * pixels
}
function unplace(a, pixels, whole) {
	if (logarithmic[a]) return exp(log(from[a]) + pixels / whole * (log(to[a]) - log(from[a])))
	return from[a] + pixels / whole * (to[a] - from[a])
}

# --- the names of points, where there is room for them ---
function obstruct(x, y) { obstacle_x[++n_obstacles] = x; obstacle_y[n_obstacles] = y }
function obstacles(p,    l, i, q, x, y, px, py, steps, s) {
	n_obstacles = n_boxes = 0
	for (l = 1; l <= n_lines; l++) for (i = 1; i <= n_order[p, l]; i++) {
		q = order[p, l, i]
		x = place("x", x_mid[q], plot_w)
		y = place("y", y_mid[q], plot_h)
		for (s = -4; s <= 4; s += 4) { obstruct(x + s, y - 4); obstruct(x + s, y); obstruct(x + s, y + 4) }
		steps = i > 1 ? int((max(x - px, px - x) + max(y - py, py - y)) / 4) : 0
		for (s = 1; s < steps; s++) obstruct(px + (x - px) * s / steps, py + (y - py) * s / steps)
		px = x
		py = y
	}
}
function is_free(x, y, w, h,    i) {
	if (x < 2 || y < 2 || x + w > plot_w - 2 || y + h > plot_h - 2) return 0
	for (i = 1; i <= n_obstacles; i++)
		if (obstacle_x[i] > x && obstacle_x[i] < x + w && obstacle_y[i] > y && obstacle_y[i] < y + h)
			return 0
	for (i = 1; i <= n_boxes; i++)
		if (box_x[i] < x + w && x < box_x[i] + box_w[i] && box_y[i] < y + h && y < box_y[i] + h) return 0
	return 1
}
# At its corners, above it, below it or at its sides, close or a little further.
function name_point(q,    x, y, w, h, side, k, away, left, low) {
	w = length(point_name[q]) * 5.8 + 4
	h = 12
	split("1 1 -1 1 1 -1 -1 -1 0 1 0 -1 1 0 -1 0", side, " ")
	for (k = 0; k < 16; k++) {
		away = k < 8 ? 6 : 12
		x = side[2 * k % 16 + 1]
		y = side[2 * k % 16 + 2]
		left = place("x", x_mid[q], plot_w) + (x > 0 ? away : x < 0 ? -w - away : -w / 2)
		low = place("y", y_mid[q], plot_h) + (y > 0 ? away : y < 0 ? -h - away : -h / 2)
		if (is_free(left, low, w, h)) break
	}
	if (k == 16) return
	box_x[++n_boxes] = left
	box_y[n_boxes] = low
	box_w[n_boxes] = w
	write(point_name[q], "first", unplace("x", left + w / 2, plot_w), unplace("y", low + h / 2, plot_h), "center", 10,
		shade[point_line[q]])
}
# Points of a line that are on one another share a name, "first, second" or "first ... last".
function join_names(p,    q, r, first) {
	for (q = 1; q <= n_points; q++) for (r = 1; r < q && point_panel[q] == p; r++) {
		if (point_panel[r] != p || point_line[r] != point_line[q] || point_name[r] == "" || point_name[q] == "") continue
		if (gap(q, r, "x", x_mid, plot_w) > 5 || gap(q, r, "y", y_mid, plot_h) > 5) continue
		if (!(r in first)) { first[r] = point_name[r]; point_name[r] = first[r] ", " point_name[q] }
		else point_name[r] = first[r] " ... " point_name[q]
		point_name[q] = ""
		if (q in on_front) on_front[r] = 1
	}
}
function gap(q, r, a, v, pixels,    d) { d = place(a, v[q], pixels) - place(a, v[r], pixels); return d < 0 ? -d : d }
function name_points(p,    pass, q) { # those on the front first
	join_names(p)
	obstacles(p)
	for (pass = 1; pass >= 0; pass--) for (q = 1; q <= n_points; q++)
		if (point_panel[q] == p && point_name[q] != "" && (q in on_front) == pass) name_point(q)
}

# --- drawing ---
function styles(    l) {
	for (l = 1; l <= n_lines; l++)
		printf "set style line %d lw 1.8 ps %g lc rgb 0x%s pt %d dt %s\n", l, mark[l] in is_filled ? .8 : 1.1, shade[l], mark[l], dash[l]
	print "set style line 100 lw 5 ps 1.9 lc rgb 0xd8d8d8 pt 7 dt solid"
	print "set style line 101 lw 1.2 ps 0 lc rgb 0x606060 pt 0 dt (6,4)"
}
function data(p, l,    i, q, text) {
	for (i = 1; i <= n_order[p, l]; i++) {
		q = order[p, l, i]
		text = text sprintf("%.17g %.17g %.17g %.17g %.17g %.17g\n", x_mid[q], y_mid[q], x_low[q], x_high[q],
			y_low[q], y_high[q])
	}
	block("d" p "_" l, text)
}
# A band ends at the axis: what is beyond it gnuplot draws beside the panel. Its edges get a point where they leave.
function band_data(p, l,    i, k, q, r, n, t, edge, a, b, c, text) {
	for (i = 1; i <= n_order[p, l]; i++) {
		r = order[p, l, i]
		n = 0
		for (k = 0; i > 1 && k < 4; k++) {
			edge = k % 2; c = k > 1
			a = place("y", edge ? y_high[q] : y_low[q], 1); b = place("y", edge ? y_high[r] : y_low[r], 1)
			if ((a - c) * (b - c) < 0) insert(t, ++n, (c - a) / (b - a))
		}
		for (k = 1; k <= n; k++)
			text = text band_at(between("x", x_mid[q], x_mid[r], t[k]), between("y", y_low[q], y_low[r], t[k]),
				between("y", y_high[q], y_high[r], t[k]))
		text = text band_at(x_mid[r], y_low[r], y_high[r])
		q = r
	}
	block("band" p "_" l, text)
}
# Puts v among the n - 1 sorted numbers of t.
function insert(t, n, v) { for (; n > 1 && t[n - 1] > v; n--) t[n] = t[n - 1]; t[n] = v }
function between(a, v, w, t) { return logarithmic[a] ? exp(log(v) + t * (log(w) - log(v))) : v + t * (w - v) }
function band_at(x, low, high) {
	return sprintf("%.17g %.17g %.17g\n", x, min(max(low, from["y"]), to["y"]), min(max(high, from["y"]), to["y"]))
}
function front_data(p,    i, text) {
	for (i = 1; i <= n_front[p]; i++)
		text = text sprintf("%.17g %.17g\n", x_mid[front[p, i]], y_mid[front[p, i]])
	block("front" p, text)
	# its edge begins at the top, and goes on to the right
	block("edge" p, sprintf("%.17g %.17g\n%s%.17g %.17g\n", x_mid[front[p, 1]], to["y"], text, to["x"],
		y_mid[front[p, n_front[p]]]))
}
# Settings vary in both directions and get bars; a function of x gets a band.
function banded(p, l,    i, any) {
	for (i = 1; i <= n_order[p, l]; i++) {
		if (point_name[order[p, l, i]] != "") return 0
		if (n_samples[order[p, l, i]] > 1) any = 1
	}
	return any && n_order[p, l] > 1
}
# Dashed lines lie on solid ones, and marks on both, so that lines of the same course show all their colours.
function plot(p,    l, d, ranges, solid, dashed, points) {
	if (limit != "") ranges = sprintf(", %.9g with lines ls 101", limit)
	if (pareto) ranges = ranges ", $edge" p " with steps ls 100, $front" p " with points ls 100"
	for (l = 1; l <= n_lines; l++) {
		if (!n_order[p, l]) continue
		d = ", $d" p "_" l " using "
		if (banded(p, l)) ranges = ranges ", $band" p "_" l " using 1:2:3 with filledcurves fc rgb 0x" shade[l] \
			" fs transparent solid " (n_lines > 6 ? .07 : .13) " noborder"
		else if ((p, l) in varies) ranges = ranges d "1:2:3:4:5:6 with xyerrorbars lc rgb 0x" shade[l] " lw 1 dt solid pt 0 ps 0"
		if (dash[l] == "solid") solid = solid d "1:2 with lines ls " l
		else dashed = dashed d "1:2 with lines ls " l
		points = points d "1:2 with points ls " l " dt solid"
	}
	print "plot " substr(ranges solid dashed points, 3)
}
function y_axis(col,    marks) { # only the first panel of a row has its numbers
	marks = ticks("y")
	if (col && !ranges_differ()) gsub(/\047%?g?[^\047]*\047/, "\047\047", marks)
	print marks
	print (col ? "unset ylabel" : "set ylabel " quoted(y_title) " offset 0.5,0")
}
function draw_panel(p,    l) {
	if (pareto) find_front(p)
	print "unset label"
	find_axes(p)
	print x_ticks(p)
	for (l = 1; l <= n_lines; l++) if (n_order[p, l]) {
		data(p, l)
		if (banded(p, l)) band_data(p, l)
	}
	if (pareto) front_data(p)
	open_panel(p)
	print "set xlabel " quoted(x_title) " offset 0,0.4"
	y_axis((p - 1) % per_row)
	if (labels) name_points(p)
	plot(p)
}
function key_look(i, x, y,    style) {
	style = i in key_style ? key_style[i] : i
	block("k" i, sprintf("%.1f %.1f\n%.1f %.1f\n", x + 2, y, x + 40, y))
	block("m" i, sprintf("%.1f %.1f\n", x + 21, y))
	return ", $k" i " with lines ls " style ", $m" i " with points ls " style " dt solid"
}
