#!/bin/sh
# Makes the table and the chart in results/, in about a quarter of an hour on one core. With the argument `reasons` it
# makes results/reasons.json instead, in ten minutes.
set -eu
cd "$(dirname "$0")"
cargo run --release -- "$@"
