#!/bin/sh
# The table and the chart of results/, in about a quarter of an hour on one core.
set -eu
cd "$(dirname "$0")"
cargo run --release
