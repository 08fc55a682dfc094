"""Blows told by the force, and by the channels alone."""

from itertools import pairwise

import numpy as np
import pytest
from tapped_scenes import FS, PERIOD, WIDTH, blows, poles_of, tapped

from identification.decay.blows import ChannelWatch, ForceWatch, Forecast
from identification.decay.poles import fit_poles

PIECE = 32
N = 20 * PERIOD


def seen_by_force(force):
    """Last samples at which it acts, piece by piece."""
    watch = ForceWatch()
    found = [(i, watch.see(force[i : i + PIECE])) for i in range(0, len(force), PIECE)]
    return [start + last for start, last in found if last is not None]


@pytest.mark.parametrize("noise", [0.0, 1e-3, 1e-2])
def test_a_force_tells_every_blow_and_nothing_else(noise):
    force, ends = blows(N)
    seen = seen_by_force(force + noise * np.random.default_rng(0).standard_normal(N))
    seen = [s for s in seen if s > ends[0] - WIDTH]  # before the first blow nothing tells noise from a force
    # A blow over the edge of two pieces is seen in both; its last sample has a quarter of its peak.
    assert {int(np.argmin(np.abs(ends - 1 - s))) for s in seen} == set(range(len(ends)))
    assert max(np.abs(ends[:, None] - 1 - np.array(seen)).min(axis=0)) <= WIDTH


def test_a_force_that_is_never_quiet_acts_throughout():
    force = np.random.default_rng(0).standard_normal(N)
    assert len(seen_by_force(force)) == -(-N // PIECE)


def test_no_force_at_all_never_acts():
    assert seen_by_force(np.zeros(N)) == []


@pytest.mark.parametrize("noise", [0.0, 1e-2])
def test_channels_at_rest_tell_a_blow(noise):
    channels, _ = tapped(N, noise=noise, period=10**6)
    _, ends = blows(N, period=10**6)
    watch = ChannelWatch(piece=4)
    seen = [i + last for i in range(0, N, PIECE) if (last := watch.see(channels[:, i : i + PIECE])) is not None]
    assert len(seen) == 1
    assert ends[0] <= seen[0] <= ends[0] + 12  # a motion that begins with its velocity, and two pieces


@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_what_was_not_foreseen_is_a_blow(noise):
    """Each blow is told from the decay before it, which has a tenth to a fifth of its motion."""
    channels, _ = tapped(N, noise=noise)
    _, ends = blows(N)
    for start, end in pairwise(ends):
        window = channels[:, start : start + 320]
        forecast = Forecast(fit_poles(window, FS, poles_of()), start, FS)
        begin = end - (end - start - 320) // PIECE * PIECE
        assert forecast.surprise(channels[:, begin:end], begin, 4) is None
        last = forecast.surprise(channels[:, end : end + PIECE], end, 4)
        assert last is not None
        assert 0 <= last <= 15


@pytest.mark.parametrize(("ratio", "told"), [(0.03, False), (0.1, False), (0.6, True)])
def test_a_forecast_bears_with_a_damping_that_changes(ratio, told):
    """Three times the damping takes a fourth of the motion in the 32 samples after the window."""
    before, n = poles_of([20.0], [0.03]), 300
    channels = tapped(106 + n, before, 1e-3, amplitudes=(1.0,), period=10**6)[0][:, 106:]
    forecast = Forecast(fit_poles(channels, FS, before), 0, FS)
    level = forecast.poles.shapes.T * np.exp(before * n / FS)
    after = np.real(level * np.exp(poles_of([20.0], [ratio])[:, None] * np.arange(PIECE) / FS))
    assert (forecast.surprise(after, n, 4) is not None) == told


def test_a_mode_that_oscillates_slowly_is_no_train_of_blows():
    """Its power passes 0 twice a period; pieces of an eighth look back over half of one."""
    period = 48
    wave = np.sin(2.0 * np.pi * np.arange(100 * period) / period)[None] * np.exp(-np.arange(100 * period) / FS)
    watch = ChannelWatch(piece=period // 8)
    seen = [watch.see(wave[:, i : i + period]) for i in range(period, wave.shape[1], period)]
    assert set(seen) == {None}
