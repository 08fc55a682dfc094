"""Finite elements in segments against finite elements in one piece."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.effects import EFFECTS, Place
from models.errors import DivergenceError
from models.fine import drifting, fine_response
from models.plant import build_plant
from models.rig_file import read_rig
from testbed.virtual import random_phase_multisine

FS = 2048.0
FORCE = random_phase_multisine(np.random.default_rng(2), FS, 512, 1, 5.0, 300.0, 10.0)
REFERENCE = read_rig(Path(__file__).parents[2] / "data/reference_rig.toml")
NEARLY_NONE = 1e-9
BESIDE = {
    "contacts": (),
    "an internal state": (EFFECTS["bouc_wen"](Place(sleeve="sleeve 2", position=1.0), 5.0, 5e-4, 2.0),),
    "an absorber": (EFFECTS["absorber"](Place(position=1.2), 0.3, 25.0, 0.05),),
    "one loss factor": (EFFECTS["structural_damping"](Place(), 0.01),),
}


def moved(rate, *beside):
    return fine_response(build_plant(REFERENCE, [*beside, EFFECTS["stiffness_drift"](Place(), rate)]), FORCE, FS)


@pytest.mark.parametrize("beside", BESIDE.values(), ids=BESIDE)
def test_segments_hand_over_motion_states_and_time(beside, monkeypatch):
    whole = moved(0.0, *beside)
    monkeypatch.setattr(drifting, "steps_of_segment", lambda *_: 500)
    # A step next to an impact is quartered or not by a hair.
    np.testing.assert_allclose(moved(NEARLY_NONE, *beside), whole, rtol=0.0, atol=1e-4 * np.abs(whole).max())


def test_shorter_segments_change_little(monkeypatch):
    usual = moved(0.05)
    monkeypatch.setattr(drifting, "steps_of_segment", lambda *_: 20)
    finer = moved(0.05)
    assert np.linalg.norm(usual - finer) < 2e-3 * np.linalg.norm(finer)  # 1e-3 rad of the highest mode in the band
    assert np.linalg.norm(finer - moved(0.0)) > 0.01 * np.linalg.norm(finer)


def test_a_stiffness_that_is_used_up_or_no_longer_holds_the_compression_is_refused():
    with pytest.raises(DivergenceError, match=r"stiffness_drift: at -5 of itself a second .* is gone 0\.2 s"):
        moved(-5.0)
    plant = build_plant(REFERENCE, [EFFECTS["stiffness_drift"](Place(), -3.0)])
    pressed = replace(plant, structure=replace(plant.structure, axial_force=-800.0))
    with pytest.raises(
        DivergenceError, match=r"a bending stiffness that changes by -3 .* cannot hold the beam 0\.\d+ s"
    ):
        fine_response(pressed, FORCE, FS)
