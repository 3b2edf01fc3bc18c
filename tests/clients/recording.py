"""Reads a recording from its CSV files. All other formats are compared with these values."""

import json

import pandas

OF_FRAME = ["step", "time"]


def kinds(recording, name):
    """Return the kind of each column of a table: number, count, flag or word."""
    with open(f"{recording}/data.json") as file:
        tables = json.load(file)["tables"]
    return {column["name"]: column["values"] for column in tables[name]}


def table(recording, name):
    """Return a table: numbers as they were written, flags and words as words, None for missing values."""
    of_columns = kinds(recording, name)
    numbers = {column: [""] for column, kind in of_columns.items() if kind != "word"}
    words = {column: "str" for column, kind in of_columns.items() if kind in ("word", "flag")}
    return pandas.read_csv(
        f"{recording}/csv/{name}.csv",
        comment="#", float_precision="round_trip", keep_default_na=False, na_values=numbers, dtype=words,
    )


def frames(recording):
    """Return step and time of each frame."""
    found = pandas.read_csv(f"{recording}/frames.csv", comment="#", float_precision="round_trip")
    assert len(found) > 1, "one frame alone tells nothing"
    return found


def codes(words, column):
    """Return words as indices in a list."""
    return column.map({word: code for code, word in enumerate(words)}).to_numpy()


def flags(column):
    """Return flags as numbers: true, false and missing are 1, 0 and -1."""
    return column.map({"true": 1, "false": 0}).fillna(-1).to_numpy()
