"""What one diagnosis works with: records, noise and resolution, which get finer as the model gets better."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, sqrt
from time import perf_counter

import numpy as np

from identification.assess import score
from identification.calibrate import all_unknowns, strained
from identification.consistency.find import pushed_out
from identification.evaluate import Evaluator, Target, TimeTarget, carry_noise
from identification.fit import Fit, fit, fit_to_its_end
from identification.hypothesis import EffectUnknown, Hypothesis, effect_unknowns, rig_unknowns
from identification.last_answer import LastAnswer
from identification.pieces import Piece, pieces_of
from identification.prepare import LEAST_TORN, Horizon, cut_to, horizons, resolved
from identification.progress import Progress
from identification.reached import NOISE_REACHED, reaches_noise, tells_much
from identification.result import Stage
from models.effects import Registry
from models.rig import Rig
from models.simulate import Settings

LENGTHENED = 1.2
"""Times the seconds of the fit before, so that the values of a table in time are told one after the other: where a
damping falls to a fortieth within 4 s, a step of half as much more ended at 3.4 times the noise."""

SEARCH_SHARE = 0.25
"""Share of what the model leaves that coarse steps are weighed against in the search, as the noise is in the fits."""

MOST_COARSE = 2.0
"""Times the noise, up to where that share is taken: suspects that come near the noise must still be told apart."""

CLEARLY_LESS = 0.8
"""Share of the seconds that were fitted, or measured, below which those that are predicted are clearly less."""

CLEARLY_LOUDER = 1.05
"""Times the noise so far; less would change no verdict."""

DRAWN_RIGS = 6
"""Within the tolerances, whose trembling at a noisy force is asked for beside the given rig's."""

REALISATIONS = 16
"""Of noise that impacts amplify: where it is large, four tell its power to a third only."""

COARSEST = 2
"""Steps per sample of the search at least; the model's own choice is finer."""


NOT_AT_A_PLACE = ("time", "measurement")
"""Families of which none is tried only because it could sit where another does."""


