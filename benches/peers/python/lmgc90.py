#!/usr/bin/env python3
"""Computes from results/lmgc90/slumps.csv the effect of LMGC90's tolerance on the slump of cohesive piles.

    lmgc90.py           # writes results/lmgc90/tolerance.json
"""

import csv
import json
import pathlib
import statistics

import interval

FOLDER = pathlib.Path(__file__).parent.parent / "results" / "lmgc90"
WET = "RST_WET_CLB"
SWEEPS, MORE_SWEEPS = 5000, 20000  # largest number of sweeps per step in the two series
LOOSE = 1e-4  # tolerance from which a setting counts as loose
TIME_STEP = 1e-3  # time step of the series over tolerances, s


def read():
    with open(FOLDER / "slumps.csv") as file:
        return list(csv.DictReader(file))


def select(rows, code, tolerance, bond, time_step, law=None, sweeps=SWEEPS):
    """Return the rows of one setting, by initial state."""
    return {
        row["state"]: row
        for row in rows
        if row["code"] == code
        and (row["law"] == law or law is None)
        and float(row["tolerance"]) == tolerance
        and float(row["bond"]) == bond
        and float(row["dt_s"]) == time_step
        and int(row["most_sweeps"] or SWEEPS) == sweeps
    }


def slumps(chosen):
    return {state: float(row["slump_1s"]) for state, row in chosen.items()}


def lmgc90(rows, tolerance, bond, time_step=TIME_STEP, law=WET, sweeps=SWEEPS):
    return select(rows, "lmgc90", tolerance, bond, time_step, law, sweeps)


def tolerance_row(rows, tolerance, bond):
    """Return the results at one tolerance. The second series has the same 24 initial states at each tolerance."""
    second = [row for row in rows if row["series"] == "second"]
    chosen, best = lmgc90(second, tolerance, bond), slumps(lmgc90(second, 1e-6, bond))
    count = len(chosen)
    return {
        "tolerance": tolerance,
        "bond": bond,
        "slump": interval.mean(slumps(chosen).values()),
        "minus_1e-6": interval.difference(slumps(chosen), best),
        "ratio_to_1e-6": sum(slumps(chosen).values()) / sum(best.values()),
        "unsolved_percent": 100 * sum(float(row["unsolved_share"]) for row in chosen.values()) / count,
        "median_residual": statistics.median(float(row["residual_solved"]) for row in chosen.values()),
        "sweeps_per_step": sum(float(row["sweeps_per_step"]) for row in chosen.values()) / count,
    }


def agreement(rows, bond, time_step):
    """Return the slump of LMGC90 at tolerance 1e-6 minus the slump of Slump's paper scheme, over all states in both."""
    ours = slumps(select(rows, "slump", 1e-7, bond, time_step))
    theirs = slumps(lmgc90(rows, 1e-6, bond, time_step))
    return {"bond": bond, "time_step_secs": time_step, "lmgc90_minus_slump": interval.difference(theirs, ours)}


def time_step_row(rows, bond):
    """Return slumps and their differences between time steps, over the states s0 to s11."""
    first = [row for row in rows if not row["state"].startswith("seed")]
    short, middle, long = (slumps(lmgc90(first, 1e-6, bond, time_step)) for time_step in (2e-4, 1e-3, 5e-3))
    return {
        "bond": bond,
        "slumps": [interval.mean(values.values()) for values in (short, middle, long)],
        "5e-3_minus_1e-3": interval.difference(long, middle),
        "1e-3_minus_2e-4": interval.difference(middle, short),
    }


def examples():
    """Return how many of LMGC90's own examples set a tolerance of 1e-4 or more."""
    with open(FOLDER / "examples.csv") as file:
        tolerances = [float(row["tolerance"]) for row in csv.DictReader(file) if row["tolerance"]]
    loose = sum(tolerance >= LOOSE for tolerance in tolerances)
    return {"settings": len(tolerances), "at_1e-4_or_looser": loose, "percent": 100 * loose / len(tolerances)}


def main():
    rows = read()
    report = {
        "about": "LMGC90 2025 rc1, law RST_WET_CLB with thickness 0, norm QM/16; README.md says how it was run",
        "command": "benches/peers/python/lmgc90.py",
        "intervals": "within is half the 95 % interval over initial states (t); differences are paired by state",
        "tolerances": [tolerance_row(rows, t, bond) for bond in (50, 100) for t in (1e-3, 1e-4, 1e-5, 1e-6)],
        "more_sweeps": [
            {
                "bond": bond,
                "sweeps": MORE_SWEEPS,
                "slump": interval.mean(slumps(lmgc90(rows, 1e-6, bond, sweeps=MORE_SWEEPS)).values()),
                "1e-4_minus_this": interval.difference(
                    slumps(lmgc90(rows, 1e-4, bond)), slumps(lmgc90(rows, 1e-6, bond, sweeps=MORE_SWEEPS))
                ),
            }
            for bond in (50, 100)
        ],
        "agreement": [
            agreement(rows, bond, time_step) for bond in (0, 20, 50, 100) for time_step in (1e-3, 5e-3)
        ],
        "examples": examples(),
        "time_steps": [time_step_row(rows, bond) for bond in (20, 50, 100)],
    }
    path = FOLDER / "tolerance.json"
    path.write_text(json.dumps(report, indent=1) + "\n")
    print(path)


if __name__ == "__main__":
    main()
