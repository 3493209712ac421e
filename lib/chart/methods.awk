# The look of each method of balance(1), the same in all charts; chart(1), "Methods", has this table too, and a test compares
# them. Colours are those of M. Okabe and K. Ito, "Color Universal Design" (2008), without yellow, which is faint on white,
# and others of P. Tol, "Colour Schemes" (SRON technical note 09-002). No two are nearer to each other, for any kind of
# colour vision, than two of Okabe and Ito's are, except magenta. A colour that serves two methods has two marks.
BEGIN {
	colours = "blue 0072B2;vermilion D55E00;green 009E73;purple CC79A7;orange E69F00;sky 56B4E9;black 000000;wine 882255;" \
		"indigo 332288;brown 661100;grey B0B0B0;magenta AA3377"
	# gnuplot's numbers of points; pairs of solid and open ones tell lines on one another apart
	marks = "circle 7;square 5;triangle 9;diamond 13;inverted triangle 11;open circle 6;open square 4;open triangle 8;" \
		"open diamond 12;pentagon 15;open inverted triangle 10;open pentagon 14;x 2;plus 1;asterisk 3"
	dashes = "solid solid;long (9,4);short (3,3);mixed (9,3,2,3)"
	methods = "adaptive:vermilion:circle:solid;" \
		"auto:magenta:open circle:short;" \
		"best:black:pentagon:short;" \
		"dc:green:x:long;" \
		"ds:purple:open diamond:solid;" \
		"factoring:wine:asterisk:mixed;" \
		"gdc:blue:square:solid;" \
		"gdc-published:sky:open square:long;" \
		"guided:indigo:open triangle:short;" \
		"hybrid:orange:diamond:long;" \
		"interleaved:grey:inverted triangle:solid;" \
		"masterslave:green:triangle:long;" \
		"sc:vermilion:plus:long;" \
		"ss:blue:open inverted triangle:solid;" \
		"weighted:brown:open pentagon:mixed"
	n_colours = listed(colours, colour_of, colour_at)
	n_marks = listed(marks, mark_of, mark_at)
	for (i = 5; i <= 15; i += 2) is_filled[i]
	n_dashes = listed(dashes, dash_of, dash_at)
	for (i = split(methods, row, ";"); i; i--) {
		split(row[i], look, ":")
		method_colour[look[1]] = colour_of[look[2]]
		method_mark[look[1]] = mark_of[look[3]]
		method_dash[look[1]] = dash_of[look[4]]
	}
}
# Reads "NAME VALUE;...": values by name, and by number from 1; returns how many there are.
function listed(list, of, at,    n, i, name) {
	n = split(list, at, ";")
	for (i = 1; i <= n; i++) {
		name = at[i]
		sub(/ [^ ]*$/, "", name)
		sub(/.* /, "", at[i])
		of[name] = at[i]
	}
	return n
}
# Sets shade, mark and dash of each line: those of its method, which may have the name of the StormView paper, D_S for ds. The
# others take the colours and marks that are left, in turn; beside methods from the end, where the rarer ones are.
function take_looks(    l, name, c, m, others, step) {
	step = 1
	for (l = 1; l <= n_lines; l++) {
		name = tolower(line_name[l])
		gsub(/_/, "", name)
		if (!(name in method_colour)) continue
		colour_taken[shade[l] = method_colour[name]]
		mark_taken[mark[l] = method_mark[name]]
		dash[l] = method_dash[name]
		step = -1
	}
	for (l = 1; l <= n_lines; l++) {
		if (l in shade) continue
		c = untaken(colour_at, n_colours, colour_taken, c, step)
		m = untaken(mark_at, n_marks, mark_taken, m, step)
		shade[l] = colour_at[c]
		mark[l] = mark_at[m]
		dash[l] = dash_at[others++ % n_dashes + 1]
	}
}
# The number after k, or before it, of 1 to n in a circle, of one that is not taken, if there is one.
function untaken(at, n, taken, k, step,    tries) {
	do k = step > 0 ? k % n + 1 : k > 1 ? k - 1 : n
	while ((at[k] in taken) && ++tries < n)
	return k
}
