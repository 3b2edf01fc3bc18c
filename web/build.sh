#!/usr/bin/env bash
# Builds the page into a folder of static files: web/build.sh [FOLDER], target/page by default.
#
# It asks for Debian's rustc-web, cargo-web, rust-web-src and lld, and for wasm-bindgen
# (cargo install wasm-bindgen-cli --version, that of web/Cargo.toml).
set -euo pipefail
web=$(realpath "$(dirname "$0")")
out=$(realpath -m "${1:-$web/../target/page}")
cd "$web"
target=$(realpath -m ../target/web)

# The standard library is built with the page: Debian's rustc comes with its source.
RUSTC_BOOTSTRAP=1 PATH=/usr/bin:$PATH CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=/usr/bin/wasm-ld \
    RUSTFLAGS="-Ctarget-feature=+simd128" \
    cargo build --release --locked -Zbuild-std=std,panic_abort --target wasm32-unknown-unknown --target-dir "$target"
rm -rf "$out"
mkdir -p "$out"
wasm-bindgen --target web --no-typescript --out-dir "$out" \
    "$target/wasm32-unknown-unknown/release/slump_web.wasm"
cp static/* "$out/"
echo "$out: $(tar -c -C "$out" . | gzip -9 | wc -c) bytes compressed"
