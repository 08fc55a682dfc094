"""The recorder's band: its low-pass, and raising, differentiating and lowering the rate of band-limited signals.

All filtering is zero-phase and done by FFT on a record that is continued beyond both ends by odd reflection, tapered to
nothing, so that the record's own ends cast no wrap-around into each other.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from models.arrays import ComplexArray, FloatArray
from models.thinning import gain_of, thinned, thinned_to, thinning_taps

PASS_EDGE = 0.37
STOP_EDGE = 0.43
SCORE_EDGE = 0.35
"""Fractions of fs: the recorder is flat to the first, stopped from the second; errors are judged below the third."""

PAD = 128
"""Samples of continuation at each end; the low-pass has died out well within."""


def recorder_gain(freq: FloatArray, fs: float) -> FloatArray:
    """Gain of the recorder's anti-alias filter: 1 to 0.37 fs, raised cosine, 0 from 0.43 fs.

    Args:
        freq: Hz, any shape.
        fs: sampling rate of the record, Hz.
    """
    share = np.clip((freq / fs - PASS_EDGE) / (STOP_EDGE - PASS_EDGE), 0.0, 1.0)
    return 0.5 * (1.0 + np.cos(np.pi * share))


def continued(signal: FloatArray, pad: int, length: int) -> FloatArray:
    """The signal with ``pad`` tapered, odd-reflected samples at each end, then zeros, on the last axis.

    Args:
        signal: (..., N).
        pad: at most N - 1.
        length: of the result, N + 2 pad at least.
    """
    end = pad + signal.shape[-1]
    first, last = signal[..., :1], signal[..., -1:]
    taper = 0.5 * (1.0 + np.cos(np.pi * np.arange(1, pad + 1) / (pad + 1)))
    long = np.empty((*signal.shape[:-1], length))
    long[..., :pad] = (2.0 * first - signal[..., pad:0:-1]) * taper[::-1]
    long[..., pad:end] = signal
    long[..., end : end + pad] = (2.0 * last - signal[..., -2 : -pad - 2 : -1]) * taper
    long[..., end + pad :] = 0.0
    return long


def raise_rate(signal: FloatArray, factor: int, *, derivative: int = 0, for_linear_hold: bool = False) -> FloatArray:
    """Band-limited interpolation by an integer factor.

    Args:
        signal: (N,) samples at fs.
        factor: how many times finer.
        derivative: 0 the signal, 1 or 2 its time derivative in units of 1/sample of the coarse rate.
        for_linear_hold: pre-compensate the sinc^2 loss of a stepper that holds its input linear between fine samples,
            so that what the stepper sees is exact in amplitude within the band.

    Returns:
        (N factor,) samples at factor * fs, the first at the first coarse sample.
    """
    n = signal.shape[-1]
    pad = min(PAD, n - 1)
    n_fast = fft.next_fast_len(n + 2 * pad, real=True)
    spectrum = fft.rfft(continued(signal, pad, n_fast))
    cycles = np.arange(spectrum.shape[-1]) / n_fast
    if n_fast % 2 == 0 and factor > 1:
        spectrum[..., -1] *= 0.5
    weight = (2j * np.pi * cycles) ** derivative if derivative else np.ones_like(cycles)
    if for_linear_hold:
        weight = weight / np.sinc(cycles / factor) ** 2
    fine = fft.irfft(spectrum * weight, n_fast * factor) * factor
    return np.ascontiguousarray(fine[..., pad * factor : (pad + n) * factor])


def delayed(signal: FloatArray, samples: float) -> FloatArray:
    """(N,) a band-limited signal later by a time that need not be whole samples; before it began, its reflection.

    Args:
        signal: (N,).
        samples: of delay, at most as many as there are.
    """
    n = len(signal)
    pad = min(PAD + int(samples), n - 1)
    n_fast = fft.next_fast_len(n + 2 * pad, real=True)
    turn = np.exp(-2j * np.pi * np.arange(n_fast // 2 + 1) / n_fast * min(samples, float(pad)))
    later = fft.irfft(fft.rfft(continued(signal, pad, n_fast)) * turn, n_fast)
    return np.ascontiguousarray(later[pad : pad + n])


def record_channels(
    fine: FloatArray, factor: int, n_samples: int, fs: float, derivatives: FloatArray | None = None
) -> FloatArray:
    """What a recorder makes of finely sampled motion: low-pass, then every ``factor``-th sample.

    Args:
        fine: (n, M) at factor * fs, the first at the record's first sample, M >= (n_samples - 1) factor + 1; it is
            continued from the record's last sample, so that the end does not depend on the factor.
        factor: fine samples per recorded sample.
        n_samples: length of the record.
        fs: rate of the record, Hz.
        derivatives: (n,) how often each row is differentiated in time on the way (1 turns velocity into acceleration,
            which needs no force between samples and so no resolved impact).

    Returns:
        (n, n_samples).
    """
    pad = min(PAD, n_samples - 1)
    length = fft.next_fast_len(n_samples + 2 * pad, real=True)
    seen = continued(fine[..., : (n_samples - 1) * factor + 1], pad * factor, length * factor)
    left = thinned_to(factor) if n_samples > PAD else factor  # a short one's ends would be seen
    if left < factor:
        seen = thinned(seen, thinning_taps(factor, left), factor // left)
    orders = [0] if derivatives is None else np.asarray(derivatives).astype(int).tolist()
    of_order = {order: _weights_of(length, fs, factor, left, order) for order in set(orders)}
    weights = of_order[orders[0]] if len(of_order) == 1 else np.stack([of_order[order] for order in orders])
    coarse = fft.irfft(fft.rfft(seen)[..., : length // 2 + 1] * weights, length)
    return np.ascontiguousarray(coarse[..., pad : pad + n_samples])


@lru_cache(maxsize=16)
def _weights_of(length: int, fs: float, factor: int, left: int, order: int) -> ComplexArray:
    """(n_lines,) what the recorder does to each line of a signal that it differentiates.

    Args:
        length: of the transform at the record's rate.
        fs: of the record, Hz.
        factor: by which the rate falls.
        left: of that by the transform, after thinning, whose gain is taken back.
        order: of the derivative.
    """
    freq = np.asarray(np.arange(length // 2 + 1) * (fs / length), np.float64)
    gain = recorder_gain(freq, fs) / left
    if left < factor:
        gain = gain / gain_of(thinning_taps(factor, left), freq / (factor * fs))
    weights = gain * (2j * np.pi * freq) ** order
    weights.flags.writeable = False
    return weights
