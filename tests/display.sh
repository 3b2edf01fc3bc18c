# Helpers for scripts that control the real window: a display with a free number, a folder for files, and functions that
# read the state that the window exports. A script sets `program` (path of the program) before it sources this file, and
# sets `window` (process id of the window) itself.

work=$(mktemp -d)
state=$work/state.json
export XDG_CONFIG_HOME=$work/config XDG_CACHE_HOME=$work/cache
[ -n "${XDG_RUNTIME_DIR:-}" ] || { export XDG_RUNTIME_DIR=$work/runtime; mkdir -m 700 "$XDG_RUNTIME_DIR"; }
unset WAYLAND_DISPLAY

window=
server=
cleanup() {
    [ -z "$window" ] || kill "$window" 2>/dev/null || true
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT

fail() {
    echo "${0##*/}: $1" >&2
    [ ! -s "$work/log" ] || sed 's/^/    /' "$work/log" >&2
    exit 1
}

# screen WIDTHxHEIGHT: replaces the display by a display of this size.
screen() {
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    rm -f "$work/display"
    Xvfb -displayfd 4 -screen 0 "$1x24" 4> "$work/display" > "$work/xvfb.log" 2>&1 &
    server=$!
    for _ in $(seq 100); do [ -s "$work/display" ] && break; sleep 0.1; done
    [ -s "$work/display" ] || fail "Xvfb does not start"
    export DISPLAY=:$(cat "$work/display")
}

# value EXPRESSION: prints a value of the exported state s.
value() { python3 -c "import json,sys; s=json.load(open('$state')); print($1)"; }

# wait_for WHAT EXPRESSION: waits until the expression is true.
wait_for() {
    for _ in $(seq 300); do
        if [ -s "$state" ] && [ "$(value "$2" 2>/dev/null)" = True ]; then return; fi
        kill -0 "$window" 2>/dev/null || fail "the window is gone while waiting for $1"
        sleep 0.1
    done
    fail "waited in vain for $1"
}

# at CONTROL FRACTION: prints the coordinates of the pixel at this fraction of the width of a control, at half its
# height.
at() { value "'%d %d' % (lambda c: (c[0] + $2 * (c[2] - c[0]), (c[1] + c[3]) / 2))(s['controls']['$1'])"; }
