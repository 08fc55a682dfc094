"""Records kept aside: whether what was learnt holds on what no fit has seen."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import inf, sqrt

import numpy as np

from identification.assess import score, with_starts
from identification.calibrate import calibrate, unknowns_of
from identification.evaluate import Evaluator
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.noise_left import noise_left, with_noise
from identification.prepare import cut_to, horizons, prepare, resolved
from identification.reached import ERROR_REACHED, MODELS_APART, NOISE_REACHED
from identification.result import FrfScore, ModesScore, RecordScore, Score
from identification.session import LAST_ITERATIONS, Session
from models.record import AnyRecord


@dataclass(frozen=True, eq=False)
class KeptAside:
    """What the updated model is worth on data that it has not seen.

    Attributes:
        scores: over whole records, ``as given`` and ``updated``; empty where nothing was kept or one of them runs away.
        missed: record on which what was learnt does not hold -> a sentence that says so.
        followed: the records, each as far as neighbouring motions stay together, and the model with the states that
            they begin in; None where nothing was kept or a motion is lost.
        left: residual over noise that remains of those missed where the model's numbers may be others, as long as these
            explain what was learnt from as well; None where that was not asked or not told (``with_other_numbers``).
    """

    scores: Mapping[str, Score] = field(default_factory=dict)
    missed: Mapping[str, str] = field(default_factory=dict)
    followed: tuple[Evaluator, Hypothesis] | None = None
    left: float | None = None

    @property
    def holds(self) -> bool:
        """Whether the model holds there, with the numbers that were learnt or with others."""
        return not self.missed or (self.left is not None and self.left <= NOISE_REACHED)


def kept_aside(session: Session, given: Hypothesis, updated: Hypothesis, records: Sequence[AnyRecord]) -> KeptAside:
    """Predict the records kept aside, and say of each whether what was learnt holds there.

    A record is judged as far as neighbouring motions stay together: beyond, no model predicts it.

    Args:
        session: is told what is decided.
        given: the rig as its owner describes it.
        updated: the model that stands.
        records: of any kind.
    """
    if not records:
        return KeptAside()
    session.progress(f"predicting {len(records)} records kept aside")
    try:
        evaluator, known = _prepared(session, updated, records)
        scores = {"updated": score(evaluator, known)}
        followed = cut_to(evaluator, inf, horizons(evaluator, known))
        judged = _judged(evaluator, followed, known)
    except ArithmeticError:
        return KeptAside(missed=_one_by_one(session, updated, records))
    try:
        scores = {"as given": score(evaluator, with_starts(evaluator, given)), **scores}
    except ArithmeticError as lost:
        session.decide(f"the rig as given does not predict what was kept aside: {lost}")
        scores = {}
    for _, told, _ in judged:
        session.decide(told)
    return KeptAside(scores, {name: told for name, told, holds in judged if not holds}, (followed, known))


def with_other_numbers(session: Session, last: Fit, kept: KeptAside) -> KeptAside:
    """Whether a model that misses a record kept aside lacks something, or is only not told well enough.

    What is added to chi-square where the records it misses are fitted beside the others is their distance from what
    was predicted in units of noise and of what is not told of the numbers together, as far as the model is linear
    about them; unlike that distance it also tells of numbers farther off. These fits are asked for that alone: the
    numbers of the model stay those that were learnt without the records kept aside.

    Args:
        session: records learnt from; told.
        last: the model fitted to all of them.
        kept: what it is worth on the others; returned as it is where the model holds there, where a motion is lost,
            where it does not reach the noise of what it was fitted to, and where so much is left that the fit may have
            gone astray.
    """
    if not kept.missed or kept.followed is None or last.ratio > NOISE_REACHED:
        return kept
    evaluator, known = kept.followed
    followed = evaluator.with_targets([each for each in evaluator.targets if each.record.name in kept.missed])
    learnt = session.all_predicted
    both = resolved(learnt.with_targets([*learnt.targets, *followed.targets]), known)
    names = " and ".join(kept.missed)
    session.progress(f"looking for numbers that explain {names} too, on {both.extent}")
    left, nearest = inf, known
    for together in _fits_of(both, known):
        more = sqrt(max(together.cost - last.cost, 0.0) / (together.n_data - last.n_data))
        left, nearest = min((left, nearest), (more, together.hypothesis), key=lambda pair: pair[0])
        if left <= NOISE_REACHED:
            break
    asked = replace(kept, left=left)
    if asked.holds:
        words = "with other numbers the same model explains it as well as what was learnt from"
        session.decide(f"{names}: {words}")
        return replace(asked, missed={name: f"{told}, but {words}" for name, told in kept.missed.items()})
    if left == inf or score(followed, nearest).nrmse > FAR_FROM_MOTION:
        session.decide(
            f"no numbers were found that explain {names} too, but so much is left that they may be elsewhere"
        )
        return kept
    session.decide(f"whatever its numbers, the model leaves {left:.2f} times the noise of {names}")
    return asked


def _fits_of(both: Evaluator, known: Hypothesis) -> Iterator[Fit]:
    """The model fitted to all records from where it is, and from numbers found on ever more of them.

    Far off, whole records have many valleys.
    """
    unknowns = (*unknowns_of(known, both), *effect_unknowns(known))
    with suppress(ArithmeticError):
        yield fit_to_its_end(both, known, unknowns, LAST_ITERATIONS)
    with suppress(ArithmeticError):
        yield fit_to_its_end(both, calibrate(both, known, unknowns).hypothesis, unknowns, LAST_ITERATIONS)


def _prepared(session: Session, updated: Hypothesis, records: Sequence[AnyRecord]) -> tuple[Evaluator, Hypothesis]:
    """The records with the noise that the updated model leaves, and that model with the states they begin in."""
    rng = np.random.default_rng(session.seed)
    evaluator = prepare(updated, records, session.everything.jobs, rng)
    known = with_starts(evaluator, updated)
    residual = evaluator.residuals([(known, None)])[0]
    if residual is not None:
        evaluator = with_noise(evaluator, noise_left(evaluator, residual), known, rng)
    return evaluator, known


def _one_by_one(session: Session, updated: Hypothesis, records: Sequence[AnyRecord]) -> dict[str, str]:
    """Where the model's motion is lost in some record: of each on which it does not hold, a sentence that says so."""
    missed: dict[str, str] = {}
    for record in records:
        try:
            evaluator, known = _prepared(session, updated, [record])
            (row,) = _judged(evaluator, cut_to(evaluator, inf, horizons(evaluator, known)), known)
        except ArithmeticError as lost:
            words = f"{_model(updated)} does not predict {record.name}, kept aside; what was learnt does not hold there"
            row = record.name, f"{words}: {lost}", False
        name, told, holds = row
        session.decide(told)
        if not holds:
            missed[name] = told
    if len(records) > 1:
        session.decide("no error over all records kept aside is told, since the motion is lost in one of them")
    return missed


