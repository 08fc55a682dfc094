"""FRFs and mode shapes whose truth is known, for the tests of the identification."""

from dataclasses import replace

import numpy as np

from identification.at_rest import linear_model, predicted_frfs
from models.linear import measurement_chain, natural_modes
from models.record import FrfRecord, ModeShapeRecord

LINES = np.arange(3.0, 200.0, 0.75)


def frfs_of(truth, *, noise=0.01, floor=0.0, lines=LINES, seed=1, name="h.uff", position=None):
    """FRFs of the true hypothesis with noise of this share of each value, and a constant one of their mean size."""
    rng = np.random.default_rng(seed)
    names = tuple(sensor.name for sensor in truth.rig.sensors)
    silent = FrfRecord(name, lines, names, np.zeros((len(names), len(lines)), complex), position)
    clean = predicted_frfs(truth, silent)
    size = np.hypot(noise * np.abs(clean), floor * np.abs(clean).mean(axis=1, keepdims=True))
    return replace(silent, values=clean + size * white(rng, clean.shape))


def white(rng, shape):
    """Complex noise of variance 1."""
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2.0)


def modes_of(truth, *, freq=0.001, shape=0.01, damping=0.1, highest=250.0, seed=1, name="m.uff"):
    """Modes of the true hypothesis as its sensors read them, with these errors, those of a shape in each part."""
    rng = np.random.default_rng(seed)
    sensors = truth.rig.sensors
    names = tuple(sensor.name for sensor in sensors)
    linear = linear_model(truth, highest)
    modes = natural_modes(linear, sensors, highest)
    read = modes.shapes * measurement_chain(linear.model.plant, names, modes.natural_freqs).T
    n = len(modes.natural_freqs)
    return ModeShapeRecord(
        name,
        names,
        modes.natural_freqs * (1.0 + freq * rng.standard_normal(n)),
        modes.damping_ratios * (1.0 + damping * rng.standard_normal(n)),
        read + np.sqrt(2.0) * shape * white(rng, read.shape),
    )
