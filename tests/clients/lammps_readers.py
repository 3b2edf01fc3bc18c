"""Reads the dumps with MDAnalysis and ASE, and compares positions, velocities and elements with the CSV files."""

import sys

import ase.io
import MDAnalysis
import numpy

from recording import frames, table

ELEMENTS = {"grain": "H", "fixed": "He", "lost": "Li"}


def main(recording):
    every, wanted = table(recording, "grains"), frames(recording)
    dump = f"{recording}/ovito/grains.dump"
    universe = MDAnalysis.Universe(dump, format="LAMMPSDUMP", topology_format="LAMMPSDUMP")
    all_atoms = ase.io.read(dump, index=":", format="lammps-dump-text", units="si")
    assert len(universe.trajectory) == len(all_atoms) == len(wanted)
    for moment, atoms, step in zip(universe.trajectory, all_atoms, wanted["step"]):
        grains = every[every["step"] == step]
        places = grains[["x", "y"]].to_numpy()
        # MDAnalysis uses single precision, and moves the corner of the box to the origin.
        found, wanted_ones = (it - it[0] for it in (moment.positions[:, :2], places))
        assert numpy.allclose(found, wanted_ones, rtol=1e-6, atol=1e-7) and moment.data["step"] == step
        metre = 1e10
        assert numpy.allclose(atoms.positions[:, :2], metre * places, rtol=1e-12, atol=1e-3)
        assert list(atoms.symbols) == [ELEMENTS[kind] for kind in grains["kind"]]
    if has_images(dump):
        check_images(dump, every, wanted)
    print(f"MDAnalysis {MDAnalysis.__version__} and ASE {ase.__version__} read {recording}")


def has_images(dump):
    with open(dump) as file:
        return any(line.endswith(" ix iy iz\n") for line in file)


def check_images(dump, every, wanted):
    """Check the image numbers in a periodic cell, from which a reader can unwrap the path of each grain."""
    universe = MDAnalysis.Universe(dump, format="LAMMPSDUMP", topology_format="LAMMPSDUMP", unwrap_images=True)
    ways = 0
    for moment, step in zip(universe.trajectory, wanted["step"]):
        grains = every[every["step"] == step]
        ways = max(ways, (grains["x_unwrapped"] - grains["x"]).abs().max())
        found, places = (it - it[0] for it in (moment.positions[:, 0], grains["x_unwrapped"].to_numpy()))
        assert numpy.allclose(found, places, rtol=1e-6, atol=1e-6)
    assert ways > 0, "no grain left its cell"


main(sys.argv[1])
