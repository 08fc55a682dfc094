"""Effects that the records cannot tell apart, each with what is known of its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common
from identification.fit import NOT_TOLD, Fit, prior_of
from identification.hypothesis import Hypothesis, Unknown, at_coordinates, coordinates, effect_unknowns
from identification.in_its_place import refit
from identification.outcome import undecided
from identification.progress import Progress
from models.arrays import FloatArray
from models.effects import Effect

MOST_RIVALS = 3
"""The most probable members of a group that a test is chosen for."""


@dataclass(frozen=True, eq=False)
class Rival:
    """One member of the group.

    Attributes:
        effect: in doubt.
        fit: of all its numbers on the records so far.
        hypothesis: at its fit, without states at the start of old records.
        chance: present probability.
        unknowns: what may still move in a new record.
        axes: (n, n) principal axes of the posterior as rows, one standard deviation long, in the unknowns' coordinates.
    """

    effect: Effect
    fit: Fit
    hypothesis: Hypothesis
    chance: float
    unknowns: tuple[Unknown, ...]
    axes: FloatArray

    def moved(self, along: FloatArray) -> Hypothesis:
        """The hypothesis away from its fit.

        Args:
            along: (n,) in the unknowns' coordinates.
        """
        return at_coordinates(self.hypothesis, self.unknowns, coordinates(self.hypothesis, self.unknowns) + along)


def rivals_of(
    fitting: Evaluator, ranked: Sequence[Ranked], chances: Sequence[float], progress: Progress
) -> tuple[Rival, ...]:
    """The rows of a round that its records do not exclude, the most probable first.

    What was only sketched is refitted beside the first one's other effects; it is no rival where that excludes it, or
    leaves the finite numbers.

    Args:
        fitting: records to refit on.
        ranked: of the round, the best first.
        chances: probabilities of its rows.
        progress: told what is being done.
    """
    doubtful = sorted(undecided(ranked, chances), key=lambda pair: -pair[1])
    rivals: list[Rival] = []
    for row, chance in doubtful if len(doubtful) > 1 else ():
        if len(rivals) == MOST_RIVALS:
            break
        member = row if row.refitted else _refitted(fitting, ranked[0], row.effect, progress)
        if member is not None:
            rivals.append(_rival(member, chance, misfit_in_common(ranked)))
    return tuple(rivals)


def _refitted(fitting: Evaluator, first: Ranked, effect: Effect, progress: Progress) -> Ranked | None:
    """A fit of another effect in the first one's place; None where it fails or the records exclude it."""
    progress(f"refitting {effect.label()}, which cannot be excluded, with all numbers on {fitting.extent}")
    others = first.fit.hypothesis.without_effect(first.fit.hypothesis.effects.index(first.effect))
    of_the_rest = tuple(unknown for unknown in first.fit.unknowns if getattr(unknown, "effect", -1) < 0)
    base = replace(first.fit, unknowns=(*of_the_rest, *effect_unknowns(others)))
    found = refit(fitting, base, others.with_effects(effect))
    if found is None or len(undecided((first, member := Ranked.of(found)), (1.0, 0.0))) < 2:
        return None
    return member


def _rival(row: Ranked, chance: float, scale: float) -> Rival:
    """With the posterior in the unit of the round's residuals; states at the start of old records are integrated out.

    What neither a prior nor the records tell is known to a thousand units, as in ``fit``.
    """
    found = row.fit
    prior = np.diag(prior_of(found.unknowns))
    value, vector = np.linalg.eigh(found.jacobian @ found.jacobian.T / scale + prior)
    covariance = (vector / np.maximum(value, NOT_TOLD)) @ vector.T
    lasting = [i for i, unknown in enumerate(found.unknowns) if unknown.record is None]
    variance, axes = np.linalg.eigh(covariance[np.ix_(lasting, lasting)])
    return Rival(
        row.effect,
        found,
        replace(found.hypothesis, starts={}, offsets={}),
        chance,
        tuple(found.unknowns[i] for i in lasting),
        np.asarray((axes * np.sqrt(np.maximum(variance, 0.0))).T),
    )
