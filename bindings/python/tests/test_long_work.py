"""Threads, memory, Ctrl-C, and the live halves."""

import dataclasses
import gc
import pathlib
import subprocess
import sys
import threading
import time
import tracemalloc

import numpy as np
import pytest
from machine import busy

import asperity as asp

FINGERS = 10


def scene_of_fingers():
    """Ten fingers on ten bodies."""
    heights_m = 1e-4 * np.random.default_rng(2).random((256, 256))
    surfaces = [
        asp.Surface(heights_m, 0.14, name=f"s{i}").on(asp.Body.stock("plate", 0.1 + 0.01 * i, "ceramic", name=f"b{i}"))
        for i in range(FINGERS)
    ]
    return asp.SceneFile(surfaces, audio={"gain": 1e-2}, actuators=[{"full_scale": 1e-3}])


def strokes(duration):
    rows = [
        asp.contacts.stroke(duration=duration, extent=(0.14, 0.14), surface=f"s{i}", contact=i + 1, start=(0.1, 0.05 + 0.09 * i))
        for i in range(FINGERS)
    ]
    rows = np.concatenate(rows)
    return rows[np.argsort(rows["t"], kind="stable")]


@pytest.mark.slow
def test_two_threads_render_in_the_time_of_one():
    scaling = busy(6_000_000)
    if scaling < 1.8:
        pytest.skip(f"two busy processes alone get {scaling:.2f} times as much done here; 1.8 are needed to tell")
    scene, rows = scene_of_fingers(), strokes(4.0)
    asp.render(scene, rows)

    def seconds(threads):
        workers = [threading.Thread(target=asp.render, args=(scene, rows)) for _ in range(threads)]
        began = time.perf_counter()
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        return time.perf_counter() - began

    ratio = min(seconds(2) / seconds(1) for _ in range(5))
    print(f"two threads take {ratio:.3f} of the time of one; two processes get {scaling:.2f} done")
    assert ratio <= 1.2


