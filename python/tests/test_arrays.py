"""Tests of arrays: their shapes and types, and whether they agree with each other and with mechanics."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest

import slump

TABLES = {
    "grains": {
        **dict.fromkeys(["step", "id"], np.int64),
        **dict.fromkeys(["time", "x", "y", "angle", "vx", "vy", "omega", "radius", "mass", "x_unwrapped", "y_unwrapped"], np.float64),
        **dict.fromkeys(["coordination", "pressure", "solid_fraction"], np.float64),
        **dict.fromkeys(["kind", "material"], np.str_),
    },
    "contacts": {
        **dict.fromkeys(["step", "id_i", "id_j", "age"], np.int64),
        **dict.fromkeys(["time", "x", "y", "nx", "ny", "gap", "normal_force", "tangential_force", "stretch"], np.float64),
        **dict.fromkeys(["fx", "fy"], np.float64),
        **dict.fromkeys(["kind_j", "name_j", "status"], np.str_),
        "bond": np.bool_,
    },
}


@pytest.fixture(scope="module", params=["moreau", "range"])
def sim(request: pytest.FixtureRequest) -> slump.Simulation:
    sim = slump.Simulation("pile", bond=30, dt=5e-4, stepper=request.param)
    sim.step(150)
    return sim


@pytest.mark.parametrize("name", TABLES)
def test_tables_have_their_columns(sim: slump.Simulation, name: str) -> None:
    table = getattr(sim, name)
    rows = {"grains": 257, "contacts": sim.observables["contacts"]}[name]
    for column, kind in TABLES[name].items():
        assert table[column].shape == (rows,), column
        assert np.issubdtype(table[column].dtype, kind), column
    frame = pd.DataFrame(table)
    assert len(frame) == rows and set(frame["step"]) == {150}


def test_arrays_are_the_columns_of_grains(sim: slump.Simulation) -> None:
    grains = pd.DataFrame(sim.grains).query("kind == 'grain'")
    count = len(grains)
    assert sim.positions.shape == sim.velocities.shape == (count, 2) == (138, 2)
    np.testing.assert_array_equal(sim.positions, grains[["x", "y"]])
    np.testing.assert_array_equal(sim.velocities, grains[["vx", "vy"]])
    for name, column in [("angles", "angle"), ("angular_velocities", "omega"), ("radii", "radius"), ("masses", "mass")]:
        assert getattr(sim, name).dtype == np.float64
        np.testing.assert_array_equal(getattr(sim, name), grains[column])
    np.testing.assert_allclose(sim.masses, np.pi * sim.radii**2)
    fixed = pd.DataFrame(sim.grains).query("kind == 'fixed'")
    assert fixed["mass"].isna().all() and (fixed[["vx", "vy", "omega"]] == 0).all(axis=None)


def test_forces_are_those_of_the_table_and_move_the_grains(sim: slump.Simulation) -> None:
    other = sim.copy()
    before = other.velocities
    other.step(1)
    contacts, forces = other.contacts, other.forces
    np.testing.assert_array_equal(forces, np.stack([contacts["fx"], contacts["fy"]], axis=1))
    # Newton's law: m Δv/Δt = m g + Σ f. The contact force on grain j is the opposite of the force on grain i.
    total = other.masses[:, None] * [0.0, -other.gravity]
    np.add.at(total, contacts["id_i"], forces)
    between = contacts["kind_j"] == "grain"
    assert 0 < between.sum() < len(between)
    np.add.at(total, contacts["id_j"][between], -forces[between])
    change = other.masses[:, None] * (other.velocities - before) / other.dt
    np.testing.assert_allclose(change, total, atol=1e-9 * np.abs(forces).max())


def test_contacts_name_what_they_are_with() -> None:
    sim = slump.Simulation("moving-walls")
    sim.step(300)
    contacts = pd.DataFrame(sim.contacts)
    walls = contacts[contacts["kind_j"] == "boundary"]
    assert set(walls["name_j"]) == {"half-space 0", "piston 1", "piston 2"}
    assert set(walls["id_j"]) == {18, 19, 20} and len(sim.grains["x"]) == 18
    assert set(contacts[contacts["kind_j"] == "grain"]["name_j"]) == {""}
    places = [boundary["point"][0] for boundary in sim.boundaries]
    assert [boundary["shape"] for boundary in sim.boundaries] == ["half-space", "piston", "piston"]
    assert places[1] > slump.Simulation("moving-walls").boundaries[1]["point"][0], "it moves in"


def test_bonds_are_told_where_the_law_has_them(sim: slump.Simulation) -> None:
    contacts = sim.contacts
    if sim.stepper == "range":
        assert contacts["bond"].any() and not np.isnan(contacts["stretch"][contacts["bond"]]).any()
    else:
        assert not contacts["bond"].any() and np.isnan(contacts["stretch"]).all()


def test_observables_are_the_last_row_of_history(sim: slump.Simulation) -> None:
    history, observables = sim.history, sim.observables
    assert list(history) == list(observables)
    for name, column in history.items():
        assert column.shape == (150,) and (column[-1] == observables[name] or np.isnan(observables[name]))
    assert history["converged"].dtype == np.bool_ and history["sweeps"].dtype == np.int64
    other = sim.copy()
    other.forget_history()
    assert other.history["slump"].shape == (0,) and list(other.history) == list(history)
    other.step(2)
    assert list(other.history["step"]) == [151, 152]


def test_measures_are_those_of_the_contacts_and_grains(sim: slump.Simulation) -> None:
    measures, grains, contacts = sim.measures, pd.DataFrame(sim.grains), pd.DataFrame(sim.contacts)
    of_grains = grains.query("kind == 'grain'")
    assert measures["step"] == 150 and measures["grains"] == len(of_grains) == 138
    ends = contacts["id_i"].tolist() + contacts["id_j"][contacts["kind_j"] == "grain"].tolist()
    touching = np.bincount(ends, minlength=138)
    np.testing.assert_array_equal(of_grains["coordination"], touching)
    assert measures["coordination"] == pytest.approx(touching.mean())
    assert grains.query("kind == 'fixed'")["pressure"].isna().all()
    histograms = pd.DataFrame(sim.histograms)
    assert set(histograms) >= {"step", "time", "quantity", "from", "to", "count"}
    assert (histograms["count"] > 0).any() and (histograms["to"] > histograms["from"]).all()


def test_arrays_are_copies(sim: slump.Simulation) -> None:
    other = sim.copy()
    kept = other.positions
    was = kept.copy()
    other.step(10)
    np.testing.assert_array_equal(kept, was)
    grains = other.grains
    for array in (kept, other.radii, other.forces, *grains.values(), *other.contacts.values()):
        with pytest.raises(ValueError, match="read-only"):
            array[:1] = array[:1]


def test_grains_are_put_elsewhere_and_pushed(sim: slump.Simulation) -> None:
    other = sim.copy()
    up = other.positions + [0.0, 50.0]
    other.set_positions(up)
    other.set_velocities(np.zeros_like(up, dtype=np.float32))
    np.testing.assert_array_equal(other.positions, up)
    assert not other.velocities.any()
    bond, secs = other.bond, other.dt
    other.bond = 0.0
    other.step(1)
    assert other.observables["lost_grains"] == sim.observables["lost_grains"]
    low = other.positions[:, 1].argmin()
    assert other.velocities[low, 1] == pytest.approx(-secs * other.gravity) or other.observables["contacts"] > 0
    assert (other.positions[:, 1] > 45.0).all() and bond > 0
    for name, given, sentence in [
        ("positions", up[:-1], r"positions.shape is \(137, 2\), but must be \(138, 2\), one row of two numbers per grain"),
        ("positions", up.T, r"positions.shape is \(2, 138\), but must be \(138, 2\)"),
        ("positions", np.zeros_like(up), r"grains\[\d+\].position is "),
        ("velocities", np.full_like(up, np.nan), r"velocities\[0\] is \[NaN, NaN\], but must be finite"),
    ]:
        with pytest.raises(slump.InputError, match=sentence):
            getattr(other, f"set_{name}")(given)


def test_a_grain_comes_in_motion_and_goes(sim: slump.Simulation) -> None:
    other, alone = sim.copy(), sim.copy()
    other.add_grain(0.0, 1.0, other.mean_diameter / 2, vx=0.25)
    assert other.positions.shape == (139, 2) and list(other.velocities[-1]) == [0.25, 0.0]
    np.testing.assert_array_equal(other.forces, sim.forces)
    other.remove_grain(138)
    for run in (other, alone):
        run.step(5)
    np.testing.assert_array_equal(other.positions, alone.positions)
    low = sim.positions[0]
    for act, sentence in [
        (lambda: other.add_grain(*low, 0.001), "place of a new grain is on another one, but must be free"),
        (lambda: other.add_grain(0.0, 1.0, 1.0), "diameter of a new grain is "),
        (lambda: other.add_grain(0.0, 1.0, 0.002, vy=np.nan), r"velocity of a new grain is \[0, NaN\], but must be finite"),
        (lambda: other.remove_grain(138), "grain is 138, but must be below 138, the number of grains"),
        (lambda: other.remove_grain(-1), "grain is -1, but must be from 0 to 137"),
    ]:
        with pytest.raises(slump.InputError, match=sentence):
            act()
    assert len(other.radii) == 138
    # After a removal every other grain keeps its id, and a new grain gets an id that no body has had.
    ids = other.grains["id"]
    others = ids.max()
    other.remove_grain(1)
    other.add_grain(0.0, 1.0, other.mean_diameter / 2)
    other.step(1)
    np.testing.assert_array_equal(other.grains["id"][:137], np.delete(ids[:138], 1))
    assert other.grains["id"][137] > others and set(other.contacts["id_i"]) <= set(other.grains["id"])


def test_body_forces_are_held_and_close_energies() -> None:
    sim = slump.Simulation("pile", bond=5, dt=5e-4)
    assert sim.body_forces.shape == sim.positions.shape and not sim.body_forces.any()
    forces = sim.masses[:, None] * [4.0, 1.0]
    sim.body_forces = forces
    sim.step(30)
    np.testing.assert_array_equal(sim.body_forces, forces)
    history = sim.history
    works = sum(history[f"{name}_work"] for name in ("normal", "tangential", "gravity"))
    np.testing.assert_allclose(np.diff(history["kinetic_energy"]), works[1:], atol=1e-12 * history["kinetic_energy"].max())
    plain = slump.Simulation("pile", bond=5, dt=5e-4)
    plain.step(30)
    momentum = (sim.masses[:, None] * (sim.velocities - plain.velocities)).sum(axis=0)
    assert momentum[0] > 0.1 * sim.time * forces[:, 0].sum()
    runs = [pickle.loads(pickle.dumps(sim)), sim.copy(), copy.deepcopy(sim), sim]
    for run in runs:
        run.step(10)
        np.testing.assert_array_equal(run.positions, sim.positions if run is sim else runs[0].positions)
    sim.remove_grain(7)
    np.testing.assert_array_equal(sim.body_forces, np.delete(forces, 7, axis=0))
    for given, sentence in [
        (forces, r"body_forces.shape is \(138, 2\), but must be \(137, 2\), one row of two numbers per grain"),
        (forces[:, :1], r"body_forces.shape is \(138, 1\), but must be \(137, 2\)"),
        (np.full((137, 2), np.nan), r"body_forces\[0\] is \[NaN, NaN\], but must be finite"),
    ]:
        with pytest.raises(slump.InputError, match=sentence):
            sim.body_forces = given
    sim.body_forces = np.zeros((137, 2))
    assert not sim.body_forces.any()


VECTORS: list[tuple[Any, str]] = [
    ([0, -1], "{name}.shape is (2,), but must be (138, 2), one row of two numbers per grain"),
    (1.5, "{name}.shape is (), but must be (138, 2), one row of two numbers per grain"),
    (np.zeros((138, 2, 1)), "{name}.shape is (138, 2, 1), but must be (138, 2), one row of two numbers per grain"),
    (pl.DataFrame({"x": [1.0], "y": [2.0]}), "{name}.shape is (1, 2), but must be (138, 2), one row"),
    (None, "{name} is <class 'NoneType'>, but must be an array of numbers of shape (138, 2), one row"),
    ("up", "{name} is <class 'str'>, but must be an array of numbers of shape (138, 2), one row"),
    ([[0.0, 1.0], [2.0]], "{name} is <class 'list'>, but must be an array of numbers of shape (138, 2), one row"),
    (iter([1.0]), "{name} is <class 'list_iterator'>, but must be an array of numbers of shape (138, 2), one row"),
    (np.zeros((138, 2), dtype=complex), "{name} is <class 'numpy.ndarray'>, but must be an array of numbers of shape"),
    (np.full((138, 2), "1"), "{name} is <class 'numpy.ndarray'>, but must be an array of numbers of shape"),
    (np.ma.masked_all((138, 2)), "{name} is <class 'numpy.ma.MaskedArray'>, but must be an array of numbers of shape"),
]


@pytest.mark.parametrize("given, sentence", VECTORS, ids=lambda part: type(part).__name__)
def test_vectors_of_another_form_are_told(given: Any, sentence: str) -> None:
    sim = slump.Simulation("pile")
    setters = {
        "positions": sim.set_positions,
        "velocities": sim.set_velocities,
        "body_forces": lambda forces: setattr(sim, "body_forces", forces),
    }
    for name, setter in setters.items():
        with pytest.raises(slump.InputError) as refused:
            setter(given)
        assert str(refused.value).startswith(sentence.format(name=name))


def test_vectors_come_in_any_layout() -> None:
    sim = slump.Simulation("pile")
    speeds = np.arange(276.0).reshape(138, 2)
    wide = np.zeros((276, 4))
    wide[::2, 1:3] = speeds
    layouts = [np.asfortranarray(speeds), wide[::2, 1:3], speeds.astype(np.float32), speeds.astype(">f8"), speeds.astype(int),
               speeds.tolist(), pd.DataFrame(speeds), pl.DataFrame(speeds), speeds.astype(object)]  # fmt: skip
    for layout in layouts:
        sim.set_velocities(np.zeros_like(speeds))
        sim.set_velocities(layout)
        np.testing.assert_array_equal(sim.velocities, speeds)


def test_pairs_have_the_means_since_they_were_begun(sim: slump.Simulation) -> None:
    other = sim.copy()
    with pytest.raises(slump.InputError, match=r"pairs is not begun, but must be asked for after begin_pairs\(\)"):
        other.pairs
    other.begin_pairs()
    assert other.pairs["fx"].shape == (0,)
    before, sums = other.velocities.copy(), np.zeros((138, 2))
    other.step(40)
    pairs = other.pairs
    assert pairs["mean_time"] == pytest.approx(40 * other.dt)
    np.add.at(sums, pairs["id_i"], np.stack([pairs["fx"], pairs["fy"]], axis=1))
    between = pairs["kind_j"] == "grain"
    np.add.at(sums, pairs["id_j"][between], -np.stack([pairs["fx"], pairs["fy"]], axis=1)[between])
    change = other.masses[:, None] * ((other.velocities - before) / (40 * other.dt) + [0.0, other.gravity])
    np.testing.assert_allclose(change, sums, atol=1e-9 * np.abs(sums).max())
    parted = len(pairs["fx"]) - len(other.contacts["fx"])
    assert parted > 0 or (parted == 0 and other.stepper == "range"), "bonds of that law hold"


def test_fields_are_exact_in_sum(sim: slump.Simulation) -> None:
    fields, measures = sim.fields(), sim.measures
    assert fields["width"] == sim.mean_diameter
    x, y = fields["x"], fields["y"]
    area = (x[1] - x[0]) * (y[1] - y[0])
    assert fields["density"].shape == (len(y), len(x))
    assert area * fields["density"].sum() == pytest.approx(sim.masses.sum(), rel=1e-12)
    momentum = (sim.masses[:, None] * sim.velocities).sum(axis=0)
    np.testing.assert_allclose(area * fields["momentum"].sum(axis=(0, 1)), momentum, rtol=1e-10)
    stress = [[measures[f"stress_{row}{column}"] for column in "xy"] for row in "xy"]
    found = area * fields["contact_stress"].sum(axis=(0, 1)) / measures["area"]
    np.testing.assert_allclose(found, stress, atol=1e-11 * np.abs(stress).max())
    middle = (fields["density"] * y[:, None]).sum() / fields["density"].sum()
    assert middle == pytest.approx(np.average(sim.positions[:, 1], weights=sim.masses), abs=0.01 * fields["width"])
    wide = sim.fields(width=3 * sim.mean_diameter)
    assert wide["density"].size < fields["density"].size
    with pytest.raises(slump.InputError, match="width is -1, but must be a finite length > 0 in m"):
        sim.fields(width=-1)


def test_a_table_of_grains_is_a_start(sim: slump.Simulation) -> None:
    for table in (sim.grains, pd.DataFrame(sim.grains)):
        other = slump.Simulation(initial=table)
        np.testing.assert_array_equal(other.positions, sim.positions)
        np.testing.assert_array_equal(other.angular_velocities, sim.angular_velocities)


def test_a_table_without_rows_has_all_columns() -> None:
    sim = slump.Simulation("bounce")
    sim.step(1)
    assert sim.observables["contacts"] == 0 and sim.forces.shape == (0, 2)
    for column, kind in TABLES["contacts"].items():
        assert sim.contacts[column].shape == (0,) and np.issubdtype(sim.contacts[column].dtype, kind), column


def test_masses_of_a_start_are_used() -> None:
    start = {"x": [0.0, 0.02], "y": [0.01, 0.01], "radius": [0.0025, 0.0025], "mass": [2.0, 3.0]}
    assert list(slump.Simulation(initial=start).grains["mass"][:2]) == [2.0, 3.0]
    del start["mass"]
    start["density"] = [2.0, 4.0]
    masses = slump.Simulation(initial=start).grains["mass"]
    assert masses[1] == 2.0 * masses[0] == pytest.approx(4.0 * math.pi * 0.0025**2)
