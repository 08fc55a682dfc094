"""Once round the loop: compare, see where it fails, learn what is missing, add it, and watch the error fall."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from time import perf_counter

import numpy as np

from identification.acceptance import (
    accepted,
    finite_first,
    fit_without,
    in_doubt,
    is_enough,
    is_explained,
    is_incomplete,
    is_of_one_law,
    pruned,
    refuted,
    verdict_of,
)
from identification.alone import one_alone
from identification.anew import looked_for_anew
from identification.another_first import another_first
from identification.assess import with_starts
from identification.beyond import (
    is_beyond_library,
    is_beyond_where_missed,
    law_beyond,
    with_what_is_seen_along,
    with_what_meets_the_noise,
)
from identification.calibrate import calibrate, strained, unknowns_of
from identification.carried import carried_by_best, carried_by_calibrated, excused
from identification.conclude import concluded, one_set_of_numbers, settled
from identification.established import NO_SIZE
from identification.evidence import Ranked
from identification.exchange import exchanged
from identification.fewer import with_fewer
from identification.fit import Fit, fit
from identification.followed_again import begin_again, fails_in_pieces, go_on
from identification.hypothesis import Hypothesis
from identification.in_all_sleeves import fallen_apart, in_all_sleeves
from identification.instead import Instead, ahead_by_all, instead_of, within_tolerances
from identification.kept_aside import KeptAside, kept_aside, predicted
from identification.other_numbers import with_other_numbers
from identification.outcome import AT_REST_ONLY
from identification.prepare import cut_to, horizons, prepare
from identification.progress import Progress, silent
from identification.reached import NOISE_REACHED
from identification.relearning import everything_again, fitted_again, relearn, reweigh
from identification.result import Diagnosis, Stage, Verdict
from identification.rounds import look_round, told_apart, with_other_starts
from identification.session import Session
from identification.sight import beginnings_of, explained_beginning, refitted_from, shorten
from identification.silent import without_silent
from identification.together import wholly_off
from identification.told_by_all import told_by_all
from identification.unstrained import unstrained
from models.effects import EFFECTS, Registry
from models.record import AnyRecord
from models.rig import Rig

MOST_EFFECTS = 3

MOST_ROUNDS = 5
"""Of adding an effect and taking out what it made needless."""

FIT_SECONDS = 16.0
"""Of records that are used for refits."""

ONCE_MORE = "a search in pieces of the records, as far as they can be begun there,"
"""What follows where a first search explains nothing, or not the rest of the records."""


def diagnose(
    rig: Rig,
    records: Sequence[AnyRecord],
    holdout: Sequence[AnyRecord] = (),
    *,
    seed: int = 0,
    jobs: int = 2,
    registry: Registry = EFFECTS,
    most_effects: int = MOST_EFFECTS,
    alike: bool = False,
    within: float = inf,
    progress: Progress = silent,
) -> Diagnosis:
    """Find what a rig file lacks to explain its records.

    FRFs and mode shapes are explained by the model linearised at rest; from them alone no nonlinearity can be seen, and
    the diagnosis says so.

    Args:
        rig: as its owner describes it.
        records: of any kind.
        holdout: records kept aside, to which no number is fitted: they show what the updated model is worth, refute it
            where no numbers explain them too, and decide about a law about whose numbers the others do not agree.
        seed: of every random choice.
        jobs: cores.
        registry: kinds of effects to consider.
        most_effects: added at most; one in all sleeves counts once.
        alike: whether the same may be wrong with all sleeves, so that what sits in one is tried in all of them at once.
        within: seconds after which no further search is begun: what stands then is concluded, and what was not begun
            is a finding.
        progress: told in words what is done and decided.

    Raises:
        InputError: a record that does not fit the rig, in which no channel moves, or that does not tell its noise.
        ArithmeticError: the given rig's motion leaves the finite numbers.
    """
    began = perf_counter()
    records, holdout = ([without_silent(record) for record in each] for each in (records, holdout))
    given = Hypothesis(rig, registry=registry)
    kinds = {**registry, **(in_all_sleeves(registry, rig) if alike else {})}
    session = _open(given, kinds, records, seed, jobs, progress)
    session.until = began + within
    started = with_starts(session.everything, given)
    stages = [session.stage("as given", started)]
    for told in wholly_off(stages[0].score):
        session.decide(told)
    base = _calibrated(session, replace(started, starts={}))  # beside the numbers as given other states fit best
    session.decide(_calibration_in_words(base))
    stages.append(session.stage("calibrated", base.hypothesis))
    chain: list[Fit] = [carried_by_calibrated(session, base)]
    search = partial(_searched, session, given, holdout, stages, most_effects)
    found = search(chain)
    in_doubt_of_the_rest = not session.is_beyond and (
        found.verdict == "unexplained" or fails_in_pieces(session, found.final)
    )
    if in_doubt_of_the_rest and session.has_time_for(ONCE_MORE) and go_on(session, found.chain[0]):
        session.decide("looking again with the rest of the records, in pieces")
        found = _looked_again(session, search, stages, found)
    calibration = one_set_of_numbers(session, found.chain[0], found.verdict)
    diagnosis = concluded(
        session, stages, found.rounds, found.verdict, found.final, found.last, found.kept, seed, began
    )
    return replace(diagnosis, calibration=calibration)


@dataclass(frozen=True, eq=False)
class _Found:
    """What a search came to: the models, what was weighed beside them, the one that stands, and what it is worth."""

    chain: list[Fit]
    rounds: list[list[Ranked]]
    verdict: Verdict
    final: Fit
    last: Fit
    kept: KeptAside


def _searched(
    session: Session,
    given: Hypothesis,
    holdout: Sequence[AnyRecord],
    stages: list[Stage],
    most_effects: int,
    chain: list[Fit],
) -> _Found:
    """Effects added for as long as one explains more, each held against all others, and the verdict."""
    rounds: list[list[Ranked]] = []
    for number in range(MOST_ROUNDS):
        if is_enough(session, chain[-1]) and session.lengthen(chain[-1]):
            ended = session.to_the_end(chain[-1])
            chain, rounds = everything_again(session, [*chain[:-1], ended], rounds, ended=ended)
        if _is_over(session, chain[-1], most_effects, is_begun=number > 0):
            break
        chain, rounds, ranked, better = _looked(session, chain, rounds)
        if better is not None and not chain[-1].hypothesis.effects:
            session.decide(f"a better calibration was found on the way: residual {better.ratio:.2f} times the noise")
            learnt = relearn(session, excused(session, better))
            chain = [learnt]
            stages[-1] = session.stage("calibrated", learnt.hypothesis)
            if is_enough(session, learnt):
                continue
            if learnt is not better:
                ranked, _ = look_round(session, learnt)
        chain, (*rounds, ranked) = carried_by_best(session, chain, [*rounds, ranked])
        ranked = with_what_is_seen_along(session, chain[-1], ranked)
        chain, rounds, ranked = _from_elsewhere(session, chain, rounds, ranked, stages)
        rounds.append(told_apart(session, ranked))
        chain, rounds = reweigh(session, chain, rounds)
        rounds[-1] = with_what_meets_the_noise(session, chain[-1], rounds[-1])
        chosen = None if session.is_beyond else accepted(session, chain[-1], rounds[-1])
        if chosen is None:
            break
        chain = _with(session, chain, chosen)
        stages.append(session.stage(f"+ {chosen.hypothesis.effects[-1].label()}", chain[-1].hypothesis))
        chain, rounds = _revised(session, chain, rounds, stages)
    chain[-1], rounds = fallen_apart(chain[-1], rounds)
    return _judged(session, given, holdout, stages, chain, rounds)


def _judged(
    session: Session,
    given: Hypothesis,
    holdout: Sequence[AnyRecord],
    stages: list[Stage],
    chain: list[Fit],
    rounds: list[list[Ranked]],
) -> _Found:
    """What the search's models come to, held against laws beyond the library and against what was kept aside."""
    calibrated, law = chain[0], None
    verdict, final, last = _ended(session, chain, rounds, stages, holdout)
    if verdict == "missing_effect":
        of_one = is_of_one_law(session, last)
        law = None if of_one else law_beyond(session, calibrated, final)
        if of_one or is_beyond_library(session, law):
            verdict, final, last = "unexplained", calibrated, settled(session, calibrated)
    kept = kept_aside(session, given, last.hypothesis, holdout)
    if verdict != "unexplained":
        kept = with_other_numbers(session, last, kept)
    if verdict == "complete" and is_incomplete(session, kept):
        verdict = "unexplained"
    if verdict == "missing_effect" and (
        is_beyond_where_missed(session, last, law, kept, holdout)
        or refuted(session, calibrated, final, last, kept, rounds)
    ):
        verdict, final, last = "unexplained", calibrated, settled(session, calibrated)
        alone = kept_aside(session, given, last.hypothesis, holdout)
        kept = replace(alone, missed=alone.missed or kept.missed)
    return _Found(chain, rounds, verdict, final, last, kept)


