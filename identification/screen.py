"""A cheap look at every effect at every place: how much of the misfit could it explain?

For each trial value the model is simulated once. The change of the response, freed of what the rig's toleranced numbers
could do as well, is laid on the residual; the share of chi-square that it takes away, at its best size, is the score.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from identification.evaluate import Evaluator
from identification.fit import Fit, prior_of
from identification.hypothesis import Hypothesis
from identification.in_step import tried_with
from identification.progress import Progress
from identification.scene import Longer, in_one_valley, is_same_place, places_near, places_of, scenes
from models.arrays import FloatArray
from models.effects import Registry
from models.effects.protocol import Effect, Place


@dataclass(frozen=True, eq=False)
class Suspect:
    """An effect with trial values and what it could explain.

    Attributes:
        effect: scaled to its best size.
        gain: decrease of chi-square that the linear estimate promises or the trial itself shows.
    """

    effect: Effect
    gain: float


class Projection:
    """Takes out of a change of the response what the fit's unknowns could do as well."""

    def __init__(self, base: Fit) -> None:
        prior = prior_of(base.unknowns)
        x = np.array([unknown.get(base.hypothesis) for unknown in base.unknowns])
        self.rows = base.jacobian
        self.residual = base.residual
        self.inverse = np.linalg.pinv(base.jacobian @ base.jacobian.T + np.diag(prior), hermitian=True)
        self.held, self.penalty = prior * x, float(prior @ x**2)
        self.pull = self.inverse @ (base.jacobian @ base.residual + self.held)
        self.misfit = self.left_of(base.residual)

    def left_of(self, residual: FloatArray) -> float:
        """Chi-square and prior of another residual when the fit's unknowns have taken away what they can.

        Args:
            residual: (n_data,) in units of the noise, with the unknowns where the fit has them.
        """
        gradient = self.rows @ residual + self.held
        return float(residual @ residual + self.penalty - gradient @ self.inverse @ gradient)

    def gain(self, change: FloatArray, *, two_sided: bool = False) -> tuple[float, float]:
        """(decrease of chi-square, best factor) for a change of the response proportional to a trial value.

        Args:
            change: (n_data,) in units of the noise.
            two_sided: whether a negative factor makes sense (a gain below 1 for one above).
        """
        shared = self.rows @ change
        along = float(change @ self.residual - shared @ self.pull)
        size = float(change @ change - shared @ self.inverse @ shared)
        if size <= LEAST_SHARE * float(change @ change) or size == 0.0:
            return 0.0, 1.0
        best = -along / size
        size_of = min(max(abs(best), LEAST_FACTOR), LARGEST_FACTOR)
        factor = -size_of if best < 0 and two_sided else size_of if best > 0 else LEAST_FACTOR
        return float(-2.0 * factor * along - factor**2 * size), factor

    def gain_of_all(self, changes: FloatArray) -> float:
        """Decrease of chi-square for the best sum of changes of the response, each proportional to its factor.

        Args:
            changes: (m, n_data) in units of the noise.
        """
        shared = self.rows @ changes.T
        along = changes @ self.residual - shared.T @ self.pull
        size = changes @ changes.T - shared.T @ self.inverse @ shared
        own = np.sqrt(np.maximum(np.diag(size), 0.0))
        kept = own**2 > LEAST_SHARE * np.sum(changes**2, axis=1)
        if not kept.any():
            return 0.0
        scale = np.where(kept, own, 1.0)
        scaled, slope = (size / np.outer(scale, scale))[np.ix_(kept, kept)], (along / scale)[kept]
        return float(slope @ np.linalg.pinv(scaled, rcond=LEAST_SHARE, hermitian=True) @ slope)


LEAST_SHARE = 1e-6
"""A change of which a smaller share is its own cannot be told from the rig's numbers."""

LEAST_FACTOR, LARGEST_FACTOR = 1e-3, 3.0
"""Range in which the size of an effect is believed to act in proportion; a factor at its end is only a direction."""


