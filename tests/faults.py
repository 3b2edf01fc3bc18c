#!/usr/bin/env python3
"""Interrupts long work about 300 times, as a scheduler, a full disk or a closed terminal would.

tests/faults.py target/release/slump [FAULTS] > table

Signals at random times hit frames, GIF, sweep, reproduce and chart. Other faults: a full file system (needs root,
otherwise it is left out), folders that are read-only or missing, streams that are closed or full, and two programs
that use one folder. After each fault all finished results must exist and be readable, no file with a final name may
be incomplete, and the same command must resume the work. For sweep, reproduce and chart, the record and the series
of each finished run must be unchanged, and no finished run may be computed again. Prints a line for each kind of
fault: their number, the number of finished runs, and the losses. Exit code 1 if there was any loss.
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
[series]
interval = 0.01
grains = [0, 1, 2]
"""
ENDINGS = {".png": b"IEND\xaeB`\x82", ".svg": b"</svg>", ".json": b"}\n", ".csv": b"\n", ".md": b"\n"}
# Figures of one study that stores time series; they take a few seconds.
FIGURES = ["reproduce", "fig8", "cradle-choices", "--quick"]
CHART = ["chart", "--quick", "--only", "simulation"]
random.seed(1)
counts, losses, finished = collections.Counter(), collections.defaultdict(list), collections.Counter()


def heed_signals():
    """Restore the default signal handlers: the program would inherit ignored signals, for example under nohup."""
    for number in SIGNALS.values():
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)


