#!/usr/bin/env python3
"""Prints fingerprints (hashes) of about 8,000 short runs, one line per run: combinations of scenes, steppers, methods,
remedies and numbers.

tests/fingerprints.py target/release/slump > table        # all of them
tests/fingerprints.py target/release/slump 17 > table     # every 17th

Two builds with bitwise equal trajectories print the same table. To check a change that must not alter trajectories,
make a table before and after the change, and compare both tables with diff.
"""
import csv, hashlib, itertools, os, subprocess, sys, tempfile
from concurrent.futures import ThreadPoolExecutor

BINARY = sys.argv[1]
STRIDE = int(sys.argv[2]) if len(sys.argv) > 2 else 1
SCENES = ["pile", "cradle", "collision", "column", "mass-ratio", "chain", "cantilever", "bridge", "overlap",
    "squeeze", "moving-walls", "logs", "arch", "repose", "repose-angle", "far", "bounce", "newtons-cradle",
    "thin-wall", "lift-off", "dilatancy", "blow", "hyperstatic", "assets/scenes/hourglass.toml"]
METHODS = ["nsgs", "nsgs-parallel", "newton", "nncg", "apgd", "admm", "jacobi", "interior-point", "auto"]
REMEDIES = [[], ["--push-out", "true"], ["--max-travel", "0.1"],
    ["--sequential-impacts", "true"], ["--speculative", "true"], ["--preset", "robust"]]
NUMBERS = [["--dt", "1e-3", "--duration", "0.03", "--times", "0.03"],
    ["--dt", "5e-3", "--duration", "0.1", "--times", "0.1", "--rho", "0.9"],
    ["--dt", "2e-3", "--duration", "0.04", "--times", "0.04", "--bond", "50", "--rho", "0.5", "--stop", "residual"],
    ["--dt", "2e-3", "--duration", "0.04", "--times", "0.04", "--bond", "0", "--ordering", "bottom-up", "--cone", "compressive", "--warm-start", "false"]]

def cases():
    for scene, numbers in itertools.product(SCENES, NUMBERS):
        base = ["--scene", scene, *numbers, "--max-sweeps", "150"]
        for method, remedy in itertools.product(METHODS, REMEDIES):
            yield [*base, "--solver", method, *remedy]
        for method in METHODS:
            for remedy in ([], ["--max-travel", "0.1"], ["--preset", "robust"]):
                yield [*base, "--stepper", "range", "--solver", method, *remedy]
        for stepper in ("tgs-soft", "avbd", "dem"):
            for remedy in ([], ["--substeps", "7"]):
                yield [*base, "--stepper", stepper, *remedy]

def fingerprint(case):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([BINARY, "--headless", "--frames", folder, "--size", "8x8", "--renderer", "cpu", *case],
            capture_output=True, text=True)
        try:
            rows = list(csv.reader(open(os.path.join(folder, "observables.csv"))))
        except OSError:
            return run.returncode, "-", 0
        text = "\n".join(map(",".join, rows))
        return run.returncode, hashlib.sha256(text.encode()).hexdigest()[:16], len(rows)

with ThreadPoolExecutor(2) as pool:
    todo = list(cases())[::STRIDE]
    for case, (code, digest, rows) in zip(todo, pool.map(fingerprint, todo)):
        print(code, digest, rows, " ".join(case), flush=True)
