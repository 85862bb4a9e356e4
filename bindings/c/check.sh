#!/usr/bin/env bash
# Checks of the C library.
#
#   check.sh 1          the header is of these sources, and C and C++ programs find, build and run it (tier 1)
#   check.sh 2          everything: valgrind, the malloc counter, random calls, C#, the Unity host, Octave, Windows where it can be had (tier 2)
#   check.sh accept     notes the interface as it is now, after its version was raised
#
# Needs Rust, gcc, cmake, pkg-config and Python; tier 2 installs what else is missing, where it may. SANITIZE=1 adds the address sanitizer,
# which compiles the engine once more, with nightly Rust.
set -euo pipefail
cd "$(dirname "$0")"
here="$PWD" root="$(cd ../.. && pwd)"
tier="${1:?1, 2 or accept}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
passed=0
ok() { passed=$((passed + 1)) && printf 'ok %2d   %s (%s s)\n' "$passed" "$1" "$SECONDS"; }
fail() { echo "error: $1" && exit 1; }

target="$(cargo metadata --format-version 1 --no-deps | python3 -c 'import json,sys; print(json.load(sys.stdin)["target_directory"])')"
# The header's generator keeps its build beside the others.
cargo run -q --manifest-path header/Cargo.toml --target-dir "$target/header" -- "$work/asperity.h"
diff -u asperity.h "$work/asperity.h" || fail "asperity.h: is not of these sources; cargo run --manifest-path header/Cargo.toml -- asperity.h"
ok "asperity.h is of these sources"

export PREFIX="$work/prefix"
./install.sh >"$work/install.log" 2>&1 || { cat "$work/install.log" && fail "install.sh: failed"; }
lib="$PREFIX/lib"
ls "$lib"/libasperity.so.* >/dev/null
ok "install.sh installs under a folder"

# The interface is what the library exports and what the header declares, without comments; its sum belongs to one version.
nm -D --defined-only "$lib/libasperity.so" | awk '{ print $3 }' | LC_ALL=C sort >"$work/symbols.txt"
gcc -fpreprocessed -dD -E -P asperity.h 2>/dev/null >"$work/declared.txt"
version="$(cargo pkgid -p asperity-c | sed 's/.*[#@]//')"
line="$version $(cat "$work/symbols.txt" "$work/declared.txt" | sha256sum | cut -d' ' -f1)"
if [ "$tier" = accept ]; then
    ! grep -qs "^$version " interfaces.txt || fail "interfaces.txt: $version is noted already; raise the version in Cargo.toml (and ASP_ABI, if old programs break)"
    echo "$line" >>interfaces.txt
    cp "$work/symbols.txt" symbols.txt
    exit 0
fi
[ -f interfaces.txt ] || fail "interfaces.txt: is missing; check.sh accept writes it"
diff -u symbols.txt "$work/symbols.txt" || fail "symbols.txt: differs from the library; raise the version, then check.sh accept"
[ "$(tail -n 1 interfaces.txt)" = "$line" ] || fail "interfaces.txt: symbols or header have changed since $(tail -n 1 interfaces.txt); raise the version, then check.sh accept"
ok "symbols and header are those of version $version"

export PKG_CONFIG_PATH="$lib/pkgconfig" LD_LIBRARY_PATH="$lib"
strict="-Wall -Wextra -Werror -O1 -g"
found="$(pkg-config --cflags asperity)" libs="$(pkg-config --libs asperity) -lm -lpthread"
# shellcheck disable=SC2086
{
    gcc -std=c99 -pedantic $strict $found example/stroke.c -o "$work/stroke" $libs
    g++ -std=c++17 -pedantic $strict $found example/stroke.cpp -o "$work/stroke_cpp" $libs
    for program in replay hostile fuzz; do
        gcc -std=c99 -pedantic $strict $found tests/$program.c -o "$work/$program" $libs
    done
    gcc -std=c11 $strict $found tests/audio_thread.c -o "$work/audio_thread" $libs
    gcc -O1 -shared -fPIC tests/malloc_counter.c -o "$work/malloc_counter.so"
}
(cd "$work" && ./stroke && ./stroke_cpp)
ok "C99 and C++17 programs found by pkg-config build without a warning and run"

cmake -S example -B "$work/cmake" -DCMAKE_PREFIX_PATH="$PREFIX" >"$work/cmake.log" || { cat "$work/cmake.log" && fail "find_package: failed"; }
cmake --build "$work/cmake" >>"$work/cmake.log" 2>&1 || { tail -20 "$work/cmake.log" && fail "cmake: failed"; }
mv "$work/stroke.wav" "$work/by_pkg_config.wav"
(cd "$work" && cmake/stroke_cpp && cmake/stroke && cmp stroke.wav by_pkg_config.wav && cmake/stroke_static && cmp stroke.wav by_pkg_config.wav)
ok "the same found by find_package, shared and static, with the same samples"

