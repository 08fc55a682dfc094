"""Samples of a record that begins in motion are judged from where the recorder no longer hears what was before."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import FS, REFERENCE, let_go, oscillator

from identification.evaluate import AHEAD, TimeTarget
from identification.heard_before import unjudged_of
from identification.hypothesis import Hypothesis
from identification.noise import Noise
from models.band_limit import PAD
from models.record import Record
from models.rig import Excitation
from models.simulate import Settings

FINE = Settings(steps_per_sample=16)


def going_on(quantity, freq, share, n=2048, before=400):
    """The later part of a ringing oscillator's record, its noise, and the model in its true state there."""
    model = Hypothesis(oscillator(quantity, freq=freq, damping_ratio=1e-3))
    silent = Record("ringing", FS, None, ("top",), np.zeros((1, before + n)))
    begun = replace(model, starts={"ringing": np.array([1e-5, 2e-3])})
    clean = begun.simulated(silent, FINE).channels[:, before:]
    sensors = share * clean.std(axis=1)
    heard = clean + sensors[:, None] * np.random.default_rng(3).standard_normal(clean.shape)
    record = Record("ringing", FS, None, ("top",), heard, moving_start=True)
    return (
        record,
        Noise(sensors, 0.0, "", ""),
        replace(model, motions={"ringing": begun.motion_at(silent, before, FINE)}),
    )


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
@pytest.mark.parametrize(("freq", "share"), [(10.0, 3e-4), (20.0, 1e-4), (20.0, 3e-4), (60.0, 1e-3), (400.0, 1e-3)])
def test_a_model_in_the_true_state_leaves_the_noise(quantity, freq, share):
    record, noise, model = going_on(quantity, freq, share)
    target = TimeTarget.of(record, noise, unjudged_of(record, noise, model.plant()))

    left = target.residual(model, FINE)

    assert left @ left < 1.1 * target.n_judged


def test_with_all_samples_judged_what_was_before_is_taken_for_a_misfit():
    record, noise, model = going_on("acceleration", 20.0, 1e-4)
    target = TimeTarget.of(record, noise)

    left = target.residual(model, FINE)

    assert left @ left > 2.0 * target.n_data


def test_the_quieter_the_sensors_the_longer_the_recorder_hears_what_was_before():
    record, noise = let_go(REFERENCE, 20.0)
    plant = Hypothesis(REFERENCE).plant()

    unjudged = [unjudged_of(record, replace(noise, sensors=share * noise.sensors), plant) for share in (1e4, 1.0, 1e-2)]

    assert 0 == unjudged[0] < unjudged[1] < unjudged[2] <= PAD
    assert unjudged_of(replace(record, moving_start=False), noise, plant) == 0


def test_a_base_that_is_read_as_its_own_derivative_has_an_edge_of_its_own():
    noise = Noise(np.full(1, 1.0), 0.0, "", "")
    slow = np.sin(1e-3 * np.arange(4096))
    record = Record("driven", FS, slow, ("top",), slow[None], moving_start=True)

    def unjudged(quantity, drives):
        rig = oscillator(quantity).model_copy(update={"excitation": Excitation(name="base", quantity=drives)})
        return unjudged_of(record, noise, Hypothesis(rig).plant())

    assert unjudged("acceleration", "base_displacement") == AHEAD
    assert unjudged("displacement", "base_displacement") == unjudged("acceleration", "base_acceleration") == 0
