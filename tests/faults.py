#!/usr/bin/env python3
"""What a scheduler, a full disk or a closed terminal does to long work, some 300 times over.

tests/faults.py target/release/slump [FAULTS] > table

Signals at random times x frames, GIF, sweep; a file system that is full (needs root, else left out); folders
that are read-only or missing; streams that are closed or full. After each fault everything that was finished
must be there and readable, nothing half-written under a final name, and the same command must go on. Prints a
line for each kind of fault: how many, and what was lost. Exit code 1 where anything was.
"""
import collections, csv, glob, json, os, random, shutil, signal, subprocess, sys, tempfile, time

BINARY = os.path.abspath(sys.argv[1])
FAULTS = int(sys.argv[2]) if len(sys.argv) > 2 else 300
SIGNALS = {"KILL": signal.SIGKILL, "TERM": signal.SIGTERM, "INT": signal.SIGINT, "HUP": signal.SIGHUP}
CODES = {"KILL": -9, "TERM": 143, "INT": 130, "HUP": 129}
STUDY = """name = "faults"
[base]
scene = "cradle"
duration = 1.5
[vary]
dt = { from = 1e-4, to = 1e-2, count = 24, scale = "log" }
"""
random.seed(1)
counts, losses = collections.Counter(), collections.defaultdict(list)


def start(*words, **more):
    return subprocess.Popen([BINARY, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **more)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def check_folder(out, killed):
    """What is wrong with a folder of frames."""
    wrong = []
    left = [name for name in os.listdir(out) if "tmp" in name] if os.path.isdir(out) else []
    if left and not killed:
        wrong.append(f"left behind: {left}")
    for path in glob.glob(os.path.join(out, "frame_*.png")):
        with open(path, "rb") as file:
            if not file.read().endswith(b"IEND\xaeB`\x82"):
                wrong.append(f"half a picture: {path}")
    table = os.path.join(out, "observables.csv")
    if os.path.exists(table):
        rows = rows_of(table)
        whole = [row for row in rows if len(row) == len(rows[0])]
        # The last row of a process that was killed may be cut; no other one.
        if len(whole) < len(rows) - (1 if killed else 0):
            wrong.append("rows that are cut")
        steps = [int(row[0]) for row in whole[1:]]
        if steps != list(range(1, len(steps) + 1)):
            wrong.append("steps are missing")
    manifest = os.path.join(out, "manifest.json")
    if os.path.exists(manifest):
        try:
            ended = [run["ended"] for run in json.load(open(manifest))["runs"]]
            if not killed and not set(ended) <= {"interrupted", "complete"}:
                wrong.append(f"ended: {ended}")
        except ValueError:
            wrong.append("the manifest is no JSON")
    elif not killed and os.path.exists(table):
        wrong.append("no manifest")
    return wrong


def note(kind, wrong):
    counts[kind] += 1
    losses[kind] += wrong


def frames_or_gif(folder, name, gif):
    out = os.path.join(folder, "out")
    words = ["--headless", "--renderer", "cpu", "--size", "64x36", "--duration", "3", "--dt", "1e-3", "--solver", "newton"]
    words += ["--gif", os.path.join(folder, "a.gif")] if gif else ["--frames", out]
    if random.random() < 0.5:
        words += ["--colour", "speed"]
    run = start(*words)
    time.sleep(random.uniform(0.02, 1.0))
    run.send_signal(SIGNALS[name])
    code = run.wait(timeout=30)
    wrong = [] if code in (CODES[name], 0) else [f"exit code {code} after {name}"]
    killed = name == "KILL"
    if gif:
        path = os.path.join(folder, "a.gif")
        if os.path.exists(path) and os.path.getsize(path) > 0 and not open(path, "rb").read(6) == b"GIF89a":
            wrong.append("no GIF")
        if not killed and [n for n in os.listdir(folder) if "tmp" in n]:
            wrong.append("left behind")
    else:
        wrong += check_folder(out, killed)
    note(f"{'gif' if gif else 'frames'}, {name}", wrong)


def sweep_once(folder, name, whole):
    study = os.path.join(folder, "study.toml")
    open(study, "w").write(STUDY)
    out = os.path.join(folder, "out")
    run = start("sweep", study, "--out", out)
    time.sleep(random.uniform(0.01, 0.6))
    run.send_signal(SIGNALS[name])
    run.wait(timeout=60)
    wrong = []
    if start("sweep", study, "--out", out).wait(timeout=120) != 0:
        wrong.append("does not go on")
    elif open(os.path.join(out, "runs.csv")).read() != whole:
        wrong.append("another table")
    note(f"sweep, {name}", wrong)


def full_disk(folder):
    disk = os.path.join(folder, "disk")
    os.mkdir(disk)
    size = random.choice(["64k", "200k", "600k"])
    if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk], capture_output=True).returncode:
        return
    try:
        out = os.path.join(disk, "out")
        code = start("--headless", "--renderer", "cpu", "--size", "64x36", "--duration", "1", "--frames", out).wait(timeout=120)
        wrong = [] if code in (0, 2) else [f"exit code {code}"]
        note(f"full disk of {size}", wrong + check_folder(out, True))
    finally:
        subprocess.run(["umount", disk])


def closed_stream(folder):
    words = random.choice([["list"], ["scene"], ["--help"], ["scene", "--scene", "cradle"]])
    stream = random.choice([">&-", "2>&-", "> /dev/full", "2> /dev/full", "| head -1 > /dev/null"])
    run = subprocess.run(f"{BINARY} {' '.join(words)} {stream}", shell=True, capture_output=True, text=True)
    note(f"stream {stream}", ["panic"] if "panicked" in run.stderr or run.returncode > 2 else [])


def bad_folder(folder):
    missing = random.random() < 0.5
    place = "/proc/no/such/folder" if missing else "/proc"
    words = random.choice([["--headless", "--frames", place], ["generate", "--grains", "5", "--out", f"{place}/a.csv"],
        ["--headless", "--gif", f"{place}/a.gif", "--scene", "cradle"]])
    run = subprocess.run([BINARY, *words], capture_output=True, text=True)
    said = [line for line in run.stderr.splitlines() if line.startswith("slump:")]
    fine = run.returncode == 2 and len(said) == 1
    note("a folder that is none", [] if fine else [f"{words}: code {run.returncode}, {run.stderr[-200:]!r}"])


def main():
    with tempfile.TemporaryDirectory() as folder:
        study = os.path.join(folder, "study.toml")
        open(study, "w").write(STUDY)
        assert start("sweep", study, "--out", os.path.join(folder, "out")).wait() == 0
        whole = open(os.path.join(folder, "out", "runs.csv")).read()
    kinds = [lambda f: frames_or_gif(f, random.choice(list(SIGNALS)), False), lambda f: frames_or_gif(f, random.choice(list(SIGNALS)), True),
        lambda f: sweep_once(f, random.choice(list(SIGNALS)), whole), full_disk, closed_stream, bad_folder]
    for number in range(FAULTS):
        folder = tempfile.mkdtemp()
        kinds[number % len(kinds)](folder)
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{'fault':28} times  lost")
    for kind in sorted(counts):
        print(f"{kind:28} {counts[kind]:5}  {len(losses[kind])} {'; '.join(sorted(set(losses[kind])))[:300]}")
    print(f"{sum(counts.values())} faults, {sum(map(len, losses.values()))} losses")
    return 1 if any(losses.values()) else 0


sys.exit(main())
