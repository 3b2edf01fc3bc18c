#!/usr/bin/env bash
# Installs the Python package as a user does, in its own environment, and runs its tests: python/try.sh [PYTEST ARGUMENTS].
# The package shares the target folder of the program, and so most compiled crates. The tests compare the package with
# the program, which must be built first: cargo build --release --no-default-features. For another Python version:
# PYTHON=python3.13 python/try.sh
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
export SLUMP_PROGRAM=${SLUMP_PROGRAM:-$CARGO_TARGET_DIR/release/slump}
python=${PYTHON:-python3}
environment=$CARGO_TARGET_DIR/python-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')

# The compiled module has neither window nor GPU.
crates=$(cargo tree --locked -p slump-python -e normal,build --prefix none | sed 's/ (.*//' | sort -u)
if grep -E '^(egui|wgpu|winit) ' <<<"$crates"; then
    echo "python/Cargo.toml must leave these out, with all that they need: default-features = false" >&2
    exit 1
fi
[ -x "$environment/bin/python" ] || "$python" -m venv "$environment"
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check './python[test]'
PYTHONDONTWRITEBYTECODE=1 "$environment/bin/python" -m pytest -q -c python/pyproject.toml -p no:cacheprovider python/tests "$@"