def _is_over(session: Session, last: Fit, most_effects: int, *, is_begun: bool) -> bool:
    """Whether no further effect is looked for: none may be added, none is needed, or there is no time for it."""
    if len(last.hypothesis.effects) >= most_effects or is_explained(session, last):
        return True
    return is_begun and not session.has_time_for("a search for a further effect")


def _looked_again(
    session: Session, search: Callable[[list[Fit]], _Found], stages: list[Stage], found: _Found
) -> _Found:
    """What is found from the calibrated model on with pieces of the records; what was found, where a motion is lost."""
    before, staged = replace(session.as_it_is(), fitting=session.without_pieces, pieces=()), [*stages]
    try:
        chain = fitted_again(session, found.chain[:1])
        stages[1:] = [session.stage("calibrated", chain[0].hypothesis)]
        return search(chain)
    except ArithmeticError:
        session.decide("a motion leaves the finite numbers there: what was found before stands")
        session.back_to(before)
        stages[:] = staged
        return found


def _calibrated(session: Session, started: Hypothesis) -> Fit:
    """The rig's numbers fitted to as much of the records as the model that explains their beginning predicts."""
    while True:
        unknowns = unknowns_of(started, session.fitting)
        base = calibrate(session.fitting, started, unknowns)
        first = explained_beginning(session.fitting, started, unknowns) if base.ratio > NOISE_REACHED else None
        if first is not None:
            base = _better(session, base, first)
        base = relearn(session, session.resolve(base))
        if base.ratio <= NOISE_REACHED:
            return unstrained(session.fitting, base)
        if first is None or not shorten(session, [first]):
            return base


