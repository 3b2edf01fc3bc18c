"""Tests of runs that are saved and resumed."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
from command_line import as_arguments
from command_line import run as program

import slump

RUNS = [
    {"bond": 30, "dt": 1e-3},
    {"bond": 30, "dt": 1e-3, "stepper": "range"},
    {"scene": "moving-walls", "solver": "nncg"},
]


def told(sim: slump.Simulation) -> list[object]:
    """Return the names and bytes of all grains, contacts and observables of a simulation."""
    tables = [sim.grains, sim.contacts, {name: [value] for name, value in sim.observables.items()}]
    return [(name, np.asarray(column).tobytes()) for table in tables for name, column in table.items()]


@pytest.mark.parametrize("options", RUNS, ids=str)
@pytest.mark.filterwarnings("ignore::slump.SlumpWarning")
def test_a_saved_run_goes_on_bit_for_bit(tmp_path: Path, options: dict[str, object]) -> None:
    sim = slump.Simulation(**options)  # type: ignore[arg-type]
    sim.step(40)
    sim.save(tmp_path / "run.slump")
    other = slump.Simulation(restart=tmp_path / "run.slump")
    assert told(other) == told(sim) and other.settings == sim.settings and other.name == sim.name
    assert other.history["step"].shape == (0,)
    for run in (sim, other):
        run.step(40)
    assert other.steps == 80 and told(other) == told(sim)
    assert list(other.history["step"]) == list(range(41, 81))
    other.save(str(tmp_path / "other.slump"))
    sim.save(tmp_path / "run.slump")
    assert (tmp_path / "other.slump").read_bytes() == (tmp_path / "run.slump").read_bytes()


def test_a_saved_run_is_that_of_the_command_line_in_both_directions(tmp_path: Path) -> None:
    options = {"bond": 30, "dt": 1e-3}
    here, there, whole = (tmp_path / f"{name}.slump" for name in ("here", "there", "whole"))
    sim = slump.Simulation(**options)  # type: ignore[arg-type]
    sim.run(until=0.03)
    sim.save(here)
    done = program("--headless", f"--restart={here}", f"--save={there}", "--duration=0.06", "--bond=5")
    assert done.returncode == 0, done.stderr
    of_program = slump.Simulation(restart=there)
    sim.bond = 5
    sim.run(until=0.06)
    assert of_program.steps == 60 and told(of_program) == told(sim)
    done = program("--headless", f"--save={whole}", "--duration=0.03", *as_arguments(options))
    assert done.returncode == 0, done.stderr
    # The saved files are equal, so the statistics over all steps are equal, too.
    other = slump.Simulation(duration=0.03, **options)  # type: ignore[arg-type]
    other.run()
    other.save(here)
    assert here.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize("options", RUNS, ids=str)
@pytest.mark.filterwarnings("ignore::slump.SlumpWarning")
def test_a_pickle_goes_on_bit_for_bit(options: dict[str, object]) -> None:
    sim = slump.Simulation(**options)  # type: ignore[arg-type]
    sim.step(40)
    other = pickle.loads(pickle.dumps(sim))
    assert told(other) == told(sim) and other.settings == sim.settings and other.name == sim.name
    for run in (sim, other):
        run.step(40)
    assert other.steps == 80 and told(other) == told(sim)


def test_a_notebook_shows_a_few_numbers() -> None:
    scene = slump.scene("cradle")
    scene["name"] = "a<b"
    shown = slump.Simulation(scene)._repr_html_()
    assert "<caption>a&lt;b</caption>" in shown and "<td>steps</td><td>0</td>" in shown


def test_options_change_a_run_that_goes_on(tmp_path: Path) -> None:
    file = tmp_path / "run.slump"
    sim = slump.Simulation("pile", bond=20, dt=1e-3)
    sim.step(20)
    sim.save(file)
    other = slump.Simulation(restart=file, bond=50, stepper="range", duration=3.0)
    assert (other.bond, other.stepper, other.dt, other.duration, other.steps) == (50, "range", 1e-3, 3.0, 20)
    for start in [{"scene": "pile"}, {"initial": file}, {"initial": sim.grains}, {"grains": 30}, {"initial_step": 3}]:
        with pytest.raises(slump.InputError, match="restart is given, but must be left out where scene, initial, initial-step"):
            slump.Simulation(restart=file, **start)  # type: ignore[arg-type]
    with pytest.raises(slump.InputError, match="bond is -1, but must be"):
        slump.Simulation(restart=file, bond=-1)


def test_a_saved_run_is_a_start(tmp_path: Path) -> None:
    sim = slump.Simulation("pile", bond=20, dt=1e-3)
    sim.step(20)
    sim.save(tmp_path / "run.slump")
    other = slump.Simulation(initial=tmp_path / "run.slump", stepper="range")
    assert other.time == 0.0 and other.stepper == "range"
    np.testing.assert_array_equal(other.positions, sim.positions)
    np.testing.assert_array_equal(other.velocities, sim.velocities)


def test_a_file_that_is_no_saved_run_is_refused_in_the_words_of_the_command_line(tmp_path: Path) -> None:
    good = tmp_path / "good.slump"
    slump.Simulation("cradle").save(good)
    content = good.read_bytes()
    line, _, rest = content.partition(b"\n")
    magic, layout, version, *others = line.split(b" ")
    damaged = bytearray(content)
    damaged[-40] ^= 1
    files = {
        "cut": (content[:-100], "has been cut: "),
        "damaged": (bytes(damaged), "is damaged: its checksum"),
        "other-version": (b" ".join([magic, layout, b"0.0.9", *others]) + b"\n" + rest, "is of version 0.0.9 of the program"),
        "other-layout": (b" ".join([magic, b"0", version, *others]) + b"\n" + rest, "format 0, but must be of the one"),
        "text": (b"x,y,radius\n0,0,1\n", "holds no state of a run, but must be a state that --save"),
        "empty": (b"", "holds no state of a run"),
        "missing": (None, "No such file or directory"),
    }
    for name, (found, sentence) in files.items():
        file = tmp_path / f"{name}.slump"
        if found is not None:
            file.write_bytes(found)
        done = program("--headless", f"--restart={file}", f"--save={tmp_path / 'out'}", "--duration=5")
        with pytest.raises(slump.FileError) as refused:
            slump.Simulation(restart=file)
        assert sentence in str(refused.value)
        assert done.returncode == 2 and str(refused.value) == done.stderr.removeprefix("slump: ").strip()


def test_what_cannot_be_saved_is_told_and_leaves_what_is_there(tmp_path: Path) -> None:
    with pytest.raises(slump.FileError, match="No such file or directory"):
        slump.Simulation("cradle").save(tmp_path / "none" / "run.slump")
    file = tmp_path / "run.slump"
    file.write_text("before")
    scene = slump.scene("column", stepper="dem", substeps=1, dt=1.0)
    scene["gravity"]["acceleration"] = [0.0, -1e150]
    sim = slump.Simulation(scene)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", slump.SlumpWarning)
        with pytest.raises(slump.NotFiniteError):
            sim.step(1000)
    with pytest.raises(slump.InputError, match="state is no longer finite, but must be finite where it is saved"):
        sim.save(file)
    assert file.read_text() == "before"


def test_what_was_warned_of_before_is_not_warned_of_again(tmp_path: Path) -> None:
    sim = slump.Simulation("pile", bond=20, dt=2e-2)
    with pytest.warns(slump.SlumpWarning) as told:
        sim.step(20)
    assert "overlaps by more than one step's travel" in str(told[0].message)
    sim.save(tmp_path / "run.slump")
    other = slump.Simulation(restart=tmp_path / "run.slump")
    assert other.alarms == sim.alarms != []
    other.step(20)
