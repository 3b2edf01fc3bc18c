#!/usr/bin/env bash
# Reads recordings with the programs of users: pandas, polars, PyVista, MDAnalysis, ASE and OVITO from PyPI, and
# ParaView if it is installed. Records a few small runs, reads them with each program, and fails if a program reads
# other values.
#
#   tests/clients/try.sh [--fast] [FOLDER]
#
# --fast omits OVITO and ParaView, which are large. The recordings and ParaView's picture remain in FOLDER. The Python
# packages are installed once, to target/clients. The variable SLUMP names an existing program; without it the program
# is built.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."

fast=
if [ "${1:-}" = --fast ]; then
    fast=yes
    shift
fi
if [ $# -gt 0 ]; then
    out=$1
    mkdir -p "$out"
else
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi

if [ -z "${SLUMP:-}" ]; then
    cargo build --release --quiet
    SLUMP=$PWD/target/release/slump
fi
python=target/clients/bin/python
[ -x "$python" ] || python3 -m venv target/clients
packages=(numpy pandas polars pyarrow pyvista MDAnalysis ase)
[ -n "$fast" ] || packages+=(ovito)
"$python" -m pip install --quiet --disable-pip-version-check "${packages[@]}"

record() {
    local name=$1
    shift
    "$SLUMP" --headless --data "$out/$name" --overwrite --data-format parquet,csv,vtk,ovito,fields "$@" 2>"$out/$name.log" ||
        { cat "$out/$name.log" >&2; exit 1; }
}
# Runs: the paper's law on a base of fixed discs, bonds with a stretch, and walls of every shape.
record pile --bond 20 --dt 1e-3 --duration 0.3 --data-every 0.05
record bonds --stepper range --bond 20 --dt 1e-3 --duration 0.02 --data-every 0.01
record walls --scene assets/scenes/hourglass.toml --duration 0.1 --data-every 0.02
# A run in which grains leave a periodic cell.
record periodic --scene shear --dt 2e-3 --duration 1 --data-every 0.25

for run in pile bonds walls; do
    "$python" "$here/tables.py" "$out/$run"
    "$python" "$here/vtk_files.py" "$out/$run"
    "$python" "$here/lammps_readers.py" "$out/$run"
    [ -n "$fast" ] || "$python" "$here/ovito_files.py" "$out/$run"
done

"$python" "$here/lammps_readers.py" "$out/periodic"

if [ -z "$fast" ] && command -v pvpython >/dev/null; then
    # Debian's ParaView draws only on a display.
    xvfb-run -a pvpython "$here/draw_in_paraview.py" "$out/pile" 0.2 "$out/paraview.png"
    test -s "$out/paraview.png"
    echo "ParaView draws the pile"
fi
