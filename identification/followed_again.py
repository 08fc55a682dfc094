"""What explains the beginning of the records is tried on the rest, in pieces; where it fails there, they are fitted."""

from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator
from identification.fit import Fit, fit
from identification.pieces import Piece, fit_from_own_starts
from identification.session import Session

NEARLY = 1.5
"""Residual over noise that a model may leave in pieces begun by itself: others leave several times the noise."""


def fails_in_pieces(session: Session, final: Fit) -> bool:
    """Whether a model leaves far more than the noise past where it loses the records, and more than before.

    Args:
        session: with the records, told; how far the model follows them is known.
        final: the model that stands.
    """
    own = None if session.pieces else _beside_own_pieces(session, final)
    if own is None:
        return False
    left, seconds = _left_in_pieces(*own)
    session.decide(
        f"in {seconds:.1f} s that were not fitted, followed again from later starts, {left:.2f} times the noise is left"
    )
    return left >= NEARLY * max(1.0, final.ratio)


def go_on(session: Session, base: Fit) -> bool:
    """Whether the rest of the records is fitted from now on, in pieces begun by the calibrated model.

    Args:
        session: with the records.
        base: the calibrated model.
    """
    return not session.pieces and session.follow(session.pieces_by(base.hypothesis))


def begin_again(session: Session, result: Fit, before: Fit) -> bool:
    """Whether pieces that are fitted were begun anew, by a model that comes nearer than the one before.

    Args:
        session: with the records.
        result: what comes nearer.
        before: the model without it.
    """
    is_nearer = bool(session.pieces) and result.ratio < before.ratio
    return is_nearer and session.follow(session.pieces_by(result.hypothesis))


def explains_its_own(session: Session, result: Fit) -> bool:
    """Whether a model comes to the noise in pieces begun by itself, where others are fitted.

    A start that was found by a model without what is missing is off by more than its slopes can tell.

    Args:
        session: with the records, told.
        result: on the others.
    """
    own = _beside_own_pieces(session, result) if session.pieces else None
    if own is None:
        return False
    left, _ = _left_in_pieces(*own)
    label = result.hypothesis.effects[-1].label()
    session.progress(f"in pieces begun by {label} {left:.2f} times the noise is left, {result.ratio:.2f} in all before")
    return left < NEARLY


def _beside_own_pieces(session: Session, result: Fit) -> tuple[Evaluator, Fit] | None:
    """A model fitted to the beginnings and pieces begun by itself; None where there are none, or it is lost in them."""
    pieces = session.pieces_by(result.hypothesis)
    if not pieces:
        return None
    own = session.fitting.with_targets([*session.without_pieces.targets, *pieces])
    try:
        return own, fit_from_own_starts(own, fit(own, replace(result.hypothesis, motions={}), result.unknowns))
    except ArithmeticError:
        return None


def _left_in_pieces(evaluator: Evaluator, found: Fit) -> tuple[float, float]:
    """Residual over noise in the pieces alone, and their seconds."""
    parts = [(piece, part) for piece, part in evaluator.parts_of(found.residual) if isinstance(piece, Piece)]
    chi2, judged = (sum(each) for each in zip(*((float(r @ r), piece.n_judged) for piece, r in parts), strict=True))
    return float(np.sqrt(chi2 / judged)), sum(piece.record.duration for piece, _ in parts)
