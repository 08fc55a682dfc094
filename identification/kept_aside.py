"""Records kept aside: whether what was learnt holds on what no fit has seen."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, sqrt

import numpy as np

from identification.assess import score, with_starts
from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.noise_left import noise_left, with_noise
from identification.prepare import cut_to, horizons, prepare
from identification.reached import ERROR_REACHED, MODELS_APART
from identification.result import FrfScore, ModesScore, RecordScore, Score
from identification.session import Session
from models.record import AnyRecord


@dataclass(frozen=True, eq=False)
class KeptAside:
    """What the updated model is worth on data that it has not seen.

    Attributes:
        scores: over whole records, ``as given`` and ``updated``; empty where nothing was kept or one of them runs away.
        missed: record on which what was learnt does not hold -> a sentence that says so.
    """

    scores: Mapping[str, Score] = field(default_factory=dict)
    missed: Mapping[str, str] = field(default_factory=dict)


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
        judged = _judged(evaluator, known)
    except ArithmeticError:
        return KeptAside(missed=_one_by_one(session, updated, records))
    try:
        scores = {"as given": score(evaluator, with_starts(evaluator, given)), **scores}
    except ArithmeticError as lost:
        session.decide(f"the rig as given does not predict what was kept aside: {lost}")
        scores = {}
    for _, told, _ in judged:
        session.decide(told)
    return KeptAside(scores, {name: told for name, told, holds in judged if not holds})


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
            (row,) = _judged(*_prepared(session, updated, [record]))
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


def _judged(evaluator: Evaluator, known: Hypothesis) -> list[tuple[str, str, bool]]:
    """Of each record its name, what the model leaves there, in words, and whether noise and its error explain it."""
    limits = horizons(evaluator, known)
    durations = {target.record.name: target.record.duration for target in evaluator.timed}
    followed = score(cut_to(evaluator, inf, limits), known)
    return [_in_words(row, durations, _model(known)) for row in (*followed.records, *followed.at_rest)]


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


CUT_SHORT = 0.95
"""Share of a record that is worth a word where no more of it can be followed: its last samples never are judged."""
