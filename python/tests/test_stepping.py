"""Tests of steps in the background of Python: callbacks, Ctrl-C, threads and processes."""

from __future__ import annotations

import copy
import multiprocessing
import os
import signal
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import slump


def test_a_callback_is_called_at_intervals_of_simulated_time_and_may_look_and_change() -> None:
    sim = slump.Simulation("pile", bond=50, dt=1e-3)
    seen = []

    def look(now: slump.Simulation) -> None:
        assert now is sim
        seen.append((now.steps, now.positions[0, 0], now.grains["x"][0]))
        now.bond = 10 * len(seen)

    sim.run(until=0.025, callback=look, every=0.01)
    assert [steps for steps, _, _ in seen] == [10, 20]
    assert all(of_array == of_table for _, of_array, of_table in seen)
    assert sim.bond == 20 and sim.steps == 25
    calls: list[int] = []
    sim.step(3, callback=lambda now: calls.append(now.steps))
    assert calls == [26, 27, 28]
    sim.run(until=sim.time + 2e-3, callback=lambda now: calls.append(now.steps))
    assert calls == [26, 27, 28, 29, 30]


@pytest.mark.parametrize("every", [2.5e-3, 1e-2, 4e-4, 1e-300, 1e300])
def test_callbacks_come_at_the_frames_of_a_recording(tmp_path: Path, every: float) -> None:
    sim = slump.Simulation("cradle", dt=1e-3)
    sim.step(3)
    sim.record(tmp_path, every=every, formats=["csv"])
    seen: list[int] = []
    for until in (0.011, 0.02):
        sim.run(until=until, callback=lambda now: seen.append(now.steps), every=every)
    sim.end_recording()
    lines = (tmp_path / "frames.csv").read_text().splitlines()
    frames = [int(line.split(",")[0]) for line in lines if line[0].isdigit()]
    assert seen == [step for step in frames if step > 3]


def test_a_run_says_whether_a_time_is_its_end_or_its_length() -> None:
    sim = slump.Simulation("cradle", dt=1e-3)
    sim.run(until=0.02)
    sim.run(until=0.02)
    assert sim.steps == 20, "the end"
    sim.run(until=sim.time + 0.02)
    assert sim.steps == 40, "the length"
    with pytest.raises(TypeError, match=r"run is given 0\.2, but must be given until=0\.2 to end at t = 0\.2 s, or until=sim\.time"):
        sim.run(0.2)  # type: ignore[call-arg]
    for every in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(slump.InputError, match="every is .*, but must be a finite number of seconds > 0"):
            sim.run(until=0.1, callback=print, every=every)
    with pytest.raises(slump.InputError, match="every is 0.1, but must be left out where no callback is given"):
        sim.run(until=0.1, every=0.1)
    assert sim.steps == 40


def test_an_exception_of_a_callback_ends_the_stepping() -> None:
    sim = slump.Simulation("cradle")

    def stop(_: slump.Simulation) -> None:
        raise StopIteration("enough")

    with pytest.raises(StopIteration, match="enough"):
        sim.run(until=100 * sim.dt, callback=stop, every=7 * sim.dt)
    assert sim.steps == 7
    sim.step(1)
    assert sim.steps == len(sim.history["step"]) == 8


def test_ctrl_c_ends_stepping_at_once_and_the_simulation_goes_on_as_if_it_had_never_been_pressed() -> None:
    sim = slump.Simulation("pile", bond=20, dt=1e-5)
    pressed: list[float] = []

    def press() -> None:
        pressed.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.3, press)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        sim.step(10**9)
    # A step of this pile takes much less than a millisecond. The limit is large because the machine may be busy.
    assert time.perf_counter() - pressed[0] < 0.5
    taken = sim.steps
    assert 0 < taken == len(sim.history["step"])
    sim.step(5)
    whole = slump.Simulation("pile", bond=20, dt=1e-5)
    whole.step(taken + 5)
    np.testing.assert_array_equal(sim.positions, whole.positions)


