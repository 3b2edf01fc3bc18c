"""A pile changed in PyVista: shifted.py RECORDING FILE saves the last frame, lifted; with a third folder,
the first frame of the recording there must have that pile, bit by bit."""

import sys

import numpy
import pyvista

LIFT = 0.25


def main(recording, file, started=None):
    frames = pyvista.get_reader(f"{recording}/vtk/grains.pvd")
    frames.set_active_time_value(frames.time_values[-1])
    pile = frames.read()[0]
    pile.points[:, 1] += LIFT
    if started is None:
        pile.save(file)
        return
    found = pyvista.read(f"{started}/vtk/grains_000000.vtp")
    assert found.n_points == pile.n_points
    assert (found.points == pile.points).all()
    for name in ["radius", "velocity", "omega", "kind", "id"]:
        assert (found.point_data[name] == pile.point_data[name]).all(), name
    assert numpy.isnan(found.point_data["mass"][pile.point_data["kind"] == 1]).all()
    print("a pile that PyVista saved is started from")


main(*sys.argv[1:])
