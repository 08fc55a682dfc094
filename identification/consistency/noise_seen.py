"""How much a combination of residuals really varies: as the residuals show it, and as the force's noise makes it.

A force's noise passes the contacts: what it does to one line it does to others and later, which no density of noise
tells. So the combination is formed of realisations of that noise too, as the model carries it.
"""

from collections.abc import Sequence
from functools import cached_property
from math import inf

import numpy as np

from identification.consistency.cells import Weighted
from identification.consistency.finding import sigmas_of
from identification.consistency.own_values import Parts
from identification.evaluate import Evaluator, TimeTarget
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from identification.noise_changes import changes_by_noise
from models.arrays import FloatArray

REALISATIONS = 24
"""Of the noise of each record's excitation."""


class Scatter:
    """Significances that account for how the noise comes to the data.

    Args:
        evaluator: records that were fitted.
        hypothesis: the model that carries the force's noise.
        data: the records, weighted.
        rng: of the realisations.
    """

    def __init__(
        self, evaluator: Evaluator, hypothesis: Hypothesis, data: Sequence[Weighted], rng: np.random.Generator
    ) -> None:
        self.evaluator = evaluator
        self.hypothesis = hypothesis
        self.data = data
        self.rng = rng

    def sigmas(
        self, parts: Parts, combination: FloatArray, moves: FloatArray, chi2: float, degrees: int, least: float
    ) -> float:
        """Significance of a chi-square, less where its combination varies more than was assumed.

        Sums over the channels of a line are taken as one datum each. With M realisations of a noise that makes the
        share s of the variance, this is known by M / s^2 degrees of freedom.
        Source: K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986) 13, the variance of clustered data; F. E. Satterthwaite,
        Biometrics Bulletin 2 (1946) 110, the degrees of freedom of a sum of variances.

        Args:
            parts: of the fit, by band or by time.
            combination: (n_cells, p) coefficients of the Jacobian's rows.
            moves: (n_cells, p) steps of the unknowns after which the rest is looked at.
            chi2: of the combination, if the noise is what was assumed.
            degrees: of freedom.
            least: significance up to which the noise is not asked; what is above can only fall.
        """
        sigma = sigmas_of(chi2, degrees)
        if sigma <= least:
            return sigma
        rows = parts.along(self.data, combination)
        assumed = sum(float(row @ row) for row in rows)
        steps = parts.along(self.data, moves)
        seen = sum(
            float(np.sum(record.by_line(row * (record.rest + step)) ** 2))
            for record, row, step in zip(self.data, rows, steps, strict=True)
        )
        sigma = sigmas_of(chi2 / max(1.0, seen / assumed), degrees)
        if sigma <= least or not any(len(each) for each in self.carried):
            return sigma
        carried = sum(
            float(np.mean((each @ row) ** 2)) for each, row in zip(self.carried, rows, strict=True) if len(each)
        )
        own = sum(float(np.sum(row**2 * share)) for row, share in zip(rows, self.own, strict=True))
        known_by = REALISATIONS * ((carried + own) / carried) ** 2 if carried > 0.0 else inf
        return sigmas_of(chi2 / max(1.0, seen / assumed, (carried + own) / assumed), degrees, known_by)

    @cached_property
    def own(self) -> list[FloatArray]:
        """(n_data,) variance that the sensors' own noise has after weighting, one a record."""
        shares = []
        for record in self.data:
            target, share = record.target, record.shared**2
            if isinstance(target, TimeTarget):
                own = np.minimum(target.with_noise(target.noise).density / target.density, 1.0)
                share = share * np.repeat(own.ravel(), 2)
            shares.append(share)
        return shares

    @cached_property
    def carried(self) -> list[FloatArray]:
        """(REALISATIONS, n_data) what the force's noise does to the weighted residual, one a record; or (0, n_data)."""
        rows = []
        for record in self.data:
            target, changes = record.target, list[FloatArray]()
            if isinstance(target, TimeTarget) and target.noise.excitation > 0:
                changes = changes_by_noise(self.evaluator, target, self.hypothesis, self.rng, REALISATIONS)
            rows.append(np.stack(changes) * record.shared if changes else np.empty((0, target.n_data)))
        return rows

    def moved(self, found: Fit) -> FloatArray:
        """(p,) standard deviation by which the excitations' noise moves each number of a fit, in its own coordinate.

        Args:
            found: of the same data, in which that noise counted as if lines and channels did not share it.
        """
        ends = np.cumsum([0, *(target.n_data for target in self.evaluator.targets)]).tolist()
        variance = np.zeros(len(found.unknowns))
        for record, changes, start, end in zip(self.data, self.carried, ends[:-1], ends[1:], strict=True):
            if len(changes):
                steps = (changes / record.shared) @ found.jacobian[:, start:end].T @ found.covariance
                variance += np.mean(steps**2, axis=0)
        return np.asarray(np.sqrt(variance))