def screen(
    evaluator: Evaluator, base: Fit, registry: Registry, progress: Progress, channels: Collection[Place] | None = None
) -> list[Suspect]:
    """Every kind at every place, the most promising first.

    A trial that changes the response by far more than what is left, of which nothing is in proportion any more, is
    tried again as large as what is left.

    Args:
        evaluator: records to judge on.
        base: the calibrated model on the same records.
        registry: kinds to try.
        progress: told how many simulations are coming.
        channels: on which effects may sit (``places_of``).
    """
    projection = Projection(base)

    def seen(trials: Sequence[Effect]) -> Iterator[Seen]:
        for trial, row in _residuals(evaluator, base.hypothesis, trials):
            change = row - base.residual
            gain, factor = projection.gain(change, two_sided=_two_sided(trial))
            if projection.misfit - projection.left_of(row) > AS_IT_IS * gain:
                factor = 1.0
            yield trial, Suspect(trial.scaled(factor), gain), float(change @ change)

    trials = _trials(evaluator, base, registry, channels=channels)
    first = [row[len(row) // 2] for row in trials.values()]
    progress(f"screening {len(registry)} kinds of effect at every place: {len(first)} trials")
    suspects = _looked_at(seen, first, projection.misfit, progress)
    near = {(s.effect.kind, s.effect.place) for s in promising(suspects, PLACES_TO_VARY)}
    rest = [e for key, row in trials.items() if key in near for e in row if e is not row[len(row) // 2]]
    progress(f"trying {len(rest)} other values at the best places")
    suspects += _looked_at(seen, rest, projection.misfit, progress)
    return sorted(suspects, key=lambda suspect: -suspect.gain)


AS_IT_IS = 0.8
"""Share of what a trial promises in proportion to its size, from which on it is taken as it is: what it shows at its
own size is sure, and a delay of many turns is in proportion to nothing."""

Seen = tuple[Effect, Suspect, float]
"""A trial, what it promises, and the square of its change of the residual."""


def _looked_at(
    seen: Callable[[Sequence[Effect]], Iterator[Seen]], trials: Sequence[Effect], left: float, progress: Progress
) -> list[Suspect]:
    """The trials, and those that change far more than is left once more, as large as that.

    Args:
        seen: simulates trials.
        trials: to be looked at.
        left: chi-square.
        progress: told how many follow.
    """
    looked = list(seen(trials))
    far = [(trial, by) for trial, _, by in looked if 0.0 < left < SMALL_ENOUGH**2 * by]
    smaller = [less for trial, by in far if (less := trial.scaled(float(np.sqrt(left / by)))) != trial]
    if smaller:
        progress(f"trying {len(smaller)} again, as large as what is left")
    return [suspect for _, suspect, _ in [*looked, *seen(smaller)]]


SMALL_ENOUGH = 0.3
"""Share of a trial's change of the response: where less is left, it is tried again as large as what is left. Of the
whole change: where that is so large, the slopes of the rig's numbers do not tell how much of it they could do."""

PLACES_TO_VARY = 3
"""Places of each kind at which all trial values are tried, not only the middle one."""


def survey(
    evaluator: Evaluator,
    start: Fit,
    registry: Registry,
    progress: Progress,
    near: float | None = None,
    channels: Collection[Place] | None = None,
    longer: Longer | None = None,
) -> list[Suspect]:
    """Every kind at every place at every size, none taken to act in proportion, the most promising first.

    For records so short that they can be simulated a thousand times, and misfits so large that nothing is linear but
    what the rig's numbers do. A trial that changes the response by far more than is left is tried as large as what is
    left, too; then sizes about the best of every kind at its best places.

    Args:
        evaluator: the beginning of the records.
        start: the model without a suspect and its Jacobian there.
        registry: kinds to try.
        progress: told how many simulations are coming.
        near: only at this position along the beam, m, and at sleeves close to it.
        channels: on which effects may sit (``places_of``).
        longer: what records tell that are longer than these.
    """
    projection = Projection(start)

    def seen(trials: Sequence[Effect]) -> Iterator[Seen]:
        for trial, row in _residuals(evaluator, start.hypothesis, trials):
            change = row - start.residual
            yield trial, Suspect(trial, projection.misfit - projection.left_of(row)), float(change @ change)

    trials = _trials(evaluator, start, registry, near, channels, longer)
    sizes = [trial for row in trials.values() for trial in row]
    progress(f"surveying {len(registry)} kinds of effect at every place: {len(sizes)} trials")
    suspects = _looked_at(seen, sizes, projection.misfit, progress)
    best = promising(sorted(suspects, key=lambda suspect: -suspect.gain), PLACES_TO_SIZE)
    about = [size for suspect in best for size in _sizes_about(suspect.effect)]
    if about:
        progress(f"trying {len(about)} sizes about the best of every kind")
    suspects += [suspect for _, suspect, _ in seen(about)]
    return sorted(suspects, key=lambda suspect: -suspect.gain)


PLACES_TO_SIZE = 4
"""Places of each kind at which sizes about the best one are tried."""


def _sizes_about(effect: Effect) -> list[Effect]:
    """A third of a decade smaller and larger, where that is another."""
    sizes = [effect.scaled(factor) for factor in BETWEEN if factor != 1.0]
    return [size for size in dict.fromkeys(sizes) if size != effect]


BETWEEN = (0.46, 1.0, 2.15)
"""Factors on trial sizes: thirds of a decade."""


def _residuals(
    evaluator: Evaluator, model: Hypothesis, trials: Sequence[Effect]
) -> Iterator[tuple[Effect, FloatArray]]:
    """Each trial with the residual of the model that has it too; those that diverge are left out."""
    for start in range(0, len(trials), BATCH):
        batch = trials[start : start + BATCH]
        rows = evaluator.residuals([(tried_with(evaluator, model, effect), None) for effect in batch])
        yield from ((effect, row) for effect, row in zip(batch, rows, strict=True) if row is not None)


BATCH = 16
"""Trials whose residuals are held in memory together."""


def _two_sided(effect: Effect) -> bool:
    """Its size can be on either side of nothing."""
    return any(p.neutral is not None and p.lower < p.neutral < p.upper for _, p in effect.fitted_parameters())


def _trials(
    evaluator: Evaluator,
    base: Fit,
    registry: Registry,
    near: float | None = None,
    channels: Collection[Place] | None = None,
    longer: Longer | None = None,
) -> dict[tuple[str, Place], list[Effect]]:
    """Trial effects by kind and place."""
    rig = base.hypothesis.rig
    kinds = [kind for kind in registry.values() if rig.structure.kind in kind.structures]
    places = {kind: places_of(kind, rig, channels) if near is None else places_near(kind, rig, near) for kind in kinds}
    wanted = {place for row in places.values() for place in row}
    seen = scenes(evaluator, base.hypothesis, wanted, longer) if wanted else {}
    parts = [part for effect in base.hypothesis.effects for part in effect.parts()]
    trials: dict[tuple[str, Place], list[Effect]] = {}
    for kind in kinds:
        for place in places[kind]:
            others = [part.place for part in parts if part.kind == kind.part_kind()]
            wherever = kind.sits_at(place)
            there = kind.unique and any(is_same_place(at, other, rig) for other in others for at in wherever)
            if row := [] if there else list(kind.trials(seen[place])):
                trials[kind.kind, place] = row
    return trials


def promising(suspects: Sequence[Suspect], per_kind: int, apart: float = 0.0) -> list[Suspect]:
    """The best few suspects of each kind, one a place and variant, the best kind first.

    Args:
        suspects: the best first.
        per_kind: most of a kind.
        apart: distance, m, within which positions along the beam are one place.
    """
    kept: dict[str, list[Suspect]] = {}
    for suspect in suspects:
        row = kept.setdefault(suspect.effect.kind, [])
        if len(row) < per_kind and all(_differs(suspect.effect, other.effect, apart) for other in row):
            row.append(suspect)
    return sorted((s for row in kept.values() for s in row), key=lambda suspect: -suspect.gain)


def _differs(one: Effect, other: Effect, apart: float) -> bool:
    return one.is_variant_of(other) or not in_one_valley(one.place, other.place, apart)
