#!/usr/bin/python3
"""volume_vtk FIELD SIZE SCENE OUT DISTANCE ...: VTK's vtkFixedPointVolumeRayCastMapper, one thread.

SIZE: what `accuracy_bench field` said, SCENE: a file of what `accuracy_bench scene` said. For each
DISTANCE between samples: prints it and the CPU ms of one picture by a new mapper, with all that it
prepares, the fastest of those made within LEAST_S, and writes the picture to OUT.DISTANCE. The
mapper's steps are called as its Render does, without what shows the picture: that wants a display.
"""
import array
import ctypes
import math
import sys
import time

import vtk

LEAST_S = 0.12  # as in accuracy_bench
PIECES = 64  # of a span of the map: opacity is no linear function of extinction


def grid(path, nx, ny, nz, dz):
    values = array.array("f")
    with open(path, "rb") as f:
        values.frombytes(f.read())
    scalars = vtk.vtkFloatArray()
    scalars.SetVoidArray(values, len(values), 1)
    image = vtk.vtkImageData()
    image.SetDimensions(nx, ny, nz)
    image.SetSpacing(1, 1, dz)
    image.GetPointData().SetScalars(scalars)
    return image, values


def mapping(knots, distance):
    """Opacities are those of a sample: the mapper keeps them as float, in which that of a whole
    unit of a narrow contour is 1, and can then not be brought to a shorter distance."""
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for a, b in zip(knots, knots[1:]):
        for i in range(PIECES + 1):
            w = i / PIECES
            s, k = a[0] + (b[0] - a[0]) * w, a[4] + (b[4] - a[4]) * w
            opacity.AddPoint(s, 1 - math.exp(-k * distance))
    for s, r, g, b, _ in knots:
        colour.AddRGBPoint(s, r, g, b)
    opacity.ClampingOff()
    prop = vtk.vtkVolumeProperty()
    prop.SetColor(colour)
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(distance)
    prop.SetInterpolationTypeToLinear()
    prop.ShadeOff()
    return prop


def viewed(view, angle, side, volume):
    window, renderer, camera = vtk.vtkRenderWindow(), vtk.vtkRenderer(), vtk.vtkCamera()
    window.SetOffScreenRendering(1)
    window.SetSize(side, side)
    window.AddRenderer(renderer)
    renderer.AddVolume(volume)
    camera.SetPosition(view[0])
    camera.SetFocalPoint(view[1])
    camera.SetViewUp(view[2])
    camera.SetViewAngle(angle)
    camera.SetClippingRange(1, 1000)
    renderer.SetActiveCamera(camera)
    return window, renderer


def picture(mapper, side):
    """The mapper's own part of the frame, put where it belongs, from the top."""
    image = mapper.GetRayCastImage()
    (w, h), (x0, y0), (row, _) = (
        image.GetImageInUseSize(), image.GetImageOrigin(), image.GetImageMemorySize())
    address = int(image.GetImage().split("_")[1], 16)
    pixel = ctypes.cast(address, ctypes.POINTER(ctypes.c_uint16))
    out = array.array("f", bytes(16 * side * side))
    for y in range(h):
        to = 4 * ((side - 1 - y - y0) * side + x0)
        out[to:to + 4 * w] = array.array("f", [v / 32767 for v in pixel[4 * y * row:4 * (y * row + w)]])
    return out


def drawn(image, volume, renderer, distance):
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.SetNumberOfThreads(1)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1)
    mapper.SetSampleDistance(distance)
    mapper.IntermixIntersectingGeometryOff()
    mapper.SetInputData(image)
    volume.SetMapper(mapper)
    mapper.Update()
    mapper.PerImageInitialization(
        renderer, volume, 0, list(image.GetOrigin()), list(image.GetSpacing()), list(image.GetExtent()))
    mapper.PerVolumeInitialization(renderer, volume)
    mapper.PerSubVolumeInitialization(renderer, volume, 0)
    mapper.RenderSubVolume()
    return mapper


def main():
    field, size, path, out = sys.argv[1:5]
    nx, ny, nz, dz = size.split()
    lines = [[float(v) for v in line.split()] for line in open(path)]
    image, values = grid(field, int(nx), int(ny), int(nz), float(dz))
    volume = vtk.vtkVolume()
    angle, side = lines[3][0], int(lines[3][1])
    window, renderer = viewed(lines[:3], angle, side, volume)
    for word in sys.argv[5:]:
        distance = float(word)
        volume.SetProperty(mapping(lines[4:], distance))
        best, end = math.inf, time.process_time() + LEAST_S
        while time.process_time() < end:
            begin = time.process_time()
            mapper = drawn(image, volume, renderer, distance)
            best = min(best, time.process_time() - begin)
        with open(out + "." + word, "wb") as f:
            picture(mapper, side).tofile(f)
        print(word, round(best * 1e3, 3))
    del window, values


main()
