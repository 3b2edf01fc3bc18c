"""The pile in MuJoCo: spheres that slide in the plane and turn about the normal of the plane.

Sources, in the documentation that the package `mujoco` 4.0.0 contains (mujoco/doc): `XMLreference.rst`, attributes
`contact/pair/adhesion` and `geom/gap`; `computation/index.rst`, sections Adhesion, and margin and gap; `modeling.rst`,
section Solver parameters.

* Adhesion shifts the friction cone of a contact by a force: the contact pulls with at most this force, and friction is
  bounded by μ(f_N + adhesion), with the normal force f_N. Adhesion acts on pairs that are closer than `gap`. A pair
  that does not overlap has no friction: its contact has the dimension 1 (measured by `two_bodies.py`).
* `solref` is a time constant and a damping ratio. A time constant below 2Δt is raised to 2Δt.
* `solimp` is the impedance d, below 1: a contact prevents the fraction d of the acceleration that it should prevent.
"""

import mujoco
import numpy as np

import pile


class Discs:
    """Grains on a base of fixed discs, as a MuJoCo model."""

    def __init__(self, positions, radii, base, bond, dt, gap, impedance, gravity):
        spec = mujoco.MjSpec()
        spec.option.timestep = dt
        spec.option.gravity = [0, -gravity, 0]
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.solver = mujoco.mjtSolver.mjSOL_NEWTON
        spec.option.tolerance = 1e-10
        spec.option.iterations = 200
        spec.option.impratio = 1
        mass = pile.masses(radii)
        for index, (position, radius) in enumerate(zip(positions, radii)):
            body = spec.worldbody.add_body(pos=[*position, 0])
            for axis in ([1, 0, 0], [0, 1, 0]):
                body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
            body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
            body.explicitinertial, body.ipos = True, [0, 0, 0]
            body.mass = mass[index]
            body.inertia = np.full(3, 0.5 * mass[index] * radius**2)
            sphere(body, f"grain{index}", radius)
        for index, x in enumerate(base):
            sphere(spec.worldbody, f"base{index}", pile.DIAMETER / 2, [x, 0, 0])
        pairs, to_base = pile.cohesion_forces(radii, bond)
        settings = dict(gap=gap, solref=[2 * dt, 1], solimp=[*impedance, 1e-3, 0.5, 2])
        settings |= dict(condim=3, friction=[pile.FRICTION, pile.FRICTION, 0, 0, 0])
        for one in range(len(radii)):
            others = {f"grain{other}": pairs[one, other] for other in range(one)}
            others |= {f"base{other}": to_base[one] for other in range(len(base))}
            for other, force in others.items():
                spec.add_pair(geomname1=other, geomname2=f"grain{one}", adhesion=force, **settings)
        self.start = np.array(positions)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

    def step(self):
        mujoco.mj_step(self.model, self.data)

    def positions(self):
        return self.start + self.data.qpos.reshape(-1, 3)[:, :2]

    def velocities(self):
        """Return one row per grain: the velocity of its centre, m/s, and its angular velocity, rad/s."""
        return self.data.qvel.reshape(-1, 3)

    def set_velocities(self, velocities):
        self.data.qvel[:] = np.ravel(velocities)

    def pull(self, force):
        """Pull the first grain upwards with the given force, N, from now on."""
        self.data.qfrc_applied[1] = force


def sphere(body, name, radius, position=(0, 0, 0)):
    """Add a sphere to a body. The sphere touches other bodies only in pairs that name it."""
    body.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], pos=position, contype=0, conaffinity=0
    )
