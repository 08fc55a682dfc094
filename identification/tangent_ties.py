"""What small motion about rest cannot tell: a nonlinear law from the spring or dashpot that it is there."""

from collections.abc import Sequence
from dataclasses import replace
from math import isclose

from identification.evidence import Ranked, misfit_in_common
from identification.hypothesis import Hypothesis
from identification.outcome import EXCLUDED_BY
from models.ports import PointLaw

LARGE_Q, LARGE_V, SMALLER = 1e-2, 1.0, 1e3
"""Motion, m and m/s, at which a law that is not linear shows it, and by what it is divided for comparison."""

LINEAR = 1e-6
"""Relative deviation from proportion that is round-off."""


def tied(ranked: Sequence[Ranked]) -> list[Ranked]:
    """The ranking of a round that saw small motion only: what fits as well as the best is as probable, linear first.

    That an effect sits at a sleeve, and so has no free place, makes it no more probable than a dashpot at that place,
    as long as nobody has seen the force grow out of proportion.

    Args:
        ranked: the best first.
    """
    if not ranked:
        return []
    least, scale = min(row.fit.cost for row in ranked if row.refitted), misfit_in_common(ranked)
    alike = [row for row in ranked if row.refitted and row.fit.cost - least < EXCLUDED_BY * scale]
    best = ranked[0].log_evidence
    level = [
        replace(row, log_evidence=best) for row in sorted(alike, key=lambda row: not is_linear(row.fit.hypothesis))
    ]
    return [*level, *(row for row in ranked if row not in alike)]


def is_linear(hypothesis: Hypothesis) -> bool:
    """Whether the last effect acts in proportion to the motion, however large.

    Args:
        hypothesis: with effects.
    """
    *others, last = hypothesis.effects
    plant, bare = hypothesis.plant(), replace(hypothesis, effects=tuple(others)).plant()
    laws = [law for law in plant.laws if law.owner == last.label()]
    return plant.contacts == bare.contacts and all(_is_proportional(law) for law in laws)


def _is_proportional(law: PointLaw) -> bool:
    """Whether a large motion answers as the sum of its parts does, a thousand times smaller and the other way."""

    def force(q: float, v: float) -> float:
        return law.force(0.0, q, v, 0.0, law.parameters)

    parts = force(-LARGE_Q / SMALLER, 0.0) + force(0.0, -LARGE_V / SMALLER)
    return law.rate is None and isclose(force(LARGE_Q, LARGE_V), -SMALLER * parts, rel_tol=LINEAR)
