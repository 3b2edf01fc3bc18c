"""Draws Fig. 5 of the paper: slump and overlap against the time step, with error bars over initial states.

Every pile is run at all time steps and Bond numbers. Many runs are taken in parallel.

    python fig5.py --out fig5.png
"""

from __future__ import annotations

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter
from piles import Collapse, arguments, in_parallel, mean_and_error, starts, time_step_axis

BONDS = [0, 20, 50, 100]
TIME_STEPS = [2e-4, 5e-4, 1e-3, 2e-3, 5e-3]


def slump_and_overlap(collapse: Collapse, duration: float) -> tuple[float, float]:
    """Run a pile. Return its slump at the end, and the mean overlap of touching grains over all steps, in d."""
    sim = collapse.simulation()
    sim.run(until=duration)
    history = sim.history
    return float(history["slump"][-1]), float(history["mean_overlap"].mean())


def main() -> None:
    options = arguments("fig5", "Fig. 5 with error bars, from a parallel sweep")
    bonds, time_steps = (BONDS[1::2], TIME_STEPS[2:]) if options.quick else (BONDS, TIME_STEPS)
    piles = starts(2 if options.quick else options.states, options.quick)
    duration = 0.1 if options.quick else 1.0

    # The longest runs come first, so that no core is idle while the last run ends.
    runs = [Collapse(pile, bond, time_step) for time_step in time_steps for bond in bonds for pile in piles]
    found = np.array(in_parallel(partial(slump_and_overlap, duration=duration), runs))
    slumps, overlaps = np.moveaxis(found.reshape(len(time_steps), len(bonds), len(piles), 2), -1, 0)

    figure, (of_slump, of_overlap) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    for axes, values in [(of_slump, slumps), (of_overlap, overlaps)]:
        mean, error = mean_and_error(values, axis=-1)
        for number, bond in enumerate(bonds):
            label = f"Bond {bond}"
            axes.errorbar(time_steps, mean[:, number], error[:, number], marker="o", ms=4, capsize=3, label=label)
        time_step_axis(axes, time_steps)
    of_slump.set_ylabel(rf"slump $\Delta y_G$ after {duration:g} s")
    of_slump.set_ylim(bottom=0)
    of_slump.set_title("a: how far the pile slumps")
    of_overlap.set_ylabel(r"mean overlap $\delta/d$")
    of_overlap.set_yscale("log")
    of_overlap.yaxis.set_minor_formatter(NullFormatter())
    of_overlap.set_title("b: how far grains overlap")
    of_overlap.legend(loc="lower right")
    figure.suptitle(f"Means and standard errors over {len(piles)} initial states")
    figure.savefig(options.out, dpi=120)
    print(options.out)


if __name__ == "__main__":
    main()
