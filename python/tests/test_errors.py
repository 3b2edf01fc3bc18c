"""Tests that a refused value or file raises an exception with the message of the command line."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import as_arguments, run as program

import slump

REFUSED: list[dict[str, Any]] = [
    {"bond": -1},
    {"bond": "much"},
    {"bond": float("nan")},
    {"dt": 0},
    {"grains": 2.5},
    {"grains": 0},
    {"max_sweeps": -3},
    {"solver": "simplex"},
    {"warm_start": "perhaps"},
    {"scene": "plie"},
    {"scene": "cradle", "grains": 10},
    {"scene": "cradle", "start": 0.5},
    {"initial": "none.csv", "seed": 3},
    {"initial": "none.csv"},
    {"scene": "none.toml"},
    {"stepper": "dem", "push_out": True},
    {"preset": "weak"},
    {"debonding_distance": 0.2, "stepper": "range"},
]


@pytest.mark.parametrize("options", REFUSED, ids=str)
def test_sentences_are_those_of_the_command_line(tmp_path: Path, options: dict[str, Any]) -> None:
    done = program("--headless", "--frames", str(tmp_path / "out"), *as_arguments(options))
    assert done.returncode == 2, "refused"
    with pytest.raises(slump.Error) as refused:
        slump.Simulation(**options)
    # The two messages may only differ in how they write NaN.
    said = done.stderr.removeprefix("slump: ").strip().replace("is nan", "is NaN")
    assert str(refused.value) == said
    kind = OSError if "none." in str(options) and "seed" not in options else ValueError
    assert isinstance(refused.value, kind)


def test_unknown_names_are_told_with_those_that_there_are() -> None:
    with pytest.raises(TypeError) as refused:
        slump.Simulation(bnd=3)  # type: ignore[call-arg]
    assert str(refused.value).startswith("bnd is given, but must be one of scene, initial, initial_step, grains,")
    for name in slump.options():
        assert name in str(refused.value)
    sim = slump.Simulation()
    with pytest.raises(TypeError, match="scene is given, but must be one of stepper, bond"):
        sim.change(scene="pile")  # type: ignore[call-arg]


def test_what_is_no_value_at_all_is_told() -> None:
    with pytest.raises(TypeError, match=r"bond is \[1, 2\], but must be a number, a word, True or False"):
        slump.Simulation(bond=[1, 2])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="initial is <class 'int'>, but must be a file of discs, or"):
        slump.Simulation(initial=5)


STARTS: list[tuple[dict[str, Any], str]] = [
    ({"x": [1.0]}, "initial: the columns are x, but must be such that x, y and radius are there"),
    ({"x": [0.0], "y": [0.0, 1.0], "radius": [1.0]}, "initial: y has 2 rows, but must have 1, as x has"),
    ({"x": ["a"], "y": [0.0], "radius": [1.0]}, "initial[\"x\"] is <class 'list'>, but must be a list of numbers, one"),
    ({"x": [[0.0]], "y": [0.0], "radius": [1.0]}, "initial[\"x\"] is <class 'list'>, but must be a list of numbers"),
    ({"x": [0.0], "y": 0.0, "radius": [1.0]}, "initial[\"y\"] is <class 'float'>, but must be a list of numbers, one"),
    ({"x": [0.0], "y": ["0"], "radius": [1.0]}, "initial[\"y\"] is <class 'list'>, but must be a list of numbers, one"),
    ({"x": [0.0], "y": [0.0], "radius": [1.0], "time": 3.0}, "initial[\"time\"] is <class 'float'>, but must be a list"),
    ({"x": [0.0], "y": [0.0], "radius": [1.0], "id": 3}, "initial[\"id\"] is <class 'int'>, but must be a list of whole"),
    ({"x": [0.0], "y": [0.0], "radius": [1.0], "kind": [3]}, "initial[\"kind\"] is <class 'list'>, but must be a list of"),
    ({"x": [0.0], "y": [0.0], "radius": [1.0], "kind": 3}, "initial[\"kind\"] is <class 'int'>, but must be a list of"),
    ({"x": [0.0], "y": [0.0], "radius": [1.0], "Vx": [1.0]}, "initial: a column is Vx, but must be one of step, time, id"),
    ({"x": [0.0], "y": [float("nan")], "radius": [1.0]}, "initial: row 0: y is NaN, but must be finite"),
    ({"x": [0.0], "y": [0.0], "radius": [-1.0]}, "initial: row 0: radius is -1, but must be finite and > 0"),
    ({"x": [0], "y": [0], "radius": [1], "kind": ["cube"]}, "initial: row 0: kind is cube, but must be grain or fixed or"),
    ({"x": [0, 1], "y": [0, 1], "radius": [1, 1], "id": [4, 4]}, "initial: row 1: id is 4, but must be another than in"),
    ({"x": [0], "y": [0], "radius": [1], "mass": [-1]}, "initial: row 0: mass is -1 kg, but must be left out or finite and > 0"),
    ({"x": [0], "y": [0], "radius": [1], "mass": [1], "density": [2]}, "but must be left out where a mass is given"),
    ({"x": [0], "y": [0.01], "radius": [0.0025], "material": ["x"]}, "but must be left out where the scene lists no materials"),
    ({"x": [], "y": [], "radius": []}, "initial: holds no disc, but must hold at least one"),
    ({"x": [0, 0], "y": [0, 0], "radius": [0.0025, 0.0025]}, "m from that of grains[0], but must be at least 0.00125 m"),
]


@pytest.mark.parametrize("start, sentence", STARTS, ids=lambda part: part if isinstance(part, str) else "")
def test_a_start_that_is_none_is_told(start: dict[str, Any], sentence: str) -> None:
    with pytest.raises(slump.InputError) as refused:
        slump.Simulation(initial=start)
    assert sentence in str(refused.value)


def test_a_file_of_discs_that_is_none_is_refused_in_the_words_of_the_command_line(tmp_path: Path) -> None:
    sim = slump.Simulation("pile")
    sim.record(tmp_path / "data", formats=["csv", "parquet"])
    sim.step(1)
    sim.end_recording()
    lines = (tmp_path / "data" / "csv" / "grains.csv").read_text().splitlines(keepends=True)
    first = next(number for number, line in enumerate(lines) if not line.startswith("#"))
    names, row = lines[first].split(","), lines[first + 1].split(",")

    def file(name: str, **changes: str) -> Path:
        changed = [changes.get(column, value) for column, value in zip(names, row)]
        path = tmp_path / f"{name}.csv"
        path.write_text("".join([*lines[: first + 1], ",".join(changed), *lines[first + 2 :]]))
        return path

    without_radius = tmp_path / "without-radius.csv"
    without_radius.write_text("x,y\n0,0\n")
    for path, sentence in [
        (file("nan", x="NaN"), "x is NaN, but must be finite"),
        (file("duplicate", id="1"), "id is 1, but must be another than in line"),
        (file("negative", radius="-1"), "radius is -1, but must be finite and > 0"),
        (file("kind", kind="cube"), "kind is cube, but must be grain or fixed or lost"),
        (without_radius, "the header line is 'x,y', but must be one that names x, y and radius"),
        (tmp_path, "has no grains, but must be a file of discs"),
    ]:
        done = program("--headless", f"--frames={tmp_path / 'out'}", f"--initial={path}")
        with pytest.raises(slump.FileError) as refused:
            slump.Simulation(initial=path)
        assert sentence in str(refused.value)
        assert done.returncode == 2 and str(refused.value) == done.stderr.removeprefix("slump: ").strip()
    # The program `slump` may have been built without Parquet, so this message is not compared with it.
    with pytest.raises(slump.FileError, match="the columns are .*nx, ny.*, but must be such that x, y and radius are there"):
        slump.Simulation(initial=tmp_path / "data" / "contacts" / "part-00000.parquet")
    part = tmp_path / "data" / "grains" / "part-00000.parquet"
    part.write_bytes(part.read_bytes()[:-50])
    with pytest.raises(slump.FileError, match="part-00000.parquet: .*, but must be"):
        slump.Simulation(initial=tmp_path / "data")


SCENES: list[tuple[dict[str, Any], str]] = [
    ({}, "scene: missing field `name`, which must be given in a scene as slump.scene(name) gives it"),
    ({"grains": []}, "grains is 0, but must be at least one disc"),
    ({"mean_diameter": -1.0}, "mean_diameter is -1, but must be a finite number > 0 m"),
    ({"colour": "red"}, "scene: unknown field `colour`, but must be one of `name`, "),
    ({"gravity": 9.8}, "scene: invalid type: floating point `9.8`, but must be "),
]


@pytest.mark.parametrize("change, sentence", SCENES, ids=str)
def test_a_scene_that_is_none_is_told(change: dict[str, Any], sentence: str) -> None:
    described = {**slump.scene("collision"), **change} if change else {}
    with pytest.raises(slump.InputError) as refused:
        slump.Simulation(described)
    assert sentence in str(refused.value)


def test_a_scene_that_is_given_has_no_other_start() -> None:
    with pytest.raises(slump.InputError, match="scene is a dictionary, but must be pile where grains, box-width, seed, deposition or sizes are given"):
        slump.Simulation(slump.scene("pile"), grains=20)


def test_a_change_that_is_refused_changes_nothing() -> None:
    sim = slump.Simulation(bond=20)
    with pytest.raises(slump.InputError, match="dt is 0, but must be a finite number of seconds > 0"):
        sim.change(bond=50, dt=0)
    with pytest.raises(slump.InputError, match="mu is -1, but must be a finite number ≥ 0"):
        sim.mu = -1
    assert (sim.bond, sim.mu) == (20, 0.5)
    with pytest.raises(slump.InputError, match="steps is -1, but must be a whole number"):
        sim.step(-1)
    for until in [-1.0, np.inf, 1e300]:
        with pytest.raises(slump.InputError, match="until is|dt is"):
            sim.run(until=until)
    assert sim.steps == 0


def test_a_state_that_is_no_longer_finite_is_told_and_left_for_looking_at() -> None:
    scene = slump.scene("column", stepper="dem", substeps=1, dt=1.0)
    scene["gravity"]["acceleration"] = [0.0, -1e150]
    sim = slump.Simulation(scene)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", slump.SlumpWarning)
        with pytest.raises(slump.NotFiniteError, match="the state is no longer finite at step"):
            sim.step(1000)
    assert not np.isfinite(sim.observables["kinetic_energy"])
    assert sim.positions.shape == (20, 2) and len(sim.history["step"]) == sim.steps > 0


def blown_up(way: str) -> slump.Simulation:
    """Return a simulation whose last step raised a NotFiniteError."""
    if way == "pulled apart":
        scene = slump.scene("column", stepper="dem", substeps=1, dt=1.0)
        scene["gravity"]["acceleration"] = [0.0, -1e150]
        sim = slump.Simulation(scene)
    else:
        sim = slump.Simulation("pile", bond=20, grains=12, box_width=4.0)
        sim.step(3)
        sim.set_velocities(sim.velocities + 1e300)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", slump.SlumpWarning)
        with pytest.raises(slump.NotFiniteError):
            sim.step(1000)
    return sim


AFTER_THE_END: dict[str, Any] = {
    **{name: lambda sim, _, name=name: getattr(sim, name) for name in dir(slump.Simulation) if name[0] != "_"},
    "step": lambda sim, _: sim.step(),
    "run": lambda sim, _: sim.run(until=sim.time + 3 * sim.dt),
    "change": lambda sim, _: sim.change(dt=1e-4, stepper="range"),
    "copy": lambda sim, _: sim.copy().step(),
    "save": lambda sim, folder: sim.save(folder / "run.slump"),
    "pickle": lambda sim, _: pickle.dumps(sim),
    "set_positions": lambda sim, _: sim.set_positions(sim.positions),
    "set_velocities": lambda sim, _: sim.set_velocities(0 * sim.velocities),
    "add_grain": lambda sim, _: sim.add_grain(0.0, 5.0, 0.5 * sim.mean_diameter),
    "remove_grain": lambda sim, _: sim.remove_grain(0),
    "body_forces": lambda sim, _: setattr(sim, "body_forces", np.zeros_like(sim.positions)),
    "begin_pairs": lambda sim, _: (sim.begin_pairs(), sim.pairs),
    "fields": lambda sim, _: sim.fields(),
    "record": lambda sim, folder: sim.record(folder, formats=["csv", "parquet", "vtk", "ovito", "fields"]),
    "end_recording": lambda sim, _: sim.end_recording(),
    "next_problem": lambda sim, _: slump.solve(sim.next_problem()),
    "forget_history": lambda sim, _: sim.forget_history(),
    "_repr_html_": lambda sim, _: sim._repr_html_(),
    "repr": lambda sim, _: repr(sim),
}


@pytest.mark.filterwarnings("ignore::slump.SlumpWarning")
@pytest.mark.parametrize("way", ["pulled apart", "thrown"])
def test_all_can_be_asked_of_a_state_that_is_no_longer_finite(tmp_path: Path, way: str) -> None:
    start = blown_up(way)
    refused = {}
    for name, ask in AFTER_THE_END.items():
        sim = start.copy()
        try:
            ask(sim, tmp_path / name)
            sim.end_recording()
        except slump.Error as error:
            refused[name] = str(error)
    for name in ("fields", "save", "pickle", "record"):
        assert "state is no longer finite, but must be finite" in refused[name]
    assert "the state is no longer finite at step" in refused["step"]
    assert set(refused) <= {"fields", "save", "pickle", "record", "step", "run", "copy", "next_problem", "set_positions", "add_grain", "pairs"}
    assert not (tmp_path / "record").exists()


def test_what_goes_wrong_and_goes_on_is_warned_of_once() -> None:
    sim = slump.Simulation("pile", bond=20, dt=2e-2)
    with pytest.warns(slump.SlumpWarning) as told:
        sim.step(20)
    texts = [str(warning.message) for warning in told]
    assert len(texts) == len(sim.alarms) == 2
    assert "overlaps by more than one step's travel" in texts[0]
    assert "a grain has left the world" in texts[1]
    sim.step(20)
