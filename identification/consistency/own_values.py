"""A number with a value of its own in each of several parts of the data, everything else in common."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from identification.consistency.cells import Cell, Weighted
from identification.consistency.finding import sigmas_of
from identification.hypothesis import LARGEST_SIGMA
from models.arrays import FloatArray

Groups = tuple[int, ...]
"""For each cell, the group whose value of the number it sees."""

NOT_TOLD = 1e-6
"""Information that stands for none, so that what no datum tells has a variance."""


@dataclass(frozen=True, eq=False)
class OwnValues:
    """One number, re-estimated in each group of cells.

    Attributes:
        groups: (B,) those that tell it to ``LARGEST_SIGMA`` tolerances.
        x: (B,) its coordinate in each.
        std: (B,) standard deviations.
        chi2: by which one common value is worse, with B - 1 degrees of freedom.
        sigma: its significance.
        moves: (n_cells, p) step of every unknown from the fit, as each cell sees it.
        weighs: (n_cells, p) coefficients of the Jacobian's rows in the contrast whose square over its variance is chi2.
    """

    groups: tuple[int, ...]
    x: FloatArray
    std: FloatArray
    chi2: float
    sigma: float
    moves: FloatArray
    weighs: FloatArray


@dataclass(frozen=True, eq=False)
class Parts:
    """A fit as the sum of its parts.

    Attributes:
        cells: of all data.
        x: (p,) fitted coordinates.
        prior: (p,) 1 where 0 +- 1 is known beforehand, else 0.
        in_time: whether the two cells of a record are early and late, and not low and high.
    """

    cells: Sequence[Cell]
    x: FloatArray
    prior: FloatArray
    in_time: bool

    def along(self, data: Sequence[Weighted], coefficients: FloatArray) -> list[FloatArray]:
        """(n_data,) sum of the Jacobian's rows with coefficients of its own in each cell, one a record.

        Args:
            data: the records, in the cells' order.
            coefficients: (n_cells, p).
        """
        of_cells, sums = iter(coefficients), []
        for record in data:
            parts = record.times if self.in_time else record.bands
            sums.append(np.sum([next(of_cells) @ rows for rows in parts], axis=0))
        return sums

    def own_values(
        self, number: int, groups: Groups, compared: Sequence[int], beside: Mapping[int, Groups]
    ) -> OwnValues:
        """The number's values in the groups, from one linear least-squares step from the fit.

        What is known beforehand holds for the other numbers; each value of this one comes from its group's data alone.

        Args:
            number: index of the unknown.
            groups: of the cells.
            compared: groups among which a common value is tested.
            beside: other numbers that have values of their own already, each with its groups.
        """
        split = {**beside, number: groups}
        rows: list[tuple[int, int | None]] = []
        for i in range(len(self.x)):
            rows += [(i, b) for b in sorted(set(split[i]))] if i in split else [(i, None)]
        index = np.array([i for i, _ in rows])
        seen = np.array([[b is None or split[i][c] == b for c in range(len(self.cells))] for i, b in rows], dtype=float)
        known = np.array([0.0 if i in split else self.prior[i] for i, _ in rows])
        normal, slope = np.diag(known + NOT_TOLD), known * self.x[index]
        for sees, cell in zip(seen.T, self.cells, strict=True):
            normal += np.outer(sees, sees) * cell.information[np.ix_(index, index)]
            slope += sees * cell.score[index]
        covariance = inverse(normal)
        step = -covariance @ slope
        own = [k for k, (i, b) in enumerate(rows) if i == number and b in compared and covariance[k, k] < TOLD]
        x, spread = (self.x[index] + step)[own], covariance[np.ix_(own, own)]
        contrast = _contrast(x, spread)
        chi2 = float(contrast @ spread @ contrast)
        place = (index[:, None] == np.arange(len(self.x))).astype(float)
        return OwnValues(
            groups=tuple(rows[k][1] or 0 for k in own),
            x=x,
            std=np.sqrt(np.diag(spread)),
            chi2=chi2,
            sigma=sigmas_of(chi2, len(own) - 1),
            moves=seen.T @ (step[:, None] * place),
            weighs=seen.T @ ((covariance[:, own] @ contrast)[:, None] * place),
        )


TOLD = LARGEST_SIGMA**2
"""Variance above which a group does not tell a number."""


def inverse(matrix: FloatArray) -> FloatArray:
    """The inverse of a positive definite matrix whose unknowns have units of very different sizes.

    Args:
        matrix: (m, m).
    """
    size = np.sqrt(np.diag(matrix))
    return np.asarray(np.linalg.inv(matrix / np.outer(size, size)) / np.outer(size, size))


def _contrast(x: FloatArray, covariance: FloatArray) -> FloatArray:
    """Coefficients of the combination that speaks most against a common value; its variance is its chi-square."""
    if len(x) < 2:
        return np.zeros(len(x))
    weight = inverse(covariance)
    common = float((weight @ x).sum() / weight.sum())
    return np.asarray(weight @ (x - common))
