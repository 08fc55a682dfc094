"""The modes that stand out of one window, fitted from poles that are nearly known."""

import numpy as np

from identification.decay.blocks import CLEAR
from identification.decay.poles import Poles, fit_poles, waves_of
from models.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from models.errors import InputError

ASTRAY = 0.5
"""Share of the way to the nearest mode that a natural frequency may move."""

PASSES = 3
"""Modes are told anew with the poles found, until they are the same; so often at most."""

TINY = float(np.finfo(float).tiny)


def fit_window(signals: FloatArray, fs: float, warm: ComplexArray, home: ComplexArray) -> tuple[Poles, IntArray] | None:
    """Fit the modes that stand out, or give None where none does or they cannot be told apart.

    Args:
        signals: (n_channels, N) a stretch in which nothing drives the rig.
        fs: sampling rate, Hz.
        warm: (n_modes,) poles to begin from, 1/s.
        home: (n_modes,) poles about which the frequencies stay.

    Returns:
        the poles and the (m,) numbers of their modes.
    """
    poles, clear, found = warm.copy(), np.zeros(len(warm), bool), None
    for _ in range(PASSES):
        now = standing_out(signals, fs, poles)
        if (now == clear).all():
            break
        clear = now
        found = _fit(signals, fs, poles, home, clear)
        if found is None:
            return None
        poles[found[1]] = found[0].values
    return found


def standing_out(signals: FloatArray, fs: float, poles: ComplexArray) -> BoolArray:
    """(n_modes,) whether each mode's amplitude is known to ``CLEAR`` of itself, all being fitted side by side.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.
        poles: (n_modes,) 1/s.
    """
    n, n_samples = len(poles), signals.shape[1]
    if n_samples < 4 * n:
        return np.zeros(n, bool)
    waves = waves_of(poles, n_samples, fs)
    basis = np.concatenate([waves.real, -waves.imag])
    covariance = np.linalg.pinv(basis @ basis.T, hermitian=True)
    numbers = covariance @ (basis @ signals.T)
    noise = np.sum((signals - numbers.T @ basis) ** 2, axis=1) / (n_samples - 2 * n)
    own = np.diag(covariance)
    power = (numbers[:n] ** 2 + numbers[n:] ** 2) / np.maximum(noise, TINY)
    strength = np.sum(power, axis=1) / (0.5 * (own[:n] + own[n:]))
    return np.asarray(strength > CLEAR**-2 + 2 * len(signals))


def _fit(
    signals: FloatArray, fs: float, warm: ComplexArray, home: ComplexArray, clear: BoolArray
) -> tuple[Poles, IntArray] | None:
    """The poles of the clear modes; once without those that went astray."""
    for _ in range(2):
        modes = np.flatnonzero(clear)
        modes = modes[np.argsort(warm[modes].imag)]
        if not modes.size:
            return None
        try:
            poles = fit_poles(signals, fs, warm[modes])
        except InputError:
            return None
        stays = near_home(poles.values, modes, home)
        if stays.all():
            return poles, modes
        clear = clear.copy()
        clear[modes[~stays]] = False
    return None


def near_home(poles: ComplexArray, modes: IntArray, home: ComplexArray) -> BoolArray:
    """(m,) whether (m,) poles of the (m,) modes are nearer in frequency to their own home than ``ASTRAY`` allows."""
    freqs = np.abs(home)
    apart = np.abs(freqs[:, None] - freqs) + np.diag(np.full(len(freqs), np.inf))
    room = ASTRAY * np.minimum(apart.min(axis=1), freqs)
    return np.asarray(np.abs(np.abs(poles) - freqs[modes]) < room[modes])
