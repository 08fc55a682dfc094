"""A march in segments against the march in one piece: nothing is lost where one segment hands over to the next."""

from dataclasses import replace

import numpy as np
import pytest
from model_scenes import REFERENCE, driven, multisine, record_of

from models import marching
from models.effects import EFFECTS, Place
from models.errors import DivergenceError
from models.plant import build_plant
from models.simulate import Settings, simulate

FS, N = 2048.0, 1024
FORCE = multisine(FS, N, 5.0, 300.0, 10.0)
TRACED = Settings(trace=True)
SLEEVE_2 = Place(sleeve="sleeve 2", position=1.0)
NEARLY_NONE = 1e-9
"""1/s, a drift that changes nothing and is marched in segments all the same."""

BESIDE = {
    "contacts": (),
    "an internal state": (EFFECTS["bouc_wen"](SLEEVE_2, 5.0, 5e-4, 2.0),),
    "a clearance that grows": (EFFECTS["wear"](SLEEVE_2, 1e-3),),
    "a dashpot": (EFFECTS["point_damping"](Place(position=0.8), 20.0),),
    "a clamp that turns": (EFFECTS["clamp_compliance"](Place(), 4e4),),
}


def moved(rate, *beside, rig=REFERENCE, settings=TRACED, n=N):
    plant = build_plant(rig, [*beside, EFFECTS["stiffness_drift"](Place(), rate)])
    return simulate(plant, record_of(plant, FORCE[:n], FS), settings)


def close(found, expected, share):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=share * np.abs(expected).max())


@pytest.mark.parametrize("beside", BESIDE.values(), ids=BESIDE)
def test_segments_hand_over_state_memory_and_time(beside, monkeypatch):
    whole = moved(0.0, *beside)
    monkeypatch.setattr(marching, "steps_of_segment", lambda *_: 7)
    parts = moved(NEARLY_NONE, *beside)
    # The iteration in a step ends at 1e-9 of the load, and impacts make that larger.
    close(parts.channels, whole.channels, 1e-5)
    for name in ("q", "v", "law_forces", "contact_forces"):
        found, expected = getattr(parts.trace, name), getattr(whole.trace, name)
        assert found.shape == expected.shape
        if expected.size:
            close(found, expected, 1e-4)


def test_a_shaken_base_is_handed_over_too(monkeypatch):
    rig = driven(REFERENCE, "base_acceleration")
    beside = EFFECTS["point_damping"](Place(position=0.8), 20.0)
    whole = moved(0.0, beside, rig=rig)
    monkeypatch.setattr(marching, "steps_of_segment", lambda *_: 7)
    close(moved(NEARLY_NONE, beside, rig=rig).channels, whole.channels, 1e-5)


def test_a_record_is_moved_alike_whatever_comes_after_and_whatever_was_kept():
    first = moved(-0.05).channels
    close(moved(-0.05, n=N // 2).channels[:, : N // 2 - 200], first[:, : N // 2 - 200], 1e-6)
    np.testing.assert_array_equal(moved(-0.05).channels, first)
    assert np.linalg.norm(first - moved(0.0).channels) > 0.01 * np.linalg.norm(first)


def test_a_motion_that_is_lost_is_told_with_its_time_and_so_is_a_stiffness_used_up():
    plant = build_plant(REFERENCE, [EFFECTS["stiffness_drift"](Place(), 1e-3)])
    plant = replace(plant, structure=plant.structure.with_dashpot(1.2, -3000.0))
    with pytest.raises(DivergenceError, match=r"test: the motion grew without bound 0\.\d+ s after the start"):
        simulate(plant, record_of(plant, FORCE, FS))
    with pytest.raises(DivergenceError, match=r"stiffness_drift: at -3 of itself a second .* is gone 0\.3333 s"):
        moved(-3.0)
