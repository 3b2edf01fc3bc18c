#!/usr/bin/env python3
"""Writes results/cohesion.json and screenshots/chart-programs.png from the runs of all programs.

    report.py WORK [DATE]      # WORK: the folder that run.sh has made

Numbers are means over initial states, with half of their 95 % confidence interval.
"""

import datetime
import importlib.metadata
import json
import os
import pathlib
import platform
import sys

import interval
import lmgc90
import runs

RESULTS = pathlib.Path(__file__).parent.parent / "results"
PICTURE = pathlib.Path(__file__).parents[3] / "screenshots" / "chart-programs.png"
TIME_STEPS = sorted(runs.TIME_STEPS)
# Name, colour and mark of each curve. TOUCH: cohesion ends with contact. RANGE: it acts up to a gap of 0.01 d.
TOUCH = {
    ("slump", "moreau, tolerance 0"): ("Slump, moreau", "black", "o"),
    ("lmgc90", "RST_WET_CLB, 1e-6"): ("LMGC90, RST_WET_CLB", "tab:purple", "D"),
    ("mujoco", "defaults, gap 0"): ("MuJoCo, default impedance", "tab:orange", "^"),
    ("mujoco", "hard, gap 0"): ("MuJoCo, hard", "tab:red", "v"),
    ("migflow", "range 0"): ("MigFlow", "tab:blue", "s"),
}
RANGE = {
    ("slump", "moreau, tolerance 0.01 d"): ("Slump, moreau", "black", "o"),
    ("slump", "range"): ("Slump, range", "tab:green", "P"),
    ("slump", "dem"): ("Slump, dem", "0.55", "X"),
    ("mujoco", "defaults, gap 0.01 d"): ("MuJoCo, default impedance", "tab:orange", "^"),
    ("mujoco", "hard, gap 0.01 d"): ("MuJoCo, hard", "tab:red", "v"),
    ("migflow", "range 0.01 d"): ("MigFlow", "tab:blue", "s"),
}
REPORTS = pathlib.Path(__file__).parents[3] / "assets" / "reports"
# For each report: a function from the settings of a group of runs to the name of its curve, or None.
OWN = {
    "touch-tolerance": lambda settings: {0.0: "moreau, tolerance 0", 0.01: "moreau, tolerance 0.01 d"}.get(
        settings["touch-tolerance"]
    ),
    "range-default": lambda settings: "range" if settings["solver"] == "newton" else None,
    "schemes": lambda settings: "dem" if settings["stepper"] == "dem" else None,
}
LEAST_STATES = 5  # results with fewer initial states are not reported, because their intervals are too wide
SIDE_BY_SIDE = 1.09  # factor that shifts Δt from curve to curve in the picture, so that points do not overlap


def peers(work):
    """Yield the runs of MuJoCo and MigFlow: program, setting, Bond number, Δt (s), state and values."""
    with open(os.path.join(work, "runs.jsonl")) as file:
        for run in map(json.loads, file):
            reach = f"{run['range']:.2g} d" if run["range"] and run["bond"] else "0"
            names = {"mujoco": f"{run['setting']}, gap {reach}", "migflow": f"range {reach}"}
            values = {name: run[name] for name in ("slump", "mean_overlap", "unsolved", "cpu_secs")}
            yield run["program"], names[run["program"]], run["bond"], run["dt"], run["state"], values


def own():
    """Yield rows from Slump's stored reports, which have the same kind of confidence interval."""
    for name in OWN:
        for group in json.loads((REPORTS / f"{name}.json").read_text())["groups"]:
            setting = OWN[name](group["settings"])
            if setting and group["settings"]["bond"] in runs.BONDS:
                mean, within = group["slump"]
                yield {
                    "program": "slump",
                    "setting": setting,
                    "bond": group["settings"]["bond"],
                    "time_step_secs": group["settings"]["dt"],
                    "slump": {"mean": mean, "within": within, "states": group["starts"]},
                    "mean_overlap": group["mean_overlap"],
                    "report": f"assets/reports/{name}.json",
                }


def supplied():
    """Yield LMGC90's runs from the states s0 to s11. The other states were run at one time step only."""
    for row in lmgc90.read():
        chosen = row["law"] == lmgc90.WET and float(row["tolerance"]) == 1e-6 and not row["state"].startswith("seed")
        if chosen:
            values = {"slump": float(row["slump_1s"])}
            yield "lmgc90", "RST_WET_CLB, 1e-6", float(row["bond"]), float(row["dt_s"]), row["state"], values


def grouped(all_runs):
    """Return the values of runs, grouped by program, setting, Bond number and Δt, and then by state."""
    groups = {}
    for program, setting, bond, dt, state, values in all_runs:
        groups.setdefault((program, setting, bond, dt), {})[state] = values
    return groups


