"""Decays with known frequencies and damping for the tests of the identifier."""

import numpy as np

from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE
from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant

FS = SAMPLING_RATE
"""Of the article's oscillator, Hz."""

__all__ = ["FS", "MASS", "OMEGA", "line", "noisy", "rest_modes", "ringing", "step"]


def noisy(signals, snr_db, seed):
    """The (n_channels, N) signals with white noise of the stated share of each one's rms."""
    rms = signals.std(axis=1, keepdims=True)
    return signals + np.random.default_rng(seed).standard_normal(signals.shape) * rms * 10.0 ** (-snr_db / 20.0)


def step(t):
    """0.06 then 0.01 N s/m from 50 s on, as a decay rate."""
    return 0.006 if t <= 50.0 else 0.001


def line(t):
    """0.06 - 0.0002 t N s/m, as a decay rate."""
    return 0.006 - 0.00002 * t


def rest_modes(rig, n):
    """(n,) poles and (n, n_sensors) shapes of small motion about a rig's rest."""
    linear = linearised(build_modal(build_plant(rig), 900.0))
    modes = natural_modes(linear, linear.model.plant.sensors, 900.0)
    omega, ratio = 2.0 * np.pi * modes.natural_freqs[:n], modes.damping_ratios[:n]
    return omega * (1j * np.sqrt(1.0 - ratio**2) - ratio), modes.shapes[:n]


def ringing(poles, shapes, fs, n_samples):
    """(n_channels, N) sum of damped sinusoids from the first sample on."""
    waves = np.exp(poles[:, None] * np.arange(n_samples) / fs)
    return np.einsum("mc,mn->cn", shapes, waves).real
