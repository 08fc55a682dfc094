"""The end of a diagnosis: a last fit of everything, what is left where, what was kept aside, what to measure next."""

from collections.abc import Sequence
from itertools import compress
from operator import attrgetter
from time import perf_counter

import numpy as np

from identification.carried import on_its_noise
from identification.consistency.find import beyond_models, calibration_findings
from identification.consistency.finding import CalibrationFinding
from identification.evaluate import Evaluator
from identification.evidence import (
    Ranked,
    log_standing,
    misfit_in_common,
    probabilities,
)
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from identification.intervals import corrected
from identification.kept_aside import KeptAside
from identification.locating.beside import RUN_AWAY, BesideRun, runs_beside
from identification.locating.locate import locate
from identification.locating.located import Located
from identification.maps import error_map
from identification.missing_force import forces_of
from identification.next_experiment.propose import next_experiment
from identification.outcome import (
    AT_REST_ONLY,
    added_effects,
    candidates_of,
    distinct,
    groups_of,
    rig_estimates,
    tried,
)
from identification.parallel import in_threads
from identification.places_open import in_parts
from identification.prepare import cut_to
from identification.reached import is_silenced
from identification.result import Diagnosis, Stage, Verdict
from identification.session import Session
from identification.together import wholly_off
from identification.unstrained import moved_back, unstrained
from models.effects import Effect
from models.simulate import Settings, Trace


def one_set_of_numbers(session: Session, calibrated: Fit, verdict: Verdict) -> tuple[CalibrationFinding, ...]:
    """What the calibrated model's numbers contradict, told where something is missing.

    Where nothing is, what two ways to compute the same rig differ by is no contradiction.
    """
    session.progress("holding the calibrated numbers against tolerances, records, times and modes")
    try:
        found = calibration_findings(session.fitting, calibrated, np.random.default_rng(session.seed))
    except ArithmeticError as lost:
        session.decide(f"the calibrated numbers were not held against each other: {lost}")
        return ()
    if verdict == "complete":
        return beyond_models(found, calibrated)
    if found:
        session.progress(f"{len(found)} of them contradict each other or their tolerances; told with the result")
    return found


def settled(session: Session, final: Fit) -> Fit:
    """The model that stands fitted to all records, its numbers freed of steps and their intervals of what is not known.

    Args:
        session: with the records.
        final: the model that stands, fitted to a part of them.
    """
    ended = session.to_the_end(final)
    if ended.unfinished > UNFINISHED:
        session.decide(
            f"the last fit stopped before its end: were the model linear there, a step more would take away "
            f"{ended.unfinished:.1%} of what is left; its numbers may still move by more than their intervals"
        )
    last = unstrained(session.all_predicted, ended)
    if words := moved_back(ended, last):
        session.decide(words)
    return corrected(session.all_predicted, last, np.random.default_rng(session.seed))


UNFINISHED = 0.01
"""Share of what is left that a step more promises, from which a fit is told not to have ended."""


