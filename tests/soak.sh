#!/usr/bin/env bash
# Runs the real window under Xvfb as fast as possible, and checks that its memory does not grow: the recorded run has a
# memory limit, and some of its states are removed when it reaches the limit. Then random clicks, drags and keys are
# sent to the window for the same time: it must stay open, print nothing on stderr and need less than 600 MiB.
#
#   tests/soak.sh [SECONDS]        time of each part (default: 60)
#
# Needs the programs that tests/window.sh needs.
set -euo pipefail

cd "$(dirname "$0")/.."
program=$(realpath "${SLUMP:-target/release/slump}")
seconds=${1:-60}
. tests/display.sh

screen 1280x800
resident_mib() { awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$window/status"; }

# The duration is so long that the run does not end after the pile has slumped and come to rest.
"$program" --reset-ui --bond 20 --dt 2e-3 --max-sweeps 20 --duration 1e6 --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the pile" "s['scene'] == 'pile'"
xdotool mousemove $(at scene 0.5)
sleep 1
xdotool search --name Slump windowfocus
# Six steps of the pace select full speed.
for _ in 1 2 3 4 5 6; do xdotool key bracketright; done
xdotool key space
wait_for "the first steps" "s['playing'] and s['step'] > 10"

halfway=
for part in 1 2 3 4 5 6 7 8 9 10; do
    sleep "$(python3 -c "print($seconds / 10)")"
    kill -0 "$window" 2>/dev/null || fail "the window is gone"
    [ "$(value "s['playing']")" = True ] || fail "the run has stopped"
    echo "$(value "s['step']") steps, $(resident_mib) MiB"
    [ "$part" -ne 5 ] || halfway=$(resident_mib)
done
# Memory limits: 96 MiB for keyframes, 64 MiB for stored states, and 6 MiB for curves.
[ "$(resident_mib)" -le $((halfway + 180)) ] || fail "more than all budgets together since half of the time"
[ "$seconds" -lt 600 ] || [ "$(resident_mib)" -le $((halfway + halfway / 10)) ] \
    || fail "memory grew from $halfway to $(resident_mib) MiB"
echo "soak.sh: $(value "s['step']") steps in $seconds s, $halfway MiB halfway and $(resident_mib) MiB at the end"

kill "$window"
wait "$window" 2> /dev/null || true
rm -f "$state"
# The random actions may save files in the folder in which the window is started.
cd "$work"
"$program" --reset-ui --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the lesson" "s['lesson'] == 1"
sleep 1
xdotool search --name Slump windowfocus
RANDOM=${SLUMP_MONKEY:-1}
anywhere() { echo "$((RANDOM % 1280)) $((RANDOM % 800))"; }
# Prints a random position in a random control of the window, or any position if the state cannot be read.
somewhere() {
    python3 -c "
import json, random
boxes = [box for box in json.load(open('$state'))['controls'].values() if box[2] <= 1280 and box[3] <= 800]
left, top, right, bottom = random.Random($RANDOM).choice(boxes)
print(int(random.Random($RANDOM).uniform(left, right)), int((top + bottom) / 2))" 2> /dev/null || anywhere
}
keys=(space Right Left r f b bracketleft bracketright ctrl+z Escape h Tab)
end=$((SECONDS + seconds)) most=0 acts=0
while [ "$SECONDS" -lt "$end" ]; do
    case $((RANDOM % 5)) in
        0) xdotool mousemove $(somewhere) mousedown 1 mousemove $(anywhere) mouseup 1 ;;
        1) xdotool key "${keys[RANDOM % ${#keys[@]}]}" ;;
        2) xdotool mousemove $(anywhere) click 1 ;;
        *) xdotool mousemove $(somewhere) click 1 ;;
    esac
    sleep 0.1
    acts=$((acts + 1))
    kill -0 "$window" 2>/dev/null || fail "the window is gone after $acts acts"
    now=$(resident_mib)
    [ "$now" -le "$most" ] || most=$now
done
[ ! -s "$work/log" ] || fail "it complained"
[ "$most" -lt 600 ] || fail "it needed $most MiB"
echo "soak.sh: $acts acts without a plan, $most MiB at most"
