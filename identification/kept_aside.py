"""Records kept aside: whether what was learnt holds on what no fit has seen."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, sqrt

import numpy as np

from identification.assess import score, with_starts
from identification.draws import drawn
from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.noise_left import noise_left, with_noise
from identification.prepare import cut_to, horizons, prepare
from identification.reached import ERROR_REACHED, MODELS_APART, NOISE_REACHED
from identification.result import AnyScore, RecordScore, Score
from identification.session import CLEARLY_LESS, Session
from models.record import AnyRecord


@dataclass(frozen=True, eq=False)
class Followed:
    """Records kept aside, each as far as neighbouring motions stay together.

    Attributes:
        heard: with the noise that the updated model leaves.
        as_told: with the noise that they tell by themselves, which may be too high.
        known: the updated model with the states that they begin in.
    """

    heard: Evaluator
    as_told: Evaluator
    known: Hypothesis


@dataclass(frozen=True, eq=False)
class KeptAside:
    """What the updated model is worth on data that it has not seen.

    Attributes:
        scores: over whole records, ``as given`` and ``updated``; empty where nothing was kept or one of them runs away.
        missed: record on which what was learnt does not hold -> a sentence that says so.
        followed: the records; None where nothing was kept or a motion is lost.
        explained: whether other numbers of the model explain those missed beside what was learnt from; None where that
            was not asked or not told (``other_numbers``).
    """

    scores: Mapping[str, Score] = field(default_factory=dict)
    missed: Mapping[str, str] = field(default_factory=dict)
    followed: Followed | None = None
    explained: bool | None = None

    @property
    def holds(self) -> bool:
        """Whether the model holds there, with the numbers that were learnt or with others."""
        return not self.missed or self.explained is True


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
        evaluator, followed = _followed(session, updated, records)
        scores = {"updated": score(evaluator, followed.known)}
        judged = _judged(session, evaluator, followed)
    except ArithmeticError:
        return KeptAside(missed=_one_by_one(session, updated, records))
    try:
        scores = {"as given": score(evaluator, with_starts(evaluator, given)), **scores}
    except ArithmeticError as lost:
        session.decide(f"the rig as given does not predict what was kept aside: {lost}")
        scores = {}
    for _, told, _ in judged:
        session.decide(told)
    return KeptAside(scores, {name: told for name, told, holds in judged if not holds}, followed)


def predicted(session: Session, records: Sequence[AnyRecord], bare: Hypothesis, updated: Hypothesis) -> bool:
    """Whether a model predicts all records kept aside to their noise, and they show what it has found.

    What cannot be followed nearly to its end shows little, and what the model meets without its effects nothing.

    Args:
        session: for its resolution and the seed of the noise.
        records: of any kind; where none is motion over time, nothing is predicted.
        bare: the calibrated model, which has no effects.
        updated: the model.
    """
    if not records:
        return False
    try:
        evaluator, followed = _followed(session, updated, records)
        scores = score(followed.heard, followed.known)
    except ArithmeticError:
        return False
    seconds, whole = (sum(target.record.duration for target in each.timed) for each in (followed.heard, evaluator))
    if not evaluator.timed or seconds < CLEARLY_LESS * whole:
        return False
    met = all(row.nrmse <= NOISE_REACHED * row.noise_nrmse for row in scores.rows)
    return met and not _is_met_by(followed.heard, bare)


def holds_on(session: Session, records: Sequence[AnyRecord], model: Hypothesis) -> bool:
    """Whether a model holds on records kept aside, each as far as it follows them.

    Args:
        session: for its resolution and the seed of the noise.
        records: of any kind.
        model: fitted to others.
    """
    try:
        whole, followed = _followed(session, model, records)
        return all(holds for _, _, holds in _judged(session, whole, followed))
    except ArithmeticError:
        return False


def left_of(kept: KeptAside, model: Hypothesis) -> float:
    """What a model leaves beyond the noise of the records that another misses, as far as that one is followed.

    Args:
        kept: of the other, which follows them.
        model: fitted to what was learnt from.

    Returns:
        the sum of squares, each as a share of the motion; infinite where the motion is lost.
    """
    assert kept.followed is not None
    heard = kept.followed.heard
    heard = heard.with_targets([target for target in heard.targets if target.record.name in kept.missed])
    try:
        scores = score(heard, with_starts(heard, model))
    except ArithmeticError:
        return inf
    return sum(beyond_noise(row) ** 2 for row in scores.rows)


def _is_met_by(followed: Evaluator, model: Hypothesis) -> bool:
    """Whether a model holds on records as far as they are followed."""
    try:
        return all(is_met(row) for row in score(followed, with_starts(followed, model)).records)
    except ArithmeticError:
        return False


def _followed(session: Session, updated: Hypothesis, records: Sequence[AnyRecord]) -> tuple[Evaluator, Followed]:
    """The records whole, and as far as they are followed.

    Raises:
        ArithmeticError: a motion is lost.
    """
    evaluator, as_told, known = _prepared(session, updated, records)
    limits = horizons(evaluator, known)
    return evaluator, Followed(cut_to(evaluator, inf, limits), cut_to(as_told, inf, limits), known)


def _prepared(
    session: Session, updated: Hypothesis, records: Sequence[AnyRecord]
) -> tuple[Evaluator, Evaluator, Hypothesis]:
    """The records with the noise that the updated model leaves, the same with their own, and it with their states."""
    rng = np.random.default_rng(session.seed)
    as_told = prepare(updated, records, session.everything.jobs, rng).with_settings(session.everything.settings)
    known = with_starts(as_told, updated)
    residual = as_told.residuals([(known, None)])[0]
    if residual is None:
        return as_told, as_told, known
    return with_noise(as_told, noise_left(as_told, residual), known, rng), as_told, known


def _one_by_one(session: Session, updated: Hypothesis, records: Sequence[AnyRecord]) -> dict[str, str]:
    """Where the model's motion is lost in some record: of each on which it does not hold, a sentence that says so."""
    missed: dict[str, str] = {}
    for record in records:
        try:
            (row,) = _judged(session, *_followed(session, updated, [record]))
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


