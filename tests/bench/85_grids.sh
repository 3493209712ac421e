#!/bin/sh
# 85_grids: VTK's own reader opens the files of nc2vtk and grib2vtk, and ours opens the files of its writer: the same
# numbers, bit by bit, and the time that each takes to read. For `make bench`, because python3-vtk9 takes 400 MB.
# shellcheck source=lib.sh
. "$(dirname "$0")/lib.sh"
ncarg=/usr/share/ncarg/data ferret=/usr/share/ferret-vis/data
/usr/bin/python3 -c 'import vtkmodules.vtkIOLegacy' || stop 'python3-vtk9 is not installed'

nc2vtk $ncarg/cdf/nc4uvt.nc 'speed=hypot(U,V)' >nc4uvt.vtk || stop 'nc4uvt.nc'
nc2vtk $ncarg/nug/rectilinear_grid_3D.nc t >echam.vtk || stop 'rectilinear_grid_3D.nc'
nc2vtk $ferret/levitus_climatology.cdf TEMP >levitus.vtk || stop 'levitus_climatology.cdf'
nc2vtk -t 6 $ferret/ocean_atlas_subset.nc TEMP >atlas.vtk || stop 'ocean_atlas_subset.nc'
grib2vtk $ncarg/grb/fh.0012_tl.press_gr.awp211.grb2 'speed=hypot(u,v)' >awp211.vtk || stop 'awp211'

cat >compare.py <<'END'
"""Each file by VTK and by the bytes: NAME.vtk's axes and values, in order; then VTK's own copies of it."""
import array, math, sys, time
from vtkmodules.vtkIOLegacy import vtkRectilinearGridReader, vtkRectilinearGridWriter

def block(data, start, count, kind):
    a = array.array(kind)
    a.frombytes(data[start:start + count * a.itemsize])
    a.byteswap()
    return a

def same(ours, theirs):
    return len(ours) == theirs.GetNumberOfValues() and all(
        x == y or (math.isnan(x) and math.isnan(y)) for x, y in
        zip(ours, (theirs.GetValue(i) for i in range(len(ours)))))

for path in sys.argv[1:]:
    data = open(path, 'rb').read()
    begin = time.process_time()
    reader = vtkRectilinearGridReader()
    reader.SetFileName(path)
    reader.Update()
    took = time.process_time() - begin
    grid = reader.GetOutput()
    ok = True
    for axis, theirs in ((b'X', grid.GetXCoordinates()), (b'Y', grid.GetYCoordinates()), (b'Z', grid.GetZCoordinates())):
        at = data.index(b'\n' + axis + b'_COORDINATES') + 1
        end = data.index(b'\n', at)
        ok = ok and same(block(data, end + 1, int(data[at:end].split()[1]), 'd'), theirs)
    n = grid.GetNumberOfPoints()
    values = grid.GetPointData().GetScalars()
    ok = ok and same(block(data, len(data) - 4 * n - 1, n, 'f'), values)
    print('%-11s %8d nodes, %6.1f ms in VTK: %s' % (path, n, 1e3 * took, 'the same' if ok else 'DIFFERENT'))
    for form in ('ASCII', 'Binary'):
        writer = vtkRectilinearGridWriter()
        writer.SetInputData(grid)
        writer.SetFileName(form + '-' + path)
        getattr(writer, 'SetFileTypeTo' + form)()
        writer.Write()
    if not ok:
        sys.exit(1)
END
/usr/bin/python3 compare.py nc4uvt.vtk echam.vtk levitus.vtk atlas.vtk awp211.vtk || stop 'VTK reads other numbers'

# Files of VTK's writer: our reader gives the same picture from a grid of nc2vtk and from VTK's copy.
cat >wind.spec <<'END'
from 190 -200 900
at 190 0 -100
up 0 1 0
angle 40
resolution 64 48
scale 1 1 0.1
map 10 1 1 1 0
map 60 1 0 0 0.1
END
for grid in nc4uvt.vtk Binary-nc4uvt.vtk ASCII-nc4uvt.vtk; do
	partition 64x48 | vcworker $grid wind.spec | gather -o $grid.pfm || stop "vcworker refuses $grid"
done
imgcmp -q nc4uvt.vtk.pfm Binary-nc4uvt.vtk.pfm || stop "a BINARY file of VTK's gives another picture"
# VTK writes 9 digits or fewer.
imgcmp -q -t 1e-5 nc4uvt.vtk.pfm ASCII-nc4uvt.vtk.pfm || stop "an ASCII file of VTK's gives another picture"
echo "files that VTK wrote, BINARY and ASCII: taken, and the same picture"
