"""Once round the loop: compare, see where it fails, learn what is missing, add it, and watch the error fall."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np

from identification.assess import score, with_starts
from identification.calibrate import calibrate, concerning, strained, unknowns_of
from identification.consistency.find import calibration_findings
from identification.consistency.finding import CalibrationFinding
from identification.evaluate import Evaluator, carry_noise
from identification.evidence import (
    LEAST_EVIDENCE,
    Ranked,
    log_fit,
    misfit_in_common,
    misfit_of,
    probabilities,
    reranked,
    with_evidence,
)
from identification.faults import suspicion
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.intervals import corrected
from identification.judge import judge, refit, restarted
from identification.locating.beside import runs_beside
from identification.locating.locate import locate
from identification.look import View
from identification.maps import error_map
from identification.missing_force import forces_of
from identification.next_experiment.propose import next_experiment
from identification.noise_left import NOISE_NEAR, noise_left, with_noise
from identification.outcome import AT_REST_ONLY, added_effects, candidates_of, groups_of, rig_estimates
from identification.prepare import cut_to, horizons, prepare
from identification.progress import Progress, silent
from identification.result import Diagnosis, Score, Stage, Verdict
from identification.session import Session
from identification.tangent_ties import is_linear, tied
from models.effects import EFFECTS, Registry
from models.record import AnyRecord
from models.rig import Rig
from models.simulate import Settings, Trace

NOISE_REACHED = 1.15
"""Residual over noise up to which a model has nothing left to explain: the noise itself is known to about a tenth."""

MOST_EFFECTS = 3

MOST_ROUNDS = 5
"""Of adding an effect and taking out what it made needless."""

LEAST_SHARE = 0.25
"""An effect is added only if it takes away this share of the squared misfit beyond the noise."""

LATER_SHARE = 0.6
"""The same for further effects, unless they reach the noise: what is left may be a shape that no simple law has."""

EXPLAINED_SHARE = 0.9
"""Share of the squared misfit beyond the noise that the effects must take away, where the noise is not reached."""

FIT_SECONDS, SCREEN_SECONDS, TIME_SECONDS = 16.0, 5.0, 10.0
"""Seconds of records that are used for refits, for the screening, and for the screening of effects in time."""


def diagnose(
    rig: Rig,
    records: Sequence[AnyRecord],
    holdout: Sequence[AnyRecord] = (),
    *,
    seed: int = 0,
    jobs: int = 2,
    registry: Registry = EFFECTS,
    most_effects: int = MOST_EFFECTS,
    progress: Progress = silent,
) -> Diagnosis:
    """Find what a rig file lacks to explain its records.

    FRFs and mode shapes are explained by the model linearised at rest; from them alone no nonlinearity can be seen, and
    the diagnosis says so.

    Args:
        rig: as its owner describes it.
        records: of any kind.
        holdout: records kept aside to show what the updated model is worth.
        seed: of every random choice.
        jobs: threads.
        registry: kinds of effects to consider.
        most_effects: added at most.
        progress: told in words what is done and decided.

    Raises:
        InputError: a record that does not fit the rig, or does not tell its noise.
        ArithmeticError: the given rig's motion leaves the finite numbers.
    """
    began = perf_counter()
    given = Hypothesis(rig, registry=registry)
    session = _open(given, records, seed, jobs, progress)
    started = with_starts(session.everything, given)
    stages = [_stage(session, "as given", started)]
    base = calibrate(session.fitting, started, unknowns_of(given, session.fitting))
    base = session.relearn(session.resolve(base))
    session.decide(_calibration_in_words(base))
    stages.append(_stage(session, "calibrated", base.hypothesis))
    _carry(session, base.hypothesis, seed)
    chain, rounds = [base], []
    for _ in range(MOST_ROUNDS):
        if len(chain[-1].hypothesis.effects) >= most_effects or _enough(chain[-1]):
            break
        ranked, better = _round(session, chain[-1])
        if better is not None and not chain[-1].hypothesis.effects:
            session.decide(f"a better calibration was found on the way: residual {better.ratio:.2f} times the noise")
            learnt = session.relearn(better)
            chain = [learnt]
            stages[-1] = _stage(session, "calibrated", learnt.hypothesis)
            if _enough(learnt):
                break
            if learnt is not better:
                ranked, _ = _round(session, learnt)
        rounds.append(_told_apart(session, _restarted(session, chain[-1], ranked)))
        chain, rounds = session.reweigh(chain, rounds)
        chosen = _accept(session, chain[-1], rounds[-1])
        if chosen is None:
            break
        chosen = session.resolve(chosen)
        learnt = session.relearn(chosen)
        if learnt is not chosen:
            chosen, chain = learnt, session.again(chain)
        chain.append(chosen)
        stages.append(_stage(session, f"+ {chosen.hypothesis.effects[-1].label()}", chosen.hypothesis))
        for index, less in _pruned(session, chain[0], chosen):
            stages.append(_stage(session, f"- {chain[-1].hypothesis.effects[index].label()}", less.hypothesis))
            chain.append(less)
            del rounds[index]
    verdict = _verdict(session, chain[0], chain[-1], rounds)
    final = chain[-1] if verdict == "missing_effect" else chain[0]
    calibration = _one_set_of_numbers(session, chain[0], verdict)
    found = _result(session, given, stages, rounds, verdict, final, holdout, seed, began)
    return replace(found, calibration=calibration, findings=(*found.findings, *(each.words for each in calibration)))


def _open(given: Hypothesis, records: Sequence[AnyRecord], seed: int, jobs: int, progress: Progress) -> Session:
    progress(f"estimating the noise of {len(records)} records")
    everything = prepare(given, records, jobs, np.random.default_rng(seed))
    limits = horizons(everything, given)
    session = Session(everything, cut_to(everything, FIT_SECONDS, limits), limits, given.registry, progress, seed)
    for limit, target in zip(limits, everything.timed, strict=True):
        if limit.seconds < target.record.duration:
            session.decide(
                f"{limit.record}: neighbouring motions part by a factor of {limit.growth:.0e}, the force's noise grows to "
                f"{limit.amplified:.3g} times its share; only the first {limit.seconds:.2f} s are used to fit"
            )
        session.decide(f"{limit.record}: sensors' noise from {target.noise.method}; {target.noise.excitation_method}")
    for rest in everything.at_rest:
        session.decide(f"{rest.record.name}: compared with the model linearised at rest; noise from {rest.method}")
    if not everything.timed:
        session.decide(f"{AT_REST_ONLY}: laws are seen by their tangents, and effects in time not at all")
    return session


def _carry(session: Session, hypothesis: Hypothesis, seed: int) -> None:
    """The excitation's noise as this model carries it, where that is less than so far.

    A model with wrong numbers may tremble at what leaves the structure cold; none carries less than the truth for long.
    """
    carried = carry_noise(session.everything, hypothesis, np.random.default_rng(seed))
    pairs = zip(session.everything.targets, carried, strict=True)
    session.everything = session.everything.with_targets([min(pair, key=lambda t: t.nrmse_of_noise) for pair in pairs])


def _stage(session: Session, label: str, hypothesis: Hypothesis) -> Stage:
    stage = Stage(label, hypothesis, score(session.everything, hypothesis))
    session.progress(f"{label}: error {stage.score.nrmse:.3%}, noise floor {stage.score.noise_nrmse:.3%}")
    return stage


def _calibration_in_words(base: Fit) -> str:
    far = strained(base)
    words = f"calibrated within the tolerances: residual {base.ratio:.2f} times the noise"
    if far:
        moves = ", ".join(f"{u.parameter.label} by {u.get(base.hypothesis):+.1f} sigma" for u in far)
        return f"{words}, but only by moving {moves}"
    return words


def _one_set_of_numbers(session: Session, calibrated: Fit, verdict: Verdict) -> tuple[CalibrationFinding, ...]:
    """What the calibrated model's numbers contradict, among the decisions where something is missing."""
    session.progress("holding the calibrated numbers against tolerances, records, times and modes")
    found = calibration_findings(session.fitting, calibrated, np.random.default_rng(session.seed))
    for each in found if verdict != "complete" else ():
        session.decide(f"calibrated model: {each.words}")
    return found


