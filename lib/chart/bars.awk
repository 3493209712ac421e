# Panels of bars over time, a lane a slot (H. L. Gantt, "Work, Wages, and Profits", 1919), told apart by lightness and
# hatching. See page.awk.
function check() {
	if (log_axes labels pareto != "00" || about["front"] == "marked")
		bad("intervals, expected none of -L, -l and -p with them")
}
function take(p) {
	x_unit = $5
	y_unit = $7
	take_bar(p, look_of($3), $4 + 0, $6 + 0, $10 + 0)
}
function samples() { return "" }
function ranges_differ() { return 0 }

# What fragstat tells apart has one look in all charts; what others do takes the looks that are left.
function look_of(method,    i) {
	if (!n_lines) {
		n_lines = split("task;task given again;wasted", line_name, ";")
		for (i = 1; i <= n_lines; i++) line_of[line_name[i]] = i
	}
	if (!(method in line_of)) line_name[line_of[method] = ++n_lines] = method
	is_shown[line_of[method]] = 1
	return line_of[method]
}
function take_bar(p, l, begin, lane, end) {
	bar_panel[++n_bars] = p
	bar_line[n_bars] = l
	bar_begin[n_bars] = begin
	bar_end[n_bars] = end
	bar_lane[n_bars] = lane
	has_bars[p, l] = 1
	n_lanes = max(n_lanes, lane + 1)
	last_until = max(last_until + 0, end)
	first_begin = min(first_begin + 0, begin)
}
# What is too small to be seen is drawn as one bar with what follows it at once.
function bar_block(p, l,    i, lane, apart, small) {
	small = (last_until - first_begin) / plot_w
	apart = small / 4
	for (lane in open_begin) delete open_begin[lane]
	printf "$b%d_%d << END_OF_DATA\n", p, l
	for (i = 1; i <= n_bars; i++) {
		if (bar_panel[i] != p || bar_line[i] != l) continue
		lane = bar_lane[i]
		if ((lane in open_begin) && bar_end[i] - bar_begin[i] < small && bar_begin[i] >= open_begin[lane] &&
			bar_begin[i] - open_end[lane] < apart) {
			open_end[lane] = max(open_end[lane], bar_end[i])
			continue
		}
		if (lane in open_begin) print_bar(lane, l)
		open_begin[lane] = bar_begin[i]
		open_end[lane] = bar_end[i]
	}
	for (lane in open_begin) print_bar(lane, l)
	print "END_OF_DATA"
}
# Hatched bars are boxes. Others are thick lines, which take a tenth of the bytes of SVG; a gap shows where one task ends and
# the next begins, as long as there is room for it.
function is_box(l) { return l == 3 }
function print_bar(lane, l,    end) {
	end = open_end[lane]
	if (is_box(l)) {
		printf "%.17g %d %.17g %.17g %.2f %.2f\n", (open_begin[lane] + end) / 2, lane, open_begin[lane], end, lane - 0.4, lane + 0.4
		return
	}
	if (bar_pixels > 4) end = max(end - last_until / plot_w, (open_begin[lane] + end) / 2)
	printf "%.17g %d %.17g 0\n", open_begin[lane], lane, end - open_begin[lane]
}
function bar_look(l, thick,    colours) {
	split("56B4E9 D55E00 - 0072B2 E69F00 CC79A7 009E73 808080", colours, " ")
	if (is_box(l)) return "using 1:2:3:4:5:6 with boxxyerror fc rgb 0x000000 fs pattern 4 border lc rgb 0x000000 lw 0.7"
	return sprintf("using 1:2:3:4 with vectors nohead dt solid lw %.2f lc rgb 0x%s", thick, colours[l < 9 ? l : l % 5 + 4])
}
function draw_panel(p,    l, text) {
	print "unset label"
	open_panel(p)
	print "set xlabel " quoted(x_title) " offset 0,0.4; set ylabel " quoted(y_title) " offset 0.5,0"
	for (l = 1; l <= n_lines; l++) {
		if (!((p, l) in has_bars)) continue
		bar_block(p, l)
		text = text ", $b" p "_" l " " bar_look(l, plot_h / n_lanes * 0.8)
	}
	print "plot " substr(text, 3)
}
function axes(    i, step, name, text) {
	split(about["lanes"], name, " ")
	step = ceil(n_lanes * 13 / plot_h)
	for (i = 0; i < n_lanes; i += step) {
		gsub(/%/, "%%", name[i + 1]) # gnuplot takes the label of a tic for a format
		text = text (i ? ", " : "") quoted(name[i + 1] == "" ? i : name[i + 1]) " " i
	}
	printf "set xrange [%.17g:%.17g]; set yrange [%.1f:-0.6]; set ytics (%s)\n", first_begin * 1.01,
		(last_until > first_begin ? last_until * 1.01 : 1), n_lanes - 0.4, text
	print "set xtics autofreq; set grid xtics noytics"
}
function prepare(    l, name) {
	n_lanes = max(n_lanes, split(about["lanes"], name, " ")) # those without a bar as well
	plot_w = 900
	plot_h = min(max(n_lanes * 22, 60), 640)
	per_row = 1
	bar_pixels = n_bars ? plot_w * n_lanes * n_panels / n_bars : 0
	for (l = 1; l <= n_lines; l++) {
		longest_key = max(longest_key, length(line_name[l]))
		if (!is_shown[l]) continue
		shown_as[++n_keys] = l
		key_name[n_keys] = line_name[l]
	}
}
function key_look(i, x, y) {
	block("k" i, is_box(shown_as[i]) ? sprintf("%.1f %.1f %.1f %.1f %.1f %.1f\n", x + 24, y, x + 8, x + 40, y - 6, y + 6) : \
		sprintf("%.1f %.1f 32 0\n", x + 8, y))
	return ", $k" i " " bar_look(shown_as[i], 12)
}
