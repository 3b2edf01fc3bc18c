#!/usr/bin/env bash
# Builds the browser version as a folder of static files: web/build.sh [FOLDER], target/page by default.
#
# Needs Debian's packages rustc-web, cargo-web, rust-web-src and lld, and wasm-bindgen in the version that
# web/Cargo.toml names (cargo install wasm-bindgen-cli --version VERSION).
set -euo pipefail
web=$(realpath "$(dirname "$0")")
out=$(realpath -m "${1:-$web/../target/page}")
cd "$web"
target=$(realpath -m ../target/web)

# The standard library is compiled, too; its source is in Debian's packages.
RUSTC_BOOTSTRAP=1 PATH=/usr/bin:$PATH CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=/usr/bin/wasm-ld \
    RUSTFLAGS="-Ctarget-feature=+simd128" \
    cargo build --release --locked -Zbuild-std=std,panic_abort --target wasm32-unknown-unknown --target-dir "$target"
rm -rf "$out"
mkdir -p "$out"
wasm-bindgen --target web --no-typescript --out-dir "$out" \
    "$target/wasm32-unknown-unknown/release/slump_web.wasm"
cp static/* "$out/"
echo "$out: $(tar -c -C "$out" . | gzip -9 | wc -c) bytes compressed"