def start(*words):
    return subprocess.Popen([BINARY, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=heed_signals)


def hit(run, name, after, before):
    """Send a signal to a process at a random time. Return its exit code."""
    time.sleep(random.uniform(after, before))
    run.send_signal(SIGNALS[name])
    try:
        return run.wait(timeout=60)
    except subprocess.TimeoutExpired:
        run.kill()
        run.wait()
        return "of none that ends"


def note(kind, wrong):
    counts[kind] += 1
    losses[kind] += wrong


def half_written(out):
    """Return files with final names that do not end as their format requires. Journals and tables of observables grow
    during the run and are not checked."""
    wrong = []
    for path in glob.glob(os.path.join(glob.escape(out), "**", "*.*"), recursive=True):
        ending = ENDINGS.get(os.path.splitext(path)[1])
        streamed = os.path.basename(path) == "observables.csv"
        if ending and os.path.isfile(path) and not streamed:
            if not open(path, "rb").read().endswith((ending, ending + b"\n")):
                wrong.append(f"half a file: {os.path.basename(path)}")
    return wrong


def check_folder(out, killed):
    """Return the faults in a folder of frames."""
    wrong = half_written(out)
    left = [name for name in os.listdir(out) if "tmp" in name] if os.path.isdir(out) else []
    if left and not killed:
        wrong.append(f"left behind: {left}")
    table = os.path.join(out, "observables.csv")
    if os.path.exists(table):
        with open(table, newline="") as file:
            rows = list(csv.reader(file))
        whole = [row for row in rows if len(row) == len(rows[0])]
        # Only the last row may be cut, and only if the process was killed.
        if len(whole) < len(rows) - (1 if killed else 0):
            wrong.append("rows that are cut")
        steps = [int(row[0]) for row in whole[1:]]
        if steps != list(range(1, len(steps) + 1)):
            wrong.append("steps are missing")
    manifest = os.path.join(out, "manifest.json")
    if os.path.exists(manifest):
        try:
            told = json.load(open(manifest))
        except ValueError:
            return wrong + ["the manifest is no JSON"]
        ended = [run["ended"] for run in told["runs"]]
        if not killed and not set(ended) <= {"interrupted", "complete"}:
            wrong.append(f"ended: {ended}")
        listed = [picture["file"] for picture in told["pictures"]]
        there = sorted(os.path.basename(path) for path in glob.glob(os.path.join(out, "frame_*.png")))
        if listed != there[:len(listed)] or not killed and len(listed) < len(there):
            wrong.append("the manifest lists other pictures")
    elif not killed and os.path.exists(table):
        wrong.append("no manifest")
    return wrong


def frames_or_gif(folder, name, gif):
    out = os.path.join(folder, "out")
    words = ["--headless", "--renderer", "cpu", "--size", "64x36", "--duration", "3", "--dt", "1e-3", "--solver", "newton"]
    words += ["--gif", os.path.join(folder, "a.gif")] if gif else ["--frames", out]
    words += random.choice([[], ["--colour", "speed"], ["--colour", "speed", "--colour-scale", "0,2"]])
    code = hit(start(*words), name, 0.02, 1.0)
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


def name_of(line):
    record = json.loads(line)["record"]
    return record.get("key") or (record["problem"], record["method"])


def kept_in(out):
    """Return the finished runs of a folder: the complete lines of each journal, and the bytes of their series."""
    kept = {}
    for path in glob.glob(os.path.join(out, "**", "*.jsonl"), recursive=True):
        # A kill can leave an incomplete last line.
        lines = open(path, "rb").read().split(b"\n")[:-1]
        courses = {}
        for line in lines:
            course = os.path.join(os.path.dirname(path), "series", f"{name_of(line)}.csv")
            if os.path.exists(course):
                courses[course] = open(course, "rb").read()
        kept[path] = (lines, courses)
    return kept


def number_of(kept):
    return sum(len(lines) for lines, _ in kept.values())


def compare(before, after):
    """Return the differences between the finished runs before and after an interruption."""
    wrong = []
    for path, (lines, courses) in before.items():
        now, courses_now = after.get(path, ([], {}))
        if now[:len(lines)] != lines:
            wrong.append(f"{os.path.basename(path)}: records that were there are gone or others")
        if any(courses_now.get(course) != text for course, text in courses.items()):
            wrong.append("a course that was there is gone or another")
    for path, (lines, _) in after.items():
        again = [name for name, times in collections.Counter(map(name_of, lines)).items() if times > 1]
        if again:
            wrong.append(f"{os.path.basename(path)}: {len(again)} finished runs were computed again")
    return wrong


def outcome_of(out):
    """Return the results of finished work. Reports are omitted, because they contain times."""
    names = [name for name in sorted(os.listdir(out)) if name.endswith((".csv", ".svg", ".png"))]
    return {name: open(os.path.join(out, name), "rb").read() for name in names}


def resumed(folder, name, words, longest, whole):
    """Interrupt a sweep or a set of figures, then run the command to its end."""
    out = os.path.join(folder, "out")
    code = hit(start(*words, "--out", out), name, 0.01, longest)
    before, wrong = kept_in(out), half_written(out)
    if code not in (-SIGNALS[name], 0):
        wrong.append(f"exit code {code}")
    if start(*words, "--out", out).wait(timeout=300) != 0:
        wrong.append("does not go on")
    elif outcome_of(out) != whole:
        wrong.append("another table or picture")
    wrong += compare(before, kept_in(out))
    finished[f"{words[0]}, {name}"] += number_of(before)
    note(f"{words[0]}, {name}", wrong)


def chart_once(name, out):
    """Interrupt a chart repeatedly; each start must resume it."""
    run = start(*CHART, "--out", out)
    before = kept_in(out)
    code = hit(run, name, 0.1, 6.0)
    wrong = [] if code in (-SIGNALS[name], 0) else [f"exit code {code}"]
    after = kept_in(out)
    finished[f"chart, {name}"] += number_of(before)
    note(f"chart, {name}", wrong + half_written(out) + compare(before, after))


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


def closed_stream():
    words = random.choice([["list"], ["scene"], ["--help"], ["scene", "--scene", "cradle"]])
    stream = random.choice([">&-", "2>&-", "> /dev/full", "2> /dev/full", "| head -1 > /dev/null"])
    run = subprocess.run(f"{BINARY} {' '.join(words)} {stream}", shell=True, capture_output=True, text=True)
    note(f"stream {stream}", ["panic"] if "panicked" in run.stderr or run.returncode > 2 else [])


def bad_folder():
    missing = random.random() < 0.5
    place = "/proc/no/such/folder" if missing else "/proc"
    words = random.choice([["--headless", "--frames", place], ["generate", "--grains", "5", "--out", f"{place}/a.csv"],
        ["--headless", "--gif", f"{place}/a.gif", "--scene", "cradle"], [*CHART, "--out", place], [*FIGURES, "--out", place]])
    run = subprocess.run([BINARY, *words], capture_output=True, text=True)
    said = [line for line in run.stderr.splitlines() if line.startswith("slump:")]
    option = "gif" if "--gif" in words else "frames" if "--frames" in words else "out"
    fine = run.returncode == 2 and len(said) == 1 and said[0].startswith(f"slump: {option} is ") and "must be" in said[0]
    note("a folder that is none", [] if fine else [f"{words}: code {run.returncode}, {run.stderr[-200:]!r}"])


PICTURES = ["--headless", "--renderer", "cpu", "--size", "64x36", "--scene", "cradle", "--duration", "4", "--frames"]
TABLES = ["--headless", "--scene", "cradle", "--duration", "4", "--data-format", "csv", "--data"]


def files_of(out):
    """Return tables and pictures. They depend only on the work, except for the command line in the head of a table."""
    paths = glob.glob(os.path.join(out, "**", "*.*"), recursive=True)
    read = lambda path: [line for line in open(path, "rb") if not line.startswith(b"# command: ")]
    return {os.path.relpath(path, out): read(path) for path in paths if path.endswith((".csv", ".png"))}


def two_programs(folder, works):
    """Start two programs that use one folder, the second at a random time. If a program ends with success, all its
    results must be there, unless the other program clears the folder and started after the first had ended."""
    out = os.path.join(folder, "out")
    kinds = random.choices(list(works), k=2)
    clears = [random.random() < 0.5 for _ in kinds]
    options = {"sweep": "--redo"}
    lines = [[*works[kind][0], out, *[options.get(kind, "--overwrite")] * clear] for kind, clear in zip(kinds, clears)]
    first = start(*lines[0])
    time.sleep(random.uniform(0, 1.5 * works[kinds[0]][2]))
    second, was_over = start(*lines[1]), first.poll() is not None
    codes = [run.wait(timeout=120) for run in (first, second)]
    there, wrong = files_of(out), half_written(out)
    if not set(codes) <= {0, 2} or 0 not in codes:
        wrong.append(f"exit codes {codes}")
    is_cleared = was_over and clears[1] and codes[1] == 0
    for kind, code, cleared in zip(kinds, codes, [is_cleared, False]):
        if code == 0 and not cleared and any(there.get(name) != text for name, text in works[kind][1].items()):
            wrong.append(f"{kind} of {kinds}, clearing {clears}: not all that was finished is there")
    finished["two programs"] += codes.count(0)
    note("two programs", wrong)


def main():
    home = tempfile.mkdtemp()
    study, charts = os.path.join(home, "study.toml"), os.path.join(home, "chart")
    open(study, "w").write(STUDY)
    sweep, whole, secs = ["sweep", study], {}, {}
    for words in (sweep, FIGURES):
        begun, out = time.time(), os.path.join(home, words[0])
        assert start(*words, "--out", out).wait() == 0
        whole[words[0]], secs[words[0]] = outcome_of(out), time.time() - begun
    works = {}
    for kind, words in {"sweep": [*sweep, "--out"], "frames": PICTURES, "data": TABLES}.items():
        begun, out = time.time(), os.path.join(home, "alone", kind)
        assert start(*words, out).wait() == 0
        works[kind] = (words, files_of(out), time.time() - begun)
    any_signal = lambda: random.choice(list(SIGNALS))
    again = lambda words: lambda folder: resumed(folder, any_signal(), words, secs[words[0]], whole[words[0]])
    kinds = [lambda folder: frames_or_gif(folder, any_signal(), False), lambda folder: frames_or_gif(folder, any_signal(), True),
        again(sweep), again(FIGURES), lambda folder: chart_once(any_signal(), charts), full_disk,
        lambda folder: closed_stream(), lambda folder: bad_folder(), lambda folder: two_programs(folder, works)]
    for number in range(FAULTS):
        folder = tempfile.mkdtemp()
        kinds[number % len(kinds)](folder)
        shutil.rmtree(folder, ignore_errors=True)
    before = kept_in(charts)
    if start(*CHART, "--out", charts).wait() != 0 or not os.path.exists(os.path.join(charts, "chart.md")):
        losses["chart"].append("does not come to its end")
    losses["chart"] += compare(before, kept_in(charts))
    shutil.rmtree(home, ignore_errors=True)
    print(f"{'fault':28} times  finished runs  lost")
    for kind in sorted(set(counts) | {kind for kind in losses if losses[kind]}):
        runs = finished.get(kind, "")
        print(f"{kind:28} {counts[kind]:5}  {runs:13}  {len(losses[kind])} {'; '.join(sorted(set(losses[kind])))[:300]}")
    print(f"{sum(counts.values())} faults, {sum(finished.values())} finished runs, {sum(map(len, losses.values()))} losses")
    return 1 if any(losses.values()) else 0


sys.exit(main())
