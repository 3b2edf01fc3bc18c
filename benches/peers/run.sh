#!/bin/sh
# All tables of results/. The 2,000 grains are settled first, which takes about a minute.
set -eu
cd "$(dirname "$0")"
cargo build --release
peers="${CARGO_TARGET_DIR:-target}/release/slump-peers"
state="${CARGO_TARGET_DIR:-target}/pile_2000.csv"
if [ ! -e "$state" ]; then
    (cd ../.. && env -u CARGO_TARGET_DIR cargo build --release)
    ../../target/release/slump generate --grains 2000 --box-width 60 --seed 1 --out "$state"
fi
"$peers" --out results/collapse_138.csv
"$peers" --initial "$state" --box-width 60 --substeps 16 --slop 5e-4 --out results/collapse_2000.csv
"$peers" --initial "$state" --box-width 60 --substeps 16 --slop 5e-4 --rest --duration 0.2 \
    --out results/rest_2000.csv