def _looked(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]]
) -> tuple[list[Fit], list[list[Ranked]], list[Ranked], Fit | None]:
    """The models and rounds, what is ranked beside the last model, and a better calibration where that was found.

    All are fitted anew where looking has changed the noise, or how much of the records can be followed.
    """
    before = session.fitting
    ranked, better = look_round(session, chain[-1])
    if session.fitting is not before:
        chain, rounds = everything_again(session, chain, rounds)
    if ranked and begin_again(session, ranked[0].fit, chain[-1]):
        chain, (*rounds, ranked) = everything_again(session, chain, [*rounds, ranked])
        better = None
    beginnings = beginnings_of(session, ranked)
    if shorten(session, beginnings):
        chain, (*rounds, ranked) = everything_again(session, chain, [*rounds, ranked])
        better = None
    return chain, rounds, refitted_from(session, beginnings, ranked), better


def _from_elsewhere(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], ranked: list[Ranked], stages: list[Stage]
) -> tuple[list[Fit], list[list[Ranked]], list[Ranked]]:
    """The models and rounds and what is ranked, other starts and firsts tried unless the library holds no such law."""
    if session.is_beyond:
        return chain, rounds, ranked
    ranked = finite_first(session, with_other_starts(session, chain[-1], ranked))
    return _with_another_first(session, chain, rounds, ranked, stages)


def _with_another_first(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], ranked: list[Ranked], stages: list[Stage]
) -> tuple[list[Fit], list[list[Ranked]], list[Ranked]]:
    """The models and rounds and what is ranked beside the first effect, or beside another in its place."""
    if not len(chain[1:]) == len(rounds) == 1:
        return chain, rounds, ranked
    other = another_first(session, chain[0], chain[1], rounds[0], ranked)
    if other is None or not _staged(session, stages, other.label, other.fit):
        return chain, rounds, ranked
    session.decide(f"{other.label}: {other.why}")
    ranked = finite_first(session, with_other_starts(session, other.fit, other.ranked))
    return [chain[0], other.fit], [other.round], ranked


