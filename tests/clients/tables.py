"""Reads the Parquet files with pandas and polars, and compares schemas, rows and values with the CSV files."""

import sys

import numpy
import pandas
import polars
import pyarrow.parquet

from recording import frames, kinds, table

DTYPES = {"number": polars.Float64, "count": polars.Int64, "flag": polars.Boolean, "word": polars.String}
PANDAS = {"number": "float64", "count": "int64"}


def main(recording):
    for name in ["grains", "contacts", "pairs", "walls", "steps", "measures", "histograms"]:
        text, of_columns = table(recording, name), kinds(recording, name)
        by_polars = polars.read_parquet(f"{recording}/{name}/*.parquet")
        by_pandas = pandas.read_parquet(f"{recording}/{name}")
        lazily = polars.scan_parquet(f"{recording}/{name}").select(polars.len()).collect().item()
        assert list(by_polars.columns) == list(by_pandas.columns) == list(text.columns) == list(of_columns), name
        assert len(by_polars) == len(by_pandas) == len(text) == lazily > 0, name
        for column, kind in of_columns.items():
            assert by_polars.schema[column] == DTYPES[kind], (name, column, by_polars.schema[column])
            assert by_pandas[column].dtype == PANDAS.get(kind, by_pandas[column].dtype), (name, column)
            compare(f"{name}.{column}", kind, text[column], by_polars[column], by_pandas[column])
        described(recording, name, of_columns)
    wanted = frames(recording)
    assert list(polars.read_parquet(f"{recording}/measures")["step"]) == list(wanted["step"])
    assert list(table(recording, "grains")["step"].unique()) == list(wanted["step"])
    steps = pandas.read_parquet(f"{recording}/steps")["step"]
    assert list(steps) == list(range(1, len(steps) + 1)), "a row a step"
    print(f"pandas {pandas.__version__} and polars {polars.__version__} read {recording}")


def compare(column, kind, text, by_polars, by_pandas):
    none = text.isna().to_numpy()
    assert (by_polars.is_null().to_numpy() == none).all(), column
    assert (by_pandas.isna().to_numpy() == none).all(), column
    here, there, too = text.to_numpy()[~none], by_polars.drop_nulls().to_numpy(), by_pandas.to_numpy()[~none]
    if kind == "flag":
        here = here == "true"
    if kind == "number":
        # The comparison is bitwise, so that -0 differs from 0.
        here, there, too = (numpy.asarray(it, dtype=float).view(numpy.int64) for it in (here, there, too))
    assert (here == there).all() and (here == too).all(), column


def described(recording, name, columns):
    """Check that the metadata contain the units of the columns and the description of the run."""
    schema = pyarrow.parquet.read_schema(f"{recording}/{name}/part-00000.parquet")
    said = {key.decode(): value.decode() for key, value in schema.metadata.items()}
    assert said["program"].startswith("slump "), said
    assert float(said["parameters.time_step_secs"]) > 0
    for column in columns:
        assert f'"{column}"' in said["columns"], column


main(sys.argv[1])
