#!/usr/bin/env bash
# The modal bank beside its peers, in one run: G mode-samples a second, force in every sample, best of many segments;
# then what each peer's 30 Hz mode rings like, because a bank that is out of tune does not do the same job.
# Ours and the C loop: examples/modal_speed.rs. Faust: needs `faust` and g++. fundsp: needs its crate.
# Usage: dsp/benches/peers/run.sh [MODES ...]
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
root="$here/../../.."
sizes=("$@")
[ $# -gt 0 ] || sizes=(64 256 1024)
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

cat <<'TEXT'
Like for like? All take a force in every sample, sum all modes to one output, have one output gain a mode, f32.
  asperity   any phase a mode; coefficients as the difference from 1 (pitch: see the end)
  C loop     direct form, 2 products for the pole pair and 1 for the gain: phase 0 only ("with phase": 1 more)
  fundsp     BiquadBank<F32x>: eight whole biquads (5 products a mode, 2 of them with 0; a phase would be free),
             direct form, states in memory. Its interface has process (a block) and tick (a sample and eight modes).
             "by hand" is ours, for the sake of the comparison: a loop around tick on a local copy of each bank, so
             that eight modes' states stay in registers for 64 samples. resonator_hz: one mode a call.
             Default build (what its users get), then target-cpu=native.
  Faust      direct form, phase 0 only, unrolled into straight code; best of scalar and -vec
So the job is the same but for phase and tune: every direct form in f32 is out of tune at low frequencies, see the end.

TEXT

(cd "$root" && cargo run --release --quiet -p asperity-dsp --example modal_speed 8 ${sizes[*]}) | tee "$work/ours"

echo
printf '%-22s %6s %10s %10s %10s %12s\n' fundsp modes process tick "by hand" resonator_hz
for flags in "" "-C target-cpu=native"; do
    target="$root/target/peers/${flags:+native}"
    (cd "$here/fundsp" && CARGO_TARGET_DIR="$target" RUSTFLAGS="$flags" cargo build --release --quiet)
    for modes in ${sizes[*]}; do
        read -r process tick by_hand single <<<"$("$target/release/fundsp-bank" speed "$modes")"
        printf '%-22s %6s %10s %10s %10s %12s\n' "${flags:-default build}" "$modes" "$process" "$tick" "$by_hand" "$single"
        of="fundsp${flags:+-native}"
        printf '%s %s %s\n' "$modes" "$of" "$(printf '%s\n' "$process" "$tick" | sort -n | tail -1)" \
            "$modes" "$of-by-hand" "$by_hand" >>"$work/peers"
    done
done
listen="$root/target/peers/release/fundsp-bank"

# faust_build OUTPUT N RATE FROM BAND DECAY "FAUST OPTIONS" "C OPTIONS"
faust_build() {
    sed "s/^N = .*/N = $2;/; s/^rate = .*/rate = $3;/; s/^from = .*/from = $4;/; s/^band = .*/band = $5;/
         s/^decay = .*/decay = $6;/" "$here/faust_bank.dsp" >"$work/bank.dsp"
    # shellcheck disable=SC2086
    faust $7 -lang c "$work/bank.dsp" -o "$work/bank.c"
    # shellcheck disable=SC2086
    g++ -x c++ -fpermissive -w -O3 -march=native -ffast-math -DMODES="$2" -DGENERATED="\"$work/bank.c\"" $8 \
        "$here/faust_main.c" -o "$1" -lm
}

if command -v faust >/dev/null; then
    echo
    echo "Faust, best of scalar and -vec, g++ -O3 -march=native -ffast-math"
    for modes in ${sizes[*]}; do
        # Beyond 256 modes Faust and g++ take minutes.
        [ "$modes" -le 256 ] || continue
        for options in "" "-vec -vs 64"; do
            faust_build "$work/bank" "$modes" 44100.0 100.0 15000.0 20.0 "$options" ""
            "$work/bank"
        done | sort -n | tail -1 | tee "$work/faust" | xargs printf '%6s  %s\n' "$modes"
        printf '%s faust %s\n' "$modes" "$(cat "$work/faust")" >>"$work/peers"
    done
else
    echo "no faust here"
fi

# The columns of modal_speed: modes, then best and (median) of two figures for each of our instruction sets.
echo
echo "asperity's best over each peer's best, by instruction set"
awk -v ours="$work/ours" -v peers="$work/peers" 'BEGIN {
    while ((getline line <ours) > 0) {
        gsub(/[()]/, " ", line); n = split(line, f, " ")
        if (f[1] == "modes") { for (i = 2; i <= n; i++) if (f[i] ~ /^(Portable|Neon|Avx2|Avx512)$/) set[++sets] = f[i] }
        else if (f[1] + 0 > 0 && n > 4) for (k = 1; k <= sets; k++) rate[f[1], k] = f[2 + 4 * (k - 1)]
    }
    while ((getline line <peers) > 0) {
        split(line, f, " ")
        out = sprintf("%6s  %-22s", f[1], f[2])
        for (k = 1; k <= sets; k++) out = out sprintf("  %s %5.2f x", set[k], rate[f[1], k] / f[3])
        print out
    }
}'

echo
echo "A mode of 30 Hz, T60 10 s, rendered: how far off its pitch and its T60 are"
for rate in 44100 192000; do
    echo " at $rate Hz"
    "$listen" pitch "$rate"
    if command -v faust >/dev/null; then
        faust_build "$work/ring" 1 "$rate.0" 30.0 0.0 0.690775527898 "" "-DRESPONSE=$((5 * rate))"
        "$work/ring" | "$listen" pitch "$rate" "Faust (and the C loop's direct form)"
    fi
done