@dataclass
class Session:
    """Records, noise and resolution of one diagnosis, and what was decided.

    Attributes:
        everything: whole records.
        fitting: the parts that are used to fit.
        limits: how far each record can be predicted.
        registry: kinds of effects to consider.
        progress: told in words what is done and decided.
        seed: of the realisations of the excitation's noise.
        decisions: in order.
        relearnt: whether the noise was lowered on the way.
        pieces: of records past where they can be followed from their start, which are fitted beside the beginnings.
        is_passing: whether what is left of the fitted part was found to be an event that passes.
        is_beyond: whether a law beyond the library was found to explain what is missing.
        until: by ``perf_counter``, s, when nothing more is begun.
        untried: what was not begun for want of time, in words.
    """

    everything: Evaluator
    fitting: Evaluator
    limits: list[Horizon]
    registry: Registry
    progress: Progress
    seed: int
    decisions: list[str] = field(default_factory=list)
    relearnt: bool = False
    is_passing: bool = False
    is_beyond: bool = False
    pieces: tuple[Piece, ...] = ()
    until: float = inf
    untried: list[str] = field(default_factory=list)
    _ended: LastAnswer[Fit] = field(default_factory=LastAnswer)
    _out: LastAnswer[bool] = field(default_factory=LastAnswer)
    _carried: LastAnswer[Evaluator] = field(default_factory=LastAnswer)
    _held: LastAnswer[bool] = field(default_factory=LastAnswer)

    def __post_init__(self) -> None:
        self._as_given = self.everything

    def stage(self, label: str, hypothesis: Hypothesis) -> Stage:
        """A model on the way, with its errors on whole records, told.

        Args:
            label: what to call it.
            hypothesis: the model.
        """
        stage = Stage(label, hypothesis, score(self.everything, hypothesis))
        self.progress(f"{label}: error {stage.score.nrmse:.3%}, noise floor {stage.score.noise_nrmse:.3%}")
        return stage

    def holds(self, hypothesis: Hypothesis) -> bool:
        """Whether a model's motion stays finite through whole records; what was fitted is a part of them.

        Args:
            hypothesis: the model; the answer for the last one asked of is kept.
        """
        return self._held.about(
            self.everything, hypothesis, ask=lambda: self.everything.residuals([(hypothesis, None)])[0] is not None
        )

    def has_time_for(self, step: str) -> bool:
        """Whether another step may begin; one that may not is told.

        Args:
            step: what would be done, in words.
        """
        if perf_counter() < self.until:
            return True
        self.untried.append(f"the time given is over: {step} was not begun")
        self.decide(self.untried[-1])
        return False

    def decide(self, text: str) -> None:
        """Keep and tell a decision."""
        self.decisions.append(text)
        self.progress(text)

    def resolve(self, result: Fit) -> Fit:
        """The fit again with smaller steps, if those it used were too coarse for the noise."""
        finer = resolved(self.fitting, result.hypothesis)
        if finer.settings == self.fitting.settings:
            return result
        self.fitting, self.everything = finer, self.everything.with_settings(finer.settings)
        self.decide(f"steps {finer.settings.times} times as short: longer ones stood above the noise")
        return fit(finer, result.hypothesis, result.unknowns, precise=True)

    def parts_of(self, everything: Evaluator) -> Evaluator:
        """What is fitted, of whole records with another noise.

        Args:
            everything: the same records.
        """
        whole = {target.record.name: target for target in everything.timed}
        parts = [
            part.heard_as(whole[part.whole_name])
            if isinstance(part, Piece)
            else whole[part.record.name].cut(part.record.n_samples)
            for part in self.fitting.timed
        ]
        return self.fitting.with_targets([*self.fitting.at_rest, *parts])

    def carried_by(self, hypothesis: Hypothesis) -> Evaluator:
        """All records with the excitation's noise as a model carries it; that of the last one asked for is kept.

        Args:
            hypothesis: the model.
        """

        def carried() -> Evaluator:
            rng = np.random.default_rng(self.seed)
            return self.everything.with_targets(carry_noise(self.everything, hypothesis, rng, REALISATIONS))

        return self._carried.about(self.everything, hypothesis, ask=carried)

    def quieter(self, others: Sequence[Target]) -> Evaluator:
        """All records, each with the noise that leaves less of it.

        Args:
            others: the same with other noise.
        """
        pairs = zip(self.everything.targets, others, strict=True)
        return self.everything.with_targets([min(pair, key=lambda target: target.nrmse_of_noise) for pair in pairs])

    def to_the_end(self, result: Fit) -> Fit:
        """A fit of everything that can be predicted: in a flat valley intervals are right only at its bottom.

        Args:
            result: on a part of the records; that of the last one asked for is kept.
        """

        def ended() -> Fit:
            self._foresee(result.hypothesis)
            return self._fit_with_tables(result)

        return self._ended.about(self.everything, result, ask=ended)

    def fit_of_all(self, hypothesis: Hypothesis, like: Fit | None = None) -> Fit:
        """A model fitted with all its numbers to everything that can be predicted.

        Args:
            hypothesis: where the fit begins.
            like: a fit nearby to a part of it.

        Raises:
            ArithmeticError: the model diverges.
        """
        whole = self.all_predicted
        self.progress(f"fit on all {whole.extent}")
        return fit_to_its_end(whole, hypothesis, all_unknowns(hypothesis, whole), like=like)

    def _fit_with_tables(self, result: Fit) -> Fit:
        """The fit of all, with tables in more detail as long as that tells much: a part may hide what they take.

        The coarsest that does is taken: a finer one holds it, and is as near whatever is there.
        """
        begun = result.hypothesis
        found = self.fit_of_all(self.told_later(begun), result)
        while found.ratio > NOISE_REACHED:
            for then in self._finer(begun):
                finer = self.fit_of_all(self.told_later(then))
                if tells_much(found, finer):
                    found, begun = finer, then
                    break
            else:
                break
        return found

    @staticmethod
    def _finer(model: Hypothesis) -> list[Hypothesis]:
        """The model with one of its effects in more detail each, the least first."""
        finer = [(k, i, each) for i, effect in enumerate(model.effects) for k, each in enumerate(effect.refined())]
        return [model.with_effect_at(i, each) for _, i, each in sorted(finer, key=lambda row: row[:2])]

    def told_later(self, hypothesis: Hypothesis) -> Hypothesis:
        """A model whose tables in time are fitted to ever more of the records: later values were told by none so far.

        From values that may be anything a fit of whole records ends in another valley.

        Args:
            hypothesis: fitted to a part of the records; returned as it is where it has no table.
        """
        if not any(u.about.table for u in effect_unknowns(hypothesis) if isinstance(u, EffectUnknown)):
            return hypothesis
        seconds, whole = max(self._fitted_seconds.values(), default=inf), cut_to(self.everything, inf, self.limits)
        while True:
            seconds *= LENGTHENED
            limits = [replace(limit, seconds=min(limit.seconds, seconds)) for limit in self.limits]
            longer = cut_to(self.everything, inf, limits)
            if longer.n_data == whole.n_data:
                return hypothesis
            self.progress(f"following its table over {longer.extent}")
            try:
                found = fit_to_its_end(longer, hypothesis, all_unknowns(hypothesis, longer))
            except ArithmeticError:
                return hypothesis
            hypothesis = found.hypothesis

    def left_tolerance(self, calibrated: Fit) -> bool:
        """Whether a number had to leave its tolerance, further than the noise of the measured force explains.

        Args:
            calibrated: the model without effects.
        """

        def out() -> bool:
            at_end = strained(calibrated)
            out = pushed_out(self.fitting, calibrated, np.random.default_rng(self.seed))
            pardoned = ", ".join(unknown.parameter.label for unknown in at_end if unknown not in out)
            if pardoned and calibrated.ratio <= NOISE_REACHED:
                self.progress(
                    f"{pardoned}: no further out than the tolerance and the force's noise together put it here"
                )
            return bool(out)

        return self._out.about(calibrated, ask=out)

    def _foresee(self, hypothesis: Hypothesis) -> None:
        """Shorten what is used of the records to what this model predicts, which may part from its neighbours sooner.

        Past that the residual follows no slope: a fit ends in one of many pits there, and calls its walls an interval.
        What was fitted already was followed.
        """
        self._limit(_no_less(horizons(self.everything, hypothesis), self._fitted_seconds))
        if self.pieces:
            self.pieces = self.pieces_by(hypothesis) or self.pieces

    def pieces_by(self, hypothesis: Hypothesis) -> tuple[Piece, ...]:
        """What a model can follow of the records past where it loses them; none where it is lost at once.

        Args:
            hypothesis: the model.
        """
        rng = np.random.default_rng(self.seed)
        try:
            return pieces_of(self.everything, hypothesis, self.limits, CLEARLY_LESS, rng)
        except ArithmeticError:
            return ()

    def follow(self, pieces: tuple[Piece, ...]) -> bool:
        """Whether there are pieces; they are fitted from now on beside the beginnings that are.

        Args:
            pieces: instead of those so far.
        """
        if not pieces:
            return False
        seconds = sum(piece.record.duration for piece in pieces)
        self.progress(f"{seconds:.1f} s more are followed in {len(pieces)} pieces, each from a start of its own")
        self.pieces, self.is_passing = pieces, False
        self.fitting = self.fitting.with_targets([*self.without_pieces.targets, *pieces])
        return True

    @property
    def without_pieces(self) -> Evaluator:
        """What is fitted but for pieces."""
        return self.fitting.with_targets([each for each in self.fitting.targets if not isinstance(each, Piece)])

    def as_it_is(self) -> "Session":
        """The same, to come ``back_to``."""
        return replace(self, limits=[*self.limits])

    def back_to(self, before: "Session") -> None:
        """What is fitted, its noise and how far records are followed as they were; what was decided since stays told.

        Args:
            before: of this session.
        """
        self.everything, self.fitting, self.limits = before.everything, before.fitting, before.limits
        self.relearnt, self.pieces = before.relearnt, before.pieces
        self.is_passing, self.is_beyond = before.is_passing, before.is_beyond

    def shorten_to(self, hypothesis: Hypothesis) -> bool:
        """Fit no more of any record from now on than this model predicts, if that is clearly less; whether it is.

        Where the force's noise tears nothing apart, what was fitted already can be followed, however near motions part.

        Args:
            hypothesis: that explains the beginning and, fitted, no more.
        """
        before = self._fitted_seconds
        try:
            found = horizons(self.everything, hypothesis)
        except ArithmeticError:  # beyond the beginning nothing holds it
            return False
        found = _no_less(found, {limit.record: before[limit.record] for limit in found if limit.torn < LEAST_TORN})
        now = {limit.record: min(limit.seconds, before[limit.record]) for limit in found}
        if all(now[name] > CLEARLY_LESS * seconds for name, seconds in before.items()):
            return False
        self._limit(found)
        short = cut_to(self.everything, sum(now.values()), self.limits)
        self.fitting = short.with_targets([*short.targets, *self.pieces])
        return True

    @property
    def _fitted_seconds(self) -> dict[str, float]:
        """Of each time record, from its start on."""
        return {t.record.name: t.record.duration for t in self.fitting.timed if not isinstance(t, Piece)}

    def _limit(self, found: Sequence[Horizon]) -> None:
        """Use no more of each record than is found."""
        for index, (old, new) in enumerate(zip(self.limits, found, strict=True)):
            if new.seconds < old.seconds:
                self.limits[index] = new
                self.decide(f"{new.in_words}, by the model that explains the beginning")

    @property
    def all_predicted(self) -> Evaluator:
        """All records, each as far as it can be predicted, and what can be followed of them after that."""
        from_start = cut_to(self.everything, inf, self.limits)
        return from_start.with_targets([*from_start.targets, *self.pieces])

    @property
    def not_followed(self) -> str:
        """That clearly less of the time records can be predicted than was measured; empty where all of it can."""
        used, whole = (sum(target.record.duration for target in e.timed) for e in (self.all_predicted, self.everything))
        if used >= CLEARLY_LESS * whole:
            return ""
        return f"; only {used:.1f} of {whole:.1f} s of records can be followed, and what shows later is not excluded"

    def lengthen(self, result: Fit) -> bool:
        """Fit on everything from now on, where the part used so far is explained and the whole is not.

        Args:
            result: that explains the part, and so carries the force's noise better than what lacks its effects.
        """
        ended, whole = self.to_the_end(result), self.all_predicted
        if ended.n_data <= result.n_data or reaches_noise(whole, ended) or self._is_noise_of(ended, result):
            return False
        self.decide(
            f"{self.fitting.extent} are explained, all {whole.extent} not: residual {ended.ratio:.2f} times the noise; "
            "all are used from here on"
        )
        self.fitting = whole
        return True

    def _is_noise_of(self, ended: Fit, result: Fit) -> bool:
        """Whether what is left of everything is the force's noise as this model carries it; that counts from now on.

        No more of it than the rig may carry: a model that trembles at anything would excuse itself.
        """
        carried = carry_noise(self.everything, ended.hypothesis, np.random.default_rng(self.seed))
        least = CLEARLY_LOUDER * self.everything.nrmse_of_noise
        if self.everything.with_targets(carried).nrmse_of_noise <= least:  # told before rigs are drawn
            return False
        pairs = zip(carried, self._carried_by_rigs(ended.hypothesis), strict=True)
        louder = self.everything.with_targets([_quieter(*pair) for pair in pairs])
        if louder.nrmse_of_noise <= least:
            return False
        before, self.everything = self.everything, louder
        again = self.fit_of_all(ended.hypothesis, ended)
        if not reaches_noise(self.all_predicted, again):
            self.everything = before
            return False
        self._ended.keep(louder, result, answer=again)
        self.decide(
            f"the force's noise, as this model carries it, leaves {louder.nrmse_of_noise:.2%} instead of "
            f"{before.nrmse_of_noise:.2%}: all {self.all_predicted.extent} are explained"
        )
        return True

    def _carried_by_rigs(self, hypothesis: Hypothesis) -> list[Target]:
        """Each record with the excitation's noise as the loudest of a few rigs within the tolerances carries it.

        One rig whose sleeves are struck a little sooner tears motions apart that the given one keeps together.

        Args:
            hypothesis: with the numbers of the records' own.
        """
        rng, most = np.random.default_rng(self.seed), list(self._as_given.targets)
        for _ in range(DRAWN_RIGS):
            rig = replace(hypothesis, effects=())
            for unknown in rig_unknowns(rig.rig):
                rig = unknown.set(rig, rng.standard_normal())
            try:
                drawn = carry_noise(self.everything, rig, rng)
            except ArithmeticError:  # it runs away
                continue
            most = [max(pair, key=lambda target: target.nrmse_of_noise) for pair in zip(most, drawn, strict=True)]
        return most

    def kinds_at_a_place(self, rig: Rig) -> Registry:
        """Kinds that may stand in another's place: not those that act over whole records, or on channels.

        Args:
            rig: whose structure they must be able to sit on.
        """
        return self.kinds_on(rig, but=NOT_AT_A_PLACE)

    def kinds_on(self, rig: Rig, but: Collection[str] = ()) -> Registry:
        """Kinds that can sit on a rig's structure.

        Args:
            rig: with the structure.
            but: families that are left out.
        """
        structure = rig.structure.kind
        return {n: k for n, k in self.registry.items() if structure in k.structures and k.family not in but}

    def searching(self, base: Fit) -> Evaluator:
        """All records at the resolution at which suspects are looked for: what the model misses hides coarser steps.

        Args:
            base: the model that suspects are added to.
        """
        misfit = min(SEARCH_SHARE * base.ratio, MOST_COARSE)
        coarse = self.fitting.with_settings(Settings(self.fitting.settings.n_modes, COARSEST))
        if resolved(coarse, base.hypothesis, misfit) is not coarse:
            coarse = resolved(
                self.fitting.with_settings(Settings(self.fitting.settings.n_modes)), base.hypothesis, misfit
            )
        return self.everything.with_settings(coarse.settings)


def _quieter(now: Target, loudest: Target) -> Target:
    """A target with the excitation's noise that it has, scaled down to the power of another's where it has more."""
    if not (isinstance(now, TimeTarget) and isinstance(loudest, TimeTarget)):
        return now
    most, own, sensors = (t.nrmse_of_noise**2 for t in (loudest, now, now.with_noise(now.noise)))
    return now if own <= most else now.with_carried(sqrt(max(0.0, most - sensors) / (own - sensors)) * now.carried)


def _no_less(found: Sequence[Horizon], followed: Mapping[str, float]) -> list[Horizon]:
    """Horizons, none before the seconds that a record was followed for."""
    return [replace(limit, seconds=max(limit.seconds, followed.get(limit.record, 0.0))) for limit in found]
