#!/usr/bin/env bash
# Builds the page into a folder of static files: web/build.sh [FOLDER], target/page by default.
#
# It asks for Debian's rustc-web, cargo-web, rust-web-src, lld and binaryen, and for wasm-bindgen
# (cargo install wasm-bindgen-cli --version, that of web/Cargo.toml).
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath -m "${1:-../target/page}")
target=$(realpath -m ../target/web)

# The standard library is built with the page: Debian's rustc comes with its source.
RUSTC_BOOTSTRAP=1 PATH=/usr/bin:$PATH CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=/usr/bin/wasm-ld \
    RUSTFLAGS="-Ctarget-feature=+simd128" \
    cargo build --release -Zbuild-std=std,panic_abort --target wasm32-unknown-unknown --target-dir "$target"
rm -rf "$out"
mkdir -p "$out"
wasm-bindgen --target web --no-typescript --out-dir "$out" \
    "$target/wasm32-unknown-unknown/release/slump_web.wasm"
wasm-opt -O2 --enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int --enable-sign-ext \
    --enable-mutable-globals --enable-reference-types --enable-multivalue \
    -o "$out/optimised.wasm" "$out/slump_web_bg.wasm"
mv "$out/optimised.wasm" "$out/slump_web_bg.wasm"
cp static/* "$out/"
echo "$out: $(tar -cz -C "$out" . | wc -c) bytes compressed"