program="${ASPERITY:-$target/release/asperity}"
[ -x "$program" ] || (cd "$root" && cargo build --release -q -p asperity-cli)
"$program" render tests/replay.toml -o "$work/reference" >/dev/null 2>&1
for block in 1 64 333 4096; do
    "$work/replay" tests/replay.toml tests/replay.jsonl 0.5 "$work/replay.f32" "$block"
    python3 tests/same_bits.py "$work/reference" "$work/replay.f32"
done
ok "a replayed log equals \`asperity render\` to the bit, in blocks of 1, 64, 333 and 4096"

LD_PRELOAD="$work/malloc_counter.so" "$work/audio_thread"
ok "nothing is allocated or freed on the audio thread"
"$work/hostile"
ok "hostile calls"
"$work/fuzz" 1 300
ok "random calls"
[ "$tier" = 2 ] || exit 0

(cd "$root" && cargo test --release -q -p asperity-c)
ok "handles, panics, sizes: the library's own tests"

need() { # PROGRAM PACKAGE…: installs what is missing, where it may.
    command -v "$1" >/dev/null && return
    shift
    { apt-get install -y --no-install-recommends "$@" || { apt-get update && apt-get install -y --no-install-recommends "$@"; }; } >"$work/apt.log" 2>&1 ||
        { tail -3 "$work/apt.log" && return 1; }
}
skip() {
    [ "${ASPERITY_NOTHING_SKIPPED:-}" != 1 ] || fail "$1"
    echo "skipped: $1"
}

if need valgrind valgrind; then
    check="valgrind -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect"
    $check "$work/hostile"
    $check "$work/audio_thread" short
    $check "$work/fuzz" 5000 60
    ok "valgrind: no error, no leak"
else
    skip "no valgrind"
fi
"$work/fuzz" 10000 1500
ok "more random calls"

if [ "${SANITIZE:-}" = 1 ]; then
    (cd "$root" && RUSTFLAGS=-Zsanitizer=address CARGO_PROFILE_RELEASE_OPT_LEVEL=1 cargo +nightly build --release -q -p asperity-c \
        --target x86_64-unknown-linux-gnu)
    built="$target/x86_64-unknown-linux-gnu/release/libasperity_c.a"
    for program in hostile fuzz replay; do
        gcc -std=c99 $strict -fsanitize=address $found tests/$program.c "$built" -o "$work/${program}_asan" -lm -lpthread -ldl
    done
    "$work/hostile_asan"
    "$work/fuzz_asan" 20000 1000
    "$work/replay_asan" tests/replay.toml tests/replay.jsonl 0.5 "$work/asan.f32" 512
    ok "address sanitizer, engine and programs: hostile and random calls, the replay"
fi

if need mcs mono-mcs && need mono mono-runtime libmono-system-core4.0-cil; then
    mcs -warnaserror -langversion:7 -out:"$work/Test.exe" unity/Runtime/Asperity.cs tests/Test.cs
    mono "$work/Test.exe"
    mcs -warnaserror -langversion:7 -out:"$work/Stroke.exe" unity/Runtime/Asperity.cs example/Stroke.cs
    mono "$work/Stroke.exe"
    # The component compiles against the few of Unity's types that it uses; nothing of Unity runs here.
    mcs -warnaserror -langversion:7 -target:library -define:ASPERITY_UNITY -out:"$work/Unity.dll" tests/unity_types.cs unity/Runtime/*.cs
    ok "C# under Mono"
else
    skip "no Mono"
fi

g++ -std=c++17 $strict -I. tests/unity_host.cpp -o "$work/unity_host" -ldl
cp "$lib/libasperity.so" "$work/libaudioplugin_asperity.so"
"$work/unity_host" "$work/libaudioplugin_asperity.so"
python3 -c 'import json; json.load(open("unity/package.json")); json.load(open("unity/Runtime/Asperity.asmdef"))'
ok "the callbacks of Unity's mixer, with its offsets; the package's files"

if need mkoctfile octave octave-dev; then
    (cd "$work" && CFLAGS="-Wall -Wextra -Werror" mkoctfile --mex $found "$here/octave/asperity_render.c" -L"$lib" -lasperity "-Wl,-rpath,$lib" -o asperity_render.mex &&
        "$work/replay" "$here/tests/replay.toml" "$here/tests/replay.jsonl" 0.5 replay.f32 512 &&
        octave-cli -q --no-init-file --no-window-system "$here/tests/test_octave.m" "$here/tests" replay.f32)
    ok "Octave"
else
    skip "no Octave"
fi

if ls "$(rustc --print sysroot)/lib/rustlib" | grep -qx x86_64-pc-windows-gnu && need x86_64-w64-mingw32-gcc gcc-mingw-w64-x86-64-win32 &&
    { command -v wine64 || [ -x /usr/lib/wine/wine64 ] || need wine64 wine64; } >/dev/null; then
    tests/windows.sh "$work"
    ok "Windows: the DLL and the C programs under Wine"
else
    echo "skipped: Windows, where Rust's library for it, mingw and Wine are installed (rustup target add x86_64-pc-windows-gnu)"
fi
printf '%d passed, 0 failed in %s s\n' "$passed" "$SECONDS"
