"""The local fit against least squares written out, the derivative of the transform, and lines and exponentials."""

import numpy as np
import pytest

from identification.decay.local_fit import fit_inside, fit_through, operations, phase_of
from identification.decay.windows import WINDOWS, window_named

N, STEP = 600, 0.3
T = np.arange(N)
RNG = np.random.default_rng(0)
ROUNDING = 1e-9  # of normal equations whose condition is 1e3, on sums of a few hundred numbers
BY_SHAPE = pytest.mark.parametrize("shape", WINDOWS)


def written_out(signal, phase, taps, rate, b):
    """z0 and the slope at b by a weighted least-squares solution of the model itself."""
    half = len(taps) // 2
    t = np.arange(max(b - half, 0), min(b + half + 1, len(signal)))
    wave = np.exp(-rate * (t - b) + 1j * (phase[t] - phase[b]))
    columns = np.stack((wave.real, -wave.imag, (t - b) * wave.real, -(t - b) * wave.imag), axis=1)
    root = np.sqrt(taps[t - b + half])
    x, y, u, v = np.linalg.lstsq(root[:, None] * columns, root * signal[t], rcond=None)[0]
    return x + 1j * y, (u + 1j * v) / (x + 1j * y) - rate


@BY_SHAPE
@pytest.mark.parametrize("step", [STEP, np.linspace(0.2, 0.4, N)], ids=["steady", "changing"])
@pytest.mark.parametrize("rate", [0.0, 0.01])
def test_it_is_the_least_squares_solution_at_the_ends_as_elsewhere(shape, step, rate):
    signal, taps = RNG.normal(size=N), window_named(shape).taps(20.0)
    z0, slope = fit_inside(signal, step, taps, rate)
    phase = phase_of(step, N)
    for b in (0, 1, 17, 300, 590, N - 1):
        value, expected = written_out(signal, phase, taps, rate, b)
        assert z0[b] == pytest.approx(value, rel=ROUNDING)
        assert slope[b] == pytest.approx(expected, rel=ROUNDING)


def test_a_window_longer_than_the_record_is_fitted_too():
    signal, taps = RNG.normal(size=50), window_named("hann").taps(40.0)
    z0, slope = fit_inside(signal, STEP, taps)
    value, expected = written_out(signal, phase_of(STEP, 50), taps, 0.0, 25)
    assert z0[25] == pytest.approx(value, rel=ROUNDING)
    assert slope[25] == pytest.approx(expected, rel=ROUNDING)


@BY_SHAPE
def test_a_line_times_the_carrier_is_found_exactly_everywhere(shape):
    signal = (1.0 - 1e-3 * T) * np.cos(STEP * T + 0.7)
    z0, slope = fit_inside(signal, STEP, window_named(shape).taps(30.0))
    np.testing.assert_allclose(z0, (1.0 - 1e-3 * T) * np.exp(1j * (STEP * T + 0.7)), rtol=ROUNDING)
    np.testing.assert_allclose(slope, -1e-3 / (1.0 - 1e-3 * T), atol=1e-3 * ROUNDING)


def test_an_exponential_is_missed_at_the_ends_by_the_square_of_its_decay():
    taps, errors = window_named("gaussian").taps(30.0), []
    for sigma in (4e-4, 2e-4):
        _, slope = fit_inside(np.exp(-sigma * T) * np.cos(STEP * T), STEP, taps)
        errors.append(np.abs(slope + sigma).max() / sigma)
    assert errors[0] < 0.05
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.05)  # relative error sigma a, so the error its square


def test_an_exponential_whose_rate_is_guessed_is_found_exactly():
    signal = np.exp(-5e-3 * T) * np.cos(STEP * T)
    _, slope = fit_inside(signal, STEP, window_named("gaussian").taps(30.0), 5e-3)
    np.testing.assert_allclose(slope, -5e-3, atol=1e-9)


def test_with_a_gaussian_the_slope_is_the_derivative_of_the_transform():
    """d ln W / db = T_1 / (a^2 T_0) beside the carrier; differences of ln W over two samples miss (1 / a)^2 of it."""
    signal = np.exp(-2e-3 * T) * np.cos(STEP * T) + 0.1 * RNG.normal(size=N)
    taps = window_named("gaussian").taps(30.0)
    z0, slope = fit_through(signal, np.zeros(180), np.zeros(180), STEP, taps)
    inside = slice(200, 400)
    along = np.gradient(np.log(z0 * np.exp(-1j * STEP * T)))
    np.testing.assert_allclose(slope[inside], along[inside], atol=2e-3 * np.abs(slope[inside]).max())


def test_in_the_interior_the_ridge_and_the_fit_are_one():
    """The image is exp(-2 omega_0^2) there, and omega_0 = 9."""
    signal, taps = RNG.normal(size=N), window_named("gaussian").taps(30.0)
    inside = slice(180, 420)
    ridge = fit_through(signal, np.zeros(180), np.zeros(180), STEP, taps)
    for one, other in zip(ridge, fit_inside(signal, STEP, taps), strict=True):
        np.testing.assert_allclose(one[inside], other[inside], rtol=1e-6)  # the cut of the Gaussian at 1.5e-8


def test_the_true_signal_beyond_the_ends_leaves_the_ridge_no_edges():
    whole = np.exp(-1e-3 * np.arange(-200, N + 200)) * np.cos(STEP * np.arange(-200, N + 200))
    taps = window_named("gaussian").taps(30.0)
    half = len(taps) // 2
    _, slope = fit_through(whole[200:-200], whole[200 - half : 200], whole[-200 : half - 200], STEP, taps)
    np.testing.assert_allclose(slope, -1e-3, rtol=1e-4)


def test_operations_grow_with_the_record_and_with_the_window():
    assert operations(20000, 201) > 1.9 * operations(10000, 201)
    assert operations(10000, 2001) > operations(10000, 201)
