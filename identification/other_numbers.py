"""A record kept aside that is missed: is the model another, or are its numbers not told well enough?"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, sqrt

import numpy as np

from identification.assess import score
from identification.calibrate import all_unknowns, calibrate
from identification.draws import drawn, most_together
from identification.evaluate import Evaluator
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import Hypothesis, Unknown
from identification.kept_aside import Followed, KeptAside, beyond_noise, is_met
from identification.noise import Noise
from identification.noise_left import noise_uncovered, with_noise
from identification.pieces import fit_from_own_starts
from identification.prepare import resolved
from identification.reached import MODELS_APART, NOISE_REACHED, STRAYS
from identification.result import RecordScore
from identification.session import REALISATIONS, Session

ASTRAY = 0.1
"""Error of a record kept aside, as a share of its motion, above which a fit may have stopped in another valley: begun
with a stiffness 2.4 times too large, a loud record of an oscillator was left with all of it."""


def with_other_numbers(session: Session, last: Fit, kept: KeptAside) -> KeptAside:
    """Whether other numbers of the model explain the records that it misses beside those that it has learnt from.

    What is added to chi-square where those are fitted beside the others is their distance from what was predicted in
    units of noise and of what is not told of the numbers together, as far as the model is linear about them; unlike
    that distance it also tells of numbers farther off. These fits are asked for that alone: the numbers of the model
    stay those that were learnt without the records kept aside.

    Args:
        session: records learnt from; told.
        last: the model fitted to all of them.
        kept: what it is worth on the others; returned as it is where the model holds there, where a motion is lost,
            where what is missed is not motion over time, where the model does not reach the noise of what it was fitted
            to, and where it is not told.
    """
    followed = kept.followed
    if not kept.missed or followed is None or last.ratio > NOISE_REACHED:
        return kept
    if not {target.record.name for target in followed.heard.timed} >= kept.missed.keys():
        return kept
    names = " and ".join(kept.missed)
    session.progress(f"looking for numbers that explain {names} too")
    try:
        explained, left = _Court.of(session, last, followed, kept).explained()
    except ArithmeticError as lost:
        session.progress(f"the motion is lost on the way: {lost}")
        return kept
    if explained:
        words = "with other numbers the same model explains it as well as what was learnt from"
        session.decide(f"{names}: {words}")
        told = {name: f"{told}, but {words}" for name, told in kept.missed.items()}
        return replace(kept, missed=told, explained=True)
    if explained is None:
        session.decide(f"no numbers were found that explain {names} too, and it is not told whether there are any")
        return kept
    session.decide(f"no numbers of the model explain {names} too: {left:.2f} times the noise is left there at least")
    return replace(kept, explained=False)


@dataclass(frozen=True, eq=False)
class _Court:
    """Where a model is fitted to what was learnt from and to what was missed.

    Attributes:
        session: for the seed of the noise.
        learnt, heard, as_told: the records learnt from, and those missed with either noise (``Followed``).
        unknowns: what may move.
        cost_alone: of the model fitted to the first alone, with the steps of the fits to both.
        known: where they begin.
    """

    session: Session
    learnt: Evaluator
    heard: Evaluator
    as_told: Evaluator
    unknowns: tuple[Unknown, ...]
    cost_alone: float
    known: Hypothesis

    @classmethod
    def of(cls, session: Session, last: Fit, followed: Followed, kept: KeptAside) -> "_Court":
        heard, as_told = (
            each.with_targets([target for target in each.timed if target.record.name in kept.missed])
            for each in (followed.heard, followed.as_told)
        )
        learnt, known = session.all_predicted, followed.known
        both = resolved(learnt.with_targets([*learnt.targets, *heard.targets]), known)
        learnt, heard, as_told = (each.with_settings(both.settings) for each in (learnt, heard, as_told))
        alone = learnt.residuals([(last.hypothesis, None)])[0]
        cost = last.cost if alone is None else float(alone @ alone) + last.penalty
        return cls(session, learnt, heard, as_told, all_unknowns(known, both), cost, known)

    def explained(self) -> tuple[bool | None, float]:
        """Whether both are explained together, if that is told, and residual over noise that those missed add.

        Far off, whole records have many valleys: so what begins with the numbers learnt begins once more on ever more
        of the records. Each time the force's noise counts as the numbers found carry it.
        """
        nearest: _Together | None = None
        for is_led in (False, True):
            try:
                now = self.fitted(self.heard, self.led() if is_led else self.known)
                told = self.told_by(now)
                now = self.fitted(self.carried([n for n, _ in told], now), now.fit.hypothesis)
                if now.explains:
                    return True, now.left
                now = self.fitted(self.carried([n for _, n in told], now), now.fit.hypothesis)
            except ArithmeticError as lost:
                self.session.progress(f"the motion is lost on the way: {lost}")
                continue
            nearest = min(nearest or now, now, key=lambda each: each.left)
        if nearest is None or not nearest.refutes or self.may_be_noise(nearest):
            return None, inf
        return False, nearest.left

    def may_be_noise(self, found: "_Together") -> bool:
        """Whether no more is left of those missed than the force's noise may leave of them; told.

        Args:
            found: what leaves it.
        """
        try:
            most = most_together(drawn(found.missed, found.fit.hypothesis, self.session.seed))
        except ArithmeticError:  # some noise would take the motion out of the finite numbers: nothing is excused by it
            return False
        if found.promised > most:
            return False
        names = " and ".join(target.record.name for target in found.missed.timed)
        self.session.decide(
            f"{names}: {found.promised:.2f} times the noise would be left, and the force's noise alone may leave "
            f"{most:.2f} times of it in one test"
        )
        return True

    def led(self) -> Hypothesis:
        """The model with numbers found on ever more of the records."""
        return calibrate(self.both(self.heard), self.known, self.unknowns).hypothesis

    def fitted(self, missed: Evaluator, begin: Hypothesis) -> "_Together":
        """The model fitted to both.

        Raises:
            ArithmeticError: the model diverges.
        """
        both = self.both(missed)
        found = fit_from_own_starts(both, fit_to_its_end(both, begin, self.unknowns))
        return _Together(self.learnt, missed, found, self.cost_alone)

    def told_by(self, found: "_Together") -> list[tuple[Noise, Noise]]:
        """Of each record missed its noise, and that which it tells by itself; one that the force hides by what is left.

        Args:
            found: what leaves it.
        """
        residual = found.fit.residual[self.learnt.n_data :]
        uncovered = noise_uncovered(self.heard, found.fit.hypothesis, residual, self.rng)
        rows = zip(self.heard.timed, self.as_told.timed, uncovered, strict=True)
        return [(noise, noise) if heard.noise.hidden else (heard.noise, own.noise) for heard, own, noise in rows]

    def both(self, missed: Evaluator) -> Evaluator:
        """What was learnt from, and what was missed behind it."""
        return self.learnt.with_targets([*self.learnt.targets, *missed.targets])

    def carried(self, noises: Sequence[Noise], found: "_Together") -> Evaluator:
        """The records missed with these noises, the force's as the numbers found carry it."""
        return with_noise(self.heard, noises, found.fit.hypothesis, self.rng, REALISATIONS)

    @property
    def rng(self) -> np.random.Generator:
        """Of the realisations of the force's noise, the same ones each time."""
        return np.random.default_rng(self.session.seed)


