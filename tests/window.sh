#!/usr/bin/env bash
# Starts the real window under Xvfb, drags the slider of the time step with the mouse, and checks in the state that the
# window exports that the new time step has reached the solver. Also tests releasing the slider, resizing, saving (a
# state, a session, data and a video), adding and removing a grain, a lost graphics device, closing, a screen of small
# pixels, and the error message if there is no display.
#
#   tests/window.sh [FOLDER]        screenshots go to FOLDER (default target/window)
#
# The pictures screenshots/window.png and screenshots/drag.gif are the files window-lesson-end.png and drag.gif in
# FOLDER.
#
# Needs a release build (cargo build --release), and Debian's packages xvfb xdotool imagemagick python3 ffmpeg,
# mesa-vulkan-drivers libvulkan1 (or libegl1 libgl1-mesa-dri), and the X11 client libraries that
# winit loads: libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0.
set -euo pipefail

cd "$(dirname "$0")/.."
program=${SLUMP:-target/release/slump}
shots=${1:-target/window}
mkdir -p "$shots"
. tests/display.sh

# Without a display, the program prints one sentence that says what is missing.
if env -u DISPLAY "$program" --reset-ui > /dev/null 2> "$work/log"; then
    fail "a window opened without a display"
fi
grep -q -- "--headless" "$work/log" || fail "a missing display is not explained"
[ "$(wc -l < "$work/log")" -eq 1 ] || fail "a missing display takes more than one sentence"

screen 1280x800

"$program" --reset-ui --bond 20 --dt 1e-3 --frames "$work/out" --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the pile" "s['scene'] == 'pile'"
sleep 1
xdotool search --name Slump windowfocus
import -window root "$shots/window-start.png"

# Drag the slider from its handle to the right end.
xdotool mousemove $(at Δt 0.66) mousedown 1
for part in 0.75 0.85 0.95 1.0; do xdotool mousemove $(at Δt $part); sleep 0.05; done
xdotool mouseup 1
wait_for "the time step" "5e-3 <= s['parameters']['time_step_secs'] <= 1e-2"
dragged=$(value "s['parameters']['time_step_secs']")

# When the slider is released, the pile starts again with the new time step.
wait_for "three steps" "s['step'] >= 3 and abs(s['time_secs'] / s['step'] - $dragged) < 1e-9"
import -window root "$shots/window-released.png"

# Test keys: pause, and one step.
xdotool key space
wait_for "the pause" "not s['playing']"
step=$(value "s['step']")
xdotool key Right
wait_for "one step" "s['step'] == $step + 1"

# Save the last state, the session, and the data of all states.
xdotool mousemove $(at save 0.5) click 1
wait_for "the page Save" "'Save state' in s['controls']"
sleep 1
at_secs=$(value "'%.4f' % s['time_secs']")
xdotool mousemove $(at "Save state" 0.5) click 1
wait_for "the state" "__import__('glob').glob('$work/out/slump-pile-bond20-dt*-${at_secs}s.slump') != []"
saved=$(echo "$work"/out/slump-pile-bond20-dt*-"${at_secs}"s.slump)
xdotool mousemove $(at "Save session" 0.5) click 1
wait_for "the session" "__import__('glob').glob('$work/out/slump-pile-bond20-dt*-${at_secs}s.session') != []"
session=$(echo "$work"/out/slump-pile-bond20-dt*-"${at_secs}"s.session)
session_step=$(value "s['step']")
xdotool mousemove $(at "Export data" 0.5) click 1
wait_for "the data" "__import__('os').path.exists('$work/out/data/frames.csv')"
sleep 1
import -window root "$shots/window-data.png"
"$program" --headless --restart "$saved" --duration "$(python3 -c "print($at_secs + 0.1)")" --save "$work/later.slump" > /dev/null 2> "$work/log" \
    || fail "the state that was saved does not go on"

