"""The noise of FRFs from their roughness: right for both of its parts, and blind to resonances."""

from dataclasses import replace

import numpy as np
import pytest
from rest_records import LINES, frfs_of, white
from trial_records import REFERENCE

from identification.frf_noise import LEAST_LINES, LEAST_SHARE, frf_noise
from identification.hypothesis import Hypothesis
from models.errors import InputError

TRUTH = Hypothesis(REFERENCE)


@pytest.mark.parametrize(
    ("noise", "floor"), [(0.01, 0.0), (0.05, 0.0), (0.0, 0.01), (0.01, 0.01)], ids=["1 %", "5 %", "constant", "both"]
)
def test_the_noise_is_found_whatever_its_parts(noise, floor):
    clean = frfs_of(TRUTH, noise=0.0)
    record = frfs_of(TRUTH, noise=noise, floor=floor)

    std, method = frf_noise(record)

    # 263 lines of two numbers each: 4 % of chance in an rms, as much in its estimate.
    ratio = np.sqrt(np.mean(np.abs((record.values - clean.values) / std) ** 2, axis=1) / 2.0)
    np.testing.assert_allclose(ratio, 1.0, atol=0.15)
    assert "roughness" in method


def test_each_part_of_the_noise_is_where_it_belongs():
    record = frfs_of(TRUTH, noise=0.0, floor=0.01)

    std, _ = frf_noise(record)

    size = np.abs(record.values)
    loud, quiet = size > 5.0 * size.mean(axis=1, keepdims=True), size < size.mean(axis=1, keepdims=True)
    # A twentieth of the variance in proportion to the FRF is chance.
    assert np.median(std[loud]) < 3.0 * np.median(std[quiet])


def test_resonances_between_two_lines_are_not_taken_for_noise():
    record = frfs_of(TRUTH, noise=0.0, lines=np.arange(2.0, 200.0, 2.0))

    std, _ = frf_noise(record)

    size = np.abs(record.values)
    assert np.all(std <= 3.0 * LEAST_SHARE * size + 1e-4 * size.mean(axis=1, keepdims=True))


def test_the_coherence_tells_where_the_noise_is_and_the_roughness_how_large():
    clean = frfs_of(TRUTH, noise=0.0)
    coherence = 1.0 - 0.3 * (1.0 + np.sin(LINES / 7.0)) / 2.0 - 0.01
    coherence = np.tile(coherence, (len(clean.sensors), 1))
    averages = 50
    # Bendat and Piersol: the variance of the magnitude is (1 - g) / (2 n g) of its square, that of both parts twice it.
    part = np.sqrt((1.0 - coherence) / (2.0 * averages * coherence)) * np.abs(clean.values)
    noisy = clean.values + np.sqrt(2.0) * part * white(np.random.default_rng(2), part.shape)

    std, method = frf_noise(replace(clean, values=noisy, coherence=coherence))

    np.testing.assert_allclose(np.median(std / part, axis=1), 1.0, atol=0.12)
    assert np.std(np.log(std / part)) < 0.2
    assert "coherence" in method


def test_a_coherence_of_one_is_no_division_by_zero():
    clean = frfs_of(TRUTH)

    std, _ = frf_noise(replace(clean, coherence=np.ones(clean.values.shape)))

    assert np.all(np.isfinite(std))
    assert np.all(std > 0.0)


def test_too_few_lines_tell_no_noise():
    with pytest.raises(InputError, match=r"h\.uff: FRFs on 31 lines above 0 Hz; .* 32 lines at least; export more"):
        frf_noise(frfs_of(TRUTH, lines=LINES[: LEAST_LINES - 1]))
