"""What denoising does to the decay rate read from a Gaussian window: the ridge is narrower than any level of a wavelet.

The rate is -d ln A / dt of the amplitude of the analytic signal in a Gaussian window about the mode (a Morlet ridge).
"""

import numpy as np
import pytest
import pywt
from signal_scenes import BEAM, FS, modes, rms, with_noise

from identification.signals.denoise import denoise_ensemble, denoise_wavelet, noise_rms

WINDOW = 0.03
DAMPING = 0.005
NEPERS = {20.0: 2.0, 40.0: 4.0, 60.0: 5.0}
"""How far down the amplitude is followed, by the noise in dB below its beginning."""

N_RECORDS = 4
TRIALS = 4


def untouched(signals):
    return signals


def universal_soft(signals):
    """The textbook's choice: soft thresholds sigma sqrt(2 ln N) on every level. Donoho and Johnstone (1994)."""
    limit = noise_rms(signals)[:, None] * np.sqrt(2.0 * np.log(signals.shape[1]))
    coarse, *details = pywt.wavedec(signals, "sym8", level=8, axis=-1)
    shrunk = [np.sign(d) * np.maximum(np.abs(d) - limit, 0.0) for d in details]
    return pywt.waverec([coarse, *shrunk], "sym8", axis=-1)[:, : signals.shape[1]]


def wavelet(signals):
    return denoise_wavelet(signals, FS).signals


def ensemble(signals):
    return denoise_ensemble(signals, FS, seed=0, trials=TRIALS).signals


def decay_rates(signals, frequency, nepers):
    """(n, N') instantaneous rates over omega, from five widths of the window after the start to so many nepers down."""
    n = signals.shape[1]
    lines = np.fft.fftfreq(2 * n, 1.0 / FS)
    window = 2.0 * np.exp(-0.5 * ((lines - frequency) / (WINDOW * frequency)) ** 2)
    amplitude = np.abs(np.fft.ifft(np.fft.fft(signals, 2 * n) * window)[:, :n])
    omega = 2.0 * np.pi * frequency
    part = slice(round(5.0 / (WINDOW * omega) * FS), round(nepers / (DAMPING * omega) * FS))
    return (-np.gradient(np.log(amplitude), axis=1) * FS / omega)[:, part]


def errors(denoise, decibels):
    """For each mode of the beam: the mean rate's error and the rms error of the instantaneous rate, in shares of it."""
    clean = np.vstack([modes(BEAM, DAMPING, n_channels=1, seed=seed).sum(axis=0) for seed in range(N_RECORDS)])
    treated = denoise(with_noise(clean, decibels))
    rates = [decay_rates(treated, frequency, NEPERS[decibels]) for frequency in BEAM]
    return np.array([(r.mean() / DAMPING - 1.0, rms(r / DAMPING - 1.0)) for r in rates])


# The noise inside the window stays, and with it the scatter. What a shrunk level takes from the decay as it sinks into
# the noise makes the decay faster: measured 0.02 at 20 dB, 0.001 at 40 dB, 4e-6 at 60 dB.
@pytest.mark.parametrize(("decibels", "faster"), [(20.0, 0.04), (40.0, 0.004), (60.0, 4e-5)])
@pytest.mark.parametrize("denoise", [wavelet, ensemble])
def test_denoising_gains_a_decay_rate_nothing_and_costs_it_little(denoise, decibels, faster):
    if denoise is ensemble:
        pytest.importorskip("PyEMD", reason="the ensemble needs the package EMD-signal")
    (mean, scatter), (treated_mean, treated_scatter) = errors(untouched, decibels).T, errors(denoise, decibels).T
    assert np.all(np.abs(treated_mean - mean) < faster)
    assert np.all(treated_scatter > 0.95 * scatter)
    assert np.all(treated_scatter < 1.2 * scatter)


def test_the_universal_soft_threshold_makes_a_decay_faster():
    """At 40 dB by 10 to 50 %, where the raw record's rates are right within 1 %."""
    (mean, scatter), (treated_mean, treated_scatter) = errors(untouched, 40.0).T, errors(universal_soft, 40.0).T
    assert np.all(np.abs(mean) < 0.01)
    assert np.all(treated_mean > 0.05)
    assert np.all(treated_scatter > 1.5 * scatter)
