#!/usr/bin/env bash
# Checks of the C library.
#
#   check.sh 1          the header is of these sources, and C and C++ programs find, build and run it (tier 1)
#   check.sh 2          everything: valgrind, the malloc counter, random calls, C#, the Unity host, Unreal's page, Octave, Windows where it can be
#                       had (tier 2)
#   check.sh accept     notes the interface as it is now, after its version was raised
#
# Needs Rust, gcc, cmake, pkg-config and Python; tier 2 installs what else is missing, where it may. SANITIZE=1 adds the address sanitizer in
# the engine too, which is compiled once more for it; TARGETS=1 the static libraries of other systems.
set -euo pipefail
cd "$(dirname "$0")"
here="$PWD" root="$(cd ../.. && pwd)"
tier="${1:?1, 2 or accept}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
passed=0
# What a README shows: its first block of a language, as it is printed.
shown() { awk -v fence="\`\`\`$2" '$0 == fence && !done { on = 1; next } /^ *```$/ && on { on = 0; done = 1 } on' "$1"; }
ok() { passed=$((passed + 1)) && printf 'ok %2d   %s (%s s)\n' "$passed" "$1" "$SECONDS"; }
fail() { echo "error: $1" && exit 1; }
skip() {
    [ "${ASPERITY_NOTHING_SKIPPED:-}" != 1 ] || fail "$1"
    echo "skipped: $1"
}

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
    for program in replay hostile fuzz pickup; do
        gcc -std=c99 -pedantic $strict $found tests/$program.c -o "$work/$program" $libs
    done
    shown README.md c >"$work/readme.c"
    gcc -std=c99 -pedantic $strict $found "$work/readme.c" -o "$work/readme" $libs
    gcc -std=c99 -pedantic $strict tests/older.c -o "$work/older" $libs
    gcc -std=c99 -pedantic $strict tests/loading.c -I. -L"$lib" -Wl,--no-as-needed -o "$work/loading" $libs -ldl
    gcc -std=c11 $strict $found tests/audio_thread.c -o "$work/audio_thread" $libs
    gcc -O1 -shared -fPIC tests/malloc_counter.c -o "$work/malloc_counter.so"
}
(cd "$work" && ./readme && ./stroke && ./stroke_cpp)
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
    "$work/replay" tests/replay.toml tests/replay.jsonl 0.5 "$work/replay.f32" "$block" "$work/pickup.f32"
    python3 tests/same_bits.py "$work/reference" "$work/replay.f32" haptic audio
    python3 tests/same_bits.py "$work/reference" "$work/pickup.f32" pickup
done
ok "a replayed log and what a pickup reads of it equal \`asperity render\` to the bit, in blocks of 1, 64, 333 and 4096"

LD_PRELOAD="$work/malloc_counter.so" "$work/audio_thread"
ok "nothing is allocated or freed on the audio thread"
"$work/hostile"
ok "hostile calls"
"$work/pickup"
ok "pickups of a tap, of a body's own motion and of pairs of colliders"
"$work/older"
ok "a program that was compiled with an older header"
if [ -f /usr/include/openxr/openxr.h ]; then
    # shellcheck disable=SC2086
    gcc -std=c99 -pedantic $strict $found tests/headset.c -o "$work/headset" -rdynamic $libs -ldl
    frames="$([ "$tier" = 2 ] && echo 100000 || echo 10000)"
    "$work/headset" "$frames"
    ok "a headset's runtime refuses no call: strokes, hitches, focus lost, another session"
else
    skip "no openxr/openxr.h (libopenxr-dev)"