def resident_kib():
    status = pathlib.Path("/proc/self/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1])


@pytest.mark.slow
@pytest.mark.skipif(not pathlib.Path("/proc/self/status").exists(), reason="resident memory is read from /proc")
def test_memory_is_flat_over_a_thousand_renders():
    surface = asp.Surface(1e-4 * np.random.default_rng(1).random((64, 64)), 0.1).on(asp.Body.stock("plate", 0.1, "steel"))
    surface = asp.SceneFile(surface, audio={"gain": 1e-2}, actuators=[{"full_scale": 1e-4}], tail_s=0.1)
    rows = asp.contacts.stroke(duration=0.1, extent=(0.1, 0.1))
    for _ in range(100):
        asp.render(surface, rows)
    gc.collect()
    before = resident_kib()
    for _ in range(1000):
        asp.render(surface, rows)
    gc.collect()
    grown = resident_kib() - before
    print(f"resident memory grew by {grown} KiB over 1000 renders")
    assert grown < 2048


def test_blocks_of_the_live_halves_have_the_bits_of_the_offline_render():
    scene, rows = scene_of_fingers(), strokes(0.5)
    take = asp.render(scene, rows, sr=48_000)
    live = asp.Scene(scene, sr=48_000, clock="exact")
    live.report_all(rows)
    latency = live.renderer.latency_samples
    blocks = [live.renderer.render(n) for n in (1, 63, 64, 1000, 22_872)]
    audio, haptic = (np.concatenate(parts, axis=-1)[..., latency:] for parts in zip(*blocks, strict=True))
    assert audio.tobytes() == take.audio[: audio.shape[-1]].tobytes()
    assert haptic.tobytes() == np.ascontiguousarray(take.haptic[:, : haptic.shape[-1]]).tobytes()
    assert np.abs(audio).max() > 1e-4


def test_render_into_fills_the_mapped_channels_and_leaves_the_others_silent():
    scene, rows = scene_of_fingers(), strokes(0.3)
    one, other = (asp.Scene(scene, sr=48_000, clock="exact") for _ in range(2))
    for live in (one, other):
        live.report_all(rows)
    audio, haptic = one.renderer.render(4800)
    assert other.renderer.channels("audio=3 haptic=1") == 4
    out = np.full((4800, 5), 7.0, np.float32)
    for start in range(0, 4800, 64):
        other.renderer.callback(out[start : start + 64], 64, None, None)
    assert out[:, 3].tobytes() == audio.tobytes() and out[:, 1].tobytes() == haptic[0].tobytes()
    assert not out[:, [0, 2, 4]].any() and np.abs(haptic).max() > 1e-4


def traced(call, out, times):
    """By how many bytes Python's memory grows over so many calls, and how far it rises meanwhile."""
    gc.collect()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(times):
        call(out)
    after, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return after - before, peak - before


def test_render_into_makes_no_python_object():
    scene, rows = scene_of_fingers(), strokes(0.5)
    live = asp.Scene(scene, sr=48_000, clock="exact")
    live.report_all(rows)
    out = np.zeros((64, 3), np.float32)
    render_into = live.renderer.render_into
    for _ in range(50):
        render_into(out)
    # What the loop itself takes, a call of nothing shows.
    nothing, growth = traced(id, out, 300), traced(render_into, out, 300)
    print(f"traced memory grows by {growth[0]} bytes and rises by {growth[1]}; with an empty call by {nothing}")
    assert growth[0] <= nothing[0] + 32 and growth[1] <= nothing[1] + 64
    assert traced(render_into, out, 3000)[0] <= growth[0] + 32


def test_wrong_buffers_and_channel_maps_are_refused():
    renderer = asp.Scene(asp.Solid("granite")).renderer
    for out in (np.zeros((64, 2)), np.zeros(64, np.float32), [[0.0]]):
        with pytest.raises(TypeError):
            renderer.render_into(out)
    with pytest.raises((ValueError, TypeError)):
        renderer.render_into(np.zeros((2, 64), np.float32).T)
    frozen = np.zeros((64, 2), np.float32)
    frozen.flags.writeable = False
    with pytest.raises((ValueError, TypeError)):
        renderer.render_into(frozen)
    with pytest.raises(ValueError, match="two signals share a channel"):
        renderer.channels("audio=0 haptic=0")
    renderer.render_into(np.zeros((64, 3), np.float32))


def test_live_reports_are_checked_and_silence_is_explained():
    live = asp.Scene(asp.Solid("granite").on(asp.Body.stock("plate", 0.1, "stone")), sr=48_000)
    assert "Renderer::render" in live.why_silent()[0]
    assert live.why_clipped() == []
    with pytest.raises(ValueError, match='"floor" is unknown; must be one of: surface'):
        live.begin(0.0, 1, "floor", [0.1, 0.5], 0.5)
    with pytest.raises(ValueError, match="normal_force_n"):
        live.begin(0.0, 1, "surface", [0.1, 0.5], float("nan"))
    with pytest.raises(ValueError, match="actuator: 3"):
        live.begin(0.0, 1, "surface", [0.1, 0.5], 0.5, actuator=3)
    live.begin(0.0, 1, "surface", [0.1, 0.5], 0.5, velocity_m_s=[0.1, 0.0])
    live.impact(0.01, "body", speed_m_s=0.5, mass_kg=0.01, radius_m=0.005)
    loudest = 0.0
    for block in range(200):
        live.move(0.01 + block * 256 / 48_000, 1, [0.1 + 0.1 * block * 256 / 48_000 / 0.14, 0.5], 0.5)
        loudest = max(loudest, np.abs(live.renderer.render(256)[0]).max())
    live.end(1.2, 1)
    assert loudest > 1e-3 and live.stats["impacts"] == 1 and live.surfaces == ["surface"] and live.bodies == ["body"]


# In a process of its own: what other tests have imported (Dask) runs code of its own in the garbage collector, and an interrupt
# that arrives there is lost.
INTERRUPTED = """
import os, signal, sys, threading, time
import numpy as np
import asperity as asp
from test_long_work import scene_of_fingers, strokes

what = sys.argv[1]
# A shell that starts the tests in the background has Ctrl-C ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
rate = 48_000
t = np.arange(4 * rate) / rate
y = sum(np.exp(-3 * t) * np.sin(2 * np.pi * 97.3 * k * t + k) for k in range(1, 120)) / 120
# Hours of strokes; a recording of more than a hundred modes.
scene, rows = scene_of_fingers(), strokes(300.0)
threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
began = time.perf_counter()
try:
    if what == "render":
        asp.render(scene, rows)
    elif what == "contacts":
        for _ in range(50):
            asp.contacts.to_jsonl(rows)
    else:
        for _ in range(50):
            asp.fit(y, rate)
except KeyboardInterrupt:
    print(time.perf_counter() - began)
# What was left behind does no harm.
assert np.abs(asp.stroke(asp.Solid("granite"), duration=0.2).haptic).max() > 1e-4
"""


@pytest.mark.slow
@pytest.mark.parametrize("what", ["render", "contacts", "fit"])
def test_ctrl_c_stops_long_work_at_once(what):
    ran = subprocess.run([sys.executable, "-c", INTERRUPTED, what], capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0 and ran.stdout, f"was not interrupted: {ran.stderr}"
    print(f"{what} stopped after {float(ran.stdout):.2f} s")
    assert float(ran.stdout) < (20.0 if what == "fit" else 3.0)


@pytest.mark.slow
def test_progress_is_told_and_what_it_raises_stops_the_work():
    told = []
    asp.render(scene_of_fingers(), strokes(20.0), progress=told.append)
    assert len(told) >= 3 and told == sorted(told) and 0 <= told[0] <= told[-1] <= 1

    def enough(done):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        asp.render(scene_of_fingers(), strokes(60.0), progress=enough)


@pytest.mark.slow
def test_a_callback_in_python_keeps_nine_tenths_of_the_headroom_of_the_loop_in_rust():
    seconds, rate, frames = 4.0, 48_000, 64
    scene, rows = dataclasses.replace(scene_of_fingers(), tail_s=0.0), strokes(seconds)
    out = np.zeros((frames, 3), np.float32)

    def in_python():
        live = asp.Scene(scene, sr=rate, clock="exact")
        live.report_all(rows)
        callback = live.renderer.callback
        began = time.perf_counter()
        for _ in range(int(seconds * rate) // frames):
            callback(out, frames, None, None)
        return time.perf_counter() - began

    def in_rust():
        # The same blocks in the offline loop; what is made around them, a render of no event shows.
        def took(part):
            began = time.perf_counter()
            asp.render(scene, part, sr=rate, block=frames, progress=False)
            return time.perf_counter() - began

        return took(rows) - took(asp.contacts.empty(0))

    pairs = [(in_rust(), in_python()) for _ in range(7)]
    share = sorted(rust / python for rust, python in pairs)[len(pairs) // 2]
    fastest = seconds / min(python for _, python in pairs)
    print(f"Python's callback: {fastest:.1f} times real time, {share:.3f} of the loop in Rust")
    assert share >= 0.9
