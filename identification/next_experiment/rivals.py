"""Effects that the records cannot tell apart, each with what is known of its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.evidence import Ranked, misfit_in_common
from identification.fit import NOT_TOLD, Fit, prior_of
from identification.hypothesis import Hypothesis, Unknown, at_coordinates, coordinates
from identification.outcome import in_one_valley, undecided
from identification.scene import is_same_place
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


def rivals_of(ranked: Sequence[Ranked], chances: Sequence[float]) -> tuple[Rival, ...]:
    """The rows of a round that its records do not exclude, the most probable first; what was only sketched is none.

    An effect that sits here or a little farther along the beam is one whose place is not told: no test would find two.

    Args:
        ranked: of the round, the best first.
        chances: probabilities of its rows.
    """
    doubtful = [pair for pair in undecided(ranked, chances) if pair[0].refitted]
    apart: list[tuple[Ranked, float]] = []
    for row, chance in sorted(doubtful, key=lambda pair: -pair[1]):
        one = next((i for i, (other, _) in enumerate(apart) if _is_one(row, other)), None)
        if one is None:
            apart.append((row, chance))
        else:
            apart[one] = apart[one][0], apart[one][1] + chance
    if len(apart) < 2:
        return ()
    likeliest = sorted(apart, key=lambda pair: -pair[1])[:MOST_RIVALS]
    return tuple(_rival(row, chance, misfit_in_common(ranked)) for row, chance in likeliest)


def _is_one(row: Ranked, other: Ranked) -> bool:
    """Whether a fit may come from one to the other; from a free place to a sleeve only where that is the same place."""
    one, two, rig = row.effect, other.effect, row.fit.hypothesis.rig
    if (one.place.sleeve or two.place.sleeve) and not is_same_place(one.place, two.place, rig):
        return False
    return in_one_valley(one, two, rig) and not one.is_variant_of(two)


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
