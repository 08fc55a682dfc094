import numpy as np

from identification.decay.free import free_stretches

FS, N = 500.0, 5000
T = np.arange(N) / FS


def noise(size=1e-3, seed=0):
    return size * np.random.default_rng(seed).standard_normal(N)


def blows(*times):
    signal = np.zeros(N)
    for time in times:
        after = np.maximum(T - time, 0.0)
        signal += np.where(time <= T, np.exp(-2.0 * after) * np.sin(60.0 * after), 0.0)
    return signal[None] + noise(seed=1)


def test_the_decay_begins_after_the_blow():
    force = np.where(np.abs(T - 1.0) < 0.01, 50.0, 0.0) + noise()
    ((start, end),) = free_stretches(force, blows(1.0), FS, least=2.0)
    assert 1.01 < start / FS < 1.1
    assert end == N


def test_each_blow_has_its_decay():
    force = sum(np.where(np.abs(T - at) < 0.01, 50.0, 0.0) for at in (1.0, 5.0)) + noise()
    stretches = free_stretches(force, blows(1.0, 5.0), FS, least=2.0)
    assert [round(start / FS, 1) for start, _ in stretches] == [1.1, 5.1]


def test_a_force_that_never_rests_leaves_nothing():
    assert free_stretches(np.sin(20.0 * T) + noise(), blows(1.0), FS, least=1.0) == []


def test_a_burst_is_over_when_it_is():
    force = np.where(T < 3.0, np.sin(40.0 * T), 0.0) + noise()
    ((start, _),) = free_stretches(force, blows(0.0), FS, least=2.0)
    assert 3.0 <= start / FS < 3.2


def test_without_a_force_the_blow_shows_in_the_response():
    ((start, end),) = free_stretches(None, blows(2.0), FS, least=2.0)
    assert 2.0 <= start / FS < 2.3
    assert end == N


def test_a_record_that_begins_with_its_decay_is_taken_whole():
    assert free_stretches(None, blows(-0.5), FS, least=2.0) == [(0, N)]


def test_beats_are_not_blows():
    signal = np.exp(-0.3 * T) * (np.sin(60.0 * T) + np.sin(62.0 * T))
    assert free_stretches(None, signal[None] + noise(), FS, least=2.0) == [(0, N)]
