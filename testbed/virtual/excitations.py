"""Excitation signals of a virtual test, band-limited by construction."""

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError


def random_phase_multisine(
    rng: np.random.Generator, fs: float, n_samples: int, n_periods: int, low: float, high: float, rms: float
) -> FloatArray:
    """Periods of a sum of sines of equal amplitude and random phase, one at each line of the period's spectrum.

    It begins where it passes 0 straight, so that a record that starts with it starts without a blow.

    Args:
        rng: draws the phases.
        fs: Hz.
        n_samples: of the whole signal; divisible by ``n_periods``.
        n_periods: how often the sum repeats.
        low: lower end of the band, Hz.
        high: upper end, Hz.
        rms: of the signal, in its unit.

    Returns:
        (n_samples,).

    Raises:
        InputError: the periods do not fit, or no line lies in the band.

    Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), section 5.3.
    """
    if n_samples % n_periods:
        raise InputError(
            f"{n_samples} samples in {n_periods} periods",
            "a period is a whole number of samples",
            "choose a length that the number of periods divides",
        )
    period = n_samples // n_periods
    freq = np.fft.rfftfreq(period, 1.0 / fs)
    lines = (freq >= low) & (freq <= high) & (freq > 0.0) & (freq < fs / 2)
    if not lines.any():
        raise InputError(
            f"a band of {low:g} to {high:g} Hz with lines {fs / period:g} Hz apart",
            "a multisine has a line in its band",
            "widen the band or lengthen the period",
        )
    spectrum = np.zeros(len(freq), complex)
    spectrum[lines] = np.exp(2j * np.pi * rng.random(int(lines.sum())))
    wave = np.fft.irfft(spectrum, period)
    bend = np.roll(wave, 1) - 2.0 * wave + np.roll(wave, -1)
    wave = np.roll(wave, -int(np.argmin(wave**2 + bend**2)))
    return np.tile(wave * (rms / np.sqrt(np.mean(wave**2))), n_periods)


def logarithmic_sweep(fs: float, n_samples: int, low: float, high: float, amplitude: float) -> FloatArray:
    """A sine whose frequency grows by equal ratios in equal times, with a tenth of the record to fade in and out.

    Args:
        fs: Hz.
        n_samples: of the signal.
        low: first frequency, Hz.
        high: last frequency, Hz.
        amplitude: peak, in the signal's unit.

    Returns:
        (n_samples,).

    Source: A. Farina, AES Convention 108 (2000) 5093, eq. (4).
    """
    time, duration = np.arange(n_samples) / fs, n_samples / fs
    ratio = np.log(high / low)
    phase = 2.0 * np.pi * low * duration / ratio * np.expm1(time / duration * ratio)
    ends = np.minimum(time, duration - time) / (0.05 * duration)
    fade = 0.5 * (1.0 - np.cos(np.pi * np.clip(ends, 0.0, 1.0)))
    return np.asarray(amplitude * fade * np.sin(phase))


def half_sine_hammer(fs: float, n_samples: int, start: float, width: float, peak: float) -> FloatArray:
    """One blow of a hammer.

    Args:
        fs: Hz.
        n_samples: of the signal.
        start: of the blow, s.
        width: of the blow, s; its spectrum has its first zero at 1.5 / width.
        peak: N.

    Returns:
        (n_samples,).
    """
    phase = (np.arange(n_samples) / fs - start) / width
    return np.where((phase > 0.0) & (phase < 1.0), peak * np.sin(np.pi * np.clip(phase, 0.0, 1.0)), 0.0)