def rows_of(groups):
    for (program, setting, bond, dt), states in sorted(groups.items()):
        if len(states) < LEAST_STATES:
            continue
        row = {"program": program, "setting": setting, "bond": bond, "time_step_secs": dt}
        row["slump"] = interval.mean(values["slump"] for values in states.values())
        for name in ("mean_overlap", "unsolved", "cpu_secs"):
            found = [values[name] for values in states.values() if name in values]
            if found:
                row[name] = sum(found) / len(found)
        yield row


def changes_of(groups):
    """Yield the slump at the longest Δt minus the slump at each shorter Δt, over the same states."""
    longest = TIME_STEPS[-1]
    for (program, setting, bond, dt), states in sorted(groups.items()):
        long = groups.get((program, setting, bond, longest), {})
        if dt == longest or len(states.keys() & long.keys()) < LEAST_STATES:
            continue
        slumps = lambda chosen: {state: values["slump"] for state, values in chosen.items()}
        change = interval.difference(slumps(long), slumps(states))
        yield {"program": program, "setting": setting, "bond": bond, "from_secs": dt, "to_secs": longest} | change


def draw(rows):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot, ticker

    pyplot.rcParams.update({"font.size": 12})
    bonds = [0, 8, 20, 50]
    figure, panels = pyplot.subplots(2, 4, figsize=(12, 7), sharex=True, sharey=True, layout="constrained")
    found = {(row["program"], row["setting"], row["bond"], row["time_step_secs"]): row["slump"] for row in rows}
    for curves, panel_row, title in ((TOUCH, panels[0], "ends with contact"), (RANGE, panels[1], "up to 0.01 d")):
        for panel, bond in zip(panel_row, bonds):
            if bond == 0 and curves is RANGE:
                continue
            for index, (curve, (label, colour, mark)) in enumerate(curves.items()):
                points = sorted((key[3], slump) for key, slump in found.items() if key[:3] == (*curve, bond))
                if not points:
                    continue
                shift = SIDE_BY_SIDE ** (index - 0.5 * (len(curves) - 1))
                panel.errorbar(
                    [dt * shift for dt, _ in points],
                    [slump["mean"] for _, slump in points],
                    [slump["within"] or 0 for _, slump in points],
                    label=label, color=colour, marker=mark, markersize=6, capsize=3, linewidth=1.3,
                )
            panel.set_title(f"Bond {bond}" + (f", {title}" if bond else ", no cohesion"), fontsize=12)
            panel.set_xscale("log")
            panel.set_xticks([1e-4, 1e-3, 5e-3], ["1e-4", "1e-3", "5e-3"])
            panel.xaxis.set_minor_locator(ticker.NullLocator())
            panel.set_ylim(0, 0.62)
            panel.grid(alpha=0.3)
    # Without cohesion only the first row has a panel; the legend takes the place of the second panel.
    panels[1, 0].axis("off")
    handles = {}
    for panel in panels.flat:
        handles |= dict(zip(*reversed(panel.get_legend_handles_labels())))
    place = {"loc": "center", "bbox_to_anchor": (0.4, 0.5)}
    panels[1, 0].legend(handles.values(), handles.keys(), fontsize=11, frameon=False, **place)
    panels[0, 0].set_ylabel("slump after 1 s")
    panels[1, 1].set_ylabel("slump after 1 s")
    panels[1, 1].yaxis.set_tick_params(labelleft=True)
    panels[0, 0].xaxis.set_tick_params(labelbottom=True)
    for panel in (panels[0, 0], *panels[1, 1:]):
        panel.set_xlabel("time step Δt, s")
    figure.savefig(PICTURE, dpi=100)


def main():
    work = sys.argv[1]
    groups = grouped([*peers(work), *supplied()])
    rows = [*own(), *rows_of(groups)]
    with open(os.path.join(work, "two_bodies.json")) as file:
        two_bodies = json.load(file)
    versions = {name: importlib.metadata.version(name) for name in ("mujoco", "migflow", "gmsh", "numpy")}
    report = {
        "about": "The pile of 138 cohesive grains in several programs; ../README.md explains the settings",
        "command": "benches/peers/python/run.sh",
        "date": sys.argv[2] if len(sys.argv) > 2 else datetime.date.today().isoformat(),
        "versions": {"lmgc90": "2025 rc1", "python": platform.python_version(), **versions},
        "intervals": "within is half the 95 % interval over initial states (t); changes are paired by state",
        "two_bodies": two_bodies,
        "rows": rows,
        "changes": list(changes_of(groups)),
    }
    path = RESULTS / "cohesion.json"
    path.write_text(json.dumps(report, indent=1) + "\n")
    draw(rows)
    print(path, PICTURE, sep="\n")


if __name__ == "__main__":
    main()
