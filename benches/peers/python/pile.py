"""The pile of Slump's scene `pile` as plain arrays: grains, rough base, masses and cohesion forces, SI units."""

import math

import numpy as np

DIAMETER = 5e-3  # mean diameter d, m
GRAVITY = 9.8  # gravitational acceleration g, m/s²
AREAL_DENSITY = 1.0  # areal density of the discs, kg/m²
FRICTION = 0.5
BOX_WIDTH = 16  # width of the box in which the pile came to rest, d
DURATION = 1.0  # simulated time of a run, s
RANGE = 0.01 * DIAMETER  # gap up to which cohesion acts in programs that have such a range, m


def read(path):
    """Return positions and radii, m, of an initial state that `slump generate` wrote."""
    with open(path) as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    columns = lines[0].strip().split(",")
    table = np.array([[float(word) for word in line.split(",")] for line in lines[1:]])
    column = {name: table[:, index] for index, name in enumerate(columns)}
    return np.column_stack([column["x"], column["y"]]), column["radius"]


def rough_base(positions):
    """Return x of the fixed discs, m: diameter d, spacing d, five heights of the pile beyond the box on each side."""
    half = math.ceil(0.5 * (BOX_WIDTH + 10 * positions[:, 1].max() / DIAMETER))
    return DIAMETER * np.arange(-half, half + 1)


def masses(radii):
    """Return the masses of discs, kg."""
    return AREAL_DENSITY * math.pi * radii**2


def cohesion_forces(radii, bond):
    """Return the cohesion force C₀ = Bond·m_ij·g of each pair of grains, and of each grain with the base, N."""
    mass = masses(radii)
    effective = mass[:, None] * mass[None, :] / (mass[:, None] + mass[None, :])
    return bond * GRAVITY * effective, bond * GRAVITY * mass


def slump(start, now):
    """Return the slump: the drop of the mean height divided by the initial mean height."""
    return (start[:, 1].sum() - now[:, 1].sum()) / start[:, 1].sum()


def mean_overlap(positions, radii):
    """Return the mean overlap of touching grains, in mean diameters."""
    i, j = np.triu_indices(len(radii), 1)
    overlap = radii[i] + radii[j] - np.hypot(*(positions[i] - positions[j]).T)
    return overlap[overlap > 0].mean() / DIAMETER
