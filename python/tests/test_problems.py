"""Tests of single contact problems, solved by the package and by the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import run as program

import slump


def test_a_problem_is_that_of_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "problem.json"
    done = program("problem", "dump", "--bond=50", "--dt=5e-4", "--at=0.05", f"--out={file}")
    assert done.returncode == 0, done.stderr
    sim = slump.Simulation("pile", bond=50, dt=5e-4)
    sim.run(until=0.05)
    problem, dumped = sim.next_problem(), json.loads(file.read_text())
    dumped.pop("comment")
    assert problem == dumped
    assert sim.steps == 100


@pytest.mark.parametrize("method", ["nsgs", "newton", "apgd"])
def test_a_solution_is_that_of_the_command_line(tmp_path: Path, method: str) -> None:
    sim = slump.Simulation("pile", bond=50, dt=5e-4)
    sim.step(100)
    problem = sim.next_problem()
    file, out = tmp_path / "problem.json", tmp_path / "solution.json"
    file.write_text(json.dumps(problem))
    options = [f"--method={method}", "--tolerance=1e-7", "--max-sweeps=20000", f"--out={out}"]
    assert program("problem", "solve", str(file), *options).returncode == 0
    expected = json.loads(out.read_text())
    arrays = {**problem, "q": np.array(problem["q"]), "mu": np.float64(problem["mu"])}
    for given in (problem, arrays, file, str(file), file.read_text()):
        solution = slump.solve(given, method=method, tolerance=1e-7, max_sweeps=20000)
        assert (solution.method, solution.contacts, solution.on_bodies) == (method, problem["nc"], True)
        assert (solution.sweeps, solution.residual) == (expected["sweeps"], expected["residual"])
        np.testing.assert_array_equal(solution.impulses.ravel(), expected["r"])
        np.testing.assert_array_equal(solution.velocities.ravel(), expected["u"])
        assert solution.body_velocities is not None
        np.testing.assert_array_equal(solution.body_velocities, expected["velocities"])
    if method == "newton":
        with pytest.raises(slump.InputError, match="method is newton, but must be one that works on W alone"):
            slump.solve(problem, method=method, without_bodies=True)
        return
    on_matrix = slump.solve(problem, method=method, tolerance=1e-7, max_sweeps=20000, without_bodies=True)
    assert not on_matrix.on_bodies and on_matrix.body_velocities is None
    assert "impulses" not in repr(on_matrix)


def test_velocities_are_those_of_the_next_step() -> None:
    sim = slump.Simulation("pile", bond=50, dt=5e-4, solver="nsgs")
    sim.step(100)
    options = {"method": sim.solver, "tolerance": 1e-9, "max_sweeps": 100_000}
    solution = slump.solve(sim.next_problem(), **options)  # type: ignore[arg-type]
    sim.change(stop="residual", tolerance=1e-9, max_sweeps=100_000)
    sim.step(1)
    assert solution.body_velocities is not None
    np.testing.assert_allclose(solution.body_velocities[:, :2], sim.velocities, atol=1e-6)


def test_a_step_with_two_solutions_is_found_to_have_them(tmp_path: Path) -> None:
    file = tmp_path / "step.json"
    options = ["--bond=0", "--dt=1e-3", "--at=0.15", "--restitution-threshold=2"]
    options += ["--friction-model=tresca", "--touch-tolerance=0", f"--out={file}"]
    assert program("problem", "dump", *options).returncode == 0
    one, other = slump.solutions(file, starts=8)
    assert one.is_solved and other.is_solved
    assert sorted(one.starts + other.starts) == list(range(8))
    assert one.distances == [] and other.distances == [pytest.approx(1.6e-3, rel=0.05)]
    apart = np.linalg.norm((one.body_velocities - other.body_velocities)[:, :2], axis=1)
    assert other.farthest == (82, pytest.approx(apart[82])) and apart.argmax() == 82
    assert len(slump.solutions(file, starts=1)) == 1
    with pytest.raises(slump.InputError, match="starts is 0, but must be 1 to 1000"):
        slump.solutions(file, starts=0)
    with pytest.raises(slump.InputError, match="tolerance is NaN, but must be a finite number > 0"):
        slump.solutions(file, tolerance=float("nan"))
    with pytest.raises(slump.InputError, match="bodies is missing, but must be in the problem: its solutions"):
        slump.solutions({**json.loads(file.read_text()), "bodies": None})


def test_what_is_no_problem_is_told(tmp_path: Path) -> None:
    problem = slump.Simulation("pile").next_problem()
    for given, sentence in [
        ({}, r"the problem is not readable \(missing field `nc` .*\), but must be the JSON of a contact problem"),
        ({**problem, "q": problem["q"][:-1]}, r"the length of q is 447, but must be 448 \(2 nc\)"),
        ({**problem, "mu": float("nan")}, "not readable"),
    ]:
        with pytest.raises(slump.InputError, match=sentence):
            slump.solve(given)
    with pytest.raises(slump.FileError, match="none.json: No such file or directory"):
        slump.solve(tmp_path / "none.json")
    with pytest.raises(TypeError, match="the problem is no data .*, but must be as JSON can say it"):
        slump.solve({"nc": object()})
    with pytest.raises(slump.InputError, match="method is simplex, but must be one of nsgs, nsgs-parallel, newton"):
        slump.solve(problem, method="simplex")
    with pytest.raises(slump.InputError, match="tolerance is -1, but must be a finite number > 0"):
        slump.solve(problem, tolerance=-1)
