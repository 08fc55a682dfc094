import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import InputError
from testbed.records.recording import Recording
from testbed.records.time_base import likely_rate, sampling_rate


def rate_of(times):
    return sampling_rate(Recording("a.csv", (), time=np.asarray(times, float)), len(times))


@given(fs=st.floats(1, 1e6), n=st.integers(2, 5000), start=st.floats(-100, 100))
def test_doubles_give_the_rate_to_their_rounding(fs, n, start):
    times = start + np.arange(n) / fs
    span = (n - 1) / fs
    # Twice the rounding of the largest stamp, over the span.
    assert rate_of(times) == pytest.approx(fs, rel=2e-12 + 4 * np.spacing(np.abs(times).max()) / span)


@pytest.mark.parametrize("fs", [333.0, 2048.0, 10000.0])
def test_single_precision_passes_and_gives_the_whole_rate(fs):
    assert rate_of((np.arange(int(20 * fs)) / fs).astype(np.float32)) == fs


@pytest.mark.parametrize(("fs", "decimals"), [(2048.0, 4), (2048.0, 6), (2000.0, 4), (5120.0, 5), (44100.0, 6)])
def test_times_printed_with_few_decimals_pass_and_give_the_whole_rate(fs, decimals):
    assert rate_of(np.round(np.arange(int(5 * fs)) / fs, decimals)) == fs


def test_a_rate_that_is_exact_is_not_rounded_to_a_whole_one():
    assert rate_of(np.arange(1000) * 0.003) == pytest.approx(1 / 0.003, rel=1e-12)


def test_decimals_coarser_than_the_step_prove_nothing():
    with pytest.raises(InputError, match="uniform"):
        rate_of(np.round(np.arange(5000) / 2048, 3))


@pytest.mark.parametrize("share", [2e-3, 0.01, 0.3])
@pytest.mark.parametrize("sample", [1, 250, 498])
def test_jitter_beyond_a_thousandth_of_a_step_is_seen_where_it_is(share, sample):
    times = np.arange(500) / 2048.0
    times[sample] += share / 2048.0
    with pytest.raises(InputError) as caught:
        rate_of(times)
    assert f"time, sample {sample} " in str(caught.value) or f"time, sample {sample + 1} " in str(caught.value)


def test_jitter_within_a_thousandth_passes():
    times = np.arange(500) / 2048.0 + 4e-4 / 2048.0 * np.sin(np.arange(500))
    assert rate_of(times) == pytest.approx(2048.0, rel=1e-5)


@pytest.mark.parametrize("sample", [1, 250, 499])
@pytest.mark.parametrize("decimals", [5, 12])
def test_a_lost_sample_is_seen_where_it_was(sample, decimals):
    times = np.delete(np.arange(501) / 2048.0, sample)
    with pytest.raises(InputError, match=rf"a\.csv: time, sample {sample} is"):
        rate_of(np.round(times, decimals))


@pytest.mark.parametrize("times", [[0.0], [1.0, 1.0], [2.0, 1.0], [0.0, 1.0, np.nan]])
def test_times_that_do_not_grow_are_refused(times):
    with pytest.raises(InputError, match=r"a\.csv: time"):
        rate_of(times)


def test_a_rate_is_whole_where_that_is_within_what_is_known():
    assert likely_rate(2048.001, 1e-6) == 2048.0
    assert likely_rate(2048.1, 1e-6) == 2048.1
    assert likely_rate(0.3, 1e-6) == 0.3
