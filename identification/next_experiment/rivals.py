"""Effects that the records cannot tell apart, each with what is known of its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.evaluate import Evaluator
from identification.evidence import Ranked, misfit_in_common
from identification.fit import NOT_TOLD, Fit, prior_of
from identification.hypothesis import Hypothesis, Unknown, at_coordinates, coordinates
from identification.in_its_place import refit, without_last
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
    """The rows of a round, those in doubt refitted beside the first one's other effects if only a sketch of them is.

    Args:
        fitting: records to refit on.
        ranked: of the round, sorted.
        chances: probabilities of its rows.
        progress: told what is being done.
    """
    doubtful = [row for row, _ in _in_doubt(ranked, chances)]
    if len(doubtful) < 2:
        return tuple(ranked)
    first, rows = ranked[0].fit, []
    last = len(first.hypothesis.effects) - 1
    shared = tuple(unknown for unknown in first.unknowns if getattr(unknown, "effect", None) != last)
    for row in ranked:
        found = None
        if row in doubtful and not row.refitted:
            progress(f"refitting {row.effect.label()}, which cannot be excluded, with all numbers on {fitting.extent}")
            begun = without_last(first.hypothesis).with_effects(row.effect)
            found = refit(fitting, replace(first, unknowns=shared), begun)
        rows.append(
            row if found is None else replace(row, effect=found.hypothesis.effects[-1], fit=found, refitted=True)
        )
    return tuple(rows)


def _in_doubt(ranked: Sequence[Ranked], chances: Sequence[float]) -> list[tuple[Ranked, float]]:
    """What a test is chosen for of the rows that the records do not exclude, the most probable first."""
    return sorted(undecided(ranked, chances), key=lambda pair: -pair[1])[:MOST_RIVALS]


def rivals_of(ranked: Sequence[Ranked], chances: Sequence[float]) -> tuple[Rival, ...]:
    """The rows of a round that its records do not exclude, the most probable first.

    Args:
        ranked: of the round.
        chances: probabilities of its rows.
    """
    scale = misfit_in_common(ranked)
    return tuple(_rival(row, chance, scale) for row, chance in _in_doubt(ranked, chances) if row.refitted)


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
