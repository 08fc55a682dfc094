"""The motion with which a part of a record begins, found from its samples, and what a change of it does to them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np

from identification.evaluate import AHEAD, Evaluator, TimeTarget
from identification.fit import fit
from identification.hypothesis import Hypothesis, StartUnknown
from identification.prepare import start_unknowns
from models.arrays import FloatArray
from models.plant import Plant
from models.simulate import Motion, modal_state

NUDGE = 1e-4
"""Of a state's typical size, by which its slopes are taken."""

SHORTEST, GROWING = 64, 2.0
"""Samples on which a start is first sought, and times as many on which it is sought next."""

SOUGHT, SETTLED = 10, 2
"""Iterations on each of these, and on the whole part from near: with one, most came to the noise that could."""

TOLERANCE = 1e-2
"""Relative decrease of the cost that ends either: slopes tell the rest."""


@dataclass(frozen=True, eq=False)
class PieceStart:
    """With what a part of a record begins.

    Attributes:
        begin: the motion at its first sample.
        slopes: (n_states, n, N) what the channels do as one entry of that state grows by its typical size.
    """

    begin: Motion
    slopes: FloatArray = field(repr=False)


def start_sought(evaluator: Evaluator, hypothesis: Hypothesis, part: TimeTarget, motion: Motion) -> PieceStart:
    """The start found on ever more of the first samples, by the sensors' noise: a state a little wrong is soon lost.

    Args:
        evaluator: with the steps to take.
        hypothesis: the model.
        part: of a record.
        motion: near which it begins.

    Raises:
        ArithmeticError: the motion from there leaves the finite numbers.
    """
    search, bare = _Search.of(evaluator, hypothesis, part, motion), _punctual(part.with_noise(part.noise), hypothesis)
    n, there = SHORTEST, search.hypothesis
    while n < part.record.n_samples:
        there = search.fitted(bare.cut(n, min(bare.unjudged, n // 2)), there, SOUGHT)
        n = ceil(GROWING * n)
    return search.start_of(search.fitted(bare, there, SOUGHT))


def _punctual(part: TimeTarget, hypothesis: Hypothesis) -> TimeTarget:
    """The part with the channels that tell of its first samples: a late one tells of what was before.

    Raises:
        ArithmeticError: all are late.
    """
    late: set[str | None] = {n for n in part.record.sensors if hypothesis.looks_back([n]) * part.record.fs > AHEAD}
    for place in (effect.place for effect in hypothesis.plant().effects if effect.place.other is not None):
        exchanged = {place.sensor, place.other}
        late |= exchanged if late & exchanged else set()
    kept = [name for name in part.record.sensors if name not in late]
    if not kept:
        raise ArithmeticError(f"{part.record.name}: all channels are late, and none tells how it begins")
    return part.only(kept)


def start_near(evaluator: Evaluator, hypothesis: Hypothesis, part: TimeTarget, motion: Motion) -> PieceStart:
    """The start found on the whole part from where another model has begun it.

    Args:
        evaluator: with the steps to take.
        hypothesis: the model.
        part: of a record.
        motion: with which the other model began.

    Raises:
        ArithmeticError: the motion from there leaves the finite numbers.
    """
    search = _Search.of(evaluator, hypothesis, part, motion)
    return search.start_of(search.fitted(part, search.hypothesis, SETTLED))


@dataclass(frozen=True, eq=False)
class _Search:
    """A part of a record, the model with a state at its first sample, and that state's numbers."""

    evaluator: Evaluator
    part: TimeTarget
    plant: Plant
    hypothesis: Hypothesis
    unknowns: Sequence[StartUnknown]

    @classmethod
    def of(cls, evaluator: Evaluator, hypothesis: Hypothesis, part: TimeTarget, motion: Motion) -> "_Search":
        plant, name = part.met_by(hypothesis.plant()), part.record.name
        begun = replace(hypothesis, starts={name: modal_state(motion, plant, part.record.fs)}, motions={})
        numbers = start_unknowns(hypothesis, [replace(part.record, moving_start=True)], plant)
        unknowns = tuple(number for number in numbers if isinstance(number, StartUnknown))
        return cls(evaluator, part, plant, begun, unknowns)

    def fitted(self, part: TimeTarget, there: Hypothesis, iterations: int) -> Hypothesis:
        alone = self.evaluator.with_targets([part])
        return fit(alone, there, self.unknowns, tolerance=TOLERANCE, max_iterations=iterations).hypothesis

    def start_of(self, found: Hypothesis) -> PieceStart:
        plain = self._channels(found)
        moved = (unknown.set(found, unknown.get(found) + NUDGE) for unknown in self.unknowns)
        slopes = np.stack([(self._channels(each) - plain) / NUDGE for each in moved])
        return PieceStart(found.motion_at(self.part.driven, 0, self.evaluator.settings, self.plant), slopes)

    def _channels(self, hypothesis: Hypothesis) -> FloatArray:
        response = hypothesis.simulated(self.part.driven, self.evaluator.settings, self.plant)
        return response.channels[:, : self.part.record.n_samples]
