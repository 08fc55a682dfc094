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


def all_refitted(
    fitting: Evaluator, ranked: Sequence[Ranked], chances: Sequence[float], progress: Progress
) -> tuple[Ranked, ...]:
    """The rows of a round, the most probable of those in doubt refitted beside the first one's other effects.

    What was refitted before stays as it is, and so does a sketch whose refit leaves the finite numbers.

    Args:
        fitting: records to refit on.
        ranked: of the round, the best first.
        chances: probabilities of its rows.
        progress: told what is being done.
    """
    doubtful = sorted(undecided(ranked, chances), key=lambda pair: -pair[1])[:MOST_RIVALS]
    sketched = [row for row, _ in doubtful if not row.refitted]
    if len(doubtful) < 2 or not sketched:
        return tuple(ranked)
    first = ranked[0].fit
    others = first.hypothesis.without_effect(first.hypothesis.effects.index(ranked[0].effect))
    of_the_rest = tuple(unknown for unknown in first.unknowns if getattr(unknown, "effect", -1) < 0)
    base = replace(first, unknowns=(*of_the_rest, *effect_unknowns(others)))
    rows = list(ranked)
    for row in sketched:
        progress(f"refitting {row.effect.label()}, which cannot be excluded, with all numbers on {fitting.extent}")
        found = refit(fitting, base, others.with_effects(row.effect))
        if found is not None:
            rows[rows.index(row)] = replace(Ranked.of(found, sketch=row.sketch), log_evidence=row.log_evidence)
    return tuple(rows)


def rivals_of(ranked: Sequence[Ranked], chances: Sequence[float]) -> tuple[Rival, ...]:
    """The rows of a round that its records do not exclude, the most probable first.

    Args:
        ranked: of the round.
        chances: probabilities of its rows.
    """
    scale = misfit_in_common(ranked)
    kept = sorted(((r, p) for r, p in undecided(ranked, chances) if r.refitted), key=lambda pair: -pair[1])
    return tuple(_rival(row, chance, scale) for row, chance in kept[:MOST_RIVALS])


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
