"""Tests that error budgets agree with the command line."""

import json

import pytest
import slump
from command_line import run

CRADLE = {"duration": 0.5, "quantity": ["max(max_overlap)", "kinetic_energy"], "within": 1e-4}


def test_a_budget_is_that_of_the_command_line(tmp_path):
    budget = slump.budget("cradle", **CRADLE)
    asked = ["--scene", "cradle", "--duration", "0.5", "--within", "1e-4", "--out", str(tmp_path)]
    run("budget", *asked, "--quantity", "max(max_overlap)", "--quantity", "kinetic_energy")
    data = json.loads((tmp_path / "budget.json").read_text())
    assert budget.answers.keys() == {"max(max_overlap)", "kinetic_energy"}
    for one in data["quantities"]:
        rows = [row for row in zip(budget["quantity"], budget["changed"], budget["adds"]) if row[0] == one["quantity"]]
        assert [(cause["changed"], (cause["adds"] or [None])[0]) for cause in one["causes"]] == [
            row[1:] for row in rows[1 : 1 + len(one["causes"])]
        ]
        assert budget.trust[one["quantity"]] == one["trust"]


def test_data_frames_read_it():
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame(slump.budget("cradle", duration=0.2, within=1e-3, quantity="max_overlap"))
    assert frame.filter(polars.col("cause") == "time step").height >= 3


def test_it_goes_on_in_a_folder_and_refuses_what_cannot_be_asked(tmp_path):
    first = slump.budget("cradle", duration=0.2, quantity="max_overlap", within=1e-3, out=tmp_path / "out")
    lines = (tmp_path / "out" / "budget.jsonl").read_text()
    assert slump.budget("cradle", duration=0.2, quantity="max_overlap", within=1e-3, out=tmp_path / "out") == first
    assert (tmp_path / "out" / "budget.jsonl").read_text() == lines
    with pytest.raises(slump.InputError, match="quantity is slumpp"):
        slump.budget(quantity="slumpp")
    with pytest.raises(slump.InputError, match="within is -1"):
        slump.budget(within=-1)
    with pytest.raises(TypeError, match="bonds is given"):
        slump.budget(bonds=3)
