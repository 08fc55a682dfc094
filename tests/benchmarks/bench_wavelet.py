"""The Morlet transform beside PyWavelets and ssqueezepy on the same scales; writes results/benchmarks/wavelet."""

from collections.abc import Callable
from time import perf_counter, process_time

import numpy as np
import pytest
from reference_run import table, write

from identification.decay.wavelet import CENTRE_FREQUENCY, morlet_transform, scale_of
from models.arrays import FloatArray

TIMES = 9
"""Runs of each, in turn, so that the machine's moods meet all alike; the fastest counts."""

CASES = {
    "8 channels of 40,960 samples, 64 scales": (8, 40_960, 2048.0, np.geomspace(250.0, 3.0, 64)),
    "1 channel of 25,600 samples, 128 scales": (1, 25_600, 256.0, np.geomspace(64.0, 0.5, 128)),
}
"""Channels, samples, sampling rate and frequencies from the highest down, as ssqueezepy wants them."""

OTHERS = ("pywt.cwt, method fft", "ssqueezepy.cwt, float64")
"""What has the same precision."""


def contenders(signals: FloatArray, fs: float, frequencies: FloatArray) -> dict[str, Callable[[], object]]:
    """The same transform by each library, ours first."""
    pywt, ssqueezepy = pytest.importorskip("pywt"), pytest.importorskip("ssqueezepy")
    scales = scale_of(frequencies, fs)
    name = f"cmor2.0-{CENTRE_FREQUENCY / (2.0 * np.pi)}"
    waves = {
        kind: ssqueezepy.Wavelet(("morlet", {"mu": CENTRE_FREQUENCY}), dtype=kind) for kind in ("float64", "float32")
    }
    rows = signals if len(signals) > 1 else signals[0]
    return {
        "morlet_transform": lambda: morlet_transform(signals, fs, frequencies, ends="zero"),
        "morlet_transform, mirrored": lambda: morlet_transform(signals, fs, frequencies, ends="mirror"),
        OTHERS[0]: lambda: pywt.cwt(signals, scales, name, method="fft", axis=-1),
        OTHERS[1]: lambda: ssqueezepy.cwt(rows, waves["float64"], scales=scales),
        "ssqueezepy.cwt, float64, not padded": lambda: ssqueezepy.cwt(
            rows, waves["float64"], scales=scales, padtype=None
        ),
        "ssqueezepy.cwt, float32, its default": lambda: ssqueezepy.cwt(rows, waves["float32"], scales=scales),
    }


def seconds_of(runs: dict[str, Callable[[], object]]) -> dict[str, tuple[float, float]]:
    """Time on the clock and of the processors, s, the least of ``TIMES``."""
    spent: dict[str, list[tuple[float, float]]] = {name: [] for name in runs}
    for run in runs.values():
        run()  # compiles
    for _ in range(TIMES):
        for name, run in runs.items():
            clock, processors = perf_counter(), process_time()
            run()
            spent[name].append((perf_counter() - clock, process_time() - processors))
    return {name: tuple(np.min(times, axis=0)) for name, times in spent.items()}


def test_faster_than_the_libraries_on_the_same_scales():
    rng, content, pages, slowest = np.random.default_rng(0), {}, [], np.inf
    for case, (channels, n, fs, frequencies) in CASES.items():
        spent = seconds_of(contenders(rng.normal(size=(channels, n)), fs, frequencies))
        clock, processors = spent["morlet_transform"]
        rows = [
            [name, f"{1e3 * a:.0f}", f"{1e3 * b:.0f}", f"{a / clock:.1f}", f"{b / processors:.1f}"]
            for name, (a, b) in spent.items()
        ]
        head = ["transform", "clock, ms", "processors, ms", "clock, ratio", "processors, ratio"]
        pages.append(f"{case}, {frequencies[-1]:g} to {frequencies[0]:g} Hz at {fs:g} Hz:\n\n{table(head, rows)}")
        content[case] = {name: {"clock": a, "processors": b} for name, (a, b) in spent.items()}
        slowest = min(slowest, *(spent[name][0] / clock for name in OTHERS))
    page = (
        "# Speed of the Morlet transform\n\n"
        f"omega_0 = {CENTRE_FREQUENCY:g}, all results in complex128 but the last; on two cores, of which"
        f" morlet_transform and ssqueezepy use both. The least of {TIMES} runs in turn.\n\n" + "\n".join(pages)
    )
    write("benchmarks", "wavelet", content, page)
    assert slowest > 3.0