def concluded(
    session: Session,
    stages: list[Stage],
    rounds: Sequence[Sequence[Ranked]],
    verdict: Verdict,
    final: Fit,
    polished: Fit,
    kept: KeptAside,
    seed: int,
    began: float,
) -> Diagnosis:
    """The diagnosis.

    Args:
        session: records and what was decided.
        stages: models so far.
        rounds: effects ranked in each round.
        verdict: what the end is called.
        final: the model that stands, fitted to a part of the records.
        polished: the same, on all records, with honest intervals (``settled``).
        kept: what the model that stands is worth on records kept aside.
        seed: of every random choice.
        began: when the diagnosis did, s.
    """
    if stages[-1].hypothesis is not polished.hypothesis:
        label = stages[-1].label if verdict == "missing_effect" else "calibrated"
        begun = next(i for i, stage in enumerate(stages) if stage.label == "calibrated")
        before = stages[:-1] if verdict == "missing_effect" else stages[:begun]
        stages = [*before, session.stage(label, polished.hypothesis)]
    if session.relearnt:
        stages = [session.stage(stage.label, stage.hypothesis) for stage in stages]
    calibrated = next(stage for stage in reversed(stages) if stage.label == "calibrated")
    rounds = [distinct(ranked) for ranked in rounds]
    standing_effects = len(final.hypothesis.effects)
    for i, ranked in enumerate(rounds[:standing_effects]):
        rounds[i] = in_parts(session, ranked, polished, i)
    first = rounds[0] if rounds else []
    chances = probabilities([r.log_evidence for r in first] + [_nothing(first, final)]) if first else []
    later = [(ranked, probabilities([r.log_evidence for r in ranked])) for ranked in rounds[1:] if ranked]
    weighed = [(first, chances), *later] if first else later
    standing = weighed[:standing_effects]  # rounds in which nothing was taken may follow
    groups = tuple(dict.fromkeys(group for ranked, odds in standing for group in groups_of(ranked, odds)))
    session.progress("locating the force that the calibrated model lacks")
    heard = _heard(session)
    heard, beside = _told(session, heard, runs_beside(heard, calibrated.hypothesis))
    forces = forces_of(beside)
    updated_maps = tuple(error_map(record) for record in stages[-1].score.records)
    among = tried(stages[-1].score, holds=kept.holds)
    if verdict == "missing_effect":
        stages = [*stages[:-1], on_its_noise(session, stages[-1])]
    located = _located(session, heard, calibrated.hypothesis, beside)
    proposal = next_experiment(
        session,
        verdict,
        standing,
        polished.hypothesis,
        maps=updated_maps,
        forces=forces,
        located=located,
        kept_aside=bool(kept.scores),
        missed=tuple(kept.missed),
        is_untold=is_silenced(session.fitting, final, NEXT_TO_NOTHING),
    )
    return Diagnosis(
        verdict=verdict,
        added=added_effects(polished, rounds, among),
        candidates=candidates_of(first, chances, session.fitting, among.first, calibrated.hypothesis),
        indistinguishable=groups if verdict == "missing_effect" else (),
        stages=tuple(stages),
        times_noise=polished.ratio,
        holdout=kept.scores,
        rig_estimates=rig_estimates(polished),
        where=tuple(error_map(record) for record in calibrated.score.records),
        missing_forces=forces,
        located=located,
        updated_maps=updated_maps,
        traces=_traces(session, polished.hypothesis),
        next_experiment=proposal,
        decisions=tuple(session.decisions),
        seconds=perf_counter() - began,
        seed=seed,
        findings=(
            *session.untried,
            *(f for t in session.everything.timed for f in t.record.findings),
            *(f"{t.record.name}: {AT_REST_ONLY}" for t in session.everything.at_rest),
            *wholly_off(stages[0].score),
        ),
        not_predicted=tuple(kept.missed.values()),
        candidates_beside=_others_in(first),
    )


NEXT_TO_NOTHING = 0.2
"""Share of what the noise leaves to be told of the motion, as power, below which records may be of something else."""


def _others_in(ranked: Sequence[Ranked]) -> tuple[Effect, ...]:
    """What the model of a round's best row has beside its own effect."""
    return tuple(effect for effect in ranked[0].fit.hypothesis.effects if effect != ranked[0].effect) if ranked else ()


LOCATED_SAMPLES = 150_000
"""Of all time records that locating works on at most: it holds every line beside every way in which a force may act,
some 20 kB a sample."""


def _heard(session: Session) -> Evaluator:
    """The records that a force is located in, whole unless they are very long."""
    records = [target.record for target in session.everything.timed]
    share = LOCATED_SAMPLES / max(1, sum(record.n_samples for record in records))
    if share >= 1.0:
        return session.everything
    heard = cut_to(session.everything, share * sum(record.duration for record in records), session.limits)
    session.decide(f"a missing force is located in {heard.extent}: more would not fit into the memory")
    return heard


def _told(session: Session, heard: Evaluator, runs: Sequence[BesideRun]) -> tuple[Evaluator, list[BesideRun]]:
    """The records that a missing force can be told from, and their runs; told where one is left out."""
    told = list(compress(runs, in_threads(heard.jobs, attrgetter("is_told"), runs)))
    lost = [run.record.name for run in runs if run not in told]
    if lost:
        session.decide(
            f"no missing force is told from {' and '.join(lost)}: the calibrated model is so far off there that the "
            f"force that explains it would move the rig more than {RUN_AWAY:g} times as far"
        )
    return heard.with_targets([*(run.target for run in told), *heard.at_rest]), told


def _located(session: Session, heard: Evaluator, hypothesis: Hypothesis, beside: Sequence[BesideRun]) -> Located | None:
    """Where the missing force acts; a model that its own numbers bring down leaves the rest of the diagnosis whole."""
    try:
        return locate(heard, hypothesis, beside, session.seed)
    except ArithmeticError as lost:
        session.decide(f"the missing force was not located: {lost}")
        return None


def _nothing(first: Sequence[Ranked], final: Fit) -> float:
    """Log evidence of "nothing more", on the scale of the round."""
    if final.hypothesis.effects:
        return min(r.log_evidence for r in first) - 50.0
    return log_standing(final, misfit_in_common(first))


def _traces(session: Session, hypothesis: Hypothesis) -> dict[str, Trace]:
    responses = session.everything.responses(hypothesis, Settings(trace=True))
    rows = zip(session.everything.timed, responses, strict=True)
    return {target.record.name: response.trace for target, response in rows if response.trace is not None}
