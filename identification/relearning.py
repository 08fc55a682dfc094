"""The noise learnt anew from what a model leaves, and fits and evidence on the noise as it is now."""

from dataclasses import replace

import numpy as np

from identification.evidence import Ranked, reweighed
from identification.fit import Fit, fit
from identification.noise import Noise
from identification.noise_left import noise_left, noise_uncovered, with_noise
from identification.pieces import Piece, begun_by
from identification.session import Session

MOST_LOWERINGS = 3
"""A fit on noise taken far too high is held by the tolerances and leaves more than it would: so it is repeated."""

REWEIGHING_TOLERANCE = 2e-3
"""Relative decrease of the cost that ends a fit on new weights."""


def relearn(session: Session, result: Fit, *, uncover: bool = False) -> Fit:
    """The fit again with the noise lowered to what it leaves, for as long as it leaves clearly less.

    Args:
        session: its noise is changed.
        result: the best there is.
        uncover: also tell the noise of excitations that hide theirs.
    """
    for _ in range(MOST_LOWERINGS):
        targets, rng = session.fitting.timed, np.random.default_rng(session.seed)
        noises = noise_left(session.fitting, result.residual)
        if uncover:
            noises = noise_uncovered(session.fitting, result.hypothesis, result.residual, rng)
        by_name = {target.record.name: noise for target, noise in zip(targets, noises, strict=True)}
        noises = [by_name[t.whole_name] if isinstance(t, Piece) else by_name[t.record.name] for t in targets]
        changed = [(t, n) for t, n in zip(targets, noises, strict=True) if n is not t.noise and not t.begins_later]
        if not changed:
            break
        for target, noise in changed:
            session.decide(f"{target.record.name}: {_in_words(target.noise, noise)}")
        ordered = [by_name[target.record.name] for target in session.everything.timed]
        session.fitting = with_noise(session.fitting, noises, result.hypothesis, rng)
        session.everything = with_noise(session.everything, ordered, result.hypothesis, rng)
        session.relearnt = True
        result = session.resolve(fit(session.fitting, result.hypothesis, result.unknowns, precise=True, like=result))
    return result


def reweigh(session: Session, chain: list[Fit], rounds: list[list[Ranked]]) -> tuple[list[Fit], list[list[Ranked]]]:
    """Fits and evidence on the noise that the best effect of the last round leaves, where that is clearly lower.

    Args:
        session: its noise is changed.
        chain: the models so far.
        rounds: effects ranked in each round.
    """
    first = rounds[-1][0] if rounds[-1] and rounds[-1][0].refitted else None
    found = chain[-1] if first is None else first.fit
    best = relearn(session, found, uncover=True)
    if best is found:
        return chain, rounds
    session.decide("all models fitted and weighed again on the lower noise")
    if first is None:
        chain = [*chain[:-1], best]
    else:
        rounds = [*rounds[:-1], [_with_fit(first, best), *rounds[-1][1:]]]
    return everything_again(session, chain, rounds, ended=best)


def everything_again(
    session: Session, chain: list[Fit], rounds: list[list[Ranked]], ended: Fit | None = None
) -> tuple[list[Fit], list[list[Ranked]]]:
    """The models so far and every refitted suspect, on the records and the noise as they are now.

    Args:
        session: with records and noise as they are now.
        chain: the models so far.
        rounds: effects ranked in each round.
        ended: one of them that is there already.
    """
    rows = [[row for row in ranked if row.refitted] for ranked in rounds]
    fits = [[_row_again(session, row, ranked[0], ended) for row in ranked] for ranked in rows]
    again = [[_with_fit(*pair) for pair in zip(*both, strict=True)] for both in zip(rows, fits, strict=True)]
    return fitted_again(session, chain, ended), [reweighed(old, new) for old, new in zip(rounds, again, strict=True)]


def fitted_again(session: Session, results: list[Fit], ended: Fit | None = None) -> list[Fit]:
    """The fits again on the noise as it is now.

    Args:
        session: with the noise as it is now.
        results: each at its minimum under another noise.
        ended: one of them that is there already.
    """
    return [result if result is ended else _again(session, result) for result in results]


def _row_again(session: Session, row: Ranked, first: Ranked, ended: Fit | None) -> Fit:
    """The fit of a row again; of one that another noise of the same records does not bring near, where it is."""
    if row.fit is ended:
        return row.fit
    if session.fitting.n_judged != row.fit.n_data or row.log_evidence > first.log_evidence - HOPELESS:
        return _again(session, row.fit)
    fitting, begun = begun_by(session.fitting, row.fit.hypothesis)
    return fit(fitting, begun, row.fit.unknowns, max_iterations=0, like=row.fit)


HOPELESS = 1000.0
"""Logarithm of the odds against a row that another noise does not bring near: where it rises by a half, in all eight
channels alike, an eighteenth of that is left."""


def _again(session: Session, result: Fit) -> Fit:
    fitting, begun = begun_by(session.fitting, result.hypothesis)
    return fit(
        fitting,
        begun,
        result.unknowns,
        max_iterations=4,
        tolerance=REWEIGHING_TOLERANCE,
        precise=True,
        like=result,
    )


def _with_fit(row: Ranked, result: Fit) -> Ranked:
    return replace(row, fit=result, effect=result.hypothesis.effects[-1])


def _in_words(before: Noise, now: Noise) -> str:
    share = now.sensors / np.maximum(before.sensors, np.finfo(float).tiny)
    parts = []
    if np.any(share < 1.0):
        parts.append(
            f"the noise of {np.sum(share < 1.0)} sensors lowered, to {share.min():.2g} of its estimate at the least: "
            "the model leaves no more in its quietest bands"
        )
    if now.excitation != before.excitation:
        parts.append(f"noise of the excitation {now.excitation_method}")
    return "; ".join(parts)
