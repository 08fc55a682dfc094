"""Whether what was found on some lines is more than noise leaves there: one test for a whole band of lines."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import chi2

from models.arrays import BoolArray, FloatArray

FALSE_ALARM = 0.01
"""Probability of any finding of one cause in a record that has none of it; shared out over its sensors and bands."""

BAND_LINES = 16
"""Lines of a band at least."""

BANDS_IN, BANDS_ABOVE = 8, 4
"""Bands of the excited range, and above it, at most."""


@dataclass(frozen=True, eq=False)
class Share:
    """The part of the responses that one cause has, band by band.

    Attributes:
        power: (n_sensors, n_bands) mean square in the sensor's unit squared, noise's own part taken off, at least 0;
            NaN where no line tells.
        above_chance: (n_sensors, n_bands) power found on the lines that tell over what noise alone leaves there.
        p: (n_sensors, n_bands) probability of finding as much where there is noise alone; 1 where no line tells.
    """

    power: FloatArray
    above_chance: FloatArray
    p: FloatArray

    @property
    def found(self) -> BoolArray:
        """(n_sensors, n_bands) where the cause is there, with ``FALSE_ALARM`` for all of them together."""
        return np.asarray(self.p < FALSE_ALARM / max(1, int(np.sum(~np.isnan(self.power)))))

    @property
    def total(self) -> FloatArray:
        """(n_sensors,) over the bands that tell; NaN where none does."""
        return np.where(np.isnan(self.power).all(axis=1), np.nan, np.nansum(self.power, axis=1))


def band_edges(frequency: FloatArray, excited: BoolArray) -> FloatArray:
    """(n_bands + 1,) Hz: what lies below the excited range, bands of equal width over it, and some above it.

    Args:
        frequency: (K,) Hz, evenly spaced.
        excited: (K,).
    """
    half = 0.5 * frequency[0]
    reached = frequency[excited]
    edges = [half]
    for low, high, most in (
        (half, reached[0] - half, 1),
        (reached[0] - half, reached[-1] + half, BANDS_IN),
        (reached[-1] + half, frequency[-1] + half, BANDS_ABOVE),
    ):
        n_lines = round((high - low) / frequency[0])
        if n_lines > 0:
            n_bands = min(max(n_lines // BAND_LINES, 1), most)
            edges += list(np.linspace(low, high, n_bands + 1)[1:])
    return np.array(edges)


def members(frequency: FloatArray, edges: FloatArray) -> Iterable[BoolArray]:
    """The lines of each band, (K,) at a time.

    Args:
        frequency: (K,) Hz.
        edges: (n_bands + 1,) Hz.
    """
    for low, high in pairwise(edges):
        yield (frequency > low) & (frequency <= high)


def share(
    power: FloatArray,
    chance: FloatArray,
    freedom: FloatArray,
    lines: Iterable[tuple[BoolArray, BoolArray]],
) -> Share:
    """A cause's part in each band.

    Args:
        power: (n, K) found.
        chance: (n, K) what noise alone leaves there on average.
        freedom: (K,) complex degrees of freedom behind that average.
        lines: for each band (K,) the lines that tell, and those that the cause acts on, told or not.
    """
    columns = []
    for telling, acting in lines:
        ratio, p = excess(power[:, telling], chance[:, telling], freedom[telling])
        found = np.full(len(power), np.nan)
        if telling.any():
            mean = np.mean(power[:, telling] - chance[:, telling], axis=1)
            found = np.maximum(mean, 0.0) * max(int(acting.sum()), int(telling.sum()))
        columns.append((found, ratio, p))
    return Share(*(np.stack(column, axis=1) for column in zip(*columns, strict=True)))


def excess(power: FloatArray, chance: FloatArray, freedom: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What lines hold together over what noise leaves there, and its probability under noise alone.

    Under noise a line's power over its estimated mean is F-distributed with 2 and 2 nu degrees of freedom, and exceeds
    F with the probability (1 + F / nu)^-nu. The probabilities are combined, not the powers: noise that differs from
    line to line, as it does about a resonance, then changes nothing.

    Args:
        power: (n, L) found on the lines, each exponentially distributed under noise alone.
        chance: (n, L) estimate of its mean.
        freedom: (L,) nu, complex degrees of freedom of that estimate.

    Returns:
        (n,) ratio of the sums, NaN without lines, and (n,) probability.

    Source: R. A. Fisher, Statistical Methods for Research Workers (1932), section 21.1.
    """
    if power.shape[1] == 0 or freedom.min() < 1:
        return np.full(len(power), np.nan), np.ones(len(power))
    tiny = np.finfo(float).tiny
    ratio = power / np.maximum(chance, tiny)
    evidence = 2.0 * np.sum(freedom * np.log1p(ratio / freedom), axis=1)
    together = power.sum(axis=1) / np.maximum(chance.sum(axis=1), tiny)
    return together, np.asarray(chi2.sf(evidence, 2 * power.shape[1]))
