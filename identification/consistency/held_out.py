"""One record held out: do the numbers of the others, as well as they know them, predict it?"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from identification.consistency.cells import Cell, Weighted
from identification.consistency.own_values import NOT_TOLD, Parts, inverse
from identification.hypothesis import LARGEST_SIGMA
from models.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class HeldOut:
    """A record against the numbers of the others.

    Attributes:
        record: index.
        fitted: residual over noise with the numbers of all.
        predicted: the same with those of the others, its own unknowns apart.
        others: residual over noise of the other records.
        chi2: by which its own numbers differ from those of the others.
        degrees: of freedom of that.
        moves: (n_cells, p) step of every unknown from the fit, as each cell sees it, where the record is fitted apart.
        weighs: (n_cells, p) coefficients of the Jacobian's rows in the combination whose square over its variance is
            chi2.
    """

    record: int
    fitted: float
    predicted: float
    others: float
    chi2: float
    degrees: int
    moves: FloatArray
    weighs: FloatArray


def held_out(data: Sequence[Weighted], parts: Parts, record: int, is_its_own: BoolArray) -> HeldOut:
    """One record, left out, in linear approximation about the fit of all.

    With the others' covariance C of the common numbers and this record's information A about them, the score of the
    record at the others' numbers has the covariance A + A C A.

    Args:
        data: the records, weighted.
        parts: of the fit, by band.
        record: index.
        is_its_own: (p,) unknowns that concern this record alone; they are fitted to it whatever the others say.
    """
    mine = [cell for cell in parts.cells if cell.record == record]
    rest = [cell for cell in parts.cells if cell.record != record]
    normal, slope = _sum(rest, len(parts.x))
    covariance = inverse(normal + np.diag(parts.prior + NOT_TOLD))
    away = -covariance @ (slope + parts.prior * parts.x)
    information, score = _sum(mine, len(parts.x))
    common, own = np.flatnonzero(~is_its_own), np.flatnonzero(is_its_own)
    taken = np.zeros((len(common), len(own)))
    if len(own):
        inner = information[np.ix_(own, own)] + NOT_TOLD * np.eye(len(own))
        taken = information[np.ix_(common, own)] @ inverse(inner)
    free = information[np.ix_(common, common)] - taken @ information[np.ix_(own, common)]
    at_fit = score[common] - taken @ score[own]
    known = covariance[np.ix_(common, common)]
    speaks, degrees = _most_apart(free, at_fit + free @ away[common], known)
    change = 2.0 * at_fit @ away[common] + away[common] @ free @ away[common]
    before, fitted = float(data[record].rest @ data[record].rest), _ratio([data[record]])
    here = np.zeros(len(parts.x))
    here[common], here[own] = speaks, -taken.T @ speaks
    there = -covariance[:, common] @ (free @ speaks)
    apart = -inverse(information + np.diag(WIDE * parts.prior + NOT_TOLD)) @ score
    is_mine = np.array([cell.record == record for cell in parts.cells])[:, None]
    return HeldOut(
        record=record,
        fitted=fitted,
        predicted=fitted * float(np.sqrt(np.clip(1.0 + change / max(before, TINY), 0.0, None))),
        others=_ratio([each for k, each in enumerate(data) if k != record]),
        chi2=float(speaks @ (free + free @ known @ free) @ speaks),
        degrees=degrees,
        moves=np.where(is_mine, apart, away),
        weighs=np.where(is_mine, here, there),
    )


TINY = 1e-300

WIDE = LARGEST_SIGMA**-2
"""Information on the numbers of a record that is fitted apart: as far as any calibration lets them go."""


def _sum(cells: Sequence[Cell], n: int) -> tuple[FloatArray, FloatArray]:
    information, score = np.zeros((n, n)), np.zeros(n)
    for cell in cells:
        information += cell.information
        score += cell.score
    return information, score


def _ratio(data: Sequence[Weighted]) -> float:
    """Residual over noise."""
    return float(np.sqrt(np.mean(np.concatenate([each.plain for each in data]) ** 2)))


def _most_apart(information: FloatArray, score: FloatArray, covariance: FloatArray) -> tuple[FloatArray, int]:
    """The combination b of a score with covariance V = A + A C A of which b's = b'Vb is chi-square, and its degrees."""
    root = linalg.cholesky(covariance, lower=True)
    told, turn = linalg.eigh(root.T @ information @ root)
    known = told > LEAST_TOLD
    turned = root @ turn[:, known]
    return turned @ ((turned.T @ score) / (told[known] * (1.0 + told[known]))), int(known.sum())


LEAST_TOLD = 1e-4
"""Information of the record over that of the others, in a direction, below which it cannot contradict them."""
