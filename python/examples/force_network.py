"""Draws the force network of a stable pile, and the distribution of its contact forces.

    python force_network.py --out force_network.png
"""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.ticker import NullFormatter
from piles import arguments, in_parallel, starts

import slump

PUSH, PULL = "#b2182b", "#2166ac"
BOND = 50


def held(start: dict[str, Any]) -> slump.Simulation:
    """Return a pile that has come to rest without its walls."""
    sim = slump.Simulation(start, bond=BOND, dt=5e-4)
    sim.run(until=0.3)
    return sim


def branches(sim: slump.Simulation) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the line of each contact, from centre to centre (m), and the normal force of each contact (N)."""
    grains, contacts = sim.grains, sim.contacts
    centres = np.stack([grains["x"], grains["y"]], axis=1)
    # The ids are also row numbers here: grains come first, then fixed discs, and this pile touches no other bodies.
    ends = np.stack([centres[contacts["id_i"]], centres[contacts["id_j"]]], axis=1)
    return ends, contacts["normal_force"]


def draw_network(axes: Axes, sim: slump.Simulation) -> None:
    """Draw grains in grey, and each contact as a line whose width is proportional to its force."""
    grains = sim.grains
    diameter = sim.mean_diameter
    farthest = np.abs(sim.positions[:, 0]).max() + 1.5 * diameter
    in_view = np.abs(grains["x"]) < farthest
    for kind, colour in [("grain", "0.88"), ("fixed", "0.65")]:
        those = (grains["kind"] == kind) & in_view
        widths = 2e3 * grains["radius"][those]
        offsets = 1e3 * np.stack([grains["x"], grains["y"]], axis=1)[those]
        discs = EllipseCollection(
            widths, widths, np.zeros_like(widths), units="xy", offsets=offsets,
            offset_transform=axes.transData, facecolor=colour, edgecolor="white", linewidth=0.4,
        )  # fmt: skip
        axes.add_collection(discs)
    ends, forces = branches(sim)
    widest = np.quantile(np.abs(forces), 0.98)
    for sign, colour, label in [(1, PUSH, "push"), (-1, PULL, "pull")]:
        those = np.sign(forces) == sign
        widths = 4 * np.minimum(np.abs(forces[those]) / widest, 1.2)
        lines = LineCollection(list(1e3 * ends[those]), linewidths=widths, colors=colour, capstyle="round")
        axes.add_collection(lines)
        axes.plot([], [], color=colour, linewidth=3, label=label)
    axes.set_aspect("equal")
    axes.set_xlim(-1e3 * farthest, 1e3 * farthest)
    axes.set_ylim(-1e3 * diameter, 1e3 * (sim.positions[:, 1].max() + diameter))
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    axes.legend(loc="upper right")
    axes.set_title(f"Force network, Bond {BOND}")


def draw_distribution(axes: Axes, sims: list[slump.Simulation]) -> None:
    """Draw the distribution P(f) of pushing and pulling forces, with f in units of each pile's mean push."""
    forces = []
    for sim in sims:
        normal = sim.contacts["normal_force"]
        forces.append(normal / normal[normal > 0].mean())
    all_forces = np.concatenate(forces)
    edges = np.linspace(0, 6, 25)
    middles = 0.5 * (edges[1:] + edges[:-1])
    for sign, colour, label in [(1, PUSH, "push"), (-1, PULL, "pull")]:
        counts, _ = np.histogram(sign * all_forces, edges)
        # Divide by the number of all contacts, so that both curves together have the area 1.
        density = counts / (len(all_forces) * np.diff(edges))
        error = np.sqrt(counts) / (len(all_forces) * np.diff(edges))
        # NaN in empty bins interrupts the line.
        density[counts == 0] = np.nan
        axes.errorbar(middles, density, error, color=colour, marker="o", ms=4, capsize=2, label=label)
    axes.set_yscale("log")
    axes.set_xlim(0, 6)
    axes.set_ylim(1e-3, 2)
    axes.set_xlabel(r"$f = |N|\,/\,\langle N\rangle$ of those that push")
    axes.set_ylabel(r"$P(f)$")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.legend()
    axes.set_title(f"{len(all_forces)} contacts of {len(sims)} piles")


def main() -> None:
    options = arguments("force_network", "Force network and P(f) of a pile")
    piles = starts(2 if options.quick else options.states, options.quick)
    sims = in_parallel(held, piles)
    figure, (network, distribution) = plt.subplots(
        1, 2, figsize=(11, 4.2), layout="constrained", width_ratios=[1.6, 1]
    )
    draw_network(network, sims[0])
    draw_distribution(distribution, sims)
    figure.savefig(options.out, dpi=120)
    print(options.out)


if __name__ == "__main__":
    main()
