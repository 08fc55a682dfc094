"""What the channels say of the measurement itself, before any physics is blamed.

A sensor that is dead, upside down, late, mis-scaled or displaced contradicts all others, and physics that explains one
channel alone is rare: so each channel is left out in turn, and the rig's numbers are fitted to the rest. A hum, or a
floor that shakes, stands in a few lines of all channels: so these lines are left out.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.calibrate import beginning, concerning
from identification.evaluate import Evaluator, TimeTarget, in_parallel
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.lines import lines_left
from identification.screen import Projection
from models.arrays import BoolArray
from models.effects import Registry

PLAINLY = 0.3
"""Share of the excess of chi-square over the noise that is left at most without what is at fault."""

MOSTLY = 0.5
"""The same without a few lines of thousands; what a floor does as it begins to shake is no line."""

LARGE = 3.0
"""Residual over noise above which slopes say too little, and the numbers are fitted without each channel."""

MOST_SENSORS = 2
"""At fault at once; where more disagree, it is not the sensors."""

LEAST_SENSORS = 3
"""Channels of which one can be outvoted."""

WINDOW = (0.1, 0.75)
"""Share of the response's energy, and seconds at least, on which channels are left out in turn."""

AROUND = 3.0
"""Lines of the record on either side of one that are left out with it: the record's ends make it wide."""

ITERATIONS, TOLERANCE = 6, 1e-2
"""Of the rig's numbers without a channel."""


@dataclass(frozen=True)
class Suspicion:
    """What is wrong with the measurement, as far as the channels say.

    Attributes:
        sensors: channels without which the others agree, the worst first.
        in_lines: all that is left stands in single lines.
        words: what was seen, for the report; empty where nothing was.
    """

    sensors: tuple[str, ...] = ()
    in_lines: bool = False
    words: str = ""

    def __bool__(self) -> bool:
        """Something is suspected."""
        return bool(self.sensors) or self.in_lines

    def kinds(self, registry: Registry) -> Registry:
        """The kinds of effects that could do this.

        Args:
            registry: all kinds.
        """
        return {
            name: kind
            for name, kind in registry.items()
            if ("sensor" in kind.places and self.sensors) or (kind.record_parameters and self.in_lines)
        }


NO_SUSPICION = Suspicion()


def suspicion(evaluator: Evaluator, there: Fit) -> Suspicion:
    """What the channels say of the measurement beside a calibrated model.

    Args:
        evaluator: records, at the resolution of the search.
        there: the calibrated model on them.
    """
    if not evaluator.timed or evaluator.at_rest:
        return NO_SUSPICION
    in_lines = _in_lines(evaluator, there)
    if in_lines:
        return in_lines
    names = list(dict.fromkeys(name for target in evaluator.timed for name in target.record.sensors))
    if len(names) < LEAST_SENSORS:
        return NO_SUSPICION
    near = _left_beside(evaluator, there, names)
    window = beginning(evaluator, *WINDOW)
    rows = [near] if there.ratio < LARGE else [near, _left_in(window, there, names)]
    left = min(rows, key=lambda row: min(row.values()))
    at_fault = sorted((name for name in names if left[name] < PLAINLY), key=left.__getitem__)[:MOST_SENSORS]
    if not at_fault:
        return NO_SUSPICION
    worst = at_fault[0]
    words = f"{worst} contradicts the other channels: without it {max(left[worst], 0.0):.0%} of the misfit is left"
    return Suspicion(tuple(at_fault), words=words)


def _left_beside(evaluator: Evaluator, there: Fit, names: Sequence[str]) -> dict[str, float]:
    """Share of the excess that is left without each channel, the numbers moved by what their slopes say."""
    entry = np.concatenate([np.repeat(t.record.sensors, 2 * t.measured.shape[1]) for t in evaluator.timed])
    whole = _left_of(there, np.ones(len(entry), bool))
    return {name: _left_of(there, entry != name) / whole if whole > 0.0 else 1.0 for name in names}


def _left_of(there: Fit, kept: BoolArray) -> float:
    rows, residual = there.jacobian[:, kept], there.residual[kept]
    seen = replace(there, jacobian=rows, residual=residual)
    return Projection(seen).misfit - int(kept.sum())


def _left_in(window: Evaluator, there: Fit, names: Sequence[str]) -> dict[str, float]:
    """Share of the excess that is left without each channel, the numbers fitted on the beginning of the records."""
    alone = window.with_jobs(1)

    def excess(name: str) -> float:
        return _excess(alone.with_targets([target.without(name) for target in alone.timed]), there)

    whole, *left = in_parallel(window.jobs, excess, ["", *names])
    return {name: each / whole if whole > 0.0 else 1.0 for name, each in zip(names, left, strict=True)}


def _excess(evaluator: Evaluator, base: Fit) -> float:
    """Chi-square beyond the noise that the rig's numbers leave, as given or as calibrated, whichever is less."""
    unknowns, least = concerning(base, evaluator), float("inf")
    for start in _starts(base):
        try:
            found = fit(evaluator, start, unknowns, max_iterations=ITERATIONS, tolerance=TOLERANCE)
        except ArithmeticError:
            continue
        least = min(least, found.cost - found.n_data)
    return least


def _starts(base: Fit) -> Iterator[Hypothesis]:
    yield base.hypothesis
    if base.hypothesis.values and not base.hypothesis.effects:
        yield replace(base.hypothesis, values={})


def _in_lines(evaluator: Evaluator, base: Fit) -> Suspicion:
    """Whether all that the model leaves stands in lines that it does not explain."""
    frequencies = lines_left(evaluator, base.hypothesis).free
    if not frequencies:
        return NO_SUSPICION
    residual = base.residual
    outside = np.concatenate([_outside(target, frequencies) for target in evaluator.timed])
    excess = float(residual @ residual) - len(residual)
    left = float(residual[outside] @ residual[outside]) - int(outside.sum())
    if not excess > 0.0 or left > MOSTLY * excess:
        return NO_SUSPICION
    seen = ", ".join(f"{frequency:.4g}" for frequency in sorted(frequencies))
    words = (
        f"what is left stands in single lines at {seen} Hz: without them {max(left / excess, 0.0):.0%} of it remains"
    )
    return Suspicion(in_lines=True, words=words)


def _outside(target: TimeTarget, frequencies: tuple[float, ...]) -> BoolArray:
    """(n_data,) whether an entry of the residual is away from all of these frequencies, Hz."""
    lines = np.arange(target.measured.shape[1]) * target.record.fs / target.record.n_samples
    near = np.abs(lines[:, None] - np.array(frequencies)) < AROUND * target.record.fs / target.record.n_samples
    return np.repeat(np.tile(~near.any(axis=1), len(target.measured)), 2)
