"""How much the records speak for each suspect: Laplace's approximation to the evidence, and probabilities from it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log, pi
from typing import Self

import numpy as np

from identification.fit import Fit, prior_of
from identification.hypothesis import EffectUnknown, OwnNumber, PlaceUnknown, Unknown
from models.effects import Effect

LEAST_EVIDENCE = 12.0
"""Logarithm of the odds that an effect, or a hidden noise, must bring against the model without it."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """A suspect after its fit.

    Attributes:
        effect: the last effect of the fit's hypothesis.
        fit: with all unknowns refitted, or the sketch.
        refitted: whether all unknowns were.
        log_evidence: not yet normalised.
        sketch: its fit on the beginning of the records, from which it was refitted, where there was one.
    """

    effect: Effect
    fit: Fit
    refitted: bool
    log_evidence: float
    sketch: Fit | None = None

    @classmethod
    def of(cls, found: Fit, index: int = -1, sketch: Fit | None = None) -> Self:
        """A suspect refitted and not yet weighed.

        Args:
            found: its fit.
            index: of its effect.
            sketch: its fit on the beginning of the records.
        """
        return cls(found.hypothesis.effects[index], found, refitted=True, log_evidence=0.0, sketch=sketch)


def with_evidence(ranked: Sequence[Ranked]) -> list[Ranked]:
    """Sorted by Laplace's approximation to the evidence, with residuals in units of what the best fit leaves.

    log Z = -(chi^2 / s^2 + prior) / 2 + log(volume of the posterior / volume of the prior); s^2 is the square of the
    unit of the round, ``misfit_in_common``. The volume is that of all unknowns: an effect that takes a number of the
    rig out of play (a clearance of its own) leaves that as wide as its tolerance. Beforehand a law with a number more
    has ``SIMPLER`` times less odds, so that a law that imitates a simpler one within what is known comes after it.
    Source: D. J. C. MacKay, Information Theory, Inference, and Learning Algorithms (2003), chapter 28.
    """
    if not ranked:
        return []
    scale = misfit_in_common(ranked)
    scored = [replace(r, log_evidence=log_without(r.fit, scale) + _beforehand(r.fit, scale)) for r in ranked]
    return sorted(scored, key=lambda r: -r.log_evidence)


def log_fit(result: Fit, scale: float) -> float:
    """Logarithm of the likelihood and the prior at the fit, less what all models have in common.

    Chi-square counts beyond what noise leaves: in pieces of records the starts of some models have more numbers.

    Args:
        result: of a round.
        scale: ``misfit_in_common`` of the round; what was known beforehand is not measured in it.
    """
    return -0.5 * ((result.chi2 - result.n_data) / scale + result.penalty)


def log_without(result: Fit, scale: float) -> float:
    """``log_fit`` with the volume that is left to the unknowns that all models of a round have, per unit volume.

    Args:
        result: of a round; of its last effect's own unknowns nothing is counted.
        scale: ``misfit_in_common`` of the round.
    """
    own = set(_own(result))
    return _log_left(result, scale, [i for i in range(len(result.unknowns)) if i not in own])


def log_standing(result: Fit, scale: float) -> float:
    """``log_fit`` with the volume that is left to all unknowns of the model that the suspects of a round stand beside.

    The numbers of its effects are among those that all models of the round have: ``log_without`` counts them there.

    Args:
        result: the model without a suspect.
        scale: ``misfit_in_common`` of the round.
    """
    return _log_left(result, scale, range(len(result.unknowns)))


def _log_left(result: Fit, scale: float, those: Sequence[int]) -> float:
    """``log_fit`` with the volume that is left to some unknowns where the others stay, per unit volume."""
    if not those:
        return log_fit(result, scale)
    prior = np.diag(prior_of(result.unknowns))
    told = (np.linalg.inv(result.covariance) - prior) / scale + prior
    sizes = np.linalg.eigvalsh(told[np.ix_(those, those)])
    return log_fit(result, scale) - 0.5 * float(np.log(np.maximum(sizes, LEAST_TOLD)).sum())


LEAST_TOLD = 1e-6
"""Information in units of the prior's below which only round-off is told."""


def _beforehand(result: Fit, scale: float) -> float:
    """Logarithm of what speaks for a law apart from how it fits."""
    effects = result.hypothesis.effects
    return log_occam(result, scale) - log(SIMPLER) * (effects[-1].n_numbers if effects else 0)


SIMPLER = 20.0
"""Odds, before the records speak, that a law does not need another number; a table is one."""


def _own(result: Fit) -> list[int]:
    """Which of a fit's unknowns belong to its last effect."""
    index = len(result.hypothesis.effects) - 1
    return [i for i, unknown in enumerate(result.unknowns) if getattr(unknown, "effect", None) == index]


