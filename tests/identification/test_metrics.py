"""Each metric: exact for equal inputs, a closed-form value, its invariances, its limits, and what it refuses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from identification import metrics
from models.errors import InputError

ROUNDING = 1e-12  # sums of some hundred products in double precision

ERRORS = (metrics.mre, metrics.rmse)
PER_SENSOR = (metrics.frac, metrics.channel_csac, metrics.channel_csf)
PER_FREQUENCY = (metrics.csac, metrics.csf)
OF_FRFS = ERRORS + PER_SENSOR + PER_FREQUENCY

factors = st.complex_numbers(min_magnitude=1e-3, max_magnitude=1e3)


def random_frfs(seed, n_sensors=4, n_freq=60):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n_sensors, n_freq)) + 1j * rng.normal(size=(n_sensors, n_freq))


def oscillator_frf(frequency, natural_freq, damping_ratio=0.02):
    r = frequency / natural_freq
    return (1.0 / (1.0 - r**2 + 2j * damping_ratio * r))[np.newaxis, :]


@pytest.mark.parametrize("metric", OF_FRFS)
def test_equal_frfs_are_exact(metric):
    frfs = random_frfs(1)
    assert np.all(metric(frfs, frfs.copy()) == (0.0 if metric in ERRORS else 1.0))


@pytest.mark.parametrize("metric", OF_FRFS)
def test_one_value_per_sensor_or_per_frequency(metric):
    frfs = random_frfs(2)
    assert metric(frfs, frfs).shape == ((60,) if metric in PER_FREQUENCY else (4,))


@pytest.mark.parametrize("metric", PER_SENSOR + PER_FREQUENCY)
@given(seed=st.integers(0, 1000))
def test_a_criterion_lies_between_0_and_1(metric, seed):
    values = metric(random_frfs(seed), random_frfs(seed + 1))
    assert np.all((values >= 0.0) & (values <= 1.0))


@pytest.mark.parametrize("metric", [metrics.frac, metrics.csac, metrics.channel_csac])
@given(factor=factors)
def test_a_complex_factor_does_not_change_an_assurance_criterion(metric, factor):
    model, measured = random_frfs(3), random_frfs(4)
    expected = metric(model, measured)
    np.testing.assert_allclose(metric(factor * model, measured), expected, atol=ROUNDING)
    np.testing.assert_allclose(metric(model, factor * measured), expected, atol=ROUNDING)


@pytest.mark.parametrize("metric", [metrics.csf, metrics.channel_csf])
@given(factor=factors)
def test_the_scale_factor_of_a_scaled_copy(metric, factor):
    """CSF of s H against H is 2 |s| / (1 + |s|^2), so it is 0.8 for twice the level."""
    frfs, s = random_frfs(5), abs(factor)
    np.testing.assert_allclose(metric(factor * frfs, frfs), 2.0 * s / (1.0 + s * s), atol=ROUNDING)
    np.testing.assert_allclose(metric(2.0 * frfs, frfs), 0.8, atol=ROUNDING)


def test_orthogonal_frfs_score_0():
    model = np.array([[1.0, 1.0j], [1.0j, 1.0]])
    measured = np.array([[1.0, -1.0j], [-1.0j, 1.0]])
    for metric in (metrics.frac, metrics.csac, metrics.csf):
        assert np.all(metric(model, measured) == 0.0)


def test_frac_and_csac_are_squared_cosines():
    """(1, 0) against (1, 1) encloses 45 degrees."""
    model, measured = np.array([[1.0 + 0j, 0.0]]), np.array([[1.0 + 0j, 1.0]])
    assert metrics.frac(model, measured) == pytest.approx([0.5], rel=ROUNDING)
    assert metrics.csac(model.T, measured.T) == pytest.approx([0.5], rel=ROUNDING)
    assert metrics.csf(model.T, measured.T) == pytest.approx([2 / 3], rel=ROUNDING)


def test_nothing_agrees_with_nothing_and_with_nothing_else():
    """An accelerance is exactly 0 at 0 Hz in model and test alike."""
    zero, one = np.zeros((2, 1), complex), np.ones((2, 1), complex)
    for metric in (metrics.frac, metrics.csac, metrics.csf):
        assert np.all(metric(zero, zero) == 1.0)
        assert np.all(metric(zero, one) == 0.0)
        assert np.all(metric(one, zero) == 0.0)


def test_tiny_receptances_do_not_underflow():
    frfs = 1e-150 * random_frfs(6)
    assert np.all(metrics.frac(frfs, frfs) == 1.0)


def test_channel_csac_sees_a_shifted_peak_and_not_a_level():
    frequency = np.arange(20.0, 80.0, 0.25)
    measured = oscillator_frf(frequency, 50.0)
    near, far = oscillator_frf(frequency, 50.5), oscillator_frf(frequency, 55.0)
    assert metrics.channel_csac(3.0 * measured, measured) == pytest.approx([1.0], rel=ROUNDING)
    assert metrics.channel_csac(far, measured) < metrics.channel_csac(near, measured) < 1.0


def test_channel_csf_sees_the_damping():
    frequency = np.arange(20.0, 80.0, 0.25)
    measured = oscillator_frf(frequency, 50.0, 0.02)
    values = [metrics.channel_csf(oscillator_frf(frequency, 50.0, zeta), measured)[0] for zeta in (0.02, 0.03, 0.06)]
    assert values == sorted(values, reverse=True)
    assert values[0] == 1.0


def test_a_band_over_all_lines_is_the_frac():
    model, measured = random_frfs(7), random_frfs(8)
    band = metrics.channel_csac(model, measured, n_band=60)
    np.testing.assert_allclose(band, metrics.frac(model, measured), atol=ROUNDING)


def test_relative_and_absolute_error_of_a_scaled_copy():
    frfs = random_frfs(9)
    np.testing.assert_allclose(metrics.mre(1.3 * frfs, frfs), 0.3, atol=ROUNDING)
    np.testing.assert_allclose(metrics.mre(1j * frfs, frfs), 0.0, atol=ROUNDING)
    np.testing.assert_allclose(metrics.rmse(frfs + 0.5j, frfs), 0.5, atol=ROUNDING)


def test_a_line_of_zero_has_no_relative_error():
    assert metrics.mre(np.array([[5.0 + 0j, 2.0]]), np.array([[0.0j, 1.0]])) == pytest.approx([1.0])


def test_nrmse_of_a_scaled_and_of_a_missing_signal():
    signal = np.random.default_rng(10).normal(size=(3, 500))
    assert metrics.nrmse(signal, signal.copy()) == 0.0
    assert metrics.nrmse(0.9 * signal, signal) == pytest.approx(0.1, rel=ROUNDING)
    assert metrics.nrmse(np.zeros_like(signal), signal) == 1.0


def test_nrmse_counts_all_channels_together():
    measured = np.array([[3.0, 3.0], [4.0, 4.0]])
    model = np.array([[3.0, 3.0], [3.0, 3.0]])
    assert metrics.nrmse(model, measured) == pytest.approx(1.0 / 5.0, rel=ROUNDING)


def test_each_quantity_is_normalised_by_its_own_rms():
    """Channels of one quantity together, then the squares by their channels: no unit decides what counts."""
    measured = np.array([[3.0, 3.0], [4.0, 4.0], [1e-4, -1e-4]])
    model = np.array([[3.0, 3.0], [3.0, 3.0], [0.0, 0.0]])
    quantities = ["acceleration", "acceleration", "displacement"]
    expected = np.sqrt((2.0 / 25.0 + 1.0) / 3.0)
    assert metrics.nrmse(model, measured, quantities) == pytest.approx(expected, rel=ROUNDING)
    scaled = np.array([[1.0], [1.0], [1e3]])
    assert metrics.nrmse(scaled * model, scaled * measured, quantities) == pytest.approx(expected, rel=ROUNDING)


def test_records_are_averaged_by_their_squares():
    assert metrics.overall_nrmse([0.3, 0.4]) == pytest.approx(np.sqrt(0.125), rel=ROUNDING)


def test_mac_of_orthogonal_and_of_scaled_shapes():
    shapes = np.array([[1.0, 0.0, 1.0], [0.0, 2.0, 0.0]])
    np.testing.assert_array_equal(metrics.mac(shapes, (2 - 3j) * shapes[:1]), [[1.0], [0.0]])
    assert metrics.mac(np.array([[1.0, 0.0]]), np.array([[1.0, 1.0]])) == pytest.approx(0.5, rel=ROUNDING)


@given(seed=st.integers(0, 1000))
def test_mac_is_symmetric_with_ones_on_its_diagonal(seed):
    shapes = random_frfs(seed, 3, 8)
    values = metrics.mac(shapes, shapes.copy())
    np.testing.assert_array_equal(np.diag(values), 1.0)
    np.testing.assert_allclose(values, values.T, atol=ROUNDING)


@pytest.mark.parametrize("metric", [*OF_FRFS, metrics.nrmse])
def test_different_sizes_are_refused(metric):
    with pytest.raises(InputError, match=r"size \(4, 60\) and a measurement of size \(4, 59\); .*same.*; evaluate"):
        metric(random_frfs(1), random_frfs(1)[:, :-1])


@pytest.mark.parametrize("metric", OF_FRFS)
def test_a_single_row_without_its_axis_is_refused(metric):
    with pytest.raises(InputError, match=r"FRFs of size \(60,\); .*; for a single sensor"):
        metric(random_frfs(1)[0], random_frfs(1)[0])


@pytest.mark.parametrize("n_band", [1, 61])
def test_a_band_that_does_not_fit_is_refused(n_band):
    with pytest.raises(InputError, match=f"n_band = {n_band} of 60 frequency lines; .*; choose"):
        metrics.channel_csac(random_frfs(1), random_frfs(1), n_band=n_band)


def test_what_has_no_scale_is_refused():
    with pytest.raises(InputError, match="zeros; its rms normalises the error; leave the dead channel out"):
        metrics.nrmse(np.ones(4), np.zeros(4))
    with pytest.raises(InputError, match="zeros; its rms normalises the error; leave the dead channel out"):
        metrics.nrmse(np.ones((2, 4)), np.array([[0.0] * 4, [1.0] * 4]), ["displacement", "acceleration"])
    dead = random_frfs(1)
    dead[2] = 0.0
    with pytest.raises(InputError, match=r"zeros \(row 2\); .*; leave the dead channel out"):
        metrics.mre(random_frfs(1), dead)
    with pytest.raises(InputError, match=r"no records; .*; name a record"):
        metrics.overall_nrmse([])


def test_shapes_at_different_sensors_are_refused():
    with pytest.raises(InputError, match=r"size \(1, 3\) and \(1, 2\); .*same sensors; keep"):
        metrics.mac(np.ones((1, 3)), np.ones((1, 2)))
