"""Excitation signals of a test, band-limited by construction."""

from typing import Literal

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError

Lines = Literal["full", "odd", "odd_detection"]

DETECTION_GROUP = 4
"""Neighbouring odd lines of which one is left out as a detection line."""


def random_phase_multisine(
    rng: np.random.Generator,
    fs: float,
    n_samples: int,
    n_periods: int,
    low: float,
    high: float,
    rms: float,
    lines: Lines = "full",
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
        lines: all of the period's spectrum; the odd ones only, so that what shows on the even ones is even distortion;
            or the odd ones without one of each four neighbours, where odd distortion shows.

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
    excited = (freq >= low) & (freq <= high) & (freq > 0.0) & (freq < fs / 2)
    if lines != "full":
        excited[0::2] = False
    if lines == "odd_detection":
        odd = np.flatnonzero(excited)
        whole = odd[: len(odd) // DETECTION_GROUP * DETECTION_GROUP].reshape(-1, DETECTION_GROUP)
        excited[whole[np.arange(len(whole)), rng.integers(DETECTION_GROUP, size=len(whole))]] = False
    if not excited.any():
        raise InputError(
            f"a band of {low:g} to {high:g} Hz with lines {fs / period:g} Hz apart",
            "a multisine has a line in its band",
            "widen the band or lengthen the period",
        )
    spectrum = np.zeros(len(freq), complex)
    spectrum[excited] = np.exp(2j * np.pi * rng.random(int(excited.sum())))
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
    return np.asarray(amplitude * faded(ends) * np.sin(phase))


def stepped_sine(fs: float, low: float, high: float, steps: int, cycles: float, amplitude: float) -> FloatArray:
    """Sines one after the other at frequencies of equal ratios, so many cycles each, without a jump of phase.

    Args:
        fs: Hz.
        low: first frequency, Hz.
        high: last frequency, Hz.
        steps: how many frequencies.
        cycles: of each.
        amplitude: peak, in the signal's unit.

    Returns:
        (N,) with a tenth of the first step to fade in.
    """
    freqs = np.geomspace(low, high, steps)
    ends = np.cumsum(cycles / freqs)
    time = np.arange(int(np.ceil(ends[-1] * fs))) / fs
    knots, turns = np.concatenate([[0.0], ends]), np.concatenate([[0.0], cycles * np.arange(1, steps + 1)])
    fade = faded(time / (0.1 * ends[0]))
    return np.asarray(amplitude * fade * np.sin(2.0 * np.pi * np.interp(time, knots, turns)))


def faded(along: FloatArray) -> FloatArray:
    """Half a cosine from 0 to 1 by which a signal fades in, in the argument's shape.

    Args:
        along: where in the fade, 0 at its start and 1 at its end, or beyond them.
    """
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.clip(along, 0.0, 1.0))))


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
