import numpy as np
import pytest
from decay_scenes import noisy, ringing

from identification.decay.blocks import block_edges, deviations, scatter
from models.errors import InputError

FS = 512.0
POLES = np.array([-0.4 + 2j * np.pi * 9.0, -0.3 + 2j * np.pi * 11.0])
SHAPES = np.array([[1.0, 0.5 - 0.1j], [0.6, -0.8]])


def paths(n):
    return POLES[:, None] * np.arange(n) / FS


def test_blocks_cover_the_record_and_are_long_enough_to_part_neighbours():
    edges = block_edges(8192, FS, np.array([9.0, 11.0]), 0)
    assert (edges[0], edges[-1]) == (0, 8192)
    lengths = np.diff(edges) / FS
    assert lengths.min() > 1.5 / 2.0 - 2.0 / FS  # the beat of 2 Hz, and rounding to samples
    assert np.ptp(np.diff(edges)) <= 1


def test_a_mode_on_its_path_deviates_by_nothing():
    signals = ringing(POLES, SHAPES, FS, 8192)
    edges = block_edges(8192, FS, np.array([9.0, 11.0]), 0)
    found = deviations(signals, FS, paths(8192), 0, edges)
    assert np.abs(found.log_amplitude).max() < 1e-9
    assert np.abs(found.phase).max() < 1e-9
    assert found.shape / found.shape[0] == pytest.approx(SHAPES[0] / SHAPES[0, 0], rel=1e-6)


def test_a_wrong_path_shows_as_a_slope():
    signals = ringing(POLES, SHAPES, FS, 8192)
    wrong = paths(8192) + np.array([[0.02 + 0.05j], [0.0]]) * np.arange(8192) / FS
    found = deviations(signals, FS, wrong, 0, block_edges(8192, FS, np.array([9.0, 11.0]), 0))
    slopes = [np.polyfit(found.times, level, 1)[0] for level in (found.log_amplitude, found.phase)]
    # within a block the wrong path is off by 0.05 x 0.75 s / 2, whose square biases the mean
    assert slopes == pytest.approx([-0.02, -0.05], abs=1e-3)


def test_the_variances_are_those_of_the_scatter():
    n = 32768
    light = 0.1 * POLES.real + 1j * POLES.imag
    edges = block_edges(n, FS, np.array([9.0, 11.0]), 0)
    draws = []
    for seed in range(40):
        signals = noisy(ringing(light, SHAPES, FS, n), 40.0, seed)
        found = deviations(signals, FS, light[:, None] * np.arange(n) / FS, 0, edges)
        draws.append(np.concatenate([found.log_amplitude, found.phase]) / np.sqrt(np.tile(found.variances, 2)))
    clear = np.tile(found.clear, 2)
    # 40 draws of 80 blocks, of which level and shape take about two away
    assert np.mean(np.square(draws), axis=0)[clear].mean() == pytest.approx(1.0, abs=0.08)


def test_scatter_is_one_where_the_noise_explains_it_and_the_excess_elsewhere():
    rng = np.random.default_rng(0)
    levels = np.sin(np.linspace(0.0, 3.0, 200)) * 0.1 + 0.01 * rng.standard_normal(200)
    assert scatter(levels, np.full(200, 1e-4)) == 1.0
    # the median of 200 correlated squares is known to about 12 %
    assert scatter(levels, np.full(200, 1e-6)) == pytest.approx(10.0, rel=0.2)
    jumping = levels + np.where(np.arange(200) > 100, 5.0, 0.0)
    assert scatter(jumping, np.full(200, 1e-4)) == 1.0


def test_a_mode_seen_for_less_than_two_blocks_has_one():
    assert list(block_edges(40, 4096.0, np.array([150.0, 200.0, 260.0, 365.0]), 0)) == [0, 40]


def test_a_mode_that_dies_within_a_beat_has_two_blocks():
    assert len(block_edges(200, FS, np.array([50.0, 52.5]), 0)) == 3


def test_more_numbers_than_samples_are_refused_in_words():
    signals = ringing(POLES, SHAPES, FS, 64)
    with pytest.raises(InputError, match=r"2 modes in 16 blocks of 64 samples together; .* take fewer blocks or modes"):
        deviations(signals, FS, paths(64), 0, np.arange(0, 65, 4))
