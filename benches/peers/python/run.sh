#!/bin/sh
# Runs the pile with cohesion in MuJoCo and MigFlow, and compares it with stored results of Slump and LMGC90. Writes
# results/cohesion.json and screenshots/chart-programs.png.
#
#   benches/peers/python/run.sh [SLUMP]     # path of the program, by default target/release/slump
#
# A second call resumes where the first call was stopped. All files are below target/programs/.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
slump=$(realpath "${1:-$root/target/release/slump}")
work=$root/target/programs
mkdir -p "$work"
test -d "$work/python" || python3 -m venv "$work/python"
python=$work/python/bin/python
"$python" -m pip install --quiet --requirement "$here/requirements.txt"
cd "$work"
for seed in 8 1 2 3 4 5 6 7; do
    test -f "seed$seed.csv" || "$slump" generate --seed $seed --out "seed$seed.csv"
done
"$python" "$here/two_bodies.py" two_bodies.json
"$python" "$here/runs.py" .
"$python" "$here/report.py" .
