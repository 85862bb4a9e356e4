#!/usr/bin/env bash
# windows.sh FOLDER: the DLL and the C programs, built with mingw, run under Wine; the replay has the bits of FOLDER/reference.
set -euo pipefail
cd "$(dirname "$0")/.."
here="$PWD" folder="$1" work="$1/windows"
mkdir -p "$work"
target="$(cargo metadata --format-version 1 --no-deps | python3 -c 'import json,sys; print(json.load(sys.stdin)["target_directory"])')"
cargo build --release -q -p asperity-c --target x86_64-pc-windows-gnu
built="$target/x86_64-pc-windows-gnu/release"
cp "$built/asperity_c.dll" "$work/asperity_c.dll"
for program in hostile fuzz replay; do
    x86_64-w64-mingw32-gcc -std=gnu99 -O1 -I. tests/$program.c -o "$work/$program.exe" "$built/libasperity_c.dll.a" -lm -lpthread -static-libgcc
done
cp "$(x86_64-w64-mingw32-gcc -print-file-name=libwinpthread-1.dll)" "$work/" 2>/dev/null || true
wine="$(command -v wine64 || echo /usr/lib/wine/wine64)"
export WINEPREFIX="$work/prefix" WINEDEBUG=-all
if ! ls /usr/lib/*/wine/x86_64-windows/bcryptprimitives.dll >/dev/null 2>&1; then
    x86_64-w64-mingw32-gcc -O1 -shared tests/bcryptprimitives.c -o "$work/bcryptprimitives.dll" -ladvapi32
fi
cp tests/replay.toml tests/replay.jsonl "$work/"
cd "$work"
"$wine" fuzz.exe 1 100
"$wine" hostile.exe
"$wine" replay.exe replay.toml replay.jsonl 0.5 replay.f32 256
python3 "$here/tests/same_bits.py" "$folder/reference" replay.f32 haptic audio
