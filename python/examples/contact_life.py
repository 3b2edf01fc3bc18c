"""Measures a quantity of your own against the time step: the rate at which a collapsing pile loses contacts.

Slump does not measure this rate. A callback reads the contacts at equal intervals of simulated time, and counts the
contacts that have disappeared since the previous call.

    python contact_life.py --out contact_life.png
"""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from piles import Collapse, arguments, in_parallel, mean_and_error, starts, time_step_axis

import slump

BONDS = [20, 100]
TIME_STEPS = [2e-4, 5e-4, 1e-3, 2e-3, 5e-3]
LOOK = 1e-2
"""Simulated time between two calls of the callback, s: a multiple of all time steps."""


class Losses:
    """Counts contacts between grains, summed over all calls, and the contacts that were gone at the next call."""

    def __init__(self) -> None:
        self.before: set[tuple[int, int]] = set()
        self.there = 0
        self.gone = 0

    def look(self, sim: slump.Simulation) -> None:
        """Count the contacts of a simulation. Call this method at equal intervals of simulated time."""
        contacts = sim.contacts
        between = contacts["kind_j"] == "grain"
        now = set(zip(contacts["id_i"][between].tolist(), contacts["id_j"][between].tolist()))
        self.there += len(self.before)
        self.gone += len(self.before - now)
        self.before = now


def lost(collapse: Collapse, duration: float) -> float:
    """Return the fraction of the contacts that are lost between two calls of the callback."""
    losses = Losses()
    collapse.simulation().run(until=duration, callback=losses.look, every=LOOK)
    return losses.gone / losses.there


def main() -> None:
    options = arguments("contact_life", "How soon contacts are lost, against the time step")
    time_steps = TIME_STEPS[2:] if options.quick else TIME_STEPS
    piles = starts(2 if options.quick else options.states, options.quick)
    duration = 0.1 if options.quick else 0.5
    runs = [Collapse(pile, bond, time_step) for time_step in time_steps for bond in BONDS for pile in piles]
    parts = np.array(in_parallel(partial(lost, duration=duration), runs))
    mean, error = mean_and_error(100 * parts.reshape(len(time_steps), len(BONDS), len(piles)), axis=-1)

    figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
    for number, bond in enumerate(BONDS):
        axes.errorbar(time_steps, mean[:, number], error[:, number], marker="o", ms=4, capsize=3, label=f"Bond {bond}")
    axes.set_ylim(bottom=0)
    time_step_axis(axes, time_steps)
    axes.set_ylabel(f"contacts lost in {1e3 * LOOK:g} ms (%)")
    axes.set_title(f"Contacts lost in the first {duration:g} s\nmeans and standard errors over {len(piles)} piles")
    axes.legend()
    figure.savefig(options.out, dpi=120)
    print(options.out)


if __name__ == "__main__":
    main()
