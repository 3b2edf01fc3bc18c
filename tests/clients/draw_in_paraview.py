"""Draws one frame of a recording with ParaView: pvpython draw_in_paraview.py RECORDING TIME PICTURE.

Grains are spheres of their radius. Contacts are tubes from centre to centre: the larger N is, the wider and darker; red
pushes and blue pulls. screenshots/paraview.png is the pile of

    slump --headless --data run/ --data-format vtk --data-every 0.05 --bond 20 --dt 5e-4

at 0.2 s, with `convert -colors 160` after it.
"""

import sys

import numpy
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

SIZE = [1280, 440]
# Colours of the grains, in the order of the words of `kind`.
COLOURS = {0: [0.90, 0.88, 0.84], 1: [0.56, 0.57, 0.60]}
# The force that one contact in twenty exceeds has the last colour and the widest tube.
SHOWN_SHARE = 0.95
# Largest radius of a tube, in mean radii of the grains.
WIDEST_TUBE = 0.42
FORCE = "millinewton"
# Colours from pull through zero to push: fraction of the force with the last colour, then red, green, blue.
SCALE = [
    (-1.0, 0.03, 0.19, 0.42), (-0.5, 0.13, 0.45, 0.71), (-0.1, 0.50, 0.67, 0.81), (0.0, 0.72, 0.70, 0.68),
    (0.1, 0.91, 0.62, 0.50), (0.5, 0.80, 0.24, 0.20), (1.0, 0.40, 0.00, 0.12),
]


def main(recording, time, picture):
    grains, at = opened(f"{recording}/vtk/grains.pvd", time)
    contacts, _ = opened(f"{recording}/vtk/contacts.pvd", time)
    view = simple.CreateView("RenderView")
    view.ViewSize = SIZE
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    view.UseFXAA = 1
    for kind, colour in COLOURS.items():
        draw_grains(view, grains, kind, colour)
    radius = numpy.mean(point_values(grains, "radius"))
    draw_contacts(view, contacts, radius)
    label(view, f"t = {at:.2f} s")
    # The first drawing of a view resets its camera, so the camera is set afterwards.
    simple.Render(view)
    look_at(view, grains, radius)
    simple.SaveScreenshot(picture, view, ImageResolution=SIZE, CompressionLevel="9")


def opened(path, time):
    """Return the frame of a series nearest to a time, and the time of this frame."""
    series = simple.PVDReader(FileName=path)
    series.UpdatePipelineInformation()
    nearest = min(series.TimestepValues, key=lambda found: abs(found - time))
    frame = simple.ForceTime(Input=series)
    frame.ForcedTime = nearest
    frame.UpdatePipeline()
    return frame, nearest


def draw_grains(view, grains, kind, colour):
    chosen = simple.Threshold(Input=grains, Scalars=["POINTS", "kind"])
    chosen.LowerThreshold = chosen.UpperThreshold = kind
    spheres = simple.Glyph(Input=chosen, GlyphType="Sphere", GlyphMode="All Points")
    spheres.GlyphType.ThetaResolution = spheres.GlyphType.PhiResolution = 48
    spheres.OrientationArray = ["POINTS", "No orientation array"]
    # The sphere has the diameter 1 before scaling.
    spheres.ScaleArray = ["POINTS", "radius"]
    spheres.ScaleFactor = 2.0
    shown = simple.Show(spheres, view)
    simple.ColorBy(shown, None)
    shown.AmbientColor = shown.DiffuseColor = colour
    shown.Ambient, shown.Diffuse, shown.Specular = 0.55, 0.45, 0.0


def draw_contacts(view, contacts, radius):
    forces = vtk_to_numpy(servermanager.Fetch(contacts).GetCellData().GetArray("normal_force"))
    strong = 1e3 * float(numpy.quantile(numpy.abs(forces), SHOWN_SHARE))
    # No two lines share a point, so each point gets the force of its own line.
    at_ends = simple.CellDatatoPointData(Input=contacts)
    force = simple.Calculator(Input=at_ends, ResultArrayName=FORCE, Function="1000*normal_force")
    size = simple.Calculator(Input=force, ResultArrayName="size")
    size.Function = f"{WIDEST_TUBE * radius!r}*(0.06 + min(abs({FORCE})/{strong!r}, 1))"
    in_front = simple.Transform(Input=size)
    in_front.Transform.Translate = [0, 0, 2 * radius]
    tubes = simple.Tube(Input=in_front, Scalars=["POINTS", "size"])
    tubes.VaryRadius = "By Absolute Scalar"
    tubes.NumberofSides = 24
    shown = simple.Show(tubes, view)
    simple.ColorBy(shown, ("POINTS", FORCE))
    shown.Ambient, shown.Diffuse, shown.Specular = 0.5, 0.5, 0.0
    colours = simple.GetColorTransferFunction(FORCE)
    colours.ColorSpace = "Lab"
    colours.RGBPoints = [number for part, *rgb in SCALE for number in [part * strong, *rgb]]
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = "normal force / mN", ""
    bar.TitleColor = bar.LabelColor = [0.2, 0.2, 0.2]
    bar.TitleFontSize, bar.LabelFontSize = 15, 13
    bar.Orientation, bar.WindowLocation = "Horizontal", "Any Location"
    bar.Position, bar.ScalarBarLength = [0.035, 0.72], 0.27
    bar.UseCustomLabels, bar.CustomLabels = 1, [0.0]
    bar.RangeLabelFormat = bar.LabelFormat = "%.1f"
    bar.DrawTickMarks = 0
    shown.SetScalarBarVisibility(view, True)


def label(view, words):
    text = simple.Text(Text=words)
    shown = simple.Show(text, view)
    shown.Color, shown.FontSize = [0.2, 0.2, 0.2], 16
    shown.WindowLocation, shown.Position = "Any Location", [0.03, 0.90]


def look_at(view, grains, radius):
    """Set the camera so that all moving bodies are as wide as the picture."""
    data = servermanager.Fetch(grains)
    moves = point_values(grains, "kind") == 0
    places = vtk_to_numpy(data.GetPoints().GetData())[moves]
    low, high = places.min(axis=0) - 3 * radius, places.max(axis=0) + 2 * radius
    height = max(high[1] - low[1], (high[0] - low[0]) * SIZE[1] / SIZE[0])
    middle = [(low[0] + high[0]) / 2, low[1] + height / 2, 0]
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = middle
    view.CameraPosition = [middle[0], middle[1], 100 * radius]
    view.CameraViewUp = [0, 1, 0]
    view.CameraParallelScale = height / 2


def point_values(source, name):
    return vtk_to_numpy(servermanager.Fetch(source).GetPointData().GetArray(name))


main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
