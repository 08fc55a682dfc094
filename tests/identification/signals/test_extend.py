"""Decays continued beyond their record: the closed form, tapered, and what may not be continued."""

import numpy as np
import pytest
from signal_scenes import BEAM, FS, modes, rms, with_noise

from identification.signals.extend import GROWTH, extend

LENGTH = 4000
# The eigenvalues are of squares, so a singular value is good to the root of the rounding; measured 2e-6.
ROOT_OF_ROUNDING = 2e-5


def continued(omega, damping, phase, n, before, after):
    """The same decay over before + n + after samples."""
    time = np.arange(-before, n + after) / FS
    return np.exp(-damping * omega * time) * np.cos(omega * time + phase)


@pytest.mark.parametrize("damping", [0.0, 0.001, 0.02])
def test_a_decay_goes_on_in_closed_form_under_its_taper(damping):
    """Backwards a decay may grow by e^3, and its taper ends there; forwards it ends with the extension."""
    omega = 2.0 * np.pi * 56.0
    n = 8192
    whole = continued(omega, damping, 0.7, n, LENGTH, LENGTH)
    found = extend(whole[None, LENGTH : LENGTH + n], LENGTH)
    assert (found.before, found.after) == (LENGTH, LENGTH)
    steps = np.arange(1, LENGTH + 1)
    reach = min(LENGTH, GROWTH * FS / (damping * omega)) if damping else LENGTH
    back = np.cos(0.5 * np.pi * np.minimum(steps / reach, 1.0)) ** 2
    ahead = np.cos(0.5 * np.pi * steps / LENGTH) ** 2
    tapers = np.concatenate((back[::-1], np.ones(n), ahead))
    near = slice(LENGTH - round(reach), None)
    np.testing.assert_allclose(found.signals[0, near], (tapers * whole)[near], atol=ROOT_OF_ROUNDING * np.exp(GROWTH))
    assert np.abs(found.signals[0, : LENGTH - round(reach)]).max(initial=0.0) < ROOT_OF_ROUNDING


def test_four_modes_of_eight_channels_under_noise():
    """What came before the record, over a tenth of the slowest mode's period, is found as well as it could be read."""
    size = 20
    whole = modes(BEAM, 0.005, start=-size).sum(axis=0)
    found = extend(with_noise(whole[:, size:], 40.0), LENGTH)
    error = rms(found.signals[:, LENGTH - size : LENGTH] - whole[:, :size])
    assert error < 0.01  # the noise; measured 0.4 of it, for 512 samples tell the amplitudes


def test_what_grows_towards_the_end_is_not_made_to_grow_beyond_it():
    time = np.arange(6000) / FS
    growing = np.exp(1.5 * time) * np.sin(2.0 * np.pi * 30.0 * time)
    found = extend(growing[None], LENGTH)
    assert np.abs(found.signals[0, found.before + time.size :]).max() < 1.01 * np.abs(growing).max()  # between samples


def test_both_ends_come_to_rest():
    found = extend(with_noise(modes(BEAM, 0.001).sum(axis=0), 60.0), LENGTH)
    assert np.abs(found.signals[:, [0, -1]]).max() < 1e-12  # a cosine's square at its end


def test_noise_alone_is_continued_by_no_more_than_noise():
    noise = np.random.default_rng(0).normal(size=(4, 8192))
    found = extend(noise, LENGTH)
    assert rms(found.signals[:, :LENGTH]) < 0.1  # a pole that chance shows dies out soon


@pytest.mark.parametrize(
    "signals", [np.zeros((2, 500)), np.zeros((2, 7)), np.ones(5)], ids=["rest", "short", "one row"]
)
def test_too_little_to_go_on_is_continued_by_nothing_new(signals):
    found = extend(signals, 50)
    np.testing.assert_array_equal(found.signals[..., 50:-50], signals)
    assert np.abs(found.signals).max() <= np.abs(signals).max()


def test_leading_sizes_are_kept_and_the_record_is_untouched():
    signals = modes(BEAM[:2], 0.01, seconds=2.0, n_channels=6).reshape(2, 2, 3, -1)
    found = extend(signals, 100)
    assert found.signals.shape == (2, 2, 3, signals.shape[-1] + 200)
    np.testing.assert_array_equal(found.signals[..., 100:-100], signals)
