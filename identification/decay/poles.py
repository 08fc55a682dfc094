"""Modes that keep frequency and damping: damped sinusoids fitted to all channels at once, with their covariance.

Amplitudes and phases of every channel follow from the poles by linear least squares, so only the poles are searched
(variable projection). docs/theory.md, section 9.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import cho_factor, cho_solve

from identification.decay.colour import left_over, noise_colour, ringing_colour
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError

MAX_ITERATIONS = 60
STILL = 1e-3
"""Change of every pole, in its standard deviations, that ends the search."""

LEAST_DAMPING = -5e-2
"""Most negative damping ratio that the search may take: a decay does not grow."""

MOST_GROWTH = 20.0
"""Np by which a mode may grow over the record while the search is under way."""

UNEVEN = 1.5
"""Factor of a variance from which noise is louder while a mode rings by more than chance makes it."""

ROUNDING = 1e-26
"""Share of a channel's energy that counts as noise at least, far below any recorder's."""


@dataclass(frozen=True, eq=False)
class Poles:
    """Modes of a decay, in order of frequency.

    Attributes:
        values: (n_modes,) -sigma + j omega_d of exp(values t), 1/s.
        shapes: (n_modes, n_channels) complex amplitudes at the first sample, in the channels' units.
        covariance: (2 n_modes, 2 n_modes) of real parts, then imaginary parts, of ``values``.
        noise: (n_channels,) standard deviation of what is left, in the channels' units.
    """

    values: ComplexArray
    shapes: ComplexArray
    covariance: FloatArray
    noise: FloatArray

    def only(self, kept: Sequence[int]) -> "Poles":
        """Some of the modes, with their part of the covariance."""
        modes = np.asarray(kept, dtype=int)
        both = np.concatenate([modes, modes + len(self.values)])
        return Poles(self.values[modes], self.shapes[modes], self.covariance[np.ix_(both, both)], self.noise)

    @property
    def natural_freqs(self) -> FloatArray:
        """(n_modes,) |pole| / 2 pi, Hz."""
        return np.abs(self.values) / (2.0 * np.pi)

    @property
    def damping_ratios(self) -> FloatArray:
        """(n_modes,) decay rate over |pole|."""
        return -self.values.real / np.abs(self.values)

    @property
    def natural_freq_stds(self) -> FloatArray:
        """(n_modes,) Hz."""
        angle, variance = self._variances()
        s, w, sw = variance
        radial = np.cos(angle) ** 2 * s + np.sin(angle) ** 2 * w + 2.0 * np.sin(angle) * np.cos(angle) * sw
        return np.sqrt(radial) / (2.0 * np.pi)

    @property
    def damping_ratio_stds(self) -> FloatArray:
        """(n_modes,) of the damping ratios."""
        angle, variance = self._variances()
        s, w, sw = variance
        across = np.sin(angle) ** 2 * s + np.cos(angle) ** 2 * w - 2.0 * np.sin(angle) * np.cos(angle) * sw
        return np.sqrt(across) * np.abs(np.sin(angle)) / np.abs(self.values)

    def waves(self, n_samples: int, fs: float) -> ComplexArray:
        """(n_modes, n_samples) exp(values t) from the first sample on."""
        return waves_of(self.values, n_samples, fs)

    def _variances(self) -> tuple[FloatArray, tuple[FloatArray, FloatArray, FloatArray]]:
        n = len(self.values)
        C = self.covariance
        return np.angle(self.values), (np.diag(C)[:n], np.diag(C)[n:], np.diag(C[:n, n:]))


def waves_of(values: ComplexArray, n_samples: int, fs: float) -> ComplexArray:
    """(n_modes, n_samples) exp(values t) from the first sample on.

    Args:
        values: (n_modes,) poles, 1/s.
        n_samples: of the record.
        fs: Hz.
    """
    return np.asarray(np.exp(values[:, None] * (np.arange(n_samples) / fs)))


def fit_poles(signals: FloatArray, fs: float, start: Sequence[complex] | ComplexArray) -> Poles:
    """Fit damped sinusoids to a decay by maximum likelihood, each channel with white noise of its own.

    The covariance is for noise that is as dense as it is about each mode and while the mode rings, or as it is in the
    mean where that is more.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.
        start: (n_modes,) poles to begin from, 1/s.

    Raises:
        InputError: no mode to begin from, a decay shorter than two samples per unknown, or modes that the record cannot
            tell apart.

    Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; covariance: Rao and Zhao, IEEE Trans. Signal
        Process. 41 (1993) 1702.
    """
    poles = np.asarray(start, dtype=complex)
    poles = poles[np.argsort(poles.imag)]
    n_channels, n_samples = signals.shape
    if not len(poles) or n_samples < 8 * len(poles):
        raise InputError(
            f"{len(poles)} modes in {n_samples} samples",
            "a mode has four numbers, and two samples are asked for each",
            "take a longer stretch, or name the modes with their frequencies",
        )
    weights = np.full(n_channels, 1.0)
    step = 0.0
    state = _state(signals, fs, poles)
    for _ in range(MAX_ITERATIONS):
        weights = (n_samples - 2 * len(poles)) / state.left
        gradient, curvature = _normal(state, weights)
        cost = float(np.sum(np.log(state.left))) * n_samples / 2.0
        factor = 0.0 if step == 0.0 else step
        while True:
            change = _solve(curvature + factor * np.diag(np.diag(curvature)), gradient)
            trial = poles + change[: len(poles)] + 1j * change[len(poles) :]
            growth = float(trial.real.max()) * n_samples / fs
            if trial.imag.min() > 0.0 and (-trial.real / np.abs(trial)).min() > LEAST_DAMPING and growth < MOST_GROWTH:
                new = _state(signals, fs, trial)
                lower = float(np.sum(np.log(new.left))) * n_samples / 2.0
                if lower <= cost + 1e-9 * abs(cost):
                    break
            factor = max(10.0 * factor, 1e-3)
            if factor > 1e12:
                new, trial, change = state, poles, np.zeros_like(change)
                break
        step = factor / 10.0 if factor > 1e-6 else 0.0
        small = change**2 * np.diag(curvature) < STILL**2
        poles, state = trial, new
        if small.all():
            break
    weights = (n_samples - 2 * len(poles)) / state.left
    _, curvature = _normal(state, weights)
    residual = left_over(signals, waves_of(poles, n_samples, fs))
    dense = np.maximum(noise_colour(residual, fs, np.abs(poles) / (2.0 * np.pi)), ringing_colour(residual, fs, poles))
    bound = _solve(curvature, np.eye(2 * len(poles)))
    uneven = np.diag(_where_it_matters(state, weights, residual, fs, poles, bound)) / np.diag(bound)
    deviation = np.sqrt(np.maximum(np.tile(dense, 2), np.where(uneven > UNEVEN, uneven, 1.0)))
    covariance = bound * np.outer(deviation, deviation)
    noise = np.sqrt(state.left / (n_samples - 2 * len(poles) - 2 * len(poles) / n_channels))
    order = np.argsort(poles.imag)
    both = np.concatenate([order, order + len(poles)])
    return Poles(poles[order], state.amplitudes.T[order], covariance[np.ix_(both, both)], noise)


def _where_it_matters(
    state: "_State", weights: FloatArray, residual: FloatArray, fs: float, poles: ComplexArray, bound: FloatArray
) -> FloatArray:
    """(2 n, 2 n) covariance of the poles for noise that is as loud at each moment as what is left there.

    Source: White, Econometrica 48 (1980) 817, eq. (10).
    """
    n, size = len(poles), residual.shape[1]
    waves = waves_of(poles, size, fs)
    basis = np.concatenate([waves.real, -waves.imag])
    steep = basis * (np.arange(size) / fs)
    reduced = steep - _solve(state.gram[: 2 * n, : 2 * n], state.gram[: 2 * n, 2 * n :]).T @ basis
    meat = np.zeros((2 * n, 2 * n))
    for c, weight in enumerate(weights):
        J = _towards(state.amplitudes[c])
        slopes = J.T @ reduced * residual[c]
        meat += weight**2 * slopes @ slopes.T
    return np.asarray(bound @ meat @ bound)


def pole_covariance(
    values: ComplexArray, shapes: ComplexArray, noise: FloatArray, fs: float, n_samples: int
) -> FloatArray:
    """(2 n_modes, 2 n_modes) least covariance of real parts, then imaginary parts, of poles; see ``Poles``."""
    silence = np.zeros((shapes.shape[1], n_samples))
    state = replace(_state(silence, fs, values), amplitudes=shapes.T)
    _, curvature = _normal(state, 1.0 / noise**2)
    return _solve(curvature, np.eye(2 * len(values)))


@dataclass(frozen=True, eq=False)
class _State:
    """What one set of poles leaves: products of the basis B and of t B, amplitudes, and the sums of squares left."""

    gram: FloatArray
    projections: FloatArray
    amplitudes: ComplexArray
    left: FloatArray


def _state(signals: FloatArray, fs: float, poles: ComplexArray) -> _State:
    n = len(poles)
    t = np.arange(signals.shape[1]) / fs
    waves = waves_of(poles, signals.shape[1], fs)
    basis = np.concatenate([waves.real, -waves.imag])
    both = np.concatenate([basis, t * basis])
    gram, projections = both @ both.T, both @ signals.T
    numbers = _solve(gram[: 2 * n, : 2 * n], projections[: 2 * n])
    left = np.einsum("ij,ij->i", signals, signals) - np.einsum("ij,ij->j", numbers, projections[: 2 * n])
    if (left < 1e-6 * np.einsum("ij,ij->i", signals, signals)).any():
        left = np.sum((signals - numbers.T @ basis) ** 2, axis=1)
    left = np.maximum(left, ROUNDING * np.einsum("ij,ij->i", signals, signals))
    return _State(gram, projections, numbers[:n].T + 1j * numbers[n:].T, left)


def _normal(state: _State, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gradient and curvature of the log-likelihood over the poles, the amplitudes following them."""
    n = state.amplitudes.shape[1]
    G = state.gram
    inner, cross, outer = G[: 2 * n, : 2 * n], G[: 2 * n, 2 * n :], G[2 * n :, 2 * n :]
    reduced = outer - cross.T @ _solve(inner, cross)
    gradient, curvature = np.zeros(2 * n), np.zeros((2 * n, 2 * n))
    for c, weight in enumerate(weights):
        J = _towards(state.amplitudes[c])
        numbers = np.concatenate([state.amplitudes[c].real, state.amplitudes[c].imag])
        fault = state.projections[2 * n :, c] - cross.T @ numbers
        gradient += weight * (J.T @ fault)
        curvature += weight * (J.T @ reduced @ J)
    return gradient, curvature


def _towards(amplitudes: ComplexArray) -> FloatArray:
    """(2 n, 2 n) derivatives of one channel by real, then imaginary parts of the poles, on the columns of t B."""
    a, b = np.diag(amplitudes.real), np.diag(amplitudes.imag)
    return np.block([[a, -b], [b, a]])


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    try:
        factor = cho_factor(matrix * np.outer(scale, scale))
    except LinAlgError as error:
        raise InputError(
            "two modes of one frequency and damping",
            "modes that are fitted together differ by more than the record's noise",
            "name fewer modes",
        ) from error
    solved = cho_solve(factor, (scale * right.T).T)
    return np.asarray((scale * solved.T).T)
