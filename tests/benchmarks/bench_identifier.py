"""The identifier's chain on 8 channels of 20 s at 2048 Hz, against how long the record lasts; prints and writes."""

from time import perf_counter

import numpy as np
from reference_run import table, write

from identification.decay.identify import identify
from identification.decay.scale_search import Training, search_scale
from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE, verification_decay
from identification.signals.peaks import find_modes
from identification.signals.separate import separate

FS, N_SAMPLES = 2048.0, 40960
MODES = 2.0 * np.pi * np.array([9.25, 39.75, 91.15, 189.3]) * (1j - 0.004)
RUNS = 3


def record():
    """(8, N) four modes in eight channels at 40 dB."""
    rng = np.random.default_rng(0)
    shapes = rng.uniform(0.3, 1.0, (8, 4)) * np.exp(2j * np.pi * rng.random(4))
    clean = (shapes @ np.exp(MODES[:, None] * np.arange(N_SAMPLES) / FS)).real
    return clean + 0.01 * clean.std(axis=1, keepdims=True) * rng.standard_normal(clean.shape)


def seconds(run):
    """Of the quickest of a few runs, after one that compiles."""
    run()
    spent = []
    for _ in range(RUNS):
        start = perf_counter()
        run()
        spent.append(perf_counter() - start)
    return min(spent)


def test_chain():
    signals = record()
    decay = verification_decay("step")
    training = Training(decay.signal, decay.damping, SAMPLING_RATE, OMEGA / (2.0 * np.pi), MASS)
    rows = [
        ("modes found", seconds(lambda: find_modes(signals, FS))),
        ("modes separated", seconds(lambda: separate(signals, FS, np.array([20.0, 60.0, 130.0])))),
        ("whole chain but the ensemble EMD", seconds(lambda: identify([signals], [0.0], FS, np.ones(8)))),
        ("all four scale searches", seconds(lambda: search_scale(training, 0))),
    ]
    lines = [(name, f"{spent:.2f} s", f"{N_SAMPLES / FS / spent:.0f}") for name, spent in rows]
    page = table(("what", "seconds", "times faster than the record lasts"), lines)
    write("benchmarks", "identifier", dict(rows), page)
