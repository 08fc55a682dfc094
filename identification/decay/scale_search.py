"""The scale of a ridge by eq. (27) of the article, looked for by a quantum genetic algorithm and by ordinary searches.

On a training signal whose damping c is known, the scale a minimises the normalised rms error of c plus the normalised
cost of the identification. The variable is log2 a, a in samples. The objective takes its extremes from the grid of the
multiscale baseline, which every search shares.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import NamedTuple

import numpy as np

from identification.decay.breaks import follow_past_jumps
from identification.decay.line_search import evolution_search, golden_search, grid_search
from identification.decay.local_fit import operations
from identification.decay.quantum import QuantumSettings, quantum_search
from identification.decay.ridge import follow_mode
from identification.decay.search import Search
from identification.decay.windows import window_named
from models.arrays import FloatArray
from models.errors import InputError

LOWEST, HIGHEST = 6.0, 9.0
"""log2 of the scales between which is looked, in samples."""

GRID_STEP = 0.2
"""Of log2 a in the multiscale baseline, whose best is 2^6.8 in the article."""

TOLERANCE = 1e-3
"""Of log2 a for the golden section; no objective tells scales apart that are closer."""

AS_GOOD = 1e-3
"""Values of the objective that lie closer than this count as equal."""

COSTS = ("operations", "seconds")
"""What an identification can be charged with: counted, the same everywhere, or measured on this machine, now."""


@dataclass(frozen=True, eq=False)
class Training:
    """A decay whose damping is known.

    Attributes:
        signal: (N,) displacement of one mode.
        damping: (N,) c, N s/m.
        fs: sampling rate, Hz.
        frequency: of the mode, Hz.
        mass: kg.
    """

    signal: FloatArray
    damping: FloatArray
    fs: float
    frequency: float
    mass: float


class Trial(NamedTuple):
    """One scale: rms error of c in N s/m, and cost in operations or seconds."""

    error: float
    cost: float


@dataclass(frozen=True, eq=False)
class ScaleSearch:
    """What the searches found.

    Attributes:
        searches: by method, positions being log2 of the scale in samples.
        trials: what each of them found there.
        frequency: of the mode, Hz.
        fs: sampling rate, Hz.
        cost: what was charged, one of ``COSTS``.
    """

    searches: dict[str, Search]
    trials: dict[str, Trial]
    frequency: float
    fs: float
    cost: str

    @property
    def lowest(self) -> str:
        """The method that found the lowest value; the one with fewer evaluations where values are equal."""
        return min(self.searches, key=lambda name: (self.searches[name].value, self.searches[name].evaluations))

    @property
    def quickest(self) -> str:
        """The method with the fewest evaluations among those whose value is as good as the lowest."""
        lowest = self.searches[self.lowest].value
        good = [name for name, search in self.searches.items() if search.value <= lowest + AS_GOOD]
        return min(good, key=lambda name: self.searches[name].evaluations)

    def scale(self, method: str) -> float:
        """Samples, as a method found it."""
        return float(2.0 ** self.searches[method].best[0])

    def centre_frequency(self, method: str) -> float:
        """omega_0 of the Morlet wave that has this scale at the mode's frequency."""
        return float(2.0 * np.pi * self.frequency * self.scale(method) / self.fs)


def search_scale(
    training: Training,
    seed: int,
    cost: str = "operations",
    bounds: tuple[float, float] = (LOWEST, HIGHEST),
    *,
    past_jumps: bool = False,
) -> ScaleSearch:
    """Look for the best scale with the grid, golden sections, differential evolution and the quantum genetic algorithm.

    Args:
        training: a decay whose damping is known.
        seed: of the searches that draw numbers.
        cost: one of ``COSTS``.
        bounds: log2 of the scales between which is looked, in samples.
        past_jumps: identify with windows that end at the jumps that were found, in two passes.

    Raises:
        InputError: an unknown cost, bounds without a step of the grid between them, or a record that is too short.

    Source: eq. (27) of the article.
    """
    if cost not in COSTS:
        raise InputError(f"cost = {cost!r}", f"an identification costs {' or '.join(COSTS)}", "choose one of them")
    low, high = bounds
    if not high - low >= GRID_STEP:
        raise InputError(
            f"scales from 2^{low:g} to 2^{high:g}",
            f"the upper bound is 2^{GRID_STEP:g} times the lower or more",
            "widen the bounds",
        )
    grid: FloatArray = low + GRID_STEP * np.arange(round((high - low) / GRID_STEP) + 1.0)
    tried = cache(lambda exponent: try_scale(training, 2.0**exponent, cost, past_jumps=past_jumps))
    objective = _objective(tried, grid)
    lower, upper = np.array([low]), np.array([high])
    searches = {
        "grid": grid_search(objective, grid[:, np.newaxis]),
        "golden": golden_search(objective, lower, upper, TOLERANCE),
        "evolution": evolution_search(objective, lower, upper, seed),
        "quantum": quantum_search(objective, lower, upper, QuantumSettings(), seed),
    }
    found = {name: tried(float(search.best[0])) for name, search in searches.items()}
    return ScaleSearch(searches, found, training.frequency, training.fs, cost)


def try_scale(training: Training, scale: float, cost: str, *, past_jumps: bool) -> Trial:
    """Identify c with one scale.

    Args:
        training: a decay whose damping is known.
        scale: samples.
        cost: one of ``COSTS``.
        past_jumps: see ``search_scale``.
    """
    follow = follow_past_jumps if past_jumps else follow_mode
    start = perf_counter()
    skeleton = follow(training.signal, training.fs, training.frequency, scale)
    spent = perf_counter() - start
    error = 2.0 * training.mass * skeleton.decay_rate - training.damping
    counted = operations(len(training.signal), len(window_named(skeleton.shape).taps(scale)))
    return Trial(float(np.sqrt(np.mean(error**2))), counted if cost == "operations" else spent)


def _objective(tried: Callable[[float], Trial], grid: FloatArray) -> Callable[[FloatArray], float]:
    """Eq. (27), its extremes taken over the grid (n,)."""
    trials = np.array([tried(float(exponent)) for exponent in grid])
    least, width = trials.min(axis=0), np.maximum(np.ptp(trials, axis=0), np.finfo(float).tiny)
    return lambda position: float(np.sum((np.array(tried(float(position[0]))) - least) / width))
