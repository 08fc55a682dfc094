"""Where in the records a misfit begins, and those records from there on.

A sweep comes to the walls after many seconds, and until then a model without the missing effect is right. So the
motion by it there is where the search begins: what acted before did not show.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.evaluate import Evaluator, Target, TimeTarget
from identification.hypothesis import Hypothesis
from identification.prepare import Horizon
from models.arrays import FloatArray
from models.record import AnyRecord

WINDOW = 0.25
"""Seconds over which a misfit is averaged."""

LASTING = 4
"""Windows in the mean of which it has to stand above the noise."""

SHOWS = 1.3
"""Residual over noise that tells effects apart."""

LEAD = 0.25
"""Seconds before the misfit shows, in which it already grows."""

LEAST_LEFT = 2.0
"""Seconds that must be left of a record."""


@dataclass(frozen=True, eq=False)
class Onset:
    """Records from where a misfit begins in them.

    Attributes:
        evaluator: those in which one does, the same beside FRFs and modes; each has a name of its own.
        hypothesis: the model, with its motion where they begin.
        limits: how far each can be predicted.
        seconds: at which each begins in the record that it is of.
    """

    evaluator: Evaluator
    hypothesis: Hypothesis
    limits: tuple[Horizon, ...]
    seconds: tuple[float, ...]


def onset_of(
    evaluator: Evaluator, hypothesis: Hypothesis, limits: Sequence[Horizon], seen: Mapping[str, float]
) -> Onset | None:
    """The records from where the misfit of a model begins in them, None where there is none with enough left of it.

    Args:
        evaluator: whole records.
        hypothesis: the model, right until then; its motion tells how it goes on (``goes_on``).
        limits: how far each time record can be predicted.
        seen: seconds at the start of some records that show no misfit, by name; of others those of a window.
    """
    begun: list[tuple[TimeTarget, Horizon, int]] = []
    for target, limit, response in zip(evaluator.timed, limits, evaluator.responses(hypothesis), strict=True):
        predicted = round(limit.seconds * target.record.fs)
        first = _first_sample(target, response.channels)
        if first is None or first < seen.get(target.record.name, WINDOW) * target.record.fs:
            continue
        least = LEAST_LEFT + hypothesis.looks_back(target.record.sensors)
        if first + least * target.record.fs < min(predicted, target.record.n_samples):
            begun.append((target, limit, first))
    if not begun:
        return None
    later: list[Target] = [*evaluator.at_rest]
    moved, motions, offsets = [], {}, dict(hypothesis.offsets)
    for target, limit, first in begun:
        seconds = first / target.record.fs
        part = target.later(
            first, f"{target.record.name} from {seconds:.2f} s", hypothesis.looks_back(target.record.sensors)
        )
        name = part.record.name
        motions[name] = hypothesis.motion_at(target.driven, first, evaluator.settings)
        offsets[name] = hypothesis.offsets.get(target.record.name, 0.0)
        moved.append(replace(limit, record=name, seconds=limit.seconds - seconds))
        later.append(part)
    return Onset(
        evaluator.with_targets(later),
        replace(hypothesis, motions=motions, offsets=offsets),
        tuple(moved),
        tuple(first / target.record.fs for target, _, first in begun),
    )


def goes_on(hypothesis: Hypothesis) -> bool:
    """Whether a motion tells how it goes on: no law has a memory or a clock, no record a phase of its own.

    A base that is measured by its velocity or acceleration would begin at rest again, and so would an absorber on an
    oscillator, whose own motion is not told.
    """
    plant = hypothesis.plant()
    if plant.structure.absorbers and not plant.structure.is_beam:
        return False
    excitation = plant.excitation
    if excitation is not None and excitation.quantity not in ("force", "base_displacement"):
        return False
    with_clock = any(effect.family == "time" or effect.record_parameters for effect in plant.effects)
    return not with_clock and all(law.rate is None for law in plant.laws)


def of_whole(hypothesis: Hypothesis, records: Sequence[AnyRecord]) -> Hypothesis:
    """A hypothesis without what parts of records have for themselves.

    Args:
        hypothesis: found on parts.
        records: whole.
    """
    names = {record.name for record in records}
    return replace(
        hypothesis,
        motions={name: motion for name, motion in hypothesis.motions.items() if name in names},
        offsets={name: offset for name, offset in hypothesis.offsets.items() if name in names},
        own={name: numbers for name, numbers in hypothesis.own.items() if name in names},
    )


def _first_sample(target: TimeTarget, channels: FloatArray) -> int | None:
    """The sample shortly before which a misfit begins to last, None where none does."""
    width = round(WINDOW * target.record.fs)
    residual = target.at_its_zero(channels[:, : target.record.n_samples]) - target.record.responses
    noise = np.maximum(target.density.mean(axis=1, keepdims=True), np.finfo(float).tiny)
    power = np.mean(residual**2 / noise, axis=0)
    n = len(power) // width
    if n < LASTING:
        return None
    windows = power[: n * width].reshape(n, width).mean(axis=1)
    lasting = np.convolve(windows, np.full(LASTING, 1.0 / LASTING), "valid")
    shows = np.flatnonzero((lasting > SHOWS**2) & (windows[: len(lasting)] > SHOWS**2))
    if len(shows) == 0:
        return None
    return max(0, int(shows[0]) * width - round(LEAD * target.record.fs))
