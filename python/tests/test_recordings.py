"""Tests of recordings on disk, and of simulations that start from a recording."""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from command_line import as_arguments
from command_line import run as program

import slump


def numbers(words: list[str]) -> list[Any]:
    """Return the values of a column of a file: exact numbers, truth values, or the words themselves."""
    if any(words) and set(words) <= {"", "true", "false"}:
        return [word == "true" for word in words]
    try:
        return [float(word or "nan") for word in words] if any(words) else words
    except ValueError:
        return words


def read(file: Path) -> pd.DataFrame:
    """Read a CSV table of a recording."""
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    names, *rows = csv.reader(lines)
    return pd.DataFrame({name: numbers(list(column)) for name, column in zip(names, zip(*rows))})


def of_moments(table: pd.DataFrame) -> list[str]:
    """Return the columns except means over the time since the previous frame, which a single moment lacks."""
    return [name for name in table if not name.startswith(("mean_stress", "mean_time"))]



def test_a_recording_is_that_of_the_command_line(tmp_path: Path) -> None:
    options = {"bond": 50, "dt": 1e-3}
    here, there = tmp_path / "here", tmp_path / "there"
    given = ["--headless", f"--data={there}", "--data-every=0.01", "--data-format=csv", "--duration=0.05"]
    done = program(*given, *as_arguments(options))
    assert done.returncode == 0, done.stderr
    sim = slump.Simulation("pile", duration=0.05, **options)
    sim.record(here, every=0.01, formats=["csv"])
    assert sim.recording == here
    sim.run()
    sim.end_recording()
    assert sim.recording is None
    for table in ("grains", "contacts", "steps", "measures", "histograms"):
        pd.testing.assert_frame_equal(read(here / "csv" / f"{table}.csv"), read(there / "csv" / f"{table}.csv"))
    for table in ("grains", "contacts"):
        frames = read(here / "csv" / f"{table}.csv")
        assert sorted(set(frames["step"])) == [0, 10, 20, 30, 40, 50]
        last = frames[frames["step"] == 50].reset_index(drop=True)
        now = pd.DataFrame(getattr(sim, table))
        assert of_moments(last) == list(now)
        for name in now:
            if last[name].any() or name == "name_j":
                np.testing.assert_array_equal(last[name].to_numpy(), now[name].to_numpy(), err_msg=name)
            else:
                assert name in ("bond", "stretch", "material"), "this law and scene have none"
    assert list(read(here / "csv" / "steps.csv")) == list(sim.history)
    assert of_moments(read(here / "csv" / "measures.csv")) == list(sim.measures)
    assert list(read(here / "csv" / "histograms.csv")) == list(sim.histograms)


@pytest.mark.parametrize("format", ["parquet", "csv"])
def test_a_recording_is_a_start(tmp_path: Path, format: Any) -> None:
    sim = slump.Simulation("pile", bond=50, dt=1e-3)
    sim.bond = 60
    sim.record(tmp_path, every=0.01, formats=[format])
    sim.step(10)
    at_ten = sim.copy()
    assert at_ten.recording is None, "what it does is of another run"
    sim.step(15)
    sim.end_recording()
    about = json.loads((tmp_path / "data.json").read_text())["about"]
    assert float(about["parameters.bond"]) == 60, "what is in force"
    starts = [slump.Simulation(initial=tmp_path, initial_step=10)]
    # The program `slump` may have been built without the other formats.
    if format == "csv":
        of_program = tmp_path / "scene.toml"
        of_program.write_text(program("scene", f"--initial={tmp_path}", "--initial-step=10").stdout)
        starts.append(slump.Simulation(of_program))
    for other in starts:
        assert other.time == 0.0
        np.testing.assert_array_equal(other.positions, at_ten.positions)
        np.testing.assert_array_equal(other.velocities, at_ten.velocities)
        np.testing.assert_array_equal(other.radii, at_ten.radii)
    last = slump.Simulation(initial=tmp_path)
    last_frame = slump.Simulation(initial=tmp_path, initial_step=20)
    np.testing.assert_array_equal(last.positions, last_frame.positions)
    with pytest.raises(slump.InputError, match="initial-step is 7, but must be one of the steps of .*: 0, 10, 20"):
        slump.Simulation(initial=tmp_path, initial_step=7)


@pytest.mark.parametrize("format", ["vtk", "ovito"])
def test_a_recording_for_other_programs_is_no_start(tmp_path: Path, format: Any) -> None:
    sim = slump.Simulation("pile")
    sim.record(tmp_path, formats=[format])
    sim.end_recording()
    with pytest.raises(slump.FileError, match="has grains for other programs alone, but must be a file of discs"):
        slump.Simulation(initial=tmp_path)