def _judged(session: Session, whole: Evaluator, followed: Followed) -> list[tuple[str, str, bool]]:
    """Of each record its name, what the model leaves there, in words, and whether noise and its error explain it."""
    durations = {target.record.name: target.record.duration for target in whole.timed}
    rows = score(followed.heard, followed.known).rows
    may_be = _may_be_noise(session, followed, rows)
    return [_in_words(row, durations, _model(followed.known), may_be) for row in rows]


def _may_be_noise(session: Session, followed: Followed, rows: Sequence[AnyScore]) -> set[str]:
    """Names of the time records not met of which no more is left than the force's noise may leave of one record.

    Neither of the error, to which a few loud lines add most, nor line by line.
    """
    unmet = {row.record.name: row.nrmse for row in rows if isinstance(row, RecordScore) and not is_met(row)}
    if not unmet:
        return set()
    heard = followed.heard.with_targets([t for t in followed.heard.timed if t.record.name in unmet])
    residual = heard.residuals([(followed.known, None)])[0]
    if residual is None:
        return set()
    try:
        draws = drawn(heard, followed.known, session.seed)
    except ArithmeticError:  # some noise would take the motion out of the finite numbers: nothing is excused by it
        return set()
    may_be = set[str]()
    for target, part in heard.parts_of(residual):
        noise = draws[target.record.name]
        ratio = sqrt(float(part @ part) / noise.n_judged)
        if unmet[target.record.name] <= noise.nrmse.max() and ratio <= noise.ratio.max():
            may_be.add(target.record.name)
    return may_be


def is_met(row: AnyScore) -> bool:
    """Whether noise, or what two ways to compute the same rig differ by, is all that a model leaves of a record.

    Args:
        row: its errors.
    """
    return row.nrmse <= ERROR_REACHED * row.noise_nrmse or beyond_noise(row) <= MODELS_APART


def beyond_noise(row: AnyScore) -> float:
    """What a model misses of a record beyond the noise, as a share of the motion.

    Args:
        row: its errors.
    """
    return sqrt(max(row.nrmse**2 - row.noise_nrmse**2, 0.0))


def _model(known: Hypothesis) -> str:
    return "the updated model" if known.effects else "the calibrated model"


def _in_words(
    row: AnyScore, durations: Mapping[str, float], model: str, may_be_noise: Collection[str]
) -> tuple[str, str, bool]:
    name = row.record.name
    holds, part = is_met(row) or name in may_be_noise, ""
    if isinstance(row, RecordScore) and row.record.duration < CUT_SHORT * durations[name]:
        part = f" in its first {row.record.duration:.3g} s, beyond which no model can follow it"
    if name in may_be_noise:
        part += ", no more than the force's noise may leave of one record"
    verdict = f"what was learnt {'holds' if holds else 'does not hold'} there"
    times = row.nrmse / max(row.noise_nrmse, np.finfo(float).tiny)
    return name, f"on {name}, kept aside, {model} leaves {times:.3g} times the noise{part}: {verdict}", holds


CUT_SHORT = 0.95
"""Share of a record that is worth a word where no more of it can be followed: its last samples never are judged."""
