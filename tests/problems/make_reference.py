#!/usr/bin/env python3
"""Solves files of contact problems with Siconos and stores the velocities.

    make_reference.py PROBLEM [PROBLEM ...]     writes reference/NAME.json beside this script
    make_reference.py --time PROBLEM            times Siconos' Gauss-Seidel solvers

Needs Siconos with its Python interface, and SciPy (Debian 12: apt install python3-siconos
python3-scipy). Siconos is an independent implementation: V. Acary et al., https://nonsmooth.gricad-pages.univ-grenoble-alpes.fr/siconos/

A plane problem is passed to Siconos' spatial solver (3D NSGS) with a third, uncoupled direction. The
free velocity in this direction is 0, so its impulse is 0 and Coulomb's disc becomes the interval of the plane problem.
Cohesion in the shifted cone is removed by p = P_n + c0, q' = q - W (c0, 0). Velocities are scaled by 1/max|q|,
because Siconos treats a small q as zero.
"""

import json
import pathlib
import sys
import time

import numpy as np
import scipy.sparse as sp
import siconos.numerics as sn

HERE = pathlib.Path(__file__).parent
TOLERANCE = 1e-13


def read_json(path):
    data = json.loads(path.read_text())
    nc = data["nc"]
    assert data.get("cone", "shifted") == "shifted", "only the shifted cone can be shifted away"
    entries = data["W"]
    matrix = sp.csr_matrix((entries["val"], (entries["row"], entries["col"])), shape=(2 * nc, 2 * nc))
    mu = np.broadcast_to(np.array(data["mu"], float), nc).copy()
    q = np.array(data["q"])
    shift = np.zeros(2 * nc)
    shift[0::2] = data.get("c0", 0.0)
    return nc, matrix, q, q - matrix @ shift, mu


def read_siconos(path):
    lines = path.read_text().split("\n")
    nc = int(lines[1])
    rows, columns, values = [], [], []
    at = 8
    while ":" in lines[at]:
        left, right = lines[at].split(":")
        if left.split()[0] == "col":
            column = int(left.split()[1])
        else:
            rows.append(int(left))
            columns.append(column)
            values.append(float(right))
        at += 1
    matrix = sp.csr_matrix((values, (rows, columns)), shape=(2 * nc, 2 * nc))
    q = np.array(lines[at].split(), float)
    return nc, matrix, q, q, np.array(lines[at + 1].split(), float)


def residual(matrix, q, free, mu, p):
    """Return Slump's residual: the natural map divided by the free impulses. `free` does not include cohesion."""
    diagonal = matrix.diagonal()
    u = matrix @ p + q
    normal, tangential = p[0::2], p[1::2]
    bound = mu * np.maximum(normal, 0.0)
    e_n = normal - np.maximum(0.0, normal - u[0::2] / diagonal[0::2])
    e_t = tangential - np.clip(tangential - u[1::2] / diagonal[1::2], -bound, bound)
    scale = np.hypot(
        np.linalg.norm(free[0::2] / diagonal[0::2]),
        np.linalg.norm((free[1::2] / diagonal[1::2])[mu > 0]),
    )
    return np.hypot(np.linalg.norm(e_n), np.linalg.norm(e_t)) / scale


def blocks(size, matrix):
    matrix = sp.csc_matrix(matrix)
    matrix.indices = matrix.indices.astype(np.int64)
    matrix.indptr = matrix.indptr.astype(np.int64)
    made = sn.SBM_from_csparse(size, matrix)
    return made[1] if isinstance(made, (tuple, list)) else made


def embedded(nc, matrix, q):
    entries = matrix.tocoo()
    place = lambda index: 3 * (index // 2) + index % 2
    third = 3 * np.arange(nc) + 2
    rows = np.concatenate([place(entries.row), third])
    columns = np.concatenate([place(entries.col), third])
    values = np.concatenate([entries.data, matrix.diagonal()[1::2]])
    q3 = np.zeros(3 * nc)
    q3[0::3], q3[1::3] = q[0::2], q[1::2]
    return sp.csc_matrix((values, (rows, columns)), shape=(3 * nc, 3 * nc)), q3


def solve(dimension, nc, matrix, q, mu, tolerance, repeats=1):
    """Return shifted impulses, iterations and shortest time (s) of Siconos' Gauss-Seidel in 2D or 3D."""
    scale = np.abs(q).max()
    if dimension == 3:
        big, big_q = embedded(nc, matrix, q)
        kind, driver = sn.SICONOS_FRICTION_3D_NSGS, sn.fc3d_driver
    else:
        big, big_q = matrix, q
        kind, driver = sn.SICONOS_FRICTION_2D_NSGS, sn.fc2d_driver
    storage = blocks(dimension, big)
    problem = sn.FrictionContactProblem(dimension, nc, storage, big_q / scale, mu)
    least = np.inf
    for _ in range(repeats):
        options = sn.SolverOptions(kind)
        options.dparam[sn.SICONOS_DPARAM_TOL] = tolerance
        options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = 1_000_000
        r, u = np.zeros(dimension * nc), np.zeros(dimension * nc)
        start = time.perf_counter()
        driver(problem, r, u, options)
        least = min(least, time.perf_counter() - start)
    r = r.reshape(nc, dimension)[:, :2].ravel() * scale
    return r, int(options.iparam[sn.SICONOS_IPARAM_ITER_DONE]), least


def main():
    timing = "--time" in sys.argv
    for name in [name for name in sys.argv[1:] if name != "--time"]:
        path = pathlib.Path(name)
        read = read_json if path.suffix == ".json" else read_siconos
        nc, matrix, free, q, mu = read(path)
        if timing:
            for dimension in [2, 3]:
                # The largest tolerance of Siconos with which Slump's residual reaches 1e-6.
                for tolerance in 1e-5 / 1.15 ** np.arange(60):
                    p, _, _ = solve(dimension, nc, matrix, q, mu, tolerance)
                    reached = residual(matrix, q, free, mu, p)
                    if reached <= 1e-6:
                        break
                _, iterations, least = solve(dimension, nc, matrix, q, mu, tolerance, 100)
                print(f"{dimension}D: {iterations} iterations, {least:.3e} s, residual {reached:.2e}")
            continue
        p, iterations, _ = solve(3, nc, matrix, q, mu, TOLERANCE)
        reference = {
            "problem": path.name,
            "solver": "Siconos 4.4.0 (Debian 12, 4.4.0+dfsg-2), 3D NSGS, its defaults otherwise",
            "tolerance": TOLERANCE,
            "iterations": iterations,
            "residual": residual(matrix, q, free, mu, p),
            "u": (matrix @ p + q).tolist(),
        }
        print(path.name, iterations, "iterations, residual", reference["residual"])
        out = HERE / "reference" / (path.stem + ".json")
        out.write_text(json.dumps(reference) + "\n")


main()