def _better(session: Session, base: Fit, first: Fit) -> Fit:
    """The calibration, or that from where a beginning is explained."""
    try:
        return min(
            base, fit(session.fitting, first.hypothesis, base.unknowns, precise=True), key=lambda each: each.cost
        )
    except ArithmeticError:  # beyond the beginning nothing holds it
        return base


def _revised(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], stages: list[Stage]
) -> tuple[list[Fit], list[list[Ranked]]]:
    """The models and rounds after the effects were held against each other: needless, others in their places, fewer."""
    chain, rounds = _pruned(session, chain, rounds, stages, newest=len(rounds) - 1)
    chain, rounds = _exchanged(session, chain, rounds, stages, range(len(rounds) - 1))
    while True:
        fewer = one_alone(session, chain[0], chain[-1]) or with_fewer(session, chain[0], chain[-1], rounds)
        if fewer is None or not _staged(session, stages, fewer.label, fewer.fit):
            return chain, rounds
        chain, rounds = _with(session, chain, fewer.fit), fewer.rounds
        if len(rounds) > 1:
            chain, rounds = _exchanged(session, chain, rounds, stages, range(len(rounds)))


def _with(session: Session, chain: list[Fit], chosen: Fit) -> list[Fit]:
    """The models so far and one more, with steps as fine as it needs, on the noise that it leaves."""
    chosen = session.resolve(chosen)
    learnt = relearn(session, chosen)
    return [*(chain if learnt is chosen else fitted_again(session, chain)), learnt]


def _exchanged(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], stages: list[Stage], waiting: Sequence[int]
) -> tuple[list[Fit], list[list[Ranked]]]:
    """The models and rounds after some effects were judged again beside the others, and what that made needless."""
    after = looked_for_anew(session, chain[0], exchanged(session, chain[0], chain[-1], rounds, waiting))
    if after.newest is None:
        return chain, after.rounds
    if not _staged(session, stages, "; ".join(after.labels), after.fit):
        return chain, rounds
    return _pruned(session, [*chain, after.fit], after.rounds, stages, newest=after.newest)


def _pruned(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], stages: list[Stage], *, newest: int
) -> tuple[list[Fit], list[list[Ranked]]]:
    """The models and rounds without the effects that a new one has made needless."""
    for index, less in pruned(session, chain[0], chain[-1], newest=newest):
        if not _staged(session, stages, f"- {chain[-1].hypothesis.effects[index].label()}", less):
            break
        chain = [*chain, less]
        rounds = [*rounds[:index], *rounds[index + 1 :]]
    return chain, rounds


def _staged(session: Session, stages: list[Stage], label: str, result: Fit) -> bool:
    """Whether another model becomes the next stage; not one, told so, whose motion is lost beyond what was fitted."""
    try:
        stages.append(session.stage(label, result.hypothesis))
    except ArithmeticError:
        session.decide(f"{label}: not done, since the motion leaves the finite numbers in the rest of the same records")
        return False
    return True


