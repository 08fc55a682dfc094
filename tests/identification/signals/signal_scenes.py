"""Free decays in closed form for the tests of the signal treatment."""

import numpy as np

FS = 2048.0
SECONDS = 20.0
BEAM = (9.0, 56.0, 120.0, 190.0)


def modes(frequencies, damping, fs=FS, seconds=SECONDS, n_channels=8, seed=0, start=0):
    """(n_modes, n_channels, N) decays with random shapes and phases, from sample ``start`` on; one damping ratio."""
    rng = np.random.default_rng(seed)
    time = np.arange(start, round(seconds * fs)) / fs
    size = (len(frequencies), n_channels, 1)
    shapes = rng.choice((-1.0, 1.0), size) * rng.uniform(0.5, 1.5, size)
    phases = rng.uniform(0.0, 2.0 * np.pi, size)
    omega = 2.0 * np.pi * np.array(frequencies)[:, None, None]
    return shapes * np.exp(-damping * omega * time) * np.cos(omega * time + phases)


def with_noise(signals, decibels, seed=1):
    """White noise this many dB below the first sample's scale of 1."""
    return signals + 10.0 ** (-decibels / 20.0) * np.random.default_rng(seed).normal(size=signals.shape)


def rms(signals):
    return np.sqrt(np.mean(signals**2))
