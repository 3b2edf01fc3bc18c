"""Reads the dumps with OVITO, and compares particles, types, radii, frames and bonds with the CSV files."""

import sys

import numpy
import ovito
from ovito.io import import_file
from ovito.modifiers import LoadTrajectoryModifier

from recording import OF_FRAME, codes, flags, frames, kinds, table

KINDS = ["grain", "fixed", "lost"]
# OVITO's names of columns of grains. All other columns have Slump's names.
PROPERTIES = {"id": "Particle Identifier", "mass": "Mass", "coordination": "coordination_number"}
MAPPED = {"kind", "x", "y", "vx", "vy", "omega", "radius"}
KINDS_OF_J = ["grain", "fixed", "boundary"]
STATUSES = ["open", "stick", "slip"]


def main(recording):
    every_grain, every_contact, wanted = table(recording, "grains"), table(recording, "contacts"), frames(recording)
    pipeline = import_file(f"{recording}/ovito/grains.dump")
    assert pipeline.source.num_frames == len(wanted)
    bonds = LoadTrajectoryModifier()
    # Columns in the order of the file's head: the first two columns name the particles of a bond.
    columns = ["Particle Identifiers.1", "Particle Identifiers.2", *of_bonds(every_contact)]
    bonds.source.load(f"{recording}/ovito/contacts.dump", columns=columns)
    assert bonds.source.num_frames == len(wanted)
    pipeline.modifiers.append(bonds)
    for number, (step, _, _) in enumerate(wanted.itertuples(index=False)):
        data = pipeline.compute(number)
        assert data.attributes["Timestep"] == step
        assert not any(data.cell.pbc)
        grains = every_grain[every_grain["step"] == step]
        check_particles(data.particles, grains, flags_of(recording, "grains"))
        contacts = every_contact[every_contact["step"] == step]
        check_bonds(data.particles, contacts[contacts["kind_j"] != "boundary"], flags_of(recording, "contacts"))
    print(f"OVITO {ovito.version_string} reads {recording}")


def flags_of(recording, name):
    return {column for column, kind in kinds(recording, name).items() if kind == "flag"}


def of_bonds(contacts):
    return [column for column in contacts.columns if column not in {*OF_FRAME, "id_i", "id_j", "name_j"}]


def check_particles(particles, grains, all_flags):
    assert particles.count == len(grains)
    types = particles.particle_types
    assert {kind.name: kind.id for kind in types.types}.items() <= {"H": 1, "He": 2, "Li": 3}.items()
    assert (types[...] - 1 == codes(KINDS, grains["kind"])).all()
    assert equal(particles.positions[:, :2], grains[["x", "y"]])
    assert equal(particles["Velocity"][:, :2], grains[["vx", "vy"]])
    assert equal(particles["Angular Velocity"][:, 2], grains["omega"])
    # OVITO stores radii in single precision.
    assert equal(particles["Radius"][...], grains["radius"], relative=1.2e-7)
    for column in grains.columns.difference([*OF_FRAME, *MAPPED]):
        wanted = flags(grains[column]) if column in all_flags else grains[column]
        assert equal(particles[PROPERTIES.get(column, column)][...], wanted), column


def check_bonds(particles, contacts, all_flags):
    bonds = particles.bonds
    assert bonds.count == len(contacts) > 0
    ids = particles["Particle Identifier"][...][bonds.topology[...]]
    assert (ids == contacts[["id_i", "id_j"]].to_numpy()).all()
    words = {"kind_j": KINDS_OF_J, "status": STATUSES}
    for column in of_bonds(contacts):
        wanted = flags(contacts[column]) if column in all_flags else contacts[column]
        wanted = codes(words[column], wanted) if column in words else wanted
        assert equal(bonds[column][...], wanted), column


def equal(found, wanted, relative=5e-16):
    """Return true if numbers are equal except for the last bit: OVITO does not read decimal numbers more precisely."""
    found, wanted = numpy.asarray(found), numpy.asarray(wanted)
    return found.shape == wanted.shape and numpy.allclose(found, wanted, rtol=relative, atol=0, equal_nan=True)


main(sys.argv[1])
