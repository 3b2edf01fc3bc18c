"""Tests that the type stubs agree with the compiled module, and that the examples follow the stubs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from command_line import ROOT

import slump
from slump._slump import _kinds

STUB = Path(slump.__file__).parent / "_slump.pyi"
SOURCE = Path(__file__).parent.parent / "slump" / "_slump.pyi"
EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))
BEGINS, ENDS = "# Settings: ", "# Settings end.\n"


def type_of(kind: str | list[str]) -> str:
    return kind if isinstance(kind, str) else f"Literal[{', '.join(map(repr, kind))}]".replace("'", '"')


def section() -> str:
    """Return the classes of the stub that list all settings."""
    kinds = {name: type_of(kind) for name, kind in _kinds().items()}
    lines = ["class _Settings(TypedDict):"]
    lines += [f"    {name}: {kind}" for name, kind in kinds.items()]
    lines += ["", "class _Changes(TypedDict, total=False):"]
    given = {"float": "_Float", "int": "_Int", "bool": "_Bool"}
    lines += [f"    {name}: {given.get(kind, kind)} | None" for name, kind in kinds.items()]
    lines += ["", "class _Attributes:"]
    lines += [f"    {name}: {kind}" for name, kind in kinds.items()]
    return "\n".join(lines) + "\n"


def test_the_stub_has_all_settings() -> None:
    text = SOURCE.read_text()
    first = text.index("\n", text.index(BEGINS)) + 1
    last = text.index(ENDS)
    if os.environ.get("SLUMP_BLESS"):
        SOURCE.write_text(text[:first] + section() + text[last:])
    else:
        assert text[first:last] == section(), "renew it with SLUMP_BLESS=1"


def test_the_stub_has_all_other_options() -> None:
    text = SOURCE.read_text()
    signature = text[text.index("class _Options") : text.index("class Simulation")]
    for name in slump.options():
        assert name in (*_kinds(), "scene", "initial") or f"    {name}: " in signature, name


def allowed(give: Callable[[], object]) -> set[str]:
    """Return the allowed words that the error message on an unknown word lists."""
    try:
        give()
    except slump.InputError as error:
        return set(re.split(", | or ", str(error).partition("of ")[2]))
    raise AssertionError("a word that there is not")


def test_the_stub_allows_the_words_that_the_program_does() -> None:
    text = SOURCE.read_text()
    found = re.findall(r"^    (\w+): Literal\[(.*)\] \| None$", text[text.index("class _Changes") :], re.MULTILINE)
    words = {name: set(re.findall('"(.*?)"', listed)) for name, listed in found}
    assert {"stepper", "solver", "preset", "deposition"} <= set(words)
    for name, there in words.items():
        options: Any = {name: "?"}
        assert there == allowed(lambda: slump.Simulation(**options)), name
    formats = re.findall(r"formats: Sequence\[Literal\[(.*)\]\]", text)[0]
    nonsense: Any = ["?"]
    assert set(re.findall('"(.*?)"', formats)) == allowed(lambda: slump.Simulation("cradle").record("?", formats=nonsense))


ACCEPTED = """
from pathlib import Path

import numpy as np
import pandas as pd
import slump

file = Path("there.slump")
sim = slump.Simulation("pile", preset="paper", dt=np.float64(1e-3), duration=None)
slump.Simulation(slump.scene("pile"), preset="robust", bond=None)
slump.Simulation("cradle", start=8, seed=None)
slump.Simulation(Path("there.toml"))
slump.Simulation(initial={"x": [0, 1], "y": np.ones(2), "radius": (0.1, 0.1)})
slump.Simulation(initial=sim.grains)
slump.Simulation(initial=pd.DataFrame(sim.grains))
sim.save(file)
sim.save(str(file))
slump.Simulation(restart=file, duration=3, stepper="range")
slump.Simulation(initial=str(file))
sim.step()
sim.step(np.int64(1), callback=print)
sim.step(steps=1, callback=lambda now: now.steps)
sim.run(until=np.float64(0.02), callback=print, every=np.float64(0.01))
sim.run(until=1)
sim.change(dt=1e-4, warm_start=True)
sim.max_sweeps = 100
sim.bond = 3
sim.set_positions(sim.positions)
sim.set_velocities(sim.velocities.tolist())
sim.body_forces = sim.masses[:, None] * [0.0, 1.0]
sim.body_forces = sim.body_forces.tolist()
sim.add_grain(0.0, 0.5, 0.0025)
sim.add_grain(np.float64(0), y=1, radius=0.0025, vx=1, vy=0)
sim.remove_grain(np.int64(3))
sim.begin_pairs()
sim.fields()
sim.fields(width=1)
sim.record("recording", every=1, formats=("csv", "vtk"), overwrite=True)
sim.record(Path("recording"), formats=["parquet"], overwrite=True)
sim.end_recording()
problem = sim.next_problem()
slump.solve(problem, "nsgs", tolerance=1e-6, max_sweeps=10, repeat=2, without_bodies=True)
Path("problem.json").write_text(str(slump.scene(Path("there.toml"), initial=None)))
slump.budget("cradle", ["kinetic_energy"], cost=0.01, within=None, out=None, duration=1e-3)
slump.budget(Path("there.toml"), quantity="kinetic_energy", cost=0.01, begin=0, end=1e-3, duration=1e-3)
"""


def test_the_stub_allows_all_that_the_package_takes(tmp_path: Path) -> None:
    """Check a program that uses every argument of every function, in each form that the documentation names."""
    program = tmp_path / "accepted.py"
    program.write_text(ACCEPTED)
    scene = ROOT / "assets" / "scenes" / "hourglass.toml"
    (tmp_path / "there.toml").write_text(scene.read_text())
    done = subprocess.run([sys.executable, "-W", "ignore", program.name], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    run("mypy", "--ignore-missing-imports", "--cache-dir", str(tmp_path / "cache"), str(program))


def run(*command: str) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_of_the_compiled_part() -> None:
    run("mypy.stubtest", "slump", "--concise")


def test_examples_hold_to_the_types(tmp_path: Path) -> None:
    config = Path(__file__).parent.parent / "pyproject.toml"
    run("mypy", "--config-file", str(config), "--cache-dir", str(tmp_path), *map(str, EXAMPLES))
