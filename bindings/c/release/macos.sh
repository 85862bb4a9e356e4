#!/bin/sh
# One library for both processors of macOS. Unproven: nobody has run it yet.
set -eu
cd "$(dirname "$0")/.."
out="${1:?name a folder for libasperity.dylib}"
target="$(cargo metadata --format-version 1 --no-deps | python3 -c 'import json,sys; print(json.load(sys.stdin)["target_directory"])')"
for processor in x86_64 aarch64; do
    rustup target add "$processor-apple-darwin"
    cargo build --release -p asperity-c --features device --target "$processor-apple-darwin"
done
mkdir -p "$out"
lipo -create -output "$out/libasperity.dylib" \
    "$target/x86_64-apple-darwin/release/libasperity_c.dylib" "$target/aarch64-apple-darwin/release/libasperity_c.dylib"
