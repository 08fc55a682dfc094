"""The noise of the measured excitation as the model carries it that explains the records, instead of the given one."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf, sqrt

import numpy as np

from identification.assess import score
from identification.evaluate import Evaluator, Target, carry_noise
from identification.evidence import Ranked
from identification.fit import Fit, fit
from identification.noise_left import NOISE_NEAR
from identification.reached import ERROR_REACHED, EXPLAINED_NEAR, NOISE_REACHED, is_faint, reaches_noise, takes_away
from identification.relearning import everything_again
from identification.result import Stage
from identification.session import CLEARLY_LOUDER, Session


def carried_through(session: Session, ranked: list[Ranked]) -> list[Ranked]:
    """The ranking with the excitation's noise carried through its best model, if only then the noise is reached.

    A sensor that reads what another should also has the other's share of that noise.

    Args:
        session: its noise is changed where that is so.
        ranked: faults of the measurement.
    """
    if not ranked or ranked[0].fit.ratio <= NOISE_REACHED:
        return ranked
    before, model = (session.everything, session.fitting), ranked[0].fit.hypothesis
    for_both = [np.random.default_rng(session.seed) for _ in before]
    session.everything, session.fitting = (
        each.with_targets(carry_noise(each, model, rng)) for each, rng in zip(before, for_both, strict=True)
    )
    _, (again,) = everything_again(session, [], [ranked])
    if again[0].fit.ratio <= NOISE_REACHED:
        return again
    session.everything, session.fitting = before
    return ranked


def carried_by_calibrated(session: Session, base: Fit) -> Fit:
    """The fit on the excitation's noise as its model carries it, where that is less than so far, or all that is left.

    A model with wrong numbers may tremble at what leaves the structure cold; none carries less than the truth for long.

    Args:
        session: its noise is changed where that is so.
        base: the calibrated model.
    """
    carried = _carried(session, base)
    again = base if reaches_noise(session.fitting, base) else _excused(session, base, carried)
    if again is not base:
        return again
    session.everything = session.quieter(carried)
    quieter = session.parts_of(session.everything)
    if quieter.nrmse_of_noise * CLEARLY_LOUDER > session.fitting.nrmse_of_noise:
        return base
    session.decide(
        f"the force's noise, as the calibrated model carries it, leaves {quieter.nrmse_of_noise:.2%} instead of "
        f"{session.fitting.nrmse_of_noise:.2%}"
    )
    session.fitting = quieter
    return fit(quieter, base.hypothesis, base.unknowns, precise=True, like=base)


def on_its_noise(session: Session, stage: Stage) -> Stage:
    """The stage of the model that was found, held against the force's noise as that carries it; told.

    What lacks an effect may tremble at a noise that leaves the rig cold. Fits and evidence rest on that noise all the
    same, so the floor is lowered only where the model reaches the lower one as well.

    Args:
        session: with the records.
        stage: of that model.
    """
    floor = stage.score.noise_nrmse
    if stage.score.nrmse * CLEARLY_LOUDER >= floor:
        return stage
    try:
        quieter = session.quieter(session.carried_by(stage.hypothesis).targets)
    except ArithmeticError:  # a little other force, and it runs away
        return stage
    now = replace(stage, score=score(quieter, stage.hypothesis))
    if now.score.noise_nrmse * CLEARLY_LOUDER >= floor or now.score.nrmse > ERROR_REACHED * now.score.noise_nrmse:
        return stage
    session.decide(
        f"the force's noise, as the updated model carries it, leaves {now.score.noise_nrmse:.2%} instead of "
        f"{floor:.2%}: that is its floor"
    )
    return now


def excused(session: Session, found: Fit) -> Fit:
    """The fit on the excitation's noise as its model carries it, if that is all it leaves, within the tolerances.

    Another rig within them may carry a sixth of that: where walls are struck a little later, motions stay together.

    Args:
        session: its noise is changed where that is so.
        found: a calibrated model.
    """
    if reaches_noise(session.fitting, found):
        return found
    try:
        carried = _carried(session, found)
    except ArithmeticError:  # beyond what was fitted it runs away, and excuses nothing
        return found
    return _excused(session, found, carried)


def _carried(session: Session, found: Fit) -> list[Target]:
    return carry_noise(session.everything, found.hypothesis, np.random.default_rng(session.seed))


def _excused(session: Session, found: Fit, carried: Sequence[Target]) -> Fit:
    louder = session.everything.with_targets(carried)
    parts = session.parts_of(louder)
    if _left(parts, found) > NOISE_NEAR:
        return found
    again = fit(parts, found.hypothesis, found.unknowns, precise=True, like=found)
    before, session.everything, session.fitting = (session.everything, session.fitting), louder, parts
    if not reaches_noise(parts, again) or session.left_tolerance(again):
        session.everything, session.fitting = before
        return found
    session.decide(
        f"the force's noise, as the calibrated model carries it, leaves {parts.nrmse_of_noise:.2%} instead of "
        f"{before[1].nrmse_of_noise:.2%}: nothing else is left"
    )
    return again


def _left(louder: Evaluator, found: Fit) -> float:
    """What a model leaves of these records, over their noise, before it is fitted again on that."""
    (residual,) = louder.residuals([(found.hypothesis, None)])
    return inf if residual is None else sqrt(float(residual @ residual) / louder.n_judged)


def carried_by_best(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]]
) -> tuple[list[Fit], list[list[Ranked]]]:
    """The fits on the excitation's noise as the best model of the last round carries it, if that reaches the noise.

    A rig whose walls are touched sooner than its file says trembles more at a noisy force, and would seem to lack more
    than what was found. A model that trembles at anything does not excuse itself: it has explained the rest.

    Args:
        session: its noise is changed where that is so.
        chain: the models so far.
        rounds: effects ranked in each round.
    """
    best = rounds[-1][0].fit if rounds[-1] and rounds[-1][0].refitted else chain[-1]
    louder = louder_by(session, chain[0], best)
    if louder is None:
        return chain, rounds
    parts = session.parts_of(louder)
    session.decide(
        f"the force's noise, as {best.hypothesis.effects[-1].label()} carries it, leaves {parts.nrmse_of_noise:.2%} "
        f"instead of {session.fitting.nrmse_of_noise:.2%}: all models fitted and weighed again on that"
    )
    session.everything, session.fitting = louder, parts
    return everything_again(session, chain, rounds)


def louder_by(session: Session, base: Fit, found: Fit) -> Evaluator | None:
    """All records with the excitation's noise as a model carries it, if that is what the model leaves; or None.

    Args:
        session: with the records.
        base: a model that lacks what this one has.
        found: which explains nearly all that the other leaves, and comes near the noise.
    """
    far = found.ratio > NOISE_NEAR or not is_faint(session.fitting, found)
    if far or takes_away(base, found) < EXPLAINED_NEAR:
        return None
    louder = session.carried_by(found.hypothesis)
    return louder if _left(session.parts_of(louder), found) <= NOISE_REACHED else None