def test_a_frame_of_a_recording_is_a_start(tmp_path: Path) -> None:
    sim = slump.Simulation("pile", bond=50, dt=1e-3)
    sim.record(tmp_path, every=0.01, formats=["csv"])
    sim.step(10)
    sim.end_recording()
    frames = read(tmp_path / "csv" / "grains.csv").astype({"id": int})
    start = slump.Simulation(initial=frames[frames["step"] == 10])
    np.testing.assert_array_equal(start.positions, sim.positions)
    fixed = pd.DataFrame(start.grains).query("kind == 'fixed'")
    np.testing.assert_array_equal(fixed["x"], frames[(frames["step"] == 10) & (frames["kind"] == "fixed")]["x"])
    with pytest.raises(slump.InputError, match="initial: row 257: id is 0, but must be another than in row 0"):
        slump.Simulation(initial=frames)
    with pytest.raises(slump.InputError, match="initial-step is 10, but must be left out where initial is a table"):
        slump.Simulation(initial=frames[frames["step"] == 10], initial_step=10)


def test_what_is_asked_of_a_recording_is_checked(tmp_path: Path) -> None:
    sim = slump.Simulation("cradle")
    (tmp_path / "file").write_text("")
    asked: list[tuple[dict[str, Any], str]] = [
        ({"every": 0.0}, "every is 0, but must be a finite number of seconds > 0"),
        ({"formats": ["xml"]}, "formats is xml, but must be some of parquet, csv, vtk, ovito"),
    ]
    for arguments, sentence in asked:
        with pytest.raises(slump.InputError, match=sentence):
            sim.record(tmp_path / "data", **arguments)
    assert not (tmp_path / "data").exists() and sim.recording is None
    with pytest.raises(slump.Error, match="file"):
        sim.record(tmp_path / "file")
    sim.record(tmp_path / "data")
    with pytest.raises(slump.Error, match="data"):
        slump.Simulation("cradle").record(tmp_path / "data", overwrite=True)
    sim.step(3)
    sim.end_recording()
    done = program("--headless", f"--data={tmp_path / 'data'}", "--data-format=csv", "--scene=cradle")
    with pytest.raises(slump.InputError) as refused:
        sim.record(tmp_path / "data")
    assert done.returncode == 2 and str(refused.value) == done.stderr.removeprefix("slump: ").strip()
    sim.record(tmp_path / "data", overwrite=True)
    with pytest.raises(slump.InputError, match="data is '', but must be the name of a folder"):
        sim.record("")


def test_a_recording_that_cannot_be_written_is_told_of_and_the_run_goes_on(tmp_path: Path) -> None:
    sim = slump.Simulation("cradle", dt=1e-3)
    sim.record(tmp_path / "data", every=1e-3, formats=["vtk"])
    sim.step(5)
    sim.record(tmp_path / "other", every=1e-3, formats=["vtk"])
    frames = tmp_path / "other" / "frames.csv"
    # Wait until the first frame is written, so that no file is written while the folder is removed.
    while not frames.exists() or len(frames.read_text().splitlines()) < 2:
        time.sleep(0.01)
    shutil.rmtree(tmp_path / "other")
    with pytest.raises(slump.FileError, match="other"):
        sim.step(20)
        sim.end_recording()
    assert sim.recording is None
    sim.step(5)
    sim.end_recording()
    assert sim.steps == len(sim.history["step"]) > 5


def test_a_recording_that_nobody_ends_is_whole(tmp_path: Path) -> None:
    program = f"import slump; sim = slump.Simulation('cradle'); sim.record({str(tmp_path)!r}, formats=['csv']); sim.step(7)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    assert list(read(tmp_path / "csv" / "steps.csv")["step"]) == [1, 2, 3, 4, 5, 6, 7]


FORKED = """
import os, sys
import slump

folder, act = sys.argv[1:]
sim = slump.Simulation("cradle")
sim.record(folder, every=sim.dt, formats=["csv", "parquet", "vtk"])
sim.step(10)
child = os.fork()
if child == 0:
    if act == "drops":
        del sim
    elif act == "steps":
        # More than may wait for a thread that is not there.
        sim.step(5000)
    elif act == "ends":
        sim.end_recording()
        assert sim.recording is None
    elif act == "records":
        sim.record(folder + "-of-child", every=sim.dt, formats=["csv"])
        sim.step(5)
        sim.end_recording()
    sys.exit(7)
_, status = os.waitpid(child, 0)
assert os.waitstatus_to_exitcode(status) == 7
assert str(sim.recording) == folder
sim.step(10)
sim.end_recording()
"""


@pytest.mark.parametrize("act", ["drops", "steps", "ends", "records", "exits"])
def test_a_forked_process_leaves_the_recording_to_its_parent(tmp_path: Path, act: str) -> None:
    folder = tmp_path / "run"
    done = subprocess.run([sys.executable, "-c", FORKED, str(folder), act], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert list(read(folder / "csv" / "steps.csv")["step"]) == list(range(1, 21))
    assert sorted(set(read(folder / "csv" / "grains.csv")["step"])) == list(range(21))
    assert len(list((folder / "vtk").glob("grains-*.vtp")) or list((folder / "vtk").rglob("*.vtp"))) >= 21
    if act == "records":
        assert sorted(set(read(tmp_path / "run-of-child" / "csv" / "grains.csv")["step"])) == list(range(10, 16))