fi
loader=libopenxr_loader.so.1 layer=XR_APILAYER_LUNARG_core_validation
if [ -x "$work/headset" ] && ldconfig -p | grep -F "$loader" >/dev/null; then
    # shellcheck disable=SC2086
    gcc -std=c99 -pedantic $strict -shared -fPIC tests/openxr_runtime.c -o "$work/openxr_runtime.so"
    printf '{"file_format_version": "1.0.0", "runtime": {"library_path": "%s"}}\n' "$work/openxr_runtime.so" >"$work/runtime.json"
    export XR_RUNTIME_JSON="$work/runtime.json"
    "$work/headset" "$frames" "$loader"
    ok "the same through OpenXR's loader"
    # The layer of this loader's age knows no parametric frames. What it finds wrong it writes, and refuses.
    if ls /usr/share/openxr/1/api_layers/explicit.d/*core_validation* >/dev/null 2>&1; then
        XR_ENABLE_API_LAYERS=$layer XR_CORE_VALIDATION_EXPORT_TYPE=text XR_CORE_VALIDATION_FILE_NAME="$work/validation" \
            "$work/headset" 10000 "$loader" plain >"$work/plain.log" 2>&1
        grep -q "^Core Validation output" "$work/plain.log" || fail "OpenXR's validation layer was not loaded"
        [ ! -s "$work/validation" ] || { head -20 "$work/validation" && fail "OpenXR's validation layer finds fault"; }
        ok "OpenXR's validation layer finds nothing wrong with plain vibrations"
    else
        skip "no validation layer of OpenXR (openxr-layer-corevalidation)"
    fi
    unset XR_RUNTIME_JSON
else
    skip "no $loader (libopenxr-loader1)"
fi
"$work/fuzz" 1 300
ok "random calls"
cp "$lib/libasperity.so" "$work/another_copy.so"
"$work/loading" "$lib/libasperity.so" "$work/another_copy.so"
ok "loaded twice, closed while it plays, forked"
# shellcheck disable=SC2086
gcc -std=c99 -pedantic $strict -fsanitize=address,undefined $found tests/torture.c "$lib/libasperity.a" -o "$work/torture_asan" -lm -lpthread -ldl
"$work/torture_asan" 400
ok "host torture under the address sanitizer: any block, other rates, threads in turn, two engines, unloaded while they play"
[ "$tier" = 2 ] || exit 0

(cd "$root" && cargo test --release -q -p asperity-c)
ok "handles, panics, sizes: the library's own tests"

need() { # PROGRAM PACKAGE…: installs what is missing, where it may.
    command -v "$1" >/dev/null && return
    shift
    { apt-get install -y --no-install-recommends "$@" || { apt-get update && apt-get install -y --no-install-recommends "$@"; }; } >"$work/apt.log" 2>&1 ||
        { tail -3 "$work/apt.log" && return 1; }
}

if need valgrind valgrind; then
    check="valgrind -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect"
    $check "$work/hostile" few
    $check "$work/audio_thread" short
    $check "$work/fuzz" 5000 60
    ok "valgrind: no error, no leak"
else
    skip "no valgrind"
fi
"$work/fuzz" 10000 1500
ok "more random calls"

# The address sanitizer in the programs, and in every allocation of the library: what it frees twice, leaks or gives back too late.
# shellcheck disable=SC2086
for program in hostile fuzz replay pickup; do
    gcc -std=c99 $strict -fsanitize=address,undefined $found tests/$program.c "$lib/libasperity.a" -o "$work/${program}_asan" -lm -lpthread -ldl
done
sanitized() {
    "$work/hostile_asan"
    "$work/pickup_asan"
    "$work/torture_asan" 400
    "$work/fuzz_asan" "$1" "$2"
    "$work/replay_asan" tests/replay.toml tests/replay.jsonl 0.5 "$work/asan.f32" 512
}
sanitized 30000 300
ok "address sanitizer of the programs: hostile and random calls, the replay"
if [ "${SANITIZE:-}" = 1 ]; then
    # The stable compiler has it behind this switch.
    (cd "$root" && RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address CARGO_PROFILE_RELEASE_OPT_LEVEL=1 cargo rustc --release -q -p asperity-c \
        --crate-type staticlib --target x86_64-unknown-linux-gnu --target-dir "$target/sanitized")
    built="$target/sanitized/x86_64-unknown-linux-gnu/release/libasperity_c.a"
    # shellcheck disable=SC2086
    for program in hostile fuzz replay torture; do
        gcc -std=c99 $strict -fsanitize=address $found tests/$program.c "$built" -o "$work/${program}_asan" -lm -lpthread -ldl
    done
    sanitized 20000 1000
    ok "address sanitizer, engine and programs: hostile and random calls, the replay"
fi

if need mcs mono-mcs && need mono mono-runtime libmono-system-core4.0-cil; then
    mcs -warnaserror -langversion:7 -out:"$work/Test.exe" unity/Runtime/Asperity.cs tests/Test.cs
    mono "$work/Test.exe"
    mcs -warnaserror -langversion:7 -out:"$work/Stroke.exe" unity/Runtime/Asperity.cs example/Stroke.cs
    (cd "$work" && rm -f stroke.wav && mono Stroke.exe && [ -s stroke.wav ])
    # Unity's components and the package's sample, against the few of Unity's types that they use; nothing of Unity runs here.
    cp "$lib/libasperity.so" "$work/libaudioplugin_asperity.so"
    shown unity/README.md csharp >"$work/Shown.cs"
    mcs -langversion:7 -define:UNITY_5_3_OR_NEWER -out:"$work/UnityScene.exe" tests/unity_types.cs tests/UnityScene.cs unity/Runtime/*.cs \
        unity/Samples~/FirstTouch/FirstTouch.cs "$work/Shown.cs"
    LD_LIBRARY_PATH="$work:$lib" mono "$work/UnityScene.exe"
    ok "C# under Mono; Unity's components and the package's sample with stand-ins for Unity's types"
else
    skip "no Mono"
fi

g++ -std=c++17 $strict -I. tests/unity_host.cpp -o "$work/unity_host" -ldl
cp "$lib/libasperity.so" "$work/libaudioplugin_asperity.so"
"$work/unity_host" "$work/libaudioplugin_asperity.so"
python3 -c '
import json, os, sys
package = json.load(open("unity/package.json"))
json.load(open("unity/Runtime/Asperity.asmdef"))
assert package["version"] == sys.argv[1], "unity/package.json: version must be " + sys.argv[1]
assert all(os.path.isdir("unity/" + sample["path"]) for sample in package["samples"])
' "$version"
ok "the callbacks of Unity's mixer, with its offsets; the package's files"

mkdir -p "$work/unreal/Components"
shown unreal/README.md cpp >"$work/unreal/TouchSynth.h"
touch "$work/unreal/CoreMinimal.h" "$work/unreal/TouchSynth.generated.h" "$work/unreal/Components/SynthComponent.h"
# shellcheck disable=SC2086
g++ -std=c++20 -fno-exceptions -fno-rtti $strict -Itests/unreal -I"$work/unreal" $found tests/unreal/page.cpp -o "$work/unreal/page" $libs
"$work/unreal/page"
ok "the component of Unreal's page, with stand-ins for Unreal's types"

if need mkoctfile octave octave-dev; then
    (cd "$work" && CFLAGS="-Wall -Wextra -Werror" mkoctfile --mex $found "$here/octave/asperity_render.c" -L"$lib" -lasperity "-Wl,-rpath,$lib" -o asperity_render.mex &&
        "$work/replay" "$here/tests/replay.toml" "$here/tests/replay.jsonl" 0.5 replay.f32 512 &&
        octave-cli -q --no-init-file --no-window-system "$here/tests/test_octave.m" "$here/tests" replay.f32 &&
        octave-cli -q --no-init-file --no-window-system "$here/octave/example/stroke.m" && [ -s stroke.wav ])
    cmp octave/example/stroke.m <(shown octave/README.md matlab) || fail "octave/README.md: does not show octave/example/stroke.m"
    ok "Octave, and the example of its page"
else
    skip "no Octave"
fi

has_target() { [ -d "$(rustc --print sysroot)/lib/rustlib/$1" ] || timeout 120 rustup target add "$1" 2>/dev/null; }

if has_target x86_64-pc-windows-gnu && need x86_64-w64-mingw32-gcc gcc-mingw-w64-x86-64-win32 &&
    { command -v wine64 || [ -x /usr/lib/wine/wine64 ] || need wine64 wine64; } >/dev/null; then
    tests/windows.sh "$work"
    ok "Windows: the DLL and the C programs under Wine"
else
    echo "skipped: Windows, where Rust's library for it, mingw and Wine can be had (rustup target add x86_64-pc-windows-gnu)"
fi

# As far as other systems can be reached without their linkers: the static libraries of the recipes in release/, unoptimised, because nothing
# here can run them.
if [ "${TARGETS:-}" = 1 ]; then
    for system in x86_64-apple-darwin aarch64-apple-darwin aarch64-apple-ios aarch64-linux-android x86_64-pc-windows-msvc; do
        if has_target "$system"; then
            (cd "$root" && CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_DEBUG=0 \
                cargo rustc --release -q -p asperity-c --crate-type staticlib --target "$system" --target-dir "$target/targets")
            # Windows calls it .lib.
            built="$(find "$target/targets/$system/release" -maxdepth 1 -name 'libasperity_c.a' -o -maxdepth 1 -name 'asperity_c.lib')"
            [ -s "$built" ] || fail "$system: no static library"
            ok "$system: a static library is built; nothing of it has run"
        else
            echo "skipped: no standard library of $system"
        fi
    done
fi
printf '%d passed, 0 failed in %s s\n' "$passed" "$SECONDS"
