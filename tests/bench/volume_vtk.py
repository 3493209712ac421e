#!/usr/bin/python3
"""volume_vtk FIELD SIZE MAP DISTANCE OUT: VTK's vtkFixedPointVolumeRayCastMapper, one thread.

SIZE: what `volume_bench field` said, MAP: a file of what `volume_bench map` said, DISTANCE: between
samples. Prints the CPU us of one picture, the fastest of 3, and writes it to OUT. The mapper's steps
are called as its Render does, without what shows the picture: that wants a display.
"""
import array
import ctypes
import math
import sys
import time

import vtk

TIMES = 3
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


def mapping(knots):
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for a, b in zip(knots, knots[1:]):
        for i in range(PIECES + 1):
            w = i / PIECES
            s, k = a[0] + (b[0] - a[0]) * w, a[4] + (b[4] - a[4]) * w
            opacity.AddPoint(s, 1 - math.exp(-k))
    for s, r, g, b, _ in knots:
        colour.AddRGBPoint(s, r, g, b)
    opacity.ClampingOff()
    prop = vtk.vtkVolumeProperty()
    prop.SetColor(colour)
    prop.SetScalarOpacity(opacity)
    prop.SetScalarOpacityUnitDistance(1)
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
    """The mapper's own part of the frame, put where it belongs."""
    image = mapper.GetRayCastImage()
    (w, h), (x0, y0), (row, _) = (
        image.GetImageInUseSize(), image.GetImageOrigin(), image.GetImageMemorySize())
    address = int(image.GetImage().split("_")[1], 16)
    pixel = ctypes.cast(address, ctypes.POINTER(ctypes.c_uint16))
    out = array.array("f", bytes(16 * side * side))
    for y in range(h):
        for x in range(4 * w):
            out[4 * ((y + y0) * side + x0) + x] = pixel[4 * y * row + x] / 32767
    return out


def main():
    field, size, path, distance, out = sys.argv[1:]
    nx, ny, nz, dz = size.split()
    lines = [[float(v) for v in line.split()] for line in open(path)]
    image, values = grid(field, int(nx), int(ny), int(nz), float(dz))
    mapper = vtk.vtkFixedPointVolumeRayCastMapper()
    mapper.SetNumberOfThreads(1)
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1)
    mapper.SetSampleDistance(float(distance))
    mapper.IntermixIntersectingGeometryOff()
    mapper.SetInputData(image)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(mapping(lines[4:]))
    angle, side = lines[3][0], int(lines[3][1])
    window, renderer = viewed(lines[:3], angle, side, volume)
    mapper.Update()
    best = math.inf
    for _ in range(TIMES):
        begin = time.process_time()
        extent = [0, image.GetDimensions()[0] - 1, 0, image.GetDimensions()[1] - 1, 0,
                  image.GetDimensions()[2] - 1]
        mapper.PerImageInitialization(renderer, volume, 0, [0, 0, 0], list(image.GetSpacing()), extent)
        mapper.PerVolumeInitialization(renderer, volume)
        mapper.PerSubVolumeInitialization(renderer, volume, 0)
        mapper.RenderSubVolume()
        best = min(best, time.process_time() - begin)
    with open(out, "wb") as f:
        picture(mapper, side).tofile(f)
    print(round(best * 1e6))
    del window, values


main()
