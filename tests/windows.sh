#!/usr/bin/env bash
# Tests the program for Windows under Wine: computing, saving, resuming, two runs with one folder, and the window.
#
#   tests/windows.sh PROGRAM.exe [FOLDER]         tests it; a screenshot of the window goes to FOLDER (target/windows)
#   tests/windows.sh --run PROGRAM.exe ARGUMENTS  starts it under Wine
#
# Needs Debian's packages wine wine64 gcc-mingw-w64-x86-64 xvfb xdotool imagemagick mesa-vulkan-drivers.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
export WINEPREFIX=$here/target/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree=;mshtml="

# Wine 8 lacks the library from which Rust gets random numbers. Windows has this library, so the replacement is not
# released.
system=$WINEPREFIX/drive_c/windows/system32
if [ ! -e "$system/bcryptprimitives.dll" ]; then
    mkdir -p "$WINEPREFIX"
    wineboot --init >/dev/null 2>&1
    wineserver --wait
    x86_64-w64-mingw32-gcc -shared -o "$system/bcryptprimitives.dll" -x c - -ladvapi32 <<'C'
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count)
{
    return RtlGenRandom(bytes, count);
}
C
fi
if [ "$1" = --run ]; then
    exec wine "${@:2}"
fi

program=$(realpath "$1")
shots=$(realpath -m "${2:-$here/target/windows}")
mkdir -p "$shots"
work=$(mktemp -d)
trap 'wineserver --kill 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"
fail() {
    echo "tests/windows.sh: $*" >&2
    [ ! -s log ] || sed 's/^/    /' log >&2
    exit 1
}
slump() { wine "$program" "$@" 2>log; }

slump --version | grep -q '^slump ' || fail "it does not start"
run=(run pile --bond 20 --dt 1e-3 --renderer cpu --size 64x64)
slump "${run[@]}" --duration 0.1 --times 0.1 --frames whole --data data --data-every 0.05 --data-format csv,parquet >/dev/null ||
    fail "a run fails"
[ -s whole/observables.csv ] && [ -s data/csv/grains.csv ] || fail "a run leaves no tables"
if slump "${run[@]}" --dt 0 --frames refused >/dev/null || [ "$(wc -l <log)" -ne 1 ]; then
    fail "a time step of 0 is not refused in a sentence"
fi

# A run that was saved and resumed has the same table as an uninterrupted run.
slump "${run[@]}" --duration 0.05 --times 0.05 --frames half --save half.slump >/dev/null || fail "a run is not saved"
slump run --restart half.slump --duration 0.1 --times 0.1 --renderer cpu --size 64x64 --frames rest >/dev/null ||
    fail "a saved run is not continued"
cmp <(tail -n 1 whole/observables.csv) <(tail -n 1 rest/observables.csv) || fail "a continued run comes to another end"

# Compute a study. A second call must find all runs complete.
printf 'name = "two"\n[base]\nscene = "cradle"\nduration = 0.1\n[vary]\ndt = [1e-3, 2e-3]\n' >study.toml
slump sweep study.toml --out study >/dev/null || fail "a study fails"
cp study/runs.csv before.csv
slump sweep study.toml --out study >/dev/null || fail "a finished study is not read"
cmp before.csv study/runs.csv || fail "a finished study changes"

# Two runs must not write to the same folder.
wine "$program" run cradle --dt 1e-3 --duration 3000 --renderer cpu --size 64x18 --frames busy >/dev/null 2>&1 &
for _ in $(seq 300); do [ ! -s busy/observables.csv ] || break; sleep 0.1; done
if slump run cradle --duration 0.1 --renderer cpu --size 64x18 --frames busy --overwrite >/dev/null; then
    fail "two runs write to one folder"
fi
grep -q "is being written by another run" log || fail "a folder in use is not named"
wineserver --kill

# Open the window, which stores its settings in %APPDATA%.
Xvfb -displayfd 4 -screen 0 1280x800x24 4>display >/dev/null 2>&1 &
server=$!
for _ in $(seq 100); do [ ! -s display ] || break; sleep 0.1; done
export DISPLAY=:$(cat display)
wine "$program" --bond 20 >/dev/null 2>log &
for _ in $(seq 600); do xdotool search --name Slump >/dev/null 2>&1 && break; sleep 0.1; done
xdotool search --name Slump >/dev/null || fail "no window opens"
# Before the first frame the screen is black.
for _ in $(seq 60); do
    sleep 1
    import -window root "$shots/windows.png"
    brightness=$(convert "$shots/windows.png" -format '%[fx:mean]' info:)
    if awk "BEGIN { exit !($brightness > 0.5) }"; then break; fi
done
awk "BEGIN { exit !($brightness > 0.5) }" || fail "the window stays black: $shots/windows.png"
kill "$server"
echo "tried under wine; the window is in $shots/windows.png"
