"""Forces from channels line by line: Tikhonov's regularisation, whose penalty the channels themselves choose.

Source: A. N. Tikhonov, V. Y. Arsenin, Solutions of Ill-Posed Problems (1977), chapter 2; for the penalty
A. P. Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39 (1977) 1, and D. J. C. MacKay, Neural Computation 4
(1992) 415.
"""

import numpy as np
from scipy import fft

from models.arrays import ComplexArray, FloatArray

EXPECTATIONS = 10
"""Turns of expectation and maximisation in each estimate; the next estimate goes on from there."""

BANDS = 24
"""Bands of equal ratio within which a force's density is taken as constant."""

LEAST_TOLD = 1e-12

LEAST_FALL = 0.1
"""A density falls to this share of itself at most in a turn, so that it can rise again."""

LEAST_SHARE = 1e-6
"""Least density, as a share of the noise's in the line that tells most: less is no force, but loses digits."""

TINY = 1e-300

RIDGE = 1e-9
"""Share of a free decay's own weight that holds its size where two decays look the same."""


class ForceEstimate:
    """Solves e = H g + B x + noise for forces g that repeat with the record and free decays x.

    Args:
        frf: (lines, n_channels, n_places) H, channel unit per N.
        decays: (lines, n_channels, n_decays) B, spectra of free decays.
        variance: (lines, n_channels) of the noise's spectrum, SI^2.
        n_samples: of the record.

    Attributes:
        surprise: minus the logarithm of the evidence for the last forces, but for a constant.
        evidence: logarithm of the odds for them against none.
    """

    def __init__(self, frf: ComplexArray, decays: ComplexArray, variance: FloatArray, n_samples: int) -> None:
        scale = np.sqrt(np.sum(np.abs(decays) ** 2 / variance[:, :, None], axis=(0, 1)))
        self._decays = decays / scale
        self._n_samples = n_samples
        self._weighted = (frf.conj() / variance[:, :, None]).swapaxes(1, 2)
        self._weighted_decays = (self._decays.conj() / variance[:, :, None]).reshape(-1, len(scale)).T
        self._normal = self._weighted @ frf
        self._cross = self._weighted @ self._decays
        self._own = np.real(self._weighted_decays @ self._decays.reshape(-1, len(scale)))
        edges = np.unique(np.round(np.geomspace(min(4, len(frf)), len(frf), BANDS + 1)).astype(int))
        self._edges = np.concatenate([[0], edges[1:]])
        self._variance = variance
        self.surprise = self.evidence = 0.0
        self._density: FloatArray | None = None
        weight = np.real(np.einsum("lpp->lp", self._normal))
        most = np.maximum.reduceat(weight, self._edges[:-1], axis=0)
        self._least = np.repeat(LEAST_SHARE / np.maximum(most, TINY), np.diff(self._edges), axis=0)
        self._spread = np.zeros_like(self._normal)

    def force(self, left: ComplexArray) -> FloatArray:
        """(n_places, N) the forces, N, in the band in which they can be told.

        Args:
            left: (n_channels, lines) spectrum of what they have to explain.
        """
        seen = left.T
        projected = np.einsum("lpc,lc->lp", self._weighted, seen)
        if self._density is None:
            self._density = self._first_density(projected)
        of_decays = np.real(self._weighted_decays @ seen.ravel())
        for _ in range(EXPECTATIONS):
            spread = np.linalg.inv(
                self._normal + np.einsum("lp,pq->lpq", 1.0 / self._density, np.eye(projected.shape[1]))
            )
            told = spread @ self._cross
            own = self._own - np.real(np.einsum("lpd,lpe->de", self._cross.conj(), told, optimize=True))
            rest = of_decays - np.real(np.einsum("lpd,lp->d", told.conj(), projected))
            decay = np.linalg.solve(own + RIDGE * np.eye(len(own)), rest)
            force = np.einsum("lpq,lq->lp", spread, projected) - told @ decay
            density, own_spread = self._density, np.real(np.einsum("lpp->lp", spread))
            self._density = self._next_density(np.abs(force) ** 2, own_spread)
        explained = float(np.real(np.vdot(projected, force))) + float(of_decays @ decay)
        freedom = float(np.sum(np.log(density))) - float(np.sum(np.linalg.slogdet(spread)[1]))
        alone = float(of_decays @ np.linalg.solve(self._own + RIDGE * np.eye(len(self._own)), of_decays))
        chi2 = float(np.sum(np.abs(seen) ** 2 / self._variance))
        self.surprise, self.evidence = chi2 - explained + freedom, explained - alone - freedom
        self._spread = spread
        return self._in_time(force)

    def error(self, rng: np.random.Generator) -> FloatArray:
        """(n_places, N) a realisation of the last estimate's error, N.

        Args:
            rng: of the realisation.
        """
        lines, places = self._spread.shape[:2]
        random = rng.standard_normal((2, lines, places, 1)) * np.sqrt(0.5)
        root = np.linalg.cholesky(self._spread)
        return self._in_time((root @ (random[0] + 1j * random[1]))[:, :, 0])

    def _in_time(self, force: ComplexArray) -> FloatArray:
        full = np.zeros((self._n_samples // 2 + 1, force.shape[1]), complex)
        full[: len(force)] = force
        return np.asarray(fft.irfft(full, self._n_samples, axis=0).T)

    def _first_density(self, projected: ComplexArray) -> FloatArray:
        """The same at all lines, as the lines that tell most say; it stays where a band tells nothing."""
        weight = np.real(np.einsum("lpp->lp", self._normal)) + np.finfo(float).tiny
        each = np.sum(np.abs(projected) ** 2 / weight, axis=0) / np.sum(weight, axis=0)
        return np.broadcast_to(each, projected.shape)

    def _next_density(self, power: FloatArray, spread: FloatArray) -> FloatArray:
        """The lesser of the expectation, which rises fast, and MacKay's ratio, which falls fast in noise."""
        assert self._density is not None
        told = np.maximum(self._smooth(1.0 - spread / self._density), LEAST_TOLD)
        size = self._smooth(power)
        return np.maximum(
            np.minimum(size + self._smooth(spread), size / told), np.maximum(LEAST_FALL * self._density, self._least)
        )

    def _smooth(self, power: FloatArray) -> FloatArray:
        """Band means at every line."""
        width = np.diff(self._edges)
        mean = np.add.reduceat(power, self._edges[:-1], axis=0) / width[:, None]
        return np.asarray(np.repeat(mean, width, axis=0))