def test_ctrl_c_ends_settling_and_solving() -> None:
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        slump.Simulation(grains=3000, box_width=60)
    problem = slump.Simulation("pile", bond=20).next_problem()
    timer = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        slump.solve(problem, "nsgs", tolerance=1e-300, repeat=20)


def test_other_threads_run_while_steps_are_taken() -> None:
    sim = slump.Simulation("pile", bond=20, dt=1e-5)
    stepping = threading.Thread(target=sim.step, args=(3000,))
    stepping.start()
    looks = 0
    last = 0
    while stepping.is_alive():
        assert sim.steps >= last
        last = sim.steps
        looks += 1
    stepping.join()
    assert looks > 3 and sim.steps == 3000


def test_threads_give_what_one_after_the_other_gives() -> None:
    def run(bond: float) -> list[float]:
        sim = slump.Simulation("pile", bond=bond, solver="nsgs-parallel")
        sim.step(40)
        return list(sim.history["kinetic_energy"])

    bonds = [0.0, 10.0, 20.0, 50.0]
    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(run, bonds)) == [run(bond) for bond in bonds]


def many_heaps(count: int) -> dict[str, Any]:
    """Return a scene of heaps with enough contacts of one colour for `nsgs-parallel` to use several threads."""
    scene = slump.scene("repose")
    heap = scene["grains"]
    apart = 50 * scene["mean_diameter"]
    places = [(apart * number, grain) for number in range(count) for grain in heap]
    scene["grains"] = [{**grain, "position": [x + grain["position"][0], grain["position"][1]]} for x, grain in places]
    scene["boundaries"] = [{"shape": "half-space", "point": [0.0, 0.0], "normal": [0.0, 1.0]}]
    scene["fixed_discs"] = []
    return scene


def energy_of_heaps(bond: float) -> float:
    sim = slump.Simulation(many_heaps(800), bond=bond, solver="nsgs-parallel", max_sweeps=20)
    sim.step(2)
    return float(sim.observables["kinetic_energy"])


def test_a_forked_process_steps_on_several_threads_too() -> None:
    here = energy_of_heaps(3.0)
    with warnings.catch_warnings():
        # Python warns of forks in a process with threads. This test makes such a fork on purpose.
        warnings.simplefilter("ignore", DeprecationWarning)
        with multiprocessing.get_context("fork").Pool(2) as processes:
            assert processes.map_async(energy_of_heaps, [3.0, 3.0]).get(timeout=60) == [here] * 2


def test_a_copy_goes_on_as_the_original_would() -> None:
    sim = slump.Simulation("pile", bond=20)
    sim.step(20)
    copies = [sim.copy(), copy.copy(sim), copy.deepcopy(sim)]
    sim.step(20)
    for other in copies:
        assert other.steps == 20
        other.step(20)
        np.testing.assert_array_equal(other.positions, sim.positions)
        np.testing.assert_array_equal(other.history["residual"], sim.history["residual"])


def test_settings_are_attributes_and_count_from_the_next_step_on() -> None:
    sim = slump.Simulation("pile", bond=20, dt=1e-3)
    assert sim.settings["bond"] == sim.bond == 20
    assert set(sim.settings) < set(slump.options())
    sim.step(10)
    sim.change(dt=5e-4, stepper="range", solver="newton")
    assert (sim.dt, sim.stepper, sim.solver, sim.bond) == (5e-4, "range", "newton", 20)
    sim.bond = np.float64(50)
    sim.max_sweeps = np.int64(300)
    sim.warm_start = np.False_
    assert (sim.bond, sim.max_sweeps, sim.warm_start) == (50, 300, False)
    sim.step(10)
    assert list(sim.history["time_step"]) == [1e-3] * 10 + [5e-4] * 10
    # Rows of steps without bonds contain NaN in the columns of bonds.
    assert np.isnan(sim.history["bond_energy"][:10]).all() and (sim.history["bond_energy"][10:] >= 0).all()
    sim.run(until=0.02)
    assert sim.time == pytest.approx(0.02) and sim.steps == 30
