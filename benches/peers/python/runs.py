#!/usr/bin/env python3
"""Runs the pile with cohesion in MuJoCo and in MigFlow, and appends each result to WORK/runs.jsonl.

    runs.py WORK        # WORK has the initial states seed8.csv, seed1.csv, … (run.sh makes them)

A second call resumes after the last result. The runs use all cores.
"""

import concurrent.futures
import json
import os
import sys
import tempfile
import time

import pile

STATES = [f"seed{seed}" for seed in (8, 1, 2, 3, 4, 5, 6, 7)]  # seed 8 made the pile that Slump ships
BONDS = [0, 8, 20, 50]
TIME_STEPS = [5e-3, 1e-3, 2e-4]  # time steps Δt, s
RANGES = [pile.RANGE, 0.0]  # gaps up to which cohesion acts, m
# Impedance of MuJoCo's contacts without overlap and at an overlap of 1 mm. The time constant of contacts is 2Δt, the
# shortest that MuJoCo accepts: with a longer time constant, pairs that open slowly separate. `defaults` is MuJoCo's
# default impedance. With `defaults` a pair bears 3 % of its cohesion force C₀ at the longest Δt; with `hard` it bears
# all of C₀ at each Δt (`two_bodies.py` measures this).
IMPEDANCES = {"defaults": (0.9, 0.95), "hard": (0.999, 0.999)}


def settings():
    """Yield all settings of the programs, at each time step and range of cohesion. Cheap runs come first."""
    for dt in TIME_STEPS:
        for reach in RANGES:
            for program, setting in [*(("mujoco", name) for name in IMPEDANCES), ("migflow", "")]:
                yield {"program": program, "setting": setting, "dt": dt, "range": reach / pile.DIAMETER}


def cases():
    """Yield all runs. Without cohesion the range has no effect, so Bond 0 is run with one range only."""
    for setting in settings():
        for state in STATES:
            for bond in BONDS:
                if bond or setting["range"]:
                    yield setting | {"state": state, "bond": bond}


def discs_of(case, positions, radii, base):
    reach = case["range"] * pile.DIAMETER
    dt, bond, gravity = case["dt"], case["bond"], case.get("gravity", pile.GRAVITY)
    if case["program"] == "mujoco":
        import in_mujoco

        return in_mujoco.Discs(positions, radii, base, bond, dt, reach, IMPEDANCES[case["setting"]], gravity)
    import in_migflow

    return in_migflow.Discs(positions, radii, base, bond, dt, max(reach, in_migflow.LEAST_DETECTION), gravity)


def result(work, case):
    """Take one run. Return slump, overlap, CPU time (s) and number of unsolved steps, from library messages."""
    positions, radii = pile.read(os.path.join(work, case["state"] + ".csv"))
    discs = discs_of(case, positions, radii, pile.rough_base(positions))
    sys.stdout.flush()
    stdout = os.dup(1)
    with tempfile.TemporaryFile() as messages:
        os.dup2(messages.fileno(), 1)
        began = time.process_time()
        try:
            for _ in range(round(pile.DURATION / case["dt"])):
                discs.step()
        finally:
            os.dup2(stdout, 1)
            os.close(stdout)
        cpu = time.process_time() - began
        messages.seek(0)
        unsolved = sum(b"not reached" in line for line in messages)
    now = discs.positions()
    return case | {
        "slump": pile.slump(positions, now),
        "mean_overlap": pile.mean_overlap(now, radii),
        "unsolved": unsolved,
        "cpu_secs": cpu,
    }


def key(case):
    return tuple(case[name] for name in ("program", "setting", "state", "bond", "dt", "range"))


def main():
    work = sys.argv[1]
    journal = os.path.join(work, "runs.jsonl")
    done = set()
    if os.path.exists(journal):
        with open(journal) as file:
            done = {key(json.loads(line)) for line in file if line.endswith("\n")}
    todo = [case for case in cases() if key(case) not in done]
    total = len(done) + len(todo)
    workers = int(os.environ.get("WORKERS", os.cpu_count()))
    with concurrent.futures.ProcessPoolExecutor(workers) as pool, open(journal, "a") as file:
        futures = [pool.submit(result, work, case) for case in todo]
        for number, future in enumerate(concurrent.futures.as_completed(futures), len(done) + 1):
            row = future.result()
            file.write(json.dumps(row) + "\n")
            file.flush()
            print(
                f"{number} of {total}: {row['program']} {row['setting']}, {row['state']}, Bond {row['bond']}, "
                f"dt {row['dt']:g} s, range {row['range']:g} d: slump {row['slump']:.3f}, {row['cpu_secs']:.1f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
