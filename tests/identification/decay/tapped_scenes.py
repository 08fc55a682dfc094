"""Modes that are struck again and again, for the tests of the stream."""

import numpy as np

FS = 1024.0
FREQS, RATIOS = np.array([20.0, 47.0, 110.0]), np.array([0.03, 0.02, 0.012])
SHAPES = np.array([[1.0, 0.4, -0.7, 0.2], [0.6, -0.8, 0.3, 0.5], [-0.4, 0.5, 0.6, -0.6]])
PERIOD, WIDTH = 410, 6
"""Samples from one blow to the next, and of a blow."""


def poles_of(freqs=FREQS, ratios=RATIOS):
    omega = 2.0 * np.pi * np.asarray(freqs)
    return omega * (1j * np.sqrt(1.0 - np.asarray(ratios) ** 2) - ratios)


def blows(n, first=100, period=PERIOD):
    """(n,) force of the blows, and the first samples after each."""
    force = np.zeros(n)
    starts = np.arange(first, n - WIDTH, period)
    for start in starts:
        force[start : start + WIDTH] = np.sin(np.pi * (np.arange(WIDTH) + 0.5) / WIDTH)
    return force, starts + WIDTH


def tapped(n, poles=None, noise=0.0, seed=0, amplitudes=(1.0, 1.0, 1.0), **choices):
    """(4, n) channels and (n,) force: decays that begin anew with each blow, and those of the blows before."""
    poles = poles_of() if poles is None else poles
    force, starts = blows(n, **choices)
    time, channels = np.arange(n) / FS, np.zeros((4, n))
    for start in starts:
        wave = np.exp(poles[:, None] * time[: n - start]).imag * np.array(amplitudes)[:, None]
        channels[:, start:] += SHAPES[: len(poles)].T @ wave
    return channels + noise * np.random.default_rng(seed).standard_normal(channels.shape), force


def fading(sigma, omega, n, noise=0.0, seed=0):
    """(4, n) one mode whose decay rate sigma(t), 1/s, changes: exp(-integral of it) sin(omega t)."""
    time = np.arange(n) / FS
    level = -np.concatenate([[0.0], np.cumsum(0.5 * (sigma(time[1:]) + sigma(time[:-1])))]) / FS
    channels = SHAPES[0][:, None] * np.exp(level) * np.sin(omega * time)
    return channels + noise * np.random.default_rng(seed).standard_normal(channels.shape)
