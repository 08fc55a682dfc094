"""What all channels have in common beside the model: a unit, a sign; not what a structure does."""

from types import SimpleNamespace

import numpy as np
import pytest

from identification.together import loudness, off_by, wholly_off
from models.record import Record

RNG = np.random.default_rng(4)
MODEL = RNG.standard_normal((4, 2000)) * np.array([[1.0], [3.0], [0.2], [1.0]])
"""What each channel should read."""

SPREAD = np.array([[0.9], [1.1], [1.0], [1.2]])
"""What walls do to motion that is not quite in proportion to its force."""


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (9.81, "near 9.807 or its inverse (g, or kilograms-force)"),
        (1.0 / 9.81, "near 9.807 or its inverse"),
        (1e-3, "near 1000 or its inverse"),
        (4.448, "pounds-force"),
    ],
)
def test_a_unit_is_told_by_the_factor_that_all_channels_share(factor, words):
    told = off_by(factor * SPREAD * MODEL, MODEL)
    assert "all 4 channels are" in told
    assert words in told


def test_a_factor_that_is_no_unit_is_told_without_one():
    told = off_by(3.0 * MODEL, MODEL)
    assert "3 to 3 times the model's" in told
    assert "near" not in told


def test_a_reversed_force_turns_all_channels_over():
    noise = 0.5 * RNG.standard_normal(MODEL.shape) * MODEL.std(axis=1, keepdims=True)
    assert off_by(noise - MODEL, MODEL) == "all 4 channels are upside down, as if the force sensor were reversed"


@pytest.mark.parametrize(
    "measured",
    [
        MODEL * np.array([[1.0], [1.0], [1.0], [9.81]]),  # one sensor in another unit
        MODEL * np.array([[-1.0], [-1.0], [-1.0], [1.0]]),
        2.0 * SPREAD * MODEL,  # a resonance that is damped less
        RNG.standard_normal(MODEL.shape) * MODEL.std(axis=1, keepdims=True),  # chaos
    ],
    ids=["one sensor", "three of four upside down", "twice as loud", "another path"],
)
def test_what_a_structure_or_one_sensor_does_is_not_of_all_channels(measured):
    assert not off_by(measured, MODEL)


def test_one_channel_shares_nothing_and_a_dead_one_tells_nothing():
    assert not off_by(9.81 * MODEL[:1], MODEL[:1])
    dead = 9.81 * MODEL
    dead[2] = 0.0
    assert "all 3 channels" in off_by(dead, MODEL)
    np.testing.assert_allclose(loudness(dead, MODEL), 9.81)


@pytest.mark.parametrize(("force", "told"), [(RNG.standard_normal(2000), True), (None, False)])
def test_what_drives_a_record_is_to_be_measured_for_a_factor_to_be_told(force, told):
    """Without it the model only decays, and what goes on to move is no unit."""
    record = Record("test", 512.0, force, tuple("ABCD"), 9.81 * MODEL)
    row = SimpleNamespace(record=record, predicted=MODEL)

    assert bool(wholly_off(SimpleNamespace(records=(row,)))) == told
