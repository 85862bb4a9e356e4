#!/usr/bin/env bash
# `asperity play` on a real audio server without a sound card: JACK with its dummy driver, 256 frames,
# 4 channels, 48 kHz.
#
#   cargo build --release -p asperity-cli --features jack
#   tests/jack_dummy.sh [target/release/asperity]
#
# 0. Only the outputs of the host are listed; a block that it does not run in is refused with the one it does.
# 1. Four ports are recorded with jack_rec: four different signals on four channels, no underrun in 30 s.
# 2. The server is killed while it plays: one error line, no panic, no hang.
# 3. The server is killed and comes back: the stream is built anew and plays to its end.
# Says that it skips where jackd is not installed or its dummy driver does not start. Underruns fail it when the
# engine used half of the time or more, and always with JACK_STRICT=1; otherwise they are the machine's.
set -euo pipefail
cd "$(dirname "$0")/.."
play="$PWD/${1:-target/release/asperity}"
seconds="${JACK_SECONDS:-30}"
for tool in jackd jack_rec jack_lsp python3; do
    command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed"; exit 0; }
done

folder="$(mktemp -d)"
# JACK keeps a register of eight servers. One that is killed stays in it until a server of its name starts, so the
# name is the same in every run, and every run ends its last server in order.
export JACK_DEFAULT_SERVER="asperity-test" JACK_NO_AUDIO_RESERVATION=1 JACK_NO_START_SERVER=1
server=""
stop_server() { # [signal]
    [ -z "$server" ] || { kill "-${1:-TERM}" "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; }
    server=""
}
trap 'stop_server; rm -rf "$folder"' EXIT
try_server() {
    # With real-time priority where the system grants it (-R), else without (-r).
    for priority in "-R -P 20" "-r"; do
        # shellcheck disable=SC2086
        jackd -n "$JACK_DEFAULT_SERVER" $priority -d dummy -r 48000 -p 256 -C 0 -P 4 >>"$folder/jackd.log" 2>&1 &
        server=$!
        for _ in $(seq 50); do
            jack_lsp >/dev/null 2>&1 && return
            kill -0 "$server" 2>/dev/null || break
            sleep 0.1
        done
        stop_server KILL
    done
    return 1
}
start_server() {
    try_server && return
    echo "error: jackd did not start again"; cat "$folder/jackd.log"; exit 1
}
# The first start tells whether this machine can run a server at all. A register that is full of servers that are
# gone (runs that were cut off) refuses every new one; where none is running (a killed one nobody has waited for
# does not count) it is removed, and JACK makes a new one.
start_first_server() {
    try_server && return
    if ! pgrep -r R,S,D -x 'jackd|jackdbus' >/dev/null; then
        rm -f /dev/shm/jack-shm-registry
        try_server && return
    fi
    echo "skipped: the dummy driver of jackd does not start on this machine:"; cat "$folder/jackd.log"; exit 0
}

# Three fingers on gratings that vibrate at 60, 100 and 180 Hz, and a body of 440 Hz struck twice a second.
python3 - "$folder" "$seconds" <<'PY'
import json, math, struct, sys
folder, seconds = sys.argv[1], float(sys.argv[2]) + 2
speed, tones, periods, texels = 0.08, [60, 100, 180], 8, 256
scene = ['sample_rate_hz = 48000', 'contacts = "log.jsonl"', 'tail_s = 0.2', '[audio]', 'gain = 0.02']
scene += ['[[body]]', 'name = "bar"', 'modes = "bar.modes.json"']
for tone in tones:
    with open(f'{folder}/g{tone}.pgm', 'wb') as out:
        row = [round(32767.5 + 32767 * math.sin(2 * math.pi * periods * (i + .5) / texels)) for i in range(texels)]
        out.write(b'P5\n%d 8\n65535\n' % texels + 8 * struct.pack(f'>{texels}H', *row))
    scene += ['[[surface]]', f'name = "g{tone}"', f'displacement = "g{tone}.pgm"', 'micro_relief_m = 0.0',
              f'width_m = {periods * speed / tone}', 'height_m = 0.01', 'relief_m = 4e-5', '[[actuator]]']
open(f'{folder}/scene.toml', 'w').write('\n'.join(scene) + '\n')
json.dump({'format': 'asperity.modes', 'version': 1, 'source': 'made', 'impulse_n_s': 0.01, 'modes': [
    {'frequency_hz': 440.0, 'decay_per_s': 3.0, 'amplitude': 0.3, 'phase_rad': 0.0}]}, open(f'{folder}/bar.modes.json', 'w'))
lines = []
for step in range(int(seconds * 60)):
    t = step / 60
    for finger, tone in enumerate(tones):
        event = {'t': t, 'event': 'move' if step else 'begin', 'contact': finger,
                 'uv': [speed * t / (periods * speed / tone), 0.5], 'velocity_m_s': [speed, 0.0], 'normal_force_n': 0.6}
        if not step:
            event.update(surface=f'g{tone}', actuator=finger)
        lines.append(event)
    if step % 30 == 0:
        lines.append({'t': t, 'event': 'impact', 'body': 'bar', 'speed_m_s': 0.8, 'mass_kg': 0.01,
                      'radius_m': 0.005, 'striker': 'steel'})
open(f'{folder}/log.jsonl', 'w').write('\n'.join(map(json.dumps, lines)) + '\n')
PY

start_play() {
    "$play" play "$folder/scene.toml" --host jack --channels audio=0 haptic=1,2,3 --json \
        >"$folder/play.json" 2>"$folder/play.err" &
    player=$!
}
# Waits for the player at most $1 seconds; its status is in $status.
wait_for_player() {
    for _ in $(seq $(($1 * 10))); do
        if ! kill -0 "$player" 2>/dev/null; then
            status=0
            wait "$player" || status=$?
            return
        fi
        sleep 0.1
    done
    kill -9 "$player"
    echo "error: the player hangs"; cat "$folder/play.err"; exit 1
}

start_first_server
echo "== the devices of one host, and a block that it does not run in"
"$play" play --list-devices --host jack >"$folder/devices"
cat "$folder/devices"
grep -q '^jack:output' "$folder/devices" || { echo "error: the output is not listed"; exit 1; }
! grep -vq '^jack:output' "$folder/devices" || { echo "error: more than the outputs of JACK is listed"; exit 1; }
status=0
"$play" play "$folder/scene.toml" --host jack --block 32 2>"$folder/play.err" || status=$?
cat "$folder/play.err"
[ "$status" = 1 ] && grep -q 'blocks of 32 frames are refused.*ask for 256, or for none' "$folder/play.err" \
    || { echo "error: the block is not named"; exit 1; }

echo "== four channels, $seconds s"
start_play
sleep 2
ports="$(jack_lsp | sed '/^system:/d' | sort)"
[ "$(wc -l <<<"$ports")" = 4 ] || { echo "error: four ports were expected: $ports"; cat "$folder/play.err"; exit 1; }
# shellcheck disable=SC2086
jack_rec -f "$folder/rec.wav" -d 3 -b 16 $ports >/dev/null 2>&1
wait_for_player $((${seconds%.*} + 20))
cat "$folder/play.json"
[ "$status" = 0 ] || { echo "error: status $status"; cat "$folder/play.err"; exit 1; }
python3 - "$folder" "$seconds" <<'PY'
import cmath, json, math, os, sys, wave
folder, seconds = sys.argv[1], float(sys.argv[2])
report = json.load(open(f'{folder}/play.json'))
if report['underruns']:
    # A machine that is busy elsewhere loses callbacks whatever they do; the engine's share is its load.
    print(f"{report['underruns']} underruns at a peak load of {100 * report['peak_load']:.1f} %")
    assert report['peak_load'] < 0.5 and os.environ.get('JACK_STRICT') != '1', 'underruns'
assert report['callback_frames'] == 256 and report['sample_rate_hz'] == 48000.0, report
assert report['played_s'] >= seconds and report['dropped'] == 0, report
with wave.open(f'{folder}/rec.wav') as wav:
    assert wav.getnchannels() == 4, wav.getnchannels()
    rate, raw = wav.getframerate(), wav.readframes(wav.getnframes())
samples = memoryview(raw).cast('h')
expected = [440, 60, 100, 180]
for channel, own in enumerate(expected):
    x = samples[channel::4].tolist()[rate // 2:rate // 2 + 2 * rate:4]   # 2 s at 12 kHz
    level = {}
    for tone in expected:
        turn = cmath.exp(-2j * math.pi * tone * 4 / rate)
        sum_, phase = 0j, 1 + 0j
        for value in x:
            sum_ += value * phase
            phase *= turn
        level[tone] = 20 * math.log10(2 * abs(sum_) / len(x) / 32768 + 1e-9)
    others = max(level[tone] for tone in expected if tone != own)
    print(f'channel {channel}: {own} Hz at {level[own]:.1f} dB, the other tones at most {others:.1f} dB')
    assert level[own] > -60 and level[own] > others + 20, level
PY

echo "== server killed"
start_play
sleep 2
stop_server KILL
wait_for_player 20
grep -v '^Cannot\|^JACK\|^Jack\|^jack\|^$' "$folder/play.err" || true
[ "$status" = 1 ] || { echo "error: status $status instead of 1"; cat "$folder/play.err"; exit 1; }
grep -q '^error: device: ' "$folder/play.err" || { echo "error: no error line"; exit 1; }
! grep -qi 'panic\|defect' "$folder/play.err" || { echo "error: a panic"; exit 1; }

echo "== server killed and started again"
start_server
start_play
sleep 2
stop_server KILL
start_server
wait_for_player $((${seconds%.*} + 30))
cat "$folder/play.json"
[ "$status" = 0 ] || { echo "error: status $status"; cat "$folder/play.err"; exit 1; }
python3 -c 'import json, sys; assert json.load(open(sys.argv[1]))["rebuilt"] >= 1' "$folder/play.json"
echo "passed"
