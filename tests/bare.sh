#!/usr/bin/env bash
# Runs the README's two commands on a minimal machine: tests/bare.sh [FOLDER].
#
# Makes a minimal Debian 12 system in FOLDER (target/bare by default), with Rust, a C linker and git from Debian's
# packages and nothing else: no ffmpeg, no graphics driver, no Python. Clones the last commit into this system, runs
# both commands there and prints the time that each takes. Needs root permissions, mmdebstrap (apt install mmdebstrap),
# and about 10 GB.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$(realpath -m "${1:-target/bare}")

fail() {
    echo "tests/bare.sh: $*" >&2
    exit 1
}

command -v mmdebstrap >/dev/null || fail "mmdebstrap is not on PATH, but must be: apt install mmdebstrap"
[ "$(id -u)" -eq 0 ] || fail "a root of a system can be made by root only"
[ ! -e "$root" ] || [ -e "$root/bare-root" ] || fail "$root is there, but is not a root that this script made"
rm -rf "$root"
mkdir -p "$root"

mmdebstrap --quiet --variant=minbase --include=ca-certificates,cargo-web,gcc,git,libc6-dev,rustc-web bookworm "$root"
touch "$root/bare-root"
# Copy the name resolution and the certificates that this machine trusts.
cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
rm -rf "$root/etc/ssl/certs"
cp -rL /etc/ssl/certs "$root/etc/ssl/"
git clone --quiet . "$root/slump"

in_root() {
    unshare --mount --pid --fork --kill-child sh -euc '
        mount --rbind /dev "$1/dev"
        mount -t proc proc "$1/proc"
        exec chroot "$1" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 sh -euc "$2"
    ' sh "$root" "cd /slump && $1"
}

# tell NAME COMMAND: runs the command, and prints its results and its time.
tell() {
    local start=$SECONDS
    in_root "$2" >"$root/$1.log" 2>&1 || { tail -40 "$root/$1.log"; fail "\"$2\" fails: $root/$1.log"; }
    grep -E '^test result|^wrote|\.png$' "$root/$1.log" | tail -40 || true
    echo "$2: $((SECONDS - start)) s"
}

tell figures 'cargo run --release -- --headless --frames out/'
for figure in fig3.png fig4.png fig7.png manifest.json; do
    [ -s "$root/slump/out/$figure" ] || fail "the first command left no $figure"
done
tell tests 'cargo test --release'
in_root 'git status --porcelain' >"$root/changes"
[ ! -s "$root/changes" ] || fail "the commands changed files of the repository: $(cat "$root/changes")"
