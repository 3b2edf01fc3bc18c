"""The pile in the Contact Dynamics of MigFlow.

Sources, in the package `migflow` 1.4.0: `migflow/scontact.py` (`ParticleProblem.iterate`,
`set_fixed_contact_geometry`, `set_cohesion_coefficient`). The package does not explain the six cohesion coefficients.
The machine code of its library (`contact_solve_fixed_geometry`) uses them in this order: force, smallest age of a
contact that coheres, a coefficient that only ages the contact, and radius and centre (x, y) of a region in which
cohesion vanishes. The law applies to v_n + gap/Δt, so cohesion also closes gaps: it acts on each pair that MigFlow
detects.
"""

import numpy as np
from migflow import scontact

import pile

NO_REGION = [1e-9, -100.0, 0.0]  # radius and centre of the region without cohesion, m: far from all grains
ANY_LIFETIME = [-1.0, 0.0]  # cohesion acts on contacts of any age
LEAST_DETECTION = 1e-6 * pile.DIAMETER  # detection distance that stands for a cohesion range of 0, m
TOLERANCE = 1e-8  # tolerance of the solver, m: MigFlow's default


class Discs:
    """Grains on a base of fixed discs, as a MigFlow problem."""

    def __init__(self, positions, radii, base, bond, dt, detection, gravity):
        self.dt = dt
        mass = pile.masses(radii)
        problem = self.problem = scontact.ParticleProblem(2)
        problem.set_fixed_contact_geometry(True)
        problem.contact_detection_d = detection
        for index, (position, radius) in enumerate(zip(positions, radii)):
            problem.add_particle(position, radius, mass[index], f"grain{index}")
        for x in base:
            problem.add_particle(np.array([x, 0.0]), pile.DIAMETER / 2, 1.0, "base", forced=True)
        pairs, to_base = pile.cohesion_forces(radii, bond)
        for one in range(len(radii)):
            others = {f"grain{other}": pairs[one, other] for other in range(one)} | {"base": to_base[one]}
            for other, force in others.items():
                problem.set_friction_coefficient(pile.FRICTION, f"grain{one}", other)
                problem.set_cohesion_coefficient(np.array([force, *ANY_LIFETIME, *NO_REGION]), f"grain{one}", other)
        self.grains = len(radii)
        self.forces = np.zeros((len(radii) + len(base), 2))
        self.forces[: self.grains, 1] = -mass * gravity

    def step(self):
        """Take one step. If MigFlow does not solve it, the grains still move, and MigFlow prints a warning."""
        self.problem.iterate(self.dt, self.forces, tol=TOLERANCE, force_motion=1)

    def positions(self):
        return np.array(self.problem.position()[: self.grains])

    def velocities(self):
        """Return one row per grain: the velocity of its centre, m/s, and its angular velocity, rad/s."""
        return np.column_stack([self.problem.body_velocity(), self.problem.body_omega()])[: self.grains]

    def set_velocities(self, velocities):
        moved = np.atleast_2d(velocities)
        self.problem.body_velocity()[: self.grains] = moved[:, :2]
        self.problem.body_omega()[: self.grains, 0] = moved[:, 2]

    def pull(self, force):
        """Pull the first grain upwards with the given force, N, from now on."""
        self.forces[0, 1] += force
