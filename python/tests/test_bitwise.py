"""Tests that the same options give the trajectory of the command line, bit for bit."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import ROOT, as_arguments, run as program

import slump

SCENE_FILE = str(ROOT / "assets" / "scenes" / "hourglass.toml")

RUNS: list[dict[str, Any]] = [
    {"bond": 50, "dt": 5e-4, "until": 0.05},
    {"bond": 20, "dt": 1e-3, "rho": 0.2, "cone": "compressive", "solver": "newton", "until": 0.05},
    {"bond": 8.25, "dt": 1e-3, "stepper": "range", "until": 0.05},
    {"bond": 20, "dt": 1e-3, "stepper": "dem", "until": 0.02},
    {"stepper": "tgs-soft", "substeps": 6, "until": 0.05},
    {"solver": "nsgs-parallel", "until": 0.05},
    {"grains": 40, "box_width": 8.0, "seed": 11, "bond": 0, "until": 0.05},
    {"scene": "cradle", "start": 7.5, "dt": 4e-3, "until": 1.0},
    {"scene": "collision", "until": 0.5},
    {"scene": "moving-walls", "solver": "nncg", "until": 0.1},
    {"scene": "thin-wall", "preset": "robust", "until": 0.05},
    {"scene": SCENE_FILE, "until": 0.02},
]


def rows(folder: Path, options: dict[str, Any], until: float) -> dict[str, list[str]]:
    """Run the command line with these options. Return the columns of its file `observables.csv` as text."""
    pictures = ["--headless", "--frames", str(folder), "--times", str(until), "--size", "8x8", "--renderer", "cpu"]
    done = program(*pictures, *as_arguments(options))
    assert done.returncode == 0, done.stderr
    with open(folder / "observables.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) > 10, "a run"
    return {name: [line[name] for line in lines] for name in lines[0]}


def told(text: str) -> float:
    return float(text == "true") if text in ("true", "false") else float(text)


@pytest.mark.filterwarnings("ignore::slump.SlumpWarning")
@pytest.mark.parametrize("run", RUNS, ids=lambda run: "-".join(map(str, run.values())).replace("/", "_"))
def test_rows_are_those_of_the_command_line(tmp_path: Path, run: dict[str, Any]) -> None:
    options = {name: value for name, value in run.items() if name != "until"}
    expected = rows(tmp_path, options, run["until"])
    sim = slump.Simulation(**options)
    sim.run(until=run["until"])
    history = sim.history
    # A file of observables without bonds lacks the columns of bonds.
    assert set(expected) == {name for name, column in history.items() if not np.isnan(column).all()} | {"residual"}
    for name, texts in expected.items():
        there = np.array([told(text) for text in texts])
        np.testing.assert_array_equal(history[name], there, err_msg=name)


@pytest.mark.filterwarnings("ignore::slump.SlumpWarning")
def test_a_scene_file_and_a_dictionary_are_one_scene(tmp_path: Path) -> None:
    printed = tmp_path / "scene.toml"
    printed.write_text(program("scene", "--scene", "moving-walls", "--bond", "3").stdout)
    of_file, of_data = slump.Simulation(printed), slump.Simulation(slump.scene("moving-walls", bond=3))
    for sim in (of_file, of_data):
        sim.step(100)
    np.testing.assert_array_equal(of_file.positions, of_data.positions)
    assert of_file.settings == of_data.settings


def test_arrays_and_a_file_are_one_start(tmp_path: Path) -> None:
    start = {"x": [0.0, 0.005, 0.0026], "y": [0.1, 0.1, 0.105], "radius": [0.0024, 0.0025, 0.0026], "vx": [0.1, 0, 0]}
    file = tmp_path / "start.csv"
    lines = ["x,y,radius,vx"] + [",".join(map(str, row)) for row in zip(*start.values())]
    file.write_text("\n".join(lines) + "\n")
    of_file = slump.Simulation(initial=file)
    of_arrays = slump.Simulation(initial={name: np.array(list_) for name, list_ in start.items()})
    for sim in (of_file, of_arrays):
        sim.step(50)
        assert sim.velocities[0, 0] != 0.0
    np.testing.assert_array_equal(of_file.positions, of_arrays.positions)