# Save the recorded run as a video and as an animation.
xdotool mousemove $(at "Save video" 0.5) click 1
wait_for "the video" "__import__('glob').glob('$work/out/slump-pile-bond20-dt*.mp4') != []"
import -window root "$shots/window-video.png"
head -c 64 "$work"/out/slump-pile-*.mp4 | grep -q ftypisom || fail "the video is none"
xdotool mousemove $(at "Save GIF" 0.5) click 1
wait_for "the animation" "__import__('glob').glob('$work/out/slump-pile-bond20-dt*.gif') != []"
head -c 6 "$work"/out/slump-pile-*.gif | grep -q GIF89a || fail "the animation is none"
xdotool mousemove $(at save 0.5) click 1
sleep 1

# With Shift, a click next to the pile adds a grain, at any height of the pile. A second click removes the grain.
grains=$(value "s['grains']")
beside=$(value "'%d %d' % (lambda c: (c[0] + 0.9 * (c[2] - c[0]), c[1] + 0.1 * (c[3] - c[1])))(s['controls']['scene'])")
xdotool mousemove $beside keydown Shift_L
sleep 0.5
import -window root "$shots/window-hand.png"
xdotool click 1
wait_for "one grain more" "s['grains'] == $grains + 1"
sleep 1
xdotool click 1 keyup Shift_L
wait_for "one grain less" "s['grains'] == $grains"

xdotool key r
wait_for "the reset" "s['step'] == 0"

# Pressing and releasing the button without delay counts as a click.
xdotool mousemove $(at release 0.5) mousedown 1 mouseup 1
wait_for "the release by a quick click" "s['playing']"
xdotool mousedown 1 mouseup 1
wait_for "the pause by a quick click" "not s['playing']"
xdotool key r
wait_for "the second reset" "s['step'] == 0"

# Resize the window, also to small sizes.
for size in "1000 700" "640 480" "1280 800"; do
    xdotool search --name Slump windowsize $size
    wait_for "$size pixels" "s['window'] == [${size/ /, }]"
    sleep 0.5
    import -window root "$shots/window-${size/ /x}.png"
done

# After the graphics device is lost, the window gets a new device and the run continues.
xdotool key ctrl+shift+g
sleep 2
xdotool key Right
wait_for "a step after the device was lost" "s['step'] == 1 and s['devices'] == 2"
import -window root "$shots/window-recovered.png"

# switch_other_piles EXPRESSION: presses the switch for other piles on its page, and waits until the expression is true.
switch_other_piles() {
    xdotool mousemove $(at more 0.5) click 1
    wait_for "the pages" "'Compare' in s['controls']"
    sleep 1
    xdotool mousemove $(at Compare 0.5) click 1
    wait_for "the page Compare" "'other piles' in s['controls']"
    sleep 1
    xdotool mousemove $(at "other piles" 0.1) click 1
    wait_for "other piles" "$1"
    xdotool mousemove $(at more 0.5) click 1
    sleep 1
}

# An idle window needs less than 0.1 s of processor time in 2 s. Other piles would need processor time, so they are off.
switch_other_piles "s['other_threads'] == 0"
xdotool mousemove $(at "scene" 0.5)
sleep 1
ticks() { awk '{ print $14 + $15 }' "/proc/$window/stat"; }
sleep 1
before=$(ticks)
sleep 2
used=$(($(ticks) - before))
[ "$used" -lt "$(($(getconf CLK_TCK) / 10))" ] || fail "an idle window used $used ticks in 2 s"

# A window that opens again has the layout of the closed window: without the plots, the scene is higher.
height() { value "s['controls']['scene'][3]"; }
with_plots=$(height)
xdotool mousemove $(at "Plots" 0.5) click 1
wait_for "the plots to go" "s['controls']['scene'][3] > $with_plots + 100"
sleep 0.5
without_plots=$(height)
xdotool key ctrl+q
for _ in $(seq 50); do kill -0 "$window" 2>/dev/null || break; sleep 0.1; done
! kill -0 "$window" 2>/dev/null || fail "the window does not close"
rm -f "$state"
"$program" --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the pile" "s['scene'] == 'pile'"
wait_for "the layout of the last time" "abs(s['controls']['scene'][3] - $without_plots) < 2"