def _enough(result: Fit) -> bool:
    """The noise is reached; without an effect, with every number within its tolerance."""
    return result.ratio <= NOISE_REACHED and (bool(result.hypothesis.effects) or not strained(result))


def _round(session: Session, base: Fit) -> tuple[list[Ranked], Fit | None]:
    """Effects ranked, and a calibration without the best of them if that is better than the one so far."""
    timed = bool(session.everything.timed)
    lasting = {name: kind for name, kind in session.registry.items() if kind.family == "time" and timed}
    instant = {name: kind for name, kind in session.registry.items() if kind.family != "time"}
    searching = session.searching(base)
    first = _view(session, searching, base, instant, SCREEN_SECONDS, 2)
    suspected = suspicion(first.evaluator, first.there)
    ranked: list[Ranked] = []
    if suspected:
        session.decide(suspected.words)
        faults = replace(first, registry=suspected.kinds(instant), sensors=suspected.sensors)
        ranked = judge([faults], session.fitting, base, session.progress)
    if not (ranked and _takes_away(base, ranked[0].fit) >= PLAIN_FAULT):
        views = [replace(first, sensors=suspected.sensors)]
        if lasting:
            views.append(_view(session, searching, base, lasting, TIME_SECONDS, 1))
        ranked = judge(views, session.fitting, base, session.progress)
    return (ranked, _recalibrated(session, base, ranked[0].fit)) if ranked else ([], None)