@dataclass(frozen=True, eq=False)
class _Together:
    """A model fitted to what was learnt from and to what was missed.

    Attributes:
        learnt, missed: the records.
        fit: to both, those missed last.
        cost_alone: of the fit to the first alone.
    """

    learnt: Evaluator
    missed: Evaluator
    fit: Fit
    cost_alone: float

    @property
    def left(self) -> float:
        """Residual over noise that those missed add."""
        return self._added(self.fit.cost)

    @property
    def promised(self) -> float:
        """The same, were the step taken that the fit has not taken."""
        return self._added(self.fit.cost * (1.0 - self.fit.unfinished))

    def _added(self, cost: float) -> float:
        return sqrt(max(cost - self.cost_alone, 0.0) / self.missed.n_judged)

    @property
    def noise(self) -> float:
        """What that may be of noise, as well as it is known: what impacts make of the force's strays in one record."""
        return max(NOISE_REACHED, 1.0 + STRAYS * self.missed.strays)

    @cached_property
    def rows(self) -> tuple[RecordScore, ...]:
        """Errors of those missed."""
        return score(self.missed, self.fit.hypothesis).records

    @property
    def explains(self) -> bool:
        """Whether those missed are met, and those learnt from still are."""
        still = self.fit.residual[: self.learnt.n_data]
        reached = float(still @ still) <= NOISE_REACHED**2 * self.learnt.n_judged
        return reached and self.left <= self.noise and all(is_met(row) for row in self.rows)

    @property
    def refutes(self) -> bool:
        """Whether a fit that has not gone astray promises more than noise and than two ways to compute the same rig."""
        found = max(row.nrmse for row in self.rows) <= ASTRAY
        return found and self.promised > self.noise and max(beyond_noise(row) for row in self.rows) > MODELS_APART
