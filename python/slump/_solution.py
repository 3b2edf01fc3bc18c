"""What a method made of a contact problem."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class Solution:
    """What a method made of a contact problem."""

    contacts: int
    """Number of contacts."""
    method: str
    """The method's name."""
    on_bodies: bool
    """Whether it worked on bodies, or on W alone."""
    sweeps: int
    """Sweeps, or iterations that cost about as much."""
    factorisations: int
    """Matrices factorised."""
    seconds: float
    """Time of the solve alone, s; the least of the repeats."""
    converged: bool
    """Whether the method got to its tolerance, by what it says and by the residual."""
    stalled: bool
    """Whether it did not because it had stalled: more sweeps are of no use."""
    residual: float
    """The common residual of the impulses, dimensionless."""
    impulses: npt.NDArray[np.float64] = field(repr=False)
    """(P_n, P_t) of each contact, N·s; a row a contact."""
    velocities: npt.NDArray[np.float64] = field(repr=False)
    """(v_n, v_t) of each contact at the end of the step, restitution's term included, m/s."""
    body_velocities: npt.NDArray[np.float64] | None = field(repr=False)
    """(v_x, v_y, ω) of each body at the end of the step, m/s and rad/s, where the problem has bodies."""


@dataclass(frozen=True, eq=False)
class FoundSolution:
    """One of the solutions of a contact problem under Coulomb's law."""

    residual: float
    """The common residual, dimensionless."""
    is_solved: bool
    """Whether that is within the tolerance. A result that is not may be near a solution that others led to."""
    starts: list[int]
    """The starts that led to it, from 0: the impulses of the problem, none, then random ones."""
    distances: list[float]
    """How far its velocities are from those of each solution before it, m/s: root mean square, weighted with mass."""
    farthest: tuple[int, float]
    """The grain whose velocity differs most from the first solution, and by how much, m/s."""
    body_velocities: npt.NDArray[np.float64] = field(repr=False)
    """(v_x, v_y, ω) of each body at the end of the step, m/s and rad/s."""
