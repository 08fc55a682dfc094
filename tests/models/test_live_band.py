"""The recorder's band block by block: kernels that end, against the spectra of whole records."""

import numpy as np
import pytest

from models.band_limit import PAD, continued, raise_rate, record_channels, recorder_gain
from models.live_band import FORCE_REACH, LiveRecorder, continue_before, force_kernels, raise_block

FS, N = 1000.0, 600


@pytest.mark.parametrize("factor", [1, 2, 3, 8])
@pytest.mark.parametrize("cycles", [0.0, 0.1, 0.3, 0.43])
def test_a_force_in_the_band_is_interpolated_for_a_linear_hold(factor, cycles):
    """A sine at ``cycles`` a sample keeps its phase and is raised by 1 / sinc^2 of the fine rate."""
    sample = np.arange(-FORCE_REACH, N + FORCE_REACH + 1)
    fine = raise_block(np.cos(2.0 * np.pi * cycles * sample + 0.4), force_kernels(factor))[0]
    expected = np.cos(2.0 * np.pi * cycles * np.arange(N * factor + 1) / factor + 0.4) / np.sinc(cycles / factor) ** 2
    np.testing.assert_allclose(fine, expected, atol=1e-6)  # 136 dB of the window, on the signal and on its images


@pytest.mark.parametrize("factor", [1, 3, 4])
def test_a_force_in_the_band_is_raised_as_that_of_a_whole_record(factor):
    time = np.arange(N) - N / 2
    force = np.exp(-((time / 80.0) ** 2)) * np.cos(2.0 * np.pi * 0.3 * time)
    fine = raise_block(force, force_kernels(factor))[0]
    whole = raise_rate(force, factor, for_linear_hold=True)[FORCE_REACH * factor :][: fine.size]
    np.testing.assert_allclose(fine, whole, atol=1e-6)  # the window, as above


def test_a_raised_force_does_not_depend_on_where_a_block_begins():
    force, kernels = np.random.default_rng(0).normal(size=N), force_kernels(3)
    whole = raise_block(force, kernels)[0]
    for first, last in ((0, 1), (7, 8), (100, 300)):
        part = raise_block(force[first : last + 2 * FORCE_REACH + 1], kernels)[0]
        np.testing.assert_array_equal(part, whole[3 * first : 3 * last + 1])


def test_the_force_before_its_first_sample_is_that_of_a_whole_record():
    force = np.random.default_rng(0).normal(size=N)
    known = np.concatenate([np.zeros(2 * FORCE_REACH), force])
    continue_before(known, 2 * FORCE_REACH)
    expected = continued(force, PAD, N + 2 * PAD)[PAD - FORCE_REACH : PAD + N]
    np.testing.assert_array_equal(known[FORCE_REACH:], expected)
    assert not known[:FORCE_REACH].any()


@pytest.mark.parametrize("reach", [64, 128, 512])
@pytest.mark.parametrize("order", [0, 1])
def test_the_gain_of_a_kernel_that_is_cut(reach, order):
    """11 / t^3 at each of two corners, cut: 5.5 / reach^2 at a corner, 11 / (2 pi 0.02 reach^3) 0.02 fs away from it.

    Fading moves the cut a little inwards; the other corner adds a little.
    """
    factor = 3
    kernel = LiveRecorder(reach, factor, FS, (order,)).kernels[0]
    freq = np.append(np.geomspace(1e-3, 0.02, 50), np.linspace(0.02, 0.5 * factor, 2001)) * FS
    time = np.arange(-reach * factor, reach * factor + 1) / (factor * FS)
    found = np.exp(-2j * np.pi * np.outer(freq, time)) @ kernel / (2j * np.pi * freq) ** order
    error = np.abs(found - recorder_gain(freq, FS))
    assert 2.0 / reach**2 < error.max() < 6.0 / reach**2
    assert error[freq < 0.35 * FS].max() < 1.2 * 88.0 / reach**3


@pytest.mark.parametrize("n_samples", [1, 50, 301])
def test_a_block_is_recorded_as_in_a_whole_record(n_samples):
    """Two channels of noise, one differentiated; the reach of a record's own continuation."""
    factor, length = 3, 2001
    fine = np.random.default_rng(2).normal(size=(2, (length - 1) * factor + 1))
    whole = record_channels(fine, factor, length, FS, np.array([0.0, 1.0]))
    recorder = LiveRecorder(512, factor, FS, (0, 1))
    last = 1500  # number of the block's last fine sample's sample
    block = fine[:, (last - n_samples) * factor + 1 - recorder.n_kept : last * factor + 1]
    found = recorder.record(block)
    first = last - n_samples + 1 - recorder.reach
    expected = whole[:, first : first + n_samples]
    size = np.std(whole, axis=1, keepdims=True)
    np.testing.assert_allclose(found / size, expected / size, atol=1e-4)  # the cut and the noise's own ends, 512 away


def test_where_a_block_begins_does_not_matter_to_a_channel():
    recorder = LiveRecorder(64, 3, FS, (1,))
    fine = np.random.default_rng(3).normal(size=(1, recorder.n_kept + 3 * 200))
    whole = recorder.record(fine)
    part = recorder.record(fine[:, 3 * 50 : 3 * 50 + recorder.n_kept + 3 * 7])
    np.testing.assert_allclose(part, whole[:, 50:57], atol=1e-12 * np.abs(whole).max())  # rounding of two FFTs
