"""Decays with known frequencies and damping for the tests of the identifier."""

import numpy as np

from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant

FS, OMEGA, MASS = 256.0, np.sqrt(160.0), 5.0
"""The article's oscillator: 5 kg on 800 N/m."""


def noisy(signals, snr_db, seed):
    """The (n_channels, N) signals with white noise of the stated share of each one's rms."""
    rms = signals.std(axis=1, keepdims=True)
    return signals + np.random.default_rng(seed).standard_normal(signals.shape) * rms * 10.0 ** (-snr_db / 20.0)


def oscillator(sigma, duration=100.0, amplitude=1.0):
    """(1, N) free decay of the oscillator whose decay rate is sigma(t), 1/s, integrated step by step exactly enough."""
    t = np.arange(round(duration * FS)) / FS
    state, out = np.array([amplitude, 0.0]), np.empty(len(t))
    h = 1.0 / FS
    for k, now in enumerate(t):
        out[k] = state[0]
        a = [sigma(now), sigma(now + 0.5 * h), sigma(now + h)]
        slope = [None] * 4
        for i, (c, w) in enumerate(((0, 0.0), (1, 0.5), (1, 0.5), (2, 1.0))):
            x = state if i == 0 else state + w * h * slope[i - 1]
            slope[i] = np.array([x[1], -2.0 * a[c] * x[1] - OMEGA**2 * x[0]])
        state = state + h / 6.0 * (slope[0] + 2.0 * slope[1] + 2.0 * slope[2] + slope[3])
    return out[None]


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
