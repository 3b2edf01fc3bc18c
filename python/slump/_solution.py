"""Results of solving contact problems."""

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
    """True if the solver used the bodies, False if it used only W."""
    sweeps: int
    """Sweeps, or iterations of about the same cost."""
    factorisations: int
    """Number of factorised matrices."""
    seconds: float
    """Time of the solve only, s; the shortest of the repeats."""
    converged: bool
    """True if the solver reached its tolerance and the residual confirms it."""
    stalled: bool
    """True if the solver stalled before it reached its tolerance: more sweeps would not help."""
    residual: float
    """Common residual of the impulses, dimensionless."""
    impulses: npt.NDArray[np.float64] = field(repr=False)
    """(P_n, P_t), one row per contact, N·s."""
    velocities: npt.NDArray[np.float64] = field(repr=False)
    """(v_n, v_t) at the end of the step, including the restitution term, one row per contact, m/s."""
    body_velocities: npt.NDArray[np.float64] | None = field(repr=False)
    """(v_x, v_y, ω) of each body at the end of the step, m/s and rad/s; None if the problem has no bodies."""


@dataclass(frozen=True, eq=False)
class FoundSolution:
    """One solution of a contact problem under Coulomb friction."""

    residual: float
    """Common residual, dimensionless."""
    is_solved: bool
    """True if the residual is within the tolerance. Other results may be close to a solution from another start."""
    starts: list[int]
    """Starts that led to it: 0 for the impulses of the problem, 1 for zero impulses, then random impulses."""
    distances: list[float]
    """Distance of its velocities from those of each earlier solution, m/s: root mean square, weighted with mass."""
    farthest: tuple[int, float]
    """The grain whose velocity differs most from the first solution, and the difference, m/s."""
    body_velocities: npt.NDArray[np.float64] = field(repr=False)
    """(v_x, v_y, ω) of each body at the end of the step, m/s and rad/s."""
