import numpy as np
import pytest
from decay_scenes import noisy, ringing

from identification.decay.cramer_rao import information_inverse, poles_bound
from identification.decay.poles import fit_poles
from models.errors import InputError

FS, N = 512.0, 2048
VALUES = np.array([-1.2 + 2j * np.pi * 9.0, -0.8 + 2j * np.pi * 31.0])
SHAPES = np.array([[1.0, 0.4 - 0.1j, -0.3], [0.2, -0.7, 0.5 + 0.2j]])


def test_poles_of_an_exact_decay_are_found_from_a_wrong_start():
    found = fit_poles(ringing(VALUES, SHAPES, FS, N), FS, VALUES * 1.01 - 0.5)
    # the search ends when a step is below 1e-3 deviations, which round-off makes 1e-12 of a pole
    assert found.values == pytest.approx(VALUES, rel=1e-9)
    assert found.shapes == pytest.approx(SHAPES, rel=1e-7)


def test_the_covariance_is_the_bound_and_the_scatter_is_its():
    signals = ringing(VALUES, SHAPES, FS, N)
    noise = np.array([0.01, 0.02, 0.015])
    bound = poles_bound(VALUES, SHAPES, noise, fs=FS, n_samples=N)
    found = []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        found.append(fit_poles(signals + noise[:, None] * rng.standard_normal(signals.shape), FS, VALUES))
    errors = np.array([np.concatenate([(p.values - VALUES).real, (p.values - VALUES).imag]) for p in found])
    stds = np.sqrt(np.diag(bound.covariance))
    # 200 draws: a standard deviation is known to 5 %, a mean to 7 % of it
    assert errors.std(axis=0) == pytest.approx(stds, rel=0.2)
    assert np.abs(errors.mean(axis=0)) == pytest.approx(0.0, abs=0.3 * stds.max())
    assert np.sqrt(np.diag(found[0].covariance)) == pytest.approx(stds, rel=0.15)
    assert found[0].noise == pytest.approx(noise, rel=0.06)


def test_the_bound_is_that_of_all_numbers_together():
    """Amplitudes eliminated channel by channel, against the whole Fisher information of one channel at once."""
    t = np.arange(N) / FS
    waves, shape = np.exp(VALUES[:, None] * t), SHAPES[:, :1]
    own = np.concatenate([waves.real, -waves.imag])
    moved = t * shape * waves
    columns = np.concatenate([moved.real, -moved.imag, own])
    whole = information_inverse(columns, 0.01**2)[:4, :4]
    bound = poles_bound(VALUES, shape, np.array([0.01]), fs=FS, n_samples=N)
    assert bound.covariance == pytest.approx(whole, rel=1e-8)


def test_deviations_of_frequency_and_ratio_follow_from_those_of_the_pole():
    bound = poles_bound(VALUES[:1], SHAPES[:1], np.full(3, 0.01), fs=FS, n_samples=N)
    draws = np.random.default_rng(0).multivariate_normal([0.0, 0.0], bound.covariance, 20000)
    values = VALUES[0] + draws[:, 0] + 1j * draws[:, 1]
    assert bound.natural_freq_stds[0] == pytest.approx((np.abs(values) / 2 / np.pi).std(), rel=0.02)
    assert bound.damping_ratio_stds[0] == pytest.approx((-values.real / np.abs(values)).std(), rel=0.02)


def test_modes_two_per_cent_apart_are_told_apart():
    close = np.array([-0.5 + 2j * np.pi * 30.0, -0.5 + 2j * np.pi * 30.6])
    signals = noisy(ringing(close, SHAPES, FS, 8192), 40.0, 1)
    found = fit_poles(signals, FS, close + np.array([0.5j, -0.5j]))
    bound = poles_bound(close, SHAPES, found.noise, fs=FS, n_samples=8192)
    errors = np.concatenate([(found.values - close).real, (found.values - close).imag])
    assert np.abs(errors / np.sqrt(np.diag(bound.covariance))).max() < 4.0


def test_a_low_pass_in_the_recorder_does_not_narrow_the_intervals():
    signals = ringing(VALUES, SHAPES, FS, N)
    rng = np.random.default_rng(0)
    spectrum = np.fft.rfft(0.01 * rng.standard_normal(signals.shape), axis=1)
    spectrum[:, np.fft.rfftfreq(N, 1 / FS) > 0.25 * FS] = 0.0  # half of the noise is gone, none of it about the modes
    found = fit_poles(signals + np.fft.irfft(spectrum, N, axis=1), FS, VALUES)
    bound = poles_bound(VALUES, SHAPES, np.full(3, 0.01), fs=FS, n_samples=N)
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(np.sqrt(np.diag(bound.covariance)), rel=0.15)


def test_nothing_to_begin_from_is_refused():
    with pytest.raises(InputError, match=r"0 modes in 2048 samples; .* two samples are asked for each; take a longer"):
        fit_poles(np.ones((1, N)), FS, [])


def test_one_mode_twice_is_refused():
    with pytest.raises(InputError, match="two modes of one frequency and damping"):
        fit_poles(ringing(VALUES, SHAPES, FS, N), FS, [VALUES[0], VALUES[0]])


@pytest.mark.parametrize("kind", ["steady", "while it rings"])
def test_intervals_of_heavy_damping_cover_the_truth(kind):
    """Noise that ends with the decay, as what a missing mode or an impact leaves, counts where the mode rings."""
    fs, n, draws = 4096.0, 4096, 100
    ratios = np.array([0.04, 0.09, 0.08])
    truth = 2.0 * np.pi * np.array([81.0, 160.0, 373.0]) * (1j * np.sqrt(1.0 - ratios**2) - ratios)
    shapes = np.array([[5.0, 4.0, 2.5], [-2.5j, 5.0j, 4.0j], [3.0, -4.0, 5.0]])
    clean = ringing(truth, shapes, fs, n)
    loudness = np.ones(n) if kind == "steady" else 0.02 + 20.0 * np.exp(-np.arange(n) / fs / 0.02)
    inside = []
    for seed in range(draws):
        noise = 0.01 * loudness * np.random.default_rng(seed).standard_normal(clean.shape)
        found = fit_poles(clean + noise, fs, truth * 1.01)
        of_freq = np.abs(found.natural_freqs - np.abs(truth) / 2.0 / np.pi) < 1.96 * found.natural_freq_stds
        of_ratio = np.abs(found.damping_ratios - ratios) < 1.96 * found.damping_ratio_stds
        inside.append(np.concatenate([of_freq, of_ratio]))
    # 100 draws know a share of 95 % to 2.2 %; few samples of noise tell its own size to a tenth
    assert np.mean(inside, axis=0).min() > 0.85
    assert 0.90 < np.mean(inside) < 0.985