def misfit_in_common(ranked: Sequence[Ranked]) -> float:
    """The square of the unit of all residuals of a round.

    The reduced chi-square that the best refit leaves, 1 at least, so that a misfit common to all does not speak; times
    what chi-square counts again, so that the force's noise, which all channels share, speaks once; and what no noise
    is: a difference that the best model's own error makes, and a law with a number more takes away.
    """
    return misfit_of(min((row.fit for row in ranked if row.refitted), key=lambda fit: fit.ratio))


def misfit_of(best: Fit) -> float:
    """``misfit_in_common`` of a round whose best fit is known.

    Args:
        best: with all unknowns refitted.
    """
    return unit_of(best.repeats, best.ratio, best.n_data)


def unit_of(repeats: float, ratio: float, n_data: float) -> float:
    """The square of the unit in which residuals speak for or against a suspect.

    Args:
        repeats: how many times chi-square counts noise that all channels share.
        ratio: residual over noise that the best model leaves.
        n_data: real numbers in the residual.
    """
    return repeats * max(1.0, ratio**2) + MODEL_ERROR * n_data


MODEL_ERROR = 1e-3
"""Variance, as a share of all data in units of the noise, that any model of a rig misses in one direction of its data:
a tenth in all, which chi-square does not show, in the hundred directions that some modes on some channels have."""


def reranked(ranked: Sequence[Ranked], better: Fit) -> list[Ranked]:
    """The rows with a better fit of the first one's effect; rows without a refit stay as far behind the best.

    Args:
        ranked: sorted.
        better: another fit of the same effect.
    """
    first = replace(ranked[0], fit=better, effect=better.hypothesis.effects[-1])
    return reweighed(ranked, [first, *(row for row in ranked[1:] if row.refitted)])


def reweighed(ranked: Sequence[Ranked], refitted: Sequence[Ranked]) -> list[Ranked]:
    """The refitted rows by their evidence; rows without a refit stay as far behind the best.

    Args:
        ranked: sorted, as they were.
        refitted: those of them that were fitted again.
    """
    rows = with_evidence(refitted)
    if not rows:
        return list(ranked)
    shift = rows[0].log_evidence - ranked[0].log_evidence
    return [*rows, *(replace(r, log_evidence=r.log_evidence + shift) for r in ranked if not r.refitted)]


def ranked_together(*rankings: Sequence[Ranked]) -> list[Ranked]:
    """The rows of several rankings by their evidence; those without a refit stay as far behind the best of their own.

    Args:
        rankings: each sorted.
    """
    rows = with_evidence([row for ranking in rankings for row in ranking if row.refitted])
    now = {id(row.fit): row.log_evidence for row in rows}
    left: list[Ranked] = []
    for ranking in rankings:
        first = next((row for row in ranking if row.refitted), None)
        shift = 0.0 if first is None else now[id(first.fit)] - first.log_evidence
        left += [replace(r, log_evidence=r.log_evidence + shift) for r in ranking if not r.refitted]
    return [*rows, *left]


def log_occam(result: Fit, scale: float = 1.0) -> float:
    """Logarithm of the share of the prior's volume that the data leave to the last effect's unknowns.

    Args:
        result: with covariances for noise of unit size.
        scale: square of the noise's size.
    """
    own = _own(result)
    if not own:
        return 0.0
    ranges = np.array([_range(result.unknowns[i]) for i in own])
    # What the data do not tell is as wide as what was known beforehand, not as wide as the fit lets it run.
    counted = np.array([result.unknowns[i].prior for i in own])
    beforehand = np.diag(np.where(counted, 0.0, 2.0 * pi / ranges**2))
    told = np.linalg.inv(scale * result.covariance[np.ix_(own, own)]) + beforehand
    _, volume = np.linalg.slogdet(told / (2.0 * pi))
    return min(0.0, -0.5 * float(volume) - float(np.log(ranges).sum()))


PLACES = 20.0
"""Prior range of a position in its own coordinate, twentieths of the length."""


def _range(unknown: Unknown) -> float:
    """Width of what is known beforehand: an even one's, or that of a normal distribution as high."""
    if isinstance(unknown, PlaceUnknown):
        return PLACES
    if isinstance(unknown, OwnNumber):
        return unknown.about.upper - unknown.about.lower
    assert isinstance(unknown, EffectUnknown)
    return float(np.sqrt(2.0 * pi) * (1.0 if unknown.about.scale == "log" else unknown.about.spread / unknown.unit))


def probabilities(log_evidence: Sequence[float]) -> list[float]:
    """Shares of the evidence."""
    weights = np.exp(np.array(log_evidence) - max(log_evidence))
    return [float(w) for w in weights / weights.sum()]