def _judged(whole: Evaluator, followed: Evaluator, known: Hypothesis) -> list[tuple[str, str, bool]]:
    """Of each record its name, what the model leaves there, in words, and whether noise and its error explain it."""
    durations = {target.record.name: target.record.duration for target in whole.timed}
    scores = score(followed, known)
    return [_in_words(row, durations, _model(known)) for row in (*scores.records, *scores.at_rest)]


def _model(known: Hypothesis) -> str:
    return "the updated model" if known.effects else "the calibrated model"


def _in_words(
    row: RecordScore | FrfScore | ModesScore, durations: Mapping[str, float], model: str
) -> tuple[str, str, bool]:
    name = row.record.name
    beyond = sqrt(max(row.nrmse**2 - row.noise_nrmse**2, 0.0))
    holds = row.nrmse <= ERROR_REACHED * row.noise_nrmse or beyond <= MODELS_APART
    part = ""
    if isinstance(row, RecordScore) and row.record.duration < CUT_SHORT * durations[name]:
        part = f" in its first {row.record.duration:.3g} s, beyond which no model can follow it"
    verdict = f"what was learnt {'holds' if holds else 'does not hold'} there"
    times = row.nrmse / max(row.noise_nrmse, np.finfo(float).tiny)
    return name, f"on {name}, kept aside, {model} leaves {times:.3g} times the noise{part}: {verdict}", holds


FAR_FROM_MOTION = 0.1
"""Error of a record kept aside, as a share of its motion, above which a fit may have stopped in another valley: begun
with a stiffness 2.4 times too large, a loud record of an oscillator was left with all of it."""

CUT_SHORT = 0.95
"""Share of a record that is worth a word where no more of it can be followed: its last samples never are judged."""
