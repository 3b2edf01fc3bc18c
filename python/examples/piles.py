"""Functions that the examples share: initial piles, parallel runs, and the options of a script."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

import slump

matplotlib.use("Agg")

Argument = TypeVar("Argument")
Result = TypeVar("Result")


def arguments(name: str, about: str) -> argparse.Namespace:
    """Parse the options of a script that makes one picture. `about` describes the script."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--out", type=Path, default=Path(f"{name}.png"), help="the picture (default: %(default)s)")
    parser.add_argument("--states", type=int, default=8, help="how many initial states (default: %(default)s)")
    parser.add_argument("--quick", action="store_true", help="small piles for a short time, to see whether it works")
    # These examples study large time steps, whose overlaps cause warnings.
    warnings.simplefilter("ignore", slump.SlumpWarning)
    return parser.parse_args()


def in_parallel(work: Callable[[Argument], Result], on: Sequence[Argument]) -> list[Result]:
    """Return `work` of each item of `on`, in this order. All cores are used, because steps release Python's lock."""
    results: list[Result] = []
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        for result in threads.map(work, on):
            results.append(result)
            if sys.stderr.isatty():
                end = "\n" if len(results) == len(on) else ""
                print(f"\r{len(results)} of {len(on)}", end=end, file=sys.stderr, flush=True)
    return results


def starts(count: int, quick: bool) -> list[dict[str, Any]]:
    """Return `count` piles at rest, with seeds from 1. Each pile is settled once, for all runs that start from it."""
    options: dict[str, Any] = {"grains": 40, "box_width": 8.0} if quick else {"grains": 138}
    return in_parallel(lambda seed: slump.scene(seed=seed, **options), range(1, count + 1))


@dataclass
class Collapse:
    """One run of a sweep: a pile whose walls are removed at time 0."""

    start: dict[str, Any]
    bond: float
    time_step: float

    def simulation(self) -> slump.Simulation:
        """Return a simulation in the initial state of this run."""
        return slump.Simulation(self.start, bond=self.bond, dt=self.time_step)


def time_step_axis(axes: Axes, time_steps: Sequence[float]) -> None:
    """Make the x axis logarithmic, with a mark at each time step."""
    axes.set_xscale("log")
    axes.set_xticks(time_steps, [f"{1e3 * time_step:g}" for time_step in time_steps])
    axes.minorticks_off()
    axes.set_xlabel("time step Δt (ms)")


def mean_and_error(
    values: npt.ArrayLike, axis: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the mean and the standard error of the mean along an axis."""
    values = np.asarray(values, dtype=np.float64)
    count = values.shape[axis]
    return values.mean(axis), values.std(axis, ddof=1) / np.sqrt(count)
