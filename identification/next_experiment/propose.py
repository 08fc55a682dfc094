"""From a finished diagnosis to the test that should come next."""

from collections.abc import Sequence
from dataclasses import replace

from identification.evaluate import LEAST_NOISE, Evaluator, TimeTarget
from identification.evidence import Ranked
from identification.hypothesis import Hypothesis
from identification.locating.located import Located
from identification.next_experiment.advice import (
    CHAOTIC,
    another_kind,
    higher_level,
    learn_from,
    lower_level,
    more_of_what_is_left,
    same_again,
)
from identification.next_experiment.bench import Bench
from identification.next_experiment.choose import Question, options_of, settles
from identification.next_experiment.odds import present_probability
from identification.next_experiment.proposal import Proposal
from identification.next_experiment.rivals import Rival, rivals_of
from identification.next_experiment.words import in_vain, why, words_of
from identification.outcome import AT_REST_ONLY
from identification.result import ErrorMap, MissingForce, Verdict
from identification.session import Session

Round = tuple[Sequence[Ranked], Sequence[float]]
"""What was judged together, and the probabilities."""


def next_experiment(
    session: Session,
    verdict: Verdict,
    rounds: Sequence[Round],
    model: Hypothesis,
    *,
    maps: Sequence[ErrorMap] = (),
    forces: Sequence[MissingForce] = (),
    located: Located | None = None,
    kept_aside: bool = False,
    missed: Sequence[str] = (),
    is_untold: bool = False,
) -> Proposal:
    """What to measure next to learn most.

    Args:
        session: records, noise and how far they can be followed.
        verdict: of the diagnosis.
        rounds: in order.
        model: the final one.
        maps: its errors.
        forces: that the calibrated model lacks.
        located: where one of them would explain what it leaves, if that was looked for.
        kept_aside: whether the model was tried on records that the fit had not seen.
        missed: those of them on which it does not hold.
        is_untold: whether it tells next to nothing of the motion where it was fitted.
    """
    if not session.everything.timed:
        return Proposal("the same test at a higher level, or a time record", AT_REST_ONLY)
    bench = Bench.of(model.rig, session.everything.timed)
    for ranked, chances in rounds if verdict == "missing_effect" else ():
        rivals = rivals_of(ranked, chances)
        if len(rivals) > 1:
            if not session.has_time_for("weighing tests that tell the suspects apart"):
                break
            session.progress(
                f"weighing tests that could tell {' from '.join(rival.effect.label() for rival in rivals)}"
            )
            return replace(_told_apart(session, bench, rivals, ranked[0].fit.ratio), noise=_noise(bench))
    if any(limit.growth > CHAOTIC for limit in session.limits):
        proposal = lower_level(session.everything, bench, model)
    elif verdict == "unexplained" and is_untold:
        proposal = same_again(bench)
    elif verdict == "unexplained":
        proposal = more_of_what_is_left(bench, maps, forces, located)
    elif missed:
        proposal = learn_from(session.everything, bench, model, missed)
    elif verdict == "complete" or kept_aside:
        proposal = higher_level(session.everything, bench, model, known=verdict != "complete")
    else:
        proposal = another_kind(bench)
    return replace(proposal, noise=_noise(bench))


def _noise(bench: Bench) -> dict[str, float]:
    known = bench.force_noise if bench.force_noise > LEAST_NOISE * bench.level else 0.0
    return {**dict(zip(bench.sensors, bench.noise.tolist(), strict=True)), "excitation": known}


def _told_apart(session: Session, bench: Bench, rivals: tuple[Rival, ...], ratio: float) -> Proposal:
    fitting = session.fitting
    question = Question(bench, rivals, shortened(fitting), max(1.0, ratio), fitting.settings, fitting.jobs)
    options = options_of(question)
    effects = tuple(rival.effect for rival in rivals)
    names = [effect.label() for effect in effects]
    present = present_probability(question.chances)
    if not options:
        return Proposal(
            "another kind of test than a shaker, a hammer or a sensor more", in_vain(names, None), rivals=effects
        )
    best = options[0]
    return Proposal(
        do=words_of(best),
        why=why(names, best, present, question.limits) if settles(best) else in_vain(names, best),
        test=best.test,
        options=options,
        present_probability=present,
        rivals=effects,
        rig=None if best.test.sensor is None else bench.with_sensor(best.test.sensor).rig,
    )


def shortened(records: Evaluator) -> Evaluator:
    """The beginning of long records, its noise lowered so that it tells as much as the whole.

    Args:
        records: on which the rivals were fitted.
    """
    seconds = sum(target.record.duration for target in records.timed)
    share = min(1.0, MOST_SECONDS / seconds) if seconds else 1.0
    if share == 1.0:
        return records
    targets = [_cut(target, share) if isinstance(target, TimeTarget) else target for target in records.targets]
    return records.with_targets(targets)


MOST_SECONDS = 6.0
"""Of old records on which a separation is confirmed by a fit."""


def _cut(target: TimeTarget, share: float) -> TimeTarget:
    short = target.cut(round(share * target.record.n_samples))
    return replace(short, density=short.density * short.record.n_samples / target.record.n_samples)
