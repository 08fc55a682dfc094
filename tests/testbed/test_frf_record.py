"""FRFs of a record end where its excitation does."""

import numpy as np
import pytest

from testbed.channels import Channels
from testbed.frf_record import COHERENT, incoherent, levels_json, levels_of

FS, N = 512.0, 8192


def banded(low, high):
    """Noise between two frequencies, and a sensor's noise a thousandth as large over all of them."""
    rng = np.random.default_rng(2)
    frequency = np.fft.rfftfreq(N, 1.0 / FS)
    spectrum = np.fft.rfft(rng.standard_normal(N))
    spectrum[(frequency < low) | (frequency > high)] = 0.0
    force = np.fft.irfft(spectrum, N)
    return force + 1e-3 * force.std() * rng.standard_normal(N)


@pytest.mark.parametrize(("low", "high"), [(20.0, 100.0), (0.0, 256.0), (60.0, 64.0)])
def test_frfs_keep_to_the_band_that_was_excited(low, high):
    force = banded(low, high)
    response = np.stack([2.0 * force + 1e-3 * np.random.default_rng(3).standard_normal(N)])
    channels = Channels("run", FS, force, "force", ("P1",), ("acceleration",), response, ())
    estimate = levels_of(channels, 1.0).estimates[0]
    # a Hann window spreads a line over its two neighbours
    assert abs(estimate.frequency[0] - max(low, 1.0)) <= 3.0
    assert abs(estimate.frequency[-1] - high) <= 3.0
    assert estimate.coherence.shape == estimate.h1.shape == (1, estimate.frequency.size)
    assert np.abs(estimate.h1[0, 3:-3]) == pytest.approx(2.0, rel=0.02)


def channels_of(force, noise, name="run"):
    response = np.stack([2.0 * force + noise * force.std() * np.random.default_rng(3).standard_normal(N)])
    return Channels(name, FS, force, "force", ("P1",), ("acceleration",), response, ())


def test_nothing_is_said_of_responses_that_follow_the_force():
    assert incoherent(levels_of(channels_of(banded(20.0, 100.0), 1e-3), 1.0)) == []


@pytest.mark.parametrize("repeats", [True, False], ids=["over periods", "in parts"])
def test_frfs_that_tell_little_are_told(repeats):
    force = np.tile(banded(20.0, 100.0)[: N // 8], 8) if repeats else banded(20.0, 100.0)
    levels = levels_of(channels_of(force, 6.0 if repeats else 2.0), 1.0)
    coherence = levels.estimates[0].coherence.mean()
    (said,) = levels_json(levels)["findings"]
    assert coherence < COHERENT
    assert said.startswith(f"run: mean coherence {coherence:.2f} at ")
    assert ("over whole periods" in said) == repeats
    assert ("testbed compare takes a sweep" in said) != repeats
