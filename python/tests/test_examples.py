"""Tests that the examples and the code on the documentation pages run."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT

import slump

EXAMPLES = sorted(path for path in (ROOT / "python" / "examples").glob("*.py") if "def main" in path.read_text())
PAGES = [ROOT / page for page in ("README.md", "docs/python-and-rust.md", "docs/runs.md", "python/README.md")]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_leaves_a_picture(tmp_path: Path, example: Path) -> None:
    picture = tmp_path / "picture.png"
    command = [sys.executable, str(example), "--quick", "--out", str(picture)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == "" and done.stdout.strip() == str(picture)
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 10_000


RUN_NOTEBOOK = """
import sys, nbclient, nbformat
notebook = nbformat.read(sys.argv[1], as_version=4)
nbclient.NotebookClient(notebook, kernel_name="python3").execute()
for cell in notebook.cells:
    for output in cell.get("outputs", []):
        print(output.get("text") or " ".join(output["data"]))
"""


@pytest.mark.parametrize("notebook", sorted((ROOT / "python" / "examples").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_runs_and_is_kept_without_outputs(tmp_path: Path, notebook: Path) -> None:
    assert '"outputs": []' in notebook.read_text() and "image/png" not in notebook.read_text()
    command = [sys.executable, "-c", RUN_NOTEBOOK, str(notebook)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "text/html" in done.stdout and done.stdout.count("image/png") == 2
    # Every difference that the notebook prints is due to rounding.
    rests = [float(rest) for rest in re.findall(r"^1 less .*: (\S+)$", done.stdout, re.MULTILINE)]
    assert len(rests) == 2 and max(map(abs, rests)) < 1e-11, done.stdout


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_what_a_page_says_runs(tmp_path: Path, page: Path) -> None:
    programs = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    assert programs, "a page with a program"
    # Make the recording that the code on the pages reads.
    sim = slump.Simulation("pile", bond=50, dt=5e-4)
    sim.record(tmp_path / "run", every=0.01)
    sim.step(200)
    sim.end_recording()
    for program in programs:
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert done.stdout or "print" not in program, "it says something"
