#!/usr/bin/env bash
# The modal bank beside its peers, in one run: G mode-samples a second, force in every sample, best of many segments.
# Ours and the C loop: examples/modal_speed.rs. Faust: needs `faust` and g++. fundsp: needs its crate.
# Usage: dsp/benches/peers/run.sh [MODES ...]
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$here/../../.."
sizes=("$@")
[ $# -gt 0 ] || sizes=(64 256 1024)
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

(cd "$root" && cargo run --release --quiet -p asperity-dsp --example modal_speed 8 ${sizes[*]})

echo
echo "fundsp: eight-lane biquads, one resonator a mode; default build, then target-cpu=native"
for flags in "" "-C target-cpu=native"; do
    target="$root/target/peers/${flags:+native}"
    (cd "$here/fundsp" && CARGO_TARGET_DIR="$target" RUSTFLAGS="$flags" cargo build --release --quiet)
    for modes in ${sizes[*]}; do printf '%6s  %s\n' "$modes" "$("$target/release/fundsp-bank" "$modes")"; done
done

command -v faust >/dev/null || { echo "no faust here"; exit 0; }
echo
echo "Faust, best of scalar and -vec, g++ -O3 -march=native -ffast-math"
for modes in ${sizes[*]}; do
    # Beyond 256 modes Faust and g++ take minutes.
    [ "$modes" -le 256 ] || continue
    sed "s/^N = .*/N = $modes;/" "$here/faust_bank.dsp" >"$work/bank.dsp"
    for options in "" "-vec -vs 64"; do
        faust $options -lang c "$work/bank.dsp" -o "$work/bank.c"
        g++ -x c++ -fpermissive -w -O3 -march=native -ffast-math -DMODES="$modes" -DGENERATED="\"$work/bank.c\"" \
            "$here/faust_main.c" -o "$work/bank" -lm
        "$work/bank"
    done | sort -n | tail -1 | xargs printf '%6s  %s\n' "$modes"
done
