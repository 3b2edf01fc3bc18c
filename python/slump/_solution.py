"""Results of solving single contact problems."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class Solution:
    """Result of one solver on a contact problem."""

    contacts: int
    """Number of contacts."""
    method: str
    """Name of the solver."""
    on_bodies: bool
    """True if the solver used the bodies, False if it used only the Delassus matrix W."""
    sweeps: int
    """Number of sweeps, or of iterations that cost about as much as a sweep."""
    factorisations: int
    """Number of matrix factorisations."""
    seconds: float
    """Time of the solve alone, s: the shortest of all repeats."""
    converged: bool
    """True if the solver reached its tolerance and the residual confirms it."""
    stalled: bool
    """True if the solver stalled before it reached its tolerance: more sweeps would not help."""
    residual: float
    """Residual of the impulses, dimensionless: the same measure for all solvers."""
    impulses: npt.NDArray[np.float64] = field(repr=False)
    """Normal and tangential impulses (P_n, P_t), N·s, one row per contact."""
    velocities: npt.NDArray[np.float64] = field(repr=False)
    """Velocities (v_n, v_t) at the end of the step, v_n with the restitution term, m/s, one row per contact."""
    body_velocities: npt.NDArray[np.float64] | None = field(repr=False)
    """Velocity and spin (v_x, v_y, ω) of each body at the end of the step, m/s and rad/s; None without bodies."""


@dataclass(frozen=True, eq=False)
class FoundSolution:
    """One solution of a contact problem under Coulomb friction."""

    residual: float
    """Residual of the impulses, dimensionless: the same measure for all solvers."""
    is_solved: bool
    """True if the residual is within the tolerance. If not, the result may be close to another solution of the list."""
    starts: list[int]
    """Initial guesses that led to this solution: 0 is the impulses in the problem, 1 is zero, others are random."""
    distances: list[float]
    """Distance of the velocities from each earlier solution, m/s: root mean square, weighted with mass."""
    farthest: tuple[int, float]
    """Index of the grain whose velocity differs most from the first solution, and this difference, m/s."""
    body_velocities: npt.NDArray[np.float64] = field(repr=False)
    """Velocity and spin (v_x, v_y, ω) of each body at the end of the step, m/s and rad/s."""