def _ended(
    session: Session,
    chain: Sequence[Fit],
    rounds: list[list[Ranked]],
    stages: list[Stage],
    holdout: Sequence[AnyRecord],
) -> tuple[Verdict, Fit, Fit]:
    """The verdict, the model that stands, and the same on all records with honest intervals.

    An effect whose size these intervals do not tell from none, or whose law or place they do not tell, is taken out,
    with its round. Before that, a law or a place gives way to a simpler law of its round that explains as much, and a
    size, beside a number at the end of its tolerance, to a law that needs none there. What is established gives way to
    what all records speak for. A kind that gave way is out: it does not come back to its place. The last round stays
    where it is needed to show what was weighed.
    """
    taken_out, looked = False, bool(rounds)
    predicts = partial(predicted, session, holdout, chain[0].hypothesis)
    final, weighed, out = chain[-1], rounds[:1], [set[str]() for _ in rounds]
    while True:
        verdict = verdict_of(session, chain[0], final, taken_out=taken_out, looked=looked)
        final = final if verdict == "missing_effect" else chain[0]
        last = settled(session, final)
        doubted = in_doubt(session, chain[0], final, last, predicts)
        if verdict != "missing_effect":
            rounds += [] if rounds else weighed
            return verdict, final, last
        if doubted is None:
            exchange = _ahead(session, chain[0], final, rounds, out, predicts)
            if exchange is None or not _exchanged_for(session, stages, final, *exchange):
                return verdict, final, last
            index, other = exchange
            out[index].add(final.hypothesis.effects[index].kind)
            final, rounds[index] = other.fit, other.ranked
            continue
        index, why = doubted
        effect = final.hypothesis.effects[index]
        out[index].add(effect.kind)
        look = within_tolerances if why == NO_SIZE else instead_of
        instead = look(session, chain[0], final, index, rounds[index], out[index])
        if instead is not None and _exchanged_for(session, stages, final, index, instead, why):
            final, rounds[index] = instead.fit, instead.ranked
            continue
        session.decide(f"{effect.label()} taken out again: {why}")
        taken_out = True
        label, less = f"- {effect.label()}", fit_without(session, chain[0], final, index)
        if less is not None and _staged(session, stages, label, less):
            final = less
        else:
            final = chain[0]
            stages.append(session.stage(label, final.hypothesis))
        weighed = [rounds.pop(index)]
        out.pop(index)
        del rounds[len(final.hypothesis.effects) :]  # what was weighed beside it and not taken


def _ahead(
    session: Session,
    calibrated: Fit,
    final: Fit,
    rounds: list[list[Ranked]],
    out: Sequence[Collection[str]],
    predicts: Callable[[Hypothesis], bool],
) -> tuple[int, Instead] | None:
    """The first effect against which all records speak for another, and that; the rounds are held against them.

    No kind that is out comes back: pieces are begun by the model that stands.
    """
    for index in range(len(final.hypothesis.effects)):
        rounds[index], ahead = told_by_all(session, rounds[index], final, index)
        for each in (each for each in ahead if each.row.effect.kind not in out[index]):
            other = ahead_by_all(session, calibrated, final, index, rounds[index], each, predicts)
            if other is not None:
                return index, other
    return None


def _exchanged_for(
    session: Session, stages: list[Stage], final: Fit, index: int, other: Instead, why: str = ""
) -> bool:
    """Whether another law takes an effect's place as the next stage, told."""
    now = other.fit.hypothesis.effects[index]
    label = f"{final.hypothesis.effects[index].label()} exchanged for {now.label()}"
    done = _staged(session, stages, label, other.fit)
    if done:
        session.decide(f"{label}, {other.words}{why and ': '}{why}; {now.in_words()}")
    return done


def _open(
    given: Hypothesis, kinds: Registry, records: Sequence[AnyRecord], seed: int, jobs: int, progress: Progress
) -> Session:
    progress(f"estimating the noise of {len(records)} records")
    everything = prepare(given, records, jobs, np.random.default_rng(seed))
    limits = horizons(everything, given)
    session = Session(everything, cut_to(everything, FIT_SECONDS, limits), limits, kinds, progress, seed)
    for limit, target in zip(limits, everything.timed, strict=True):
        if limit.seconds < target.record.duration:
            session.decide(limit.in_words)
        bound = " (a bound from above: the structure may move there, too)" if target.noise.at_most else ""
        heard = f"sensors' noise from {target.noise.method}{bound}"
        session.decide(f"{limit.record}: {heard}; {target.noise.excitation_method}")
    for rest in everything.at_rest:
        session.decide(f"{rest.record.name}: compared with the model linearised at rest; noise from {rest.method}")
    if not everything.timed:
        session.decide(f"{AT_REST_ONLY}: laws are seen by their tangents, and effects in time not at all")
    return session


def _calibration_in_words(base: Fit) -> str:
    far = strained(base)
    words = f"calibrated within the tolerances: residual {base.ratio:.2f} times the noise"
    if far:
        moves = ", ".join(f"{u.parameter.label} by {u.get(base.hypothesis):+.1f} sigma" for u in far)
        return f"{words}, but only by moving {moves}"
    return words
