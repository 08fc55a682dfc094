"""Records in closed form for the budget: multisines through filters, polynomials, changing gains and oscillators."""

import numpy as np
from scipy.signal import lfilter

from models.excitations import random_phase_multisine
from models.record import Record

FS, PERIOD = 512.0, 1024


def multisine(seed, periods, lines="odd_detection", high=120.0, rms=1.0):
    rng = np.random.default_rng(seed)
    return random_phase_multisine(rng, FS, PERIOD * periods, periods, 5.0, high, rms, lines)


def resonator(signal, freq=40.0, damping_ratio=0.02):
    """A linear filter with one resonance, at rest before the first sample."""
    w = 2.0 * np.pi * freq / FS
    r = np.exp(-damping_ratio * w)
    return lfilter([1.0 - 2.0 * r * np.cos(w) + r * r], [1.0, -2.0 * r * np.cos(w), r * r], signal)


def steady(filtered, signal):
    """The periodic response: the filter has run over the signal once before."""
    return filtered(np.concatenate([signal, signal]))[len(signal) :]


def record(excitation, *responses, noise=0.0, excitation_noise=0.0, seed=0, name="made"):
    rng = np.random.default_rng([seed, 7])
    rows = np.stack(responses)
    rows = rows + noise * rng.standard_normal(rows.shape)
    felt = excitation + excitation_noise * rng.standard_normal(len(excitation))
    return Record(name, FS, felt, tuple(f"P{i + 1}" for i in range(len(rows))), rows)


def line_powers(signal, period=PERIOD):
    """Mean square of each line of one period, from 1 up."""
    return 2.0 * np.abs(np.fft.rfft(signal[-period:])[1:] / period) ** 2