PLAIN_FAULT = 0.7
"""Share of the excess over the noise that a fault of the measurement takes away for physics not to be asked."""


def _view(session: Session, searching: Evaluator, base: Fit, kinds: Registry, seconds: float, most: int) -> View:
    """So many seconds of the loudest records, the quietest and those between, and the calibrated model there."""
    evaluator = cut_to(searching, seconds, session.limits, most)
    there = fit(evaluator, base.hypothesis, concerning(base, evaluator), max_iterations=1)
    return View(evaluator, there, kinds)


def _takes_away(base: Fit, found: Fit) -> float:
    """Share of the misfit beyond the noise."""
    return (base.cost - found.cost) / max(base.cost - base.n_data, 1.0)


def _recalibrated(session: Session, base: Fit, found: Fit) -> Fit | None:
    """A calibration from the numbers found beside an effect, where that ends below the one so far; first by a look."""
    if base.hypothesis.effects:
        return None
    without, slopes = replace(found.hypothesis, effects=()), found.jacobian[: len(base.unknowns)]
    look = fit(session.fitting, without, base.unknowns, max_iterations=LOOK, jacobian=slopes, tolerance=LOOK_TOLERANCE)
    if look.cost > WORTH_MORE * base.cost:
        return None
    again = fit(session.fitting, look.hypothesis, base.unknowns, precise=True)
    return again if base.cost - again.cost > max(100.0, 0.02 * base.cost) else None


LOOK, LOOK_TOLERANCE, WORTH_MORE = 5, 0.02, 1.2
"""Iterations and tolerance of a look at another calibration; how far above the one so far it may end to be followed."""


