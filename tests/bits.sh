#!/usr/bin/env bash
# Compares builds of the program by several compilers and for several systems: in five runs, all builds must give
# bitwise equal final states and tables of observables.
#
#   tests/bits.sh PROGRAM PROGRAM …
#
# A PROGRAM is a path, or in quotes the command that runs it and the path: "qemu-aarch64 -L /usr/aarch64-linux-gnu
# slump", "wine slump.exe".
set -euo pipefail
[ $# -gt 1 ] || { echo "usage: tests/bits.sh PROGRAM PROGRAM …" >&2; exit 2; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
runs=("cradle --duration 0.5" "pile --bond 20 --duration 0.2" "pile --bond 100 --dt 5e-3 --duration 0.3"
    "arch --duration 0.1" "drum --duration 0.1")

number=0
for program in "$@"; do
    number=$((number + 1))
    for run in "${!runs[@]}"; do
        folder=$out/$number-$run
        # Wine expects paths below Z:, but accepts this path, too. The shell must split the command into words.
        # shellcheck disable=SC2086
        $program run ${runs[run]} --times 0 --renderer cpu --size 64x64 --frames "$folder" 2>"$out/log" ||
            { cat "$out/log" >&2; echo "tests/bits.sh: $program fails: run ${runs[run]}" >&2; exit 1; }
        grep -o '"last_state": *"[^"]*"' "$folder/manifest.json" >"$folder/state"
        tr -d '\r' <"$folder/observables.csv" >"$folder/table"
        [ -s "$folder/state" ]
        for file in state table; do
            cmp "$out/1-$run/$file" "$folder/$file" ||
                { echo "tests/bits.sh: $program comes to another $file than $1: run ${runs[run]}" >&2; exit 1; }
        done
    done
done
echo "$# programs, ${#runs[@]} runs: the same to the last bit"