# Without a requested scene, the window opens the first lesson. Show the plots and other piles again and start the run.
# On an idle machine the effect is visible within ten seconds.
wait_for "the lesson" "s['lesson'] == 1 and s['worlds'] == 2"
xdotool mousemove $(at "Plots" 0.5) click 1
sleep 0.5
switch_other_piles "s['other_threads'] > 0"
xdotool search --name Slump windowfocus
xdotool mousemove $(at "scene" 0.5)
sleep 1
import -window root "$shots/window-lesson-start.png"
xdotool key space
wait_for "the end of the first lesson" "not s['playing'] and s['time_secs'] > 0.99"
[ "$(value "s['slump'] > 0.3")" = True ] || fail "the first pile of the lesson stands"
for _ in 1 2 3 4; do
    # On a busy machine the other piles take long, and the window stops computing them if nothing happens. The key
    # prevents this.
    xdotool key Left
    sleep 20
    [ "$(value "s['other_piles'] >= 3")" = True ] && break
done
# Move the mouse to a position without a tooltip.
xdotool mousemove 700 20
sleep 1
import -window root "$shots/window-lesson-end.png"

# Film the central gesture: Δt is dragged from 0.1 ms to 2 ms and released, and the pile starts again.
ffmpeg -loglevel error -y -f x11grab -framerate 10 -video_size 1280x800 -t 8 -i "$DISPLAY" -vf \
    "scale=800:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=128[p];[b][p]paletteuse=dither=none" \
    "$shots/drag.gif" &
film=$!
sleep 1
xdotool mousemove $(at Δt 0.34) mousedown 1
for part in 0.38 0.42 0.46 0.5 0.54 0.58 0.62 0.66 0.7 0.74 0.77; do
    xdotool mousemove $(at Δt $part)
    sleep 0.1
done
xdotool mouseup 1
wait "$film"
wait_for "the pile that was started again" "s['playing'] or s['time_secs'] > 0.5"
import -window root "$shots/window-ghost.png"
xdotool key r
wait_for "the reset" "s['step'] == 0"
for lesson in 2 3; do
    xdotool mousemove $(at "next lesson" 0.5) click 1
    wait_for "lesson $lesson" "s['lesson'] == $lesson and s['step'] == 0 and not s['playing']"
    xdotool key space
    wait_for "the end of lesson $lesson" "not s['playing'] and s['time_secs'] > 0.9"
    import -window root "$shots/window-lesson-$lesson.png"
done

# The chosen settings are still there after the window is killed.
sleep 3
kill -9 "$window"
wait "$window" 2> /dev/null || true
rm -f "$state"
"$program" --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the lesson of the time before" "s['lesson'] == 3 and s['worlds'] == 3"
xdotool mousemove $(at "leave lessons" 0.5) click 1
wait_for "the end of the lessons" "s['lesson'] == 0"
kill "$window"
wait "$window" 2> /dev/null || true
rm -f "$state"

# A session opens at the time at which it was saved, with its recorded run.
"$program" --session "$session" --export-state "$state" > "$work/log" 2>&1 &
window=$!
wait_for "the session's moment" "s['step'] == $session_step and s['lesson'] == 0"
import -window root "$shots/window-session.png"
xdotool search --name Slump windowfocus
xdotool key Left
wait_for "the step before" "s['step'] == $session_step - 1"
kill "$window"
wait "$window" 2> /dev/null || true
rm -f "$state"

# On a screen of small pixels everything is twice as large, in the light and the dark theme.
screen 2560x1440
for theme in light dark; do
    WINIT_X11_SCALE_FACTOR=2 "$program" --reset-ui --bond 20 --theme $theme --export-state "$state" > "$work/log" 2>&1 &
    window=$!
    wait_for "the pile" "s['scene'] == 'pile'"
    xdotool search --name Slump windowsize 2560 1440
    wait_for "small pixels" "s['window'] == [2560, 1440]"
    xdotool search --name Slump windowfocus
    xdotool key space
    wait_for "some steps" "s['step'] >= 20"
    xdotool key space
    wait_for "the pause" "not s['playing']"
    sleep 1
    import -window root "$shots/window-2560x1440-$theme.png"
    kill "$window"
    wait "$window" 2> /dev/null || true
    rm -f "$state"
done
echo "window.sh: Δt dragged to $dragged s reached the solver; screenshots in $shots"
