"""Frequencies that a decay does not tell apart are one mode, and those that it does are two, however damped."""

import numpy as np
import pytest
from decay_scenes import noisy, ringing

from identification.decay.mode_search import _told_apart
from identification.decay.poles import fit_poles

FS, N = 2048.0, 4096
SHAPES = np.array([[1.0, 0.6, 0.8j], [0.5, -1.0, 0.7]])


def poles_of(freqs, ratios):
    freqs, ratios = np.array(freqs), np.array(ratios)
    return 2.0 * np.pi * freqs * (1j * np.sqrt(1.0 - ratios**2) - ratios)


def test_two_modes_of_which_the_higher_turns_more_slowly_stay_two():
    """At 45 % of critical damping 111 Hz turns as fast as 99 Hz does; the frequencies are 11 % apart."""
    truth = poles_of([111.0, 100.0], [0.45, 0.01])
    signals = noisy(ringing(truth, SHAPES, FS, N), 60.0, 0)

    poles, one = _told_apart(signals, FS, fit_poles(signals, FS, truth))

    assert (one, sorted(poles.natural_freqs)) == ([], pytest.approx([100.0, 111.0], rel=0.02))


def test_two_that_are_nearer_than_the_decays_length_tells_are_one():
    """2 s tell half a hertz."""
    truth = poles_of([100.0, 100.2], [0.004, 0.004])
    signals = noisy(ringing(truth, SHAPES, FS, N), 60.0, 0)
    twice = fit_poles(signals, FS, truth)

    poles, pairs = _told_apart(signals, FS, twice)

    assert (len(twice.values), len(pairs)) == (2, 1)
    assert poles.natural_freqs == pytest.approx([100.1], abs=0.2)