def _restarted(session: Session, base: Fit, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking after other starts were tried for the best effect, where its fit stopped above the noise."""
    if not ranked or ranked[0].fit.ratio <= NOISE_REACHED:
        return ranked
    session.progress(f"{ranked[0].effect.label()}: the fit stopped above the noise; trying other starts")
    return reranked(ranked, restarted(session.fitting, base, ranked[0].fit))


def _told_apart(session: Session, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking without differences that only larger motion could show, where none was seen."""
    return ranked if session.everything.timed else tied(ranked)


def _accept(session: Session, base: Fit, ranked: Sequence[Ranked]) -> Fit | None:
    """The fit with the best effect, refined, if it explains enough."""
    if not ranked:
        session.decide("no effect of the library improves the model")
        return None
    best = ranked[0]
    odds = best.log_evidence - log_fit(base, misfit_in_common(ranked))
    share = _takes_away(base, best.fit)
    name = best.effect.label()
    least = LATER_SHARE if base.hypothesis.effects and best.fit.ratio > NOISE_NEAR else LEAST_SHARE
    if odds < LEAST_EVIDENCE or (base.ratio > NOISE_REACHED and share < least):
        session.decide(f"{name} is the best of the library, but takes away only {share:.0%} of the misfit: not added")
        return None
    session.decide(
        f"{name} added: residual from {base.ratio:.2f} to {best.fit.ratio:.2f} times the noise, "
        f"{min(share, 1.0):.0%} of the misfit beyond the noise; {best.effect.in_words()}"
    )
    if not session.everything.timed and not is_linear(best.fit.hypothesis):
        session.decide(f"{name} is seen by its tangent at rest alone: {AT_REST_ONLY}")
    return _refined(session, best.fit)


def _pruned(session: Session, calibrated: Fit, found: Fit) -> list[tuple[int, Fit]]:
    """Effects that the last one has made needless, each with the fit without it, taken out one after the other."""
    taken: list[tuple[int, Fit]] = []
    index = 0
    while index < len(found.hypothesis.effects) - 1:
        less = _without(session, calibrated, found, index)
        scale = misfit_of(found)
        if log_fit(found, scale) - log_fit(less, scale) < LEAST_EVIDENCE:
            gone, last = found.hypothesis.effects[index].label(), found.hypothesis.effects[-1].label()
            session.decide(f"{gone} taken out again: beside {last} it explains nothing more")
            taken.append((index, less))
            found = less
        else:
            index += 1
    return taken


def _without(session: Session, calibrated: Fit, found: Fit, index: int) -> Fit:
    """The fit again without one of its effects."""
    effects = found.hypothesis.effects
    hypothesis = replace(found.hypothesis, effects=(*effects[:index], *effects[index + 1 :]))
    return fit(session.fitting, hypothesis, (*calibrated.unknowns, *effect_unknowns(hypothesis)), precise=True)


def _refined(session: Session, result: Fit) -> Fit:
    """The last effect described in more detail as long as the evidence grows."""
    while True:
        rows = [
            Ranked(effect, result, refitted=True, log_evidence=0.0)
            for effect in result.hypothesis.effects[-1].refined()
        ]
        if not rows or result.ratio <= NOISE_REACHED:
            return result
        base = replace(result.hypothesis, effects=result.hypothesis.effects[:-1])
        n_shared = len([u for u in result.unknowns if getattr(u, "effect", -1) < len(base.effects)])
        shared = replace(
            result,
            hypothesis=base,
            unknowns=result.unknowns[:n_shared],
            jacobian=result.jacobian[:n_shared],
        )
        fits = [refit(session.fitting, shared, row.effect, result.hypothesis.values) for row in rows]
        now = Ranked(result.hypothesis.effects[-1], result, refitted=True, log_evidence=0.0)
        finer = [Ranked(f.hypothesis.effects[-1], f, refitted=True, log_evidence=0.0) for f in fits if f is not None]
        best = with_evidence([now, *finer])[0]
        if best.fit is result:
            return result
        session.decide(f"{best.effect.label()} described in more detail: residual {best.fit.ratio:.2f} times the noise")
        result = best.fit


def _verdict(session: Session, calibrated: Fit, final: Fit, rounds: Sequence[Sequence[Ranked]]) -> Verdict:
    if not final.hypothesis.effects:
        if not rounds or (calibrated.ratio <= NOISE_NEAR and not strained(calibrated)):
            motion = "" if session.everything.timed else " for small motion about rest"
            session.decide(f"complete: the calibrated model reaches the noise{motion}")
            return "complete"
        session.decide("unexplained: nothing in the library explains what is left")
        return "unexplained"
    share = _takes_away(calibrated, final)
    if final.ratio <= NOISE_NEAR or share >= EXPLAINED_SHARE:
        session.decide(f"missing effect found; residual {final.ratio:.2f} times the noise")
        return "missing_effect"
    session.decide(f"unexplained: the best of the library leaves {final.ratio:.1f} times the noise")
    return "unexplained"


def _result(
    session: Session,
    given: Hypothesis,
    stages: list[Stage],
    rounds: Sequence[Sequence[Ranked]],
    verdict: Verdict,
    final: Fit,
    holdout: Sequence[AnyRecord],
    seed: int,
    began: float,
) -> Diagnosis:
    polished = _polish(session, final)
    if stages[-1].hypothesis is not polished.hypothesis:
        label = stages[-1].label if verdict != "unexplained" else "calibrated"
        kept = [s for s in stages if verdict != "unexplained" or not s.hypothesis.effects]
        stages = [*kept[:-1], _stage(session, label, polished.hypothesis)]
    if session.relearnt:
        stages = [_stage(session, stage.label, stage.hypothesis) for stage in stages]
    calibrated = next(stage for stage in reversed(stages) if stage.label == "calibrated")
    first = rounds[0] if rounds else []
    chances = probabilities([r.log_evidence for r in first] + [_nothing(first, final)]) if first else []
    later = [(ranked, probabilities([r.log_evidence for r in ranked])) for ranked in rounds[1:] if ranked]
    session.progress("locating the force that the calibrated model lacks")
    beside = runs_beside(session.everything, calibrated.hypothesis)
    forces = forces_of(beside)
    updated_maps = tuple(error_map(record) for record in stages[-1].score.records)
    proposal = next_experiment(
        session,
        verdict,
        [*([(first, chances)] if first else []), *later],
        polished.hypothesis,
        maps=updated_maps,
        forces=forces,
        kept_aside=bool(holdout),
    )
    return Diagnosis(
        verdict=verdict,
        added=added_effects(polished, rounds),
        candidates=candidates_of(first, chances, session.fitting),
        indistinguishable=groups_of(first, chances),
        stages=tuple(stages),
        holdout=_held_out(session, given, polished.hypothesis, holdout, seed),
        rig_estimates=rig_estimates(polished),
        where=tuple(error_map(record) for record in calibrated.score.records),
        missing_forces=forces,
        located=locate(session.everything, calibrated.hypothesis, beside, seed),
        updated_maps=updated_maps,
        traces=_traces(session, polished.hypothesis),
        next_experiment=proposal,
        decisions=tuple(session.decisions),
        seconds=perf_counter() - began,
        seed=seed,
        findings=(
            *(f for t in session.everything.timed for f in t.record.findings),
            *(f"{t.record.name}: {AT_REST_ONLY}" for t in session.everything.at_rest),
        ),
    )


def _nothing(first: Sequence[Ranked], final: Fit) -> float:
    """Log evidence of "nothing more", on the scale of the round."""
    if final.hypothesis.effects:
        return min(r.log_evidence for r in first) - 50.0
    return log_fit(final, misfit_in_common(first))


def _polish(session: Session, final: Fit) -> Fit:
    """A last fit of all that can be predicted, to the end: in a flat valley intervals are right only at its bottom."""
    whole = cut_to(session.everything, float("inf"), session.limits)
    unknowns = (*unknowns_of(final.hypothesis, whole), *effect_unknowns(final.hypothesis))
    session.progress(f"last fit on all {whole.extent}")
    last = fit(whole, final.hypothesis, unknowns, max_iterations=LAST_ITERATIONS, tolerance=0.0, precise=True)
    return corrected(whole, last, np.random.default_rng(session.seed))


LAST_ITERATIONS = 6


def _held_out(
    session: Session, given: Hypothesis, updated: Hypothesis, holdout: Sequence[AnyRecord], seed: int
) -> Mapping[str, Score]:
    if not holdout:
        return {}
    session.progress(f"predicting {len(holdout)} records kept aside")
    rng = np.random.default_rng(seed)
    evaluator = prepare(updated, holdout, session.everything.jobs, rng)
    known = with_starts(evaluator, updated)
    residual = evaluator.residuals([(known, None)])[0]
    if residual is not None:
        evaluator = with_noise(evaluator, noise_left(evaluator, residual), known, rng)
    return {
        "as given": score(evaluator, with_starts(evaluator, given)),
        "updated": score(evaluator, known),
    }


def _traces(session: Session, hypothesis: Hypothesis) -> dict[str, Trace]:
    responses = session.everything.responses(hypothesis, Settings(trace=True))
    rows = zip(session.everything.timed, responses, strict=True)
    return {target.record.name: response.trace for target, response in rows if response.trace is not None}
