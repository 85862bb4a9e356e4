"""Microphones on bodies of simulators: MuJoCo's wheel, and plain arrays."""

import json
import pickle
import time

import numpy as np
import pytest

import asperity as asp

mujoco = pytest.importorskip("mujoco")
import asperity.mujoco  # noqa: E402
import simulated  # noqa: E402

SEEDS = range(200)


@pytest.mark.slow
def test_onsets_of_four_scenes_are_heard_within_20_ms():
    for scene in simulated.SCENES:
        pairs = []
        for seed in SEEDS[::4]:
            signal, onsets, _ = simulated.run(scene, seed)
            pairs.append((onsets, simulated.heard_onsets(signal)))
        score = simulated.f1(pairs)
        print(f"{scene}: {sum(len(truth) for truth, _ in pairs)} onsets, F1 {score:.3f}")
        assert score >= 0.95, scene


@pytest.mark.slow
def test_slip_speed_is_heard_by_an_estimator_of_other_seeds():
    heard = [simulated.features(signal, slips) for signal, _, slips in (simulated.run("dragged", seed) for seed in SEEDS)]
    train, test = ([np.concatenate(all) for all in zip(*part, strict=True)] for part in (heard[:100], heard[100:]))
    weights = simulated.fitted(*train)
    estimate = np.maximum(simulated.design(test[0]) @ weights, 0.0) ** 2
    r2 = 1.0 - np.mean((estimate - test[1]) ** 2) / np.var(test[1])
    print(f"R² {r2:.3f}")
    assert r2 >= 0.9
