#!/usr/bin/env bash
# A release in a folder: ./release.sh [FOLDER]. Archives of the program for Linux on x86-64 and aarch64 and, as an experiment,
# for Windows on x86-64; the page; a Python wheel; their checksums. The script tries each outside of this project: in a root of
# Debian 11, under qemu and under wine. FOLDER is target/release-archive by default; an earlier release in it is replaced.
#
# On Debian 12 the script installs the tools it needs: compilers, wine and qemu by apt, zig and maturin by pip, wasm-bindgen by
# cargo.
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath -m "${1:-target/release-archive}")

fail() {
    echo "release.sh: $*" >&2
    exit 1
}

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

# Tools. Debian's compiler has the sources of the standard library, which is built with the program for another system.
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" apt-get install -y -q --no-install-recommends rustc-web cargo-web rust-web-src lld gcc-mingw-w64-x86-64 \
    libc6-arm64-cross qemu-user wine wine64 xvfb xdotool mmdebstrap nodejs python3-venv
python3 -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.9,<2' 'cargo-zigbuild>=0.20' ziglang
ln -s "$work"/tools/lib/python3*/site-packages/ziglang/zig "$work/tools/bin/zig"
export PATH=$PATH:$work/tools/bin
bindgen=$(sed -n '/^name = "wasm-bindgen"$/{n;s/version = "\(.*\)"/\1/p}' web/Cargo.lock)
[ "$(wasm-bindgen --version 2>/dev/null)" = "wasm-bindgen $bindgen" ] ||
    cargo install wasm-bindgen-cli --version "$bindgen"
debian() {
    RUSTC_BOOTSTRAP=1 PATH=/usr/bin:$PATH CARGO_TARGET_DIR=$CARGO_TARGET_DIR/debian cargo "$@"
}

# The programs. Each prints the commit that it is built from. glibc 2.17 is the oldest that Rust's standard library supports.
touch build.rs
intel=x86_64-unknown-linux-gnu arm=aarch64-unknown-linux-gnu windows=x86_64-pc-windows-gnu
cargo zigbuild --release --locked --target $intel.2.17
debian zigbuild --release --locked --target $arm.2.17 -Zbuild-std
debian build --release --locked --target $windows -Zbuild-std
program=$CARGO_TARGET_DIR/$intel/release/slump
declare -A programs=([$intel]=$program [$arm]=$CARGO_TARGET_DIR/debian/$arm/release/slump
    [$windows]=$CARGO_TARGET_DIR/debian/$windows/release/slump.exe)
said=$("$program" --version)
[ "$said" = "slump $version ($commit)" ] || fail "the program says \"$said\", but is of $version ($commit)"

# What is packed with each of them.
packed=$work/packed
mkdir -p "$packed"/{completions,man/man1}
cp README.md CHANGELOG.md CITATION.cff LICENSE-MIT LICENSE-APACHE THIRD-PARTY.md assets/fonts/LICENSE-DejaVu.txt "$packed"
cp -r docs screenshots "$packed"
for shell in bash zsh fish powershell; do
    "$program" completions "$shell" >"$packed/completions/slump.$shell"
