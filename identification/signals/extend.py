"""A decay continued beyond both ends of its record, so that a transform over the record meets no edge.

Near each end the channels are a sum of exponentials whose poles all channels share. The poles come from the signal
subspace of the channels' Hankel matrices (the matrix pencil in its subspace form, ESPRIT), the amplitudes from least
squares. Each exponential is carried on with a taper of its own: backwards a decay grows, and its taper ends before it
has grown e^3 times; forwards a pole that grows is carried on without growth.

Source: Y. Hua, T. K. Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38 (1990) 814; R. Roy, T. Kailath, the same 37
(1989) 984; how many poles: M. Gavish, D. L. Donoho, IEEE Trans. Inf. Theory 60 (2014) 5040.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import rfft, rfftfreq
from scipy.linalg import eigh, lstsq
from scipy.signal import firwin, oaconvolve

from models.arrays import ComplexArray, FloatArray

FITTED_SAMPLES = 1500
"""Samples near an end, after decimation, from which its poles are found, at most."""

FITTED_SHARE = 16
"""They span this share of the extension at most: over a longer stretch frequency and damping move."""

LEAST_FITTED = 512
"""Samples, before decimation, that they may always span."""

LAGS = 360
"""Rows of the Hankel matrices at most: their eigenvalues are most of the cost."""

LEAST_LAGS = 4

MOST_POLES = 60

GROWTH = 3.0
"""Nepers that an exponential may grow before its taper has brought it to zero."""

RISE = 0.02
"""Share of the stretch looked at over which its window rises from the end: a damped mode lives only there."""

ABOVE_NOISE = 30.0
"""A line this many times above the median power is no noise: chance reaches e^-20 = 2e-9."""

OF_PEAK = 1e-6
"""Lines below this share of the strongest line's power are leakage in a record without noise."""

OVERSAMPLING = 2.6
"""Samples after decimation per period of the highest content: 2 and the slope of the filter."""

ROUNDING = 1e-7
"""Singular values below this share of the largest are rounding: their squares are what is computed."""

LEAST_ROOT = 0.1
"""A pole that loses nine tenths per sample is no vibration."""


@dataclass(frozen=True, eq=False)
class Extended:
    """Signals continued beyond both ends.

    Attributes:
        signals: (..., before + N + after) the record between its continuations, which end at zero.
        before: samples put before the record.
        after: samples put after it.
    """

    signals: FloatArray
    before: int
    after: int


def extend(signals: FloatArray, length: int) -> Extended:
    """Continue the channels of one record beyond both ends by the exponentials found there.

    Args:
        signals: (..., N) channels of one record, which share their modes.
        length: samples of each continuation; an exponential that grows outwards comes to zero before.

    Source: Hua and Sarkar (1990); Roy and Kailath (1989).
    """
    rows = signals.reshape(-1, signals.shape[-1])
    after = _continued(rows, length, may_grow=False)
    before = _continued(rows[:, ::-1], length, may_grow=True)[:, ::-1]
    whole = np.concatenate((before, rows, after), axis=1)
    return Extended(whole.reshape(*signals.shape[:-1], whole.shape[-1]), length, length)


def _continued(rows: FloatArray, length: int, *, may_grow: bool) -> FloatArray:
    """(n, length) what follows the last sample."""
    near = rows[:, -max(length // FITTED_SHARE, LEAST_FITTED) :]
    step = _decimation(near)
    stretch = near[:, -FITTED_SAMPLES * step :]
    poles = _poles(_decimated(stretch, step)) / step
    if poles.size == 0:
        return np.zeros((len(rows), length))
    amplitudes = _amplitudes(stretch, poles)
    outwards = poles if may_grow else np.minimum(poles.real, 0.0) + 1j * poles.imag
    time = np.arange(1.0, length + 1.0)
    reach = GROWTH / np.maximum(outwards.real, GROWTH / length)[:, None]
    within = np.minimum(time, reach)
    shapes = np.exp(outwards[:, None] * within) * np.cos(0.5 * np.pi * within / reach) ** 2
    return np.asarray((amplitudes @ shapes).real)


def _decimation(stretch: FloatArray) -> int:
    """The step between samples that keeps all that stands above the noise."""
    size = stretch.shape[1]
    share = np.arange(size) / size
    window = np.sin(0.5 * np.pi * share) * np.sin(0.5 * np.pi * np.minimum((1.0 - share) / RISE, 1.0))
    power = np.sum(np.abs(rfft(stretch * window**2)) ** 2, axis=0)
    heard = power > max(ABOVE_NOISE * float(np.median(power)), OF_PEAK * float(power.max()))
    highest = max(float(rfftfreq(size)[heard].max(initial=0.0)), 1.0 / size)
    return int(np.clip(1.0 / (OVERSAMPLING * highest), 1, max(size // LAGS, 1)))


def _decimated(stretch: FloatArray, step: int) -> FloatArray:
    """Every ``step``-th sample of the low-passed stretch, from its inside alone: a filter leaves poles as they are."""
    if step == 1:
        return stretch
    low_pass = firwin(16 * step + 1, 1.0 / step)
    return np.asarray(oaconvolve(stretch, low_pass[None], mode="valid", axes=1)[:, ::step])


def _poles(stretch: FloatArray) -> ComplexArray:
    """Logarithms of the poles, per sample, of the signal subspace of the stacked Hankel matrices."""
    lags = min(LAGS, stretch.shape[1] // 3)
    rms = np.sqrt(np.mean(stretch**2, axis=1))
    moving = stretch[rms > 0.0] / rms[rms > 0.0, None]
    if lags < LEAST_LAGS or len(moving) == 0:
        return np.empty(0, dtype=complex)
    products = np.zeros((lags, lags))
    for row in moving:
        hankel = np.lib.stride_tricks.sliding_window_view(row, lags)
        products += hankel.T @ hankel
    values, vectors = eigh(products)
    rank = _rank(np.sqrt(np.maximum(values, 0.0)), lags / (len(moving) * (stretch.shape[1] - lags + 1)))
    if rank == 0:
        return np.empty(0, dtype=complex)
    space = vectors[:, -rank:]
    roots = np.linalg.eigvals(lstsq(space[:-1], space[1:])[0]).astype(complex)
    return np.asarray(np.log(roots[np.abs(roots) > LEAST_ROOT]))


def _rank(singular: FloatArray, beta: float) -> int:
    """How many singular values stand above noise of unknown size; beta is rows over columns."""
    edge = 0.56 * beta**3 - 0.95 * beta**2 + 1.82 * beta + 1.43
    least = max(edge * float(np.median(singular)), ROUNDING * float(singular.max()))
    return min(int(np.count_nonzero(singular > least)), MOST_POLES, len(singular) // 2)


def _amplitudes(stretch: FloatArray, poles: ComplexArray) -> ComplexArray:
    """(n, n_poles) amplitudes at the last sample, from a fit that weighs a sample the less the farther it is."""
    size = stretch.shape[1]
    time = np.arange(1.0 - size, 1.0)
    weight = np.sin(0.5 * np.pi * np.arange(1, size + 1) / size)
    shift = np.maximum(poles.real * (1.0 - size), 0.0)  # the largest exponent of each, so that none overflows
    shapes = weight * np.exp(poles[:, None] * time - shift[:, None])
    norm = np.sqrt(np.sum(np.abs(shapes) ** 2, axis=1))
    shapes /= norm[:, None]
    found = lstsq(shapes.conj() @ shapes.T, shapes.conj() @ (weight * stretch).T, cond=1e-12)[0]
    return np.asarray(found.T * (np.exp(-shift) / norm))
