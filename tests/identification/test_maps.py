"""Error maps: their sums are the errors they divide, and an error sits where it was put."""

from dataclasses import replace

import numpy as np
import pytest

from identification.evaluate import nrmse, scored_spectrum
from identification.maps import error_map
from identification.noise import Noise
from identification.result import RecordScore
from models.record import Record

FS, N = 512.0, 4096
SIGMA = 0.01


def score_of(error, excitation=True):
    rng = np.random.default_rng(3)
    measured = rng.standard_normal((2, N))
    force = rng.standard_normal(N) if excitation else None
    record = Record("test", FS, force, ("A", "B"), measured)
    spectra = scored_spectrum(error), scored_spectrum(measured)
    channel = np.array([nrmse(e[None], m[None], ("",)) for e, m in zip(*spectra, strict=True)])
    noise = np.full(2, SIGMA * np.sqrt(0.7))  # white to fs/2, judged below 0.35 fs, beside a measurement of density 1
    return RecordScore(
        record, measured + error, Noise(np.full(2, SIGMA), 0.0, "", ""), nrmse(*spectra, ("", "")), 0.0, channel, noise
    )


@pytest.mark.parametrize("excitation", [True, False], ids=["driven", "free decay"])
def test_bands_and_windows_add_up_to_the_channels_error(excitation):
    score = score_of(0.1 * np.random.default_rng(4).standard_normal((2, N)), excitation)

    found = error_map(score)

    np.testing.assert_allclose(np.sum(found.by_frequency**2, axis=1), score.channel_nrmse**2, rtol=2e-3)  # the Nyquist
    # Windows hold 102 or 103 samples.
    np.testing.assert_allclose(np.mean(found.by_time**2, axis=1), score.channel_nrmse**2, rtol=5e-3)
    assert (found.level > 0) == excitation


def test_a_tone_shows_in_its_band_and_a_burst_in_its_window_of_one_sensor_only():
    time = np.arange(N) / FS
    tone = error_map(score_of(np.stack([0.5 * np.sin(2 * np.pi * 80.0 * time), 0 * time])))
    burst = error_map(score_of(np.stack([0 * time, np.sin(2 * np.pi * 60.0 * time) * (np.abs(time - 6.0) < 0.1)])))

    band = int(np.argmax(tone.by_frequency[0]))
    assert tone.frequency[band] == pytest.approx(80.0, rel=0.2)  # half a band's width
    assert tone.by_frequency[0, band] ** 2 > 0.99 * np.sum(tone.by_frequency[0] ** 2)
    assert np.all(tone.by_frequency[1] == pytest.approx(0.0, abs=1e-9))
    assert burst.time[int(np.argmax(burst.by_time[1]))] == pytest.approx(6.0, abs=0.2)
    assert np.all(burst.by_time[0] == pytest.approx(0.0, abs=1e-9))


def test_white_noise_is_shared_out_by_width():
    found = error_map(score_of(SIGMA * np.random.default_rng(5).standard_normal((2, N))))

    wide = found.noise_by_frequency[:, -6:]
    np.testing.assert_allclose(found.by_frequency[:, -6:], wide, rtol=0.25)  # bands of 90 lines and more: 2 sigma
    np.testing.assert_allclose(np.sum(found.noise_by_frequency**2, axis=1), 0.7 * SIGMA**2 / 0.7, rtol=0.05)


def test_noise_of_the_excitation_follows_the_models_gain():
    score = score_of(np.zeros((2, N)))
    time = np.arange(N) / FS
    tone = np.stack([np.sin(2 * np.pi * 80.0 * time)] * 2)
    carried = replace(score, predicted=tone, channel_noise_nrmse=np.full(2, 0.3))

    found = error_map(carried)

    assert found.frequency[int(np.argmax(found.noise_by_frequency[0]))] == pytest.approx(80.0, rel=0.2)
    np.testing.assert_allclose(np.sum(found.noise_by_frequency**2, axis=1), 0.3**2, rtol=1e-6)


def test_the_bands_begin_where_the_excitation_does():
    time = np.arange(N) / FS
    score = score_of(np.zeros((2, N)))
    record = replace(score.record, excitation=np.sin(2 * np.pi * (40.0 * time + 5.0 * time**2)))

    found = error_map(replace(score, record=record))

    assert 30.0 < found.frequency[0] < 45.0


def test_a_short_record_has_fewer_bands_and_none_is_empty():
    score = score_of(np.zeros((2, N)))
    record = replace(score.record, excitation=None, responses=score.record.responses[:, :30])
    found = error_map(replace(score, record=record, predicted=score.predicted[:, :30]))

    assert np.all(np.diff(found.frequency) > 0)
    assert np.all(np.isfinite(found.by_frequency))
    assert found.by_time.shape == (2, len(found.time)) == (2, 30)