done
"$program" man >"$packed/man/man1/slump.1"
for command in $("$program" help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p' | grep -v '^help$'); do
    "$program" man "$command" >"$packed/man/man1/slump-$command.1"
done
# Licences of all crates that are in a program, the wheel or the page, word by word.
: >"$work/crates"
for target in "${!programs[@]}"; do
    cargo metadata --locked --format-version 1 --filter-platform "$target" >"$work/$target.json"
    cargo tree --locked --target "$target" -e normal --prefix none --format '{p}' -p slump-lab -p slump-python >>"$work/crates"
done
of_page=(--locked --manifest-path web/Cargo.toml)
cargo metadata "${of_page[@]}" --format-version 1 --filter-platform wasm32-unknown-unknown >"$work/page.json"
cargo tree "${of_page[@]}" --target wasm32-unknown-unknown -e normal --prefix none --format '{p}' >>"$work/crates"
python3 - "$work" <<'PYTHON' >"$packed/THIRD-PARTY-LICENCES.txt"
import json, pathlib, sys

work = pathlib.Path(sys.argv[1])
used = {tuple(line.split()[:2]) for line in (work / "crates").read_text().splitlines()}
beginnings = ("LICEN", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE", "UFL", "OFL")
packages = {}
for file in work.glob("*.json"):
    for crate in json.loads(file.read_text())["packages"]:
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
# pack FOLDER FILE: packs a folder of $work into an archive whose bytes depend on the content only.
pack() {
    tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$secs" -c "$1" | gzip -9n >"$out/$2"
}
for target in "${!programs[@]}"; do
    name=slump-$version-$target
    cp -r "$packed" "$work/$name"
    cp "${programs[$target]}" "$work/$name"
    pack "$name" "$name.tar.gz"
done
cp "$packed/THIRD-PARTY-LICENCES.txt" CHANGELOG.md "$out"

# The page, a folder of static files.
web/build.sh "$work/page"
node web/states.mjs "$work/page" "$program" || fail "the page comes to other states than the program"
cp "$packed"/{LICENSE-MIT,LICENSE-APACHE,LICENSE-DejaVu.txt,THIRD-PARTY.md,THIRD-PARTY-LICENCES.txt} "$work/page"
pack page "slump-$version-page.tar.gz"

# The wheel, for the same glibc.
"$work/tools/bin/pip" download --quiet --disable-pip-version-check --only-binary :all: --dest "$work/wheels" 'numpy>=1.22'
maturin build --release --locked --strip --manifest-path python/Cargo.toml --out "$out" \
    --zig --compatibility manylinux_2_17 --interpreter python3
wheels=("$out"/slump-"$version"-*abi3*.whl)
[ -f "${wheels[0]}" ] || fail "maturin left no wheel of slump $version for all Pythons (abi3) in $out"

(cd "$out" && sha256sum -- * >SHA256SUMS && sha256sum --check --quiet SHA256SUMS) || fail "the checksums do not hold"

# The archive, tried without any variable of the environment, and on Debian 11.
tried=$work/tried
mmdebstrap --quiet --variant=essential bullseye "$tried" 2>"$work/log" || { cat "$work/log"; fail "there is no Debian 11 to try it in"; }
mkdir -p "$tried/tmp"
name=slump-$version-$intel
tar -C "$tried" -xf "$out/$name.tar.gz"
run=(run pile --bond 20 --dt 1e-3 --times 0.1 --size 480x270 --renderer cpu)
(cd "$tried/tmp" && env -i "../$name/slump" "${run[@]}" --frames plain) || fail "the program does not run with env -i"
chroot "$tried" /usr/bin/env -i "/$name/slump" "${run[@]}" --frames /tmp/old || fail "the program does not run on Debian 11"
for folder in plain old; do
    for file in manifest.json observables.csv; do
        [ -s "$tried/tmp/$folder/$file" ] || fail "the program left no $file"
    done
    cmp -s "$tried/tmp/plain/observables.csv" "$tried/tmp/$folder/observables.csv" || fail "two runs differ"
done
bash -n "$tried/$name/completions/slump.bash" || fail "the completions are no bash"

# The programs for other systems: the same bits, and the parts of the system that Windows has in its own form.
tests/windows.sh "${programs[$windows]}"
tests/bits.sh "$program" "qemu-aarch64 -L /usr/aarch64-linux-gnu ${programs[$arm]}" "tests/windows.sh --run ${programs[$windows]}"

# The wheel, tried without Rust and without an index of packages.
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
sim.run(until=0.1)
with open(sys.argv[1], newline="") as file:
    *_, last = csv.DictReader(file)
found, expected = float(sim.observables["slump"]), float(last["slump"])
assert slump.__version__ and found == expected, f"the wheel's slump is {found}, the program's {expected}"
PYTHON
) || fail "the wheel does not do what the program does"

echo "slump $version ($commit), tried, in $out:"
cat "$out/SHA256SUMS"
