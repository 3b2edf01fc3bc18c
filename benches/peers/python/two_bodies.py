#!/usr/bin/env python3
"""Measures the cohesion of MuJoCo and MigFlow on a disc above a fixed disc, without gravity, at Bond 20.

    two_bodies.py FILE.json

* pull-off force: the largest force that does not separate the pair within 0.2 s, in cohesion forces C₀
* escape speed: the largest opening speed after which the pair comes together again, m/s
* friction: the tangential impulse of one step in μC₀Δt, while a pair slides and only cohesion presses it together. The
  shifted cone gives 1, a law without cohesion 0. Measured at an overlap of 1e-6 d, and at a gap of half the range
"""

import json
import sys

import numpy as np

import pile
import runs

BOND = 20.0
RADIUS = np.array([pile.DIAMETER / 2])
COHESION = BOND * pile.masses(RADIUS)[0] * pile.GRAVITY  # cohesion force C₀, N
OVERLAP = 1e-6 * pile.DIAMETER
WAIT = 0.2  # simulated time after which a pair counts as held or separated, s
BISECTIONS = 14
SLIDING = 6.0  # initial sliding speed, in μC₀Δt/m: above 3, because friction would stop a slower disc


def pair(case, gap=-OVERLAP):
    position = np.array([[0.0, pile.DIAMETER + gap]])
    return runs.discs_of(case | {"bond": BOND, "gravity": 0.0}, position, RADIUS, np.array([0.0]))


def separates(discs, dt):
    for _ in range(round(WAIT / dt)):
        discs.step()
    return discs.positions()[0, 1] - pile.DIAMETER > 2 * pile.RANGE


def largest(held, most):
    """Return the largest number up to `most` for which `held` is true, by bisection."""
    least = 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (least + most)
        least, most = (middle, most) if held(middle) else (least, middle)
    return least


def measured(case):
    dt = case["dt"]

    def holds_force(force):
        discs = pair(case)
        discs.pull(force * COHESION)
        return not separates(discs, dt)

    def comes_back_from(speed):
        discs = pair(case)
        discs.set_velocities([[0.0, speed, 0.0]])
        return not separates(discs, dt)

    capture = BOND * pile.GRAVITY * dt

    def friction(gap):
        discs = pair(case, gap)
        discs.set_velocities([[0.0, 0.0, SLIDING * pile.FRICTION * capture / RADIUS[0]]])
        discs.step()
        return float(abs(discs.velocities()[0, 0]) / (pile.FRICTION * capture))

    return case | {
        "pull_off_over_cohesion": largest(holds_force, 2.0),
        "escape_speed": largest(comes_back_from, 4 * capture + 0.5),
        "capture_speed": capture,
        "speed_of_the_work": float(np.sqrt(2 * BOND * pile.GRAVITY * case["range"] * pile.DIAMETER)),
        "friction_of_overlap": friction(-OVERLAP),
        "friction_of_gap": friction(0.5 * case["range"] * pile.DIAMETER) if case["range"] else None,
    }


def main():
    rows = []
    for case in runs.settings():
        rows.append(measured(case))
        print(rows[-1], flush=True)
    with open(sys.argv[1], "w") as file:
        json.dump(rows, file, indent=1)


if __name__ == "__main__":
    main()
