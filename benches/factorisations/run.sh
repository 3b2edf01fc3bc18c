#!/bin/sh
# Makes piles, records their contacts shortly after the walls are removed, and times the factorisations on them.
set -eu
here=$(dirname "$(readlink -f "$0")")
program=${SLUMP:-$here/../../target/release/slump}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tables=
for pile in 500,30.5,rain 2000,61,rain 10000,134,drop-and-roll ${PILES:-}; do
    grains=$(echo "$pile" | cut -d, -f1)
    width=$(echo "$pile" | cut -d, -f2)
    "$program" --headless --grains "$grains" --box-width "$width" --deposition "${pile##*,}" --bond 20 --dt 1e-4 \
        --max-sweeps 40 --duration 0.001 --data-every 1 --data "$work/$grains" --data-format csv > "$work/log" 2>&1 \
        || { cat "$work/log" >&2; exit 2; }
    tables="$tables $work/$grains/csv/contacts.csv"
done
# The list is not quoted, because names from mktemp contain no spaces.
cargo run --quiet --release --manifest-path "$here/Cargo.toml" -- $tables
