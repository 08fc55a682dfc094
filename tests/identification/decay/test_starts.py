from dataclasses import replace

import numpy as np
import pytest
from decay_scenes import noisy, ringing

from identification.decay.poles import fit_poles
from identification.decay.starts import widened_by_decays, widened_by_starts

FS, N = 2048.0, 4096
RATIOS = np.array([0.04, 0.03])
POLES = 2.0 * np.pi * np.array([80.0, 210.0]) * (1j * np.sqrt(1.0 - RATIOS**2) - RATIOS)
SHAPES = np.array([[1.0, 0.6, 0.8j], [0.5, -1.0, 0.7]])
SEEDS = 40


def fitted(signals):
    return fit_poles(signals, FS, 1.01 * POLES)


def deviation(poles, truth=POLES):
    return np.abs(poles.values.imag - truth.imag) / np.sqrt(np.diag(poles.covariance)[len(truth) :])


def test_a_decay_of_modes_that_stay_keeps_its_intervals():
    clean = ringing(POLES, SHAPES, FS, N)
    factors = []
    for seed in range(SEEDS):
        signals = noisy(clean, 30.0, seed)
        own = fitted(signals)
        factors.append(np.diag(widened_by_starts(signals, FS, own).covariance) / np.diag(own.covariance))
    # three starts, two modes, two numbers: beyond three deviations once in a few hundred
    assert np.mean(np.array(factors) > 1.0) < 0.05


@pytest.mark.parametrize(("seconds", "stiffer"), [(0.01, 0.01), (0.03, 0.04)])
def test_a_stiffer_beginning_widens_the_modes_to_hold_the_truth_of_the_rest(seconds, stiffer):
    """As a sleeve does that a hard blow opens and closes: all frequencies are higher there."""
    t = np.arange(N) / FS
    waves = np.exp(POLES[:, None] * t + 1j * POLES.imag[:, None] * stiffer * np.minimum(t, seconds))
    signals = noisy(np.einsum("mc,mn->cn", SHAPES, waves).real, 50.0, 0)
    own = fitted(signals)
    assert deviation(own).min() > 3.0
    assert deviation(widened_by_starts(signals, FS, own)).max() < 2.0


def test_decays_that_scatter_beyond_their_intervals_are_told_with_the_scatter():
    decays = [fitted(noisy(ringing(POLES * (1.0 + off), SHAPES, FS, N), 60.0, 0)) for off in (-0.004, 0.004)]
    wide = widened_by_decays(decays)
    assert min(deviation(poles).min() for poles in decays) > 10.0
    assert max(deviation(poles).max() for poles in wide) < 1.5
    agreeing = [fitted(noisy(ringing(POLES, SHAPES, FS, N), 60.0, seed)) for seed in range(2)]
    for poles, own in zip(widened_by_decays(agreeing), agreeing, strict=True):
        assert poles.covariance == pytest.approx(own.covariance)


def test_of_ten_decays_less_scatter_is_beyond_chance_than_of_two():
    """Frequencies that scatter by 2.5 times what they should: two blows may, ten do not."""
    (own, *_) = agreeing = [fitted(noisy(ringing(POLES, SHAPES, FS, N), 60.0, seed)) for seed in range(10)]
    std = np.sqrt(np.diag(own.covariance))[len(POLES) :]
    sides = 2.5 * (-1.0) ** np.arange(10)
    strayed = [replace(own, values=own.values + 1j * side * std) for side in sides]
    assert np.diag(widened_by_decays(strayed)[0].covariance)[len(POLES)] > 4.0 * std[0] ** 2
    assert widened_by_decays(agreeing)[0].covariance == pytest.approx(own.covariance)
