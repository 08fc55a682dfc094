"""A record's periods as a steady part, a transient that dies away, a trend and noise, line by line.

On a line, period m holds S + C mu^m + D tau_m + noise, tau running from -1/2 to 1/2. A free vibration with the pole
lambda is multiplied by mu = exp(lambda T) from one period T to the next whatever the line, so the lines of a small
region share the slowest mu there; the conjugate pole's part, small near the resonance, is left to the noise. A trend is
looked for on excited lines alone: elsewhere there is nothing that a gain could change.

Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), sections 2.5 (sample
variance over periods) and 6.3.2 (a transient is smooth in frequency and dies with the poles).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.stats import f as f_distribution

from models.arrays import BoolArray, ComplexArray, FloatArray

REGION = 8
"""Neighbouring lines that share the decay of their transient."""

TAKEN = 0.05
"""Probability below which a region's transient is taken out: one that is missed passes for more than one too many."""

RADII = (0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.88, 0.94, 0.975)
"""Sizes of mu that are tried: a mode that loses less from one period to the next is steady."""

ANGLES = 24

GRID = np.array([radius * np.exp(2j * np.pi * angle / ANGLES) for radius in RADII for angle in range(ANGLES)])

DOUBTED = 4.0
"""What a transient leaves in a part over how far that part moves without the first period: 1 / (1 - r) where what is
left keeps r = 3/4 from period to period."""

MOST_ALIKE = 0.7
"""Squared cosine between a transient and the steady part beyond which periods this few cannot tell them apart."""

REACH = np.array([dx + 1j * dy for dx in (-1, 0, 1) for dy in (-1, 0, 1)])

ROUNDS = 4
"""Of looking closer about the best mu."""

NEGLIGIBLE = 1e-6
"""Share of a column's square, beyond the others' reach, below which it is no column of its own."""

ROUNDING = 1e-24
"""Least noise of a region, as a share of the mean power of all lines: records without noise are simulated to that."""

STEADY, TRANSIENT, TREND = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Columns:
    """What the periods of each line are made of.

    Attributes:
        design: (K, M, 3) steady part, transient and trend; 0 where a line has none.
        inverse: (K, 3, M) from periods to the parts' sizes.
        freedom: (K,) complex degrees of freedom that are left to the noise.
        p_transient: (n_regions,) probability of as much of a transient by chance.
    """

    design: ComplexArray
    inverse: ComplexArray
    freedom: FloatArray
    p_transient: FloatArray

    def parts(self, periods: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """(3, n, K) sizes of the parts of channels and (n, K) variance of the noise of a period.

        Args:
            periods: (M, n, K).
        """
        sizes = np.einsum("kpm,mnk->pnk", self.inverse, periods, optimize=True)
        left = periods - np.einsum("kmp,pnk->mnk", self.design, sizes, optimize=True)
        return sizes, np.sum(np.abs(left) ** 2, axis=0) / np.maximum(self.freedom, 1.0)

    def later(self) -> "Columns":
        """The same for all periods but the first."""
        design = self.design[:, 1:]
        return replace(
            self, design=design, inverse=np.asarray(np.linalg.pinv(design), complex), freedom=self.freedom - 1.0
        )

    def leftover(self, periods: ComplexArray, part: int, lines: BoolArray) -> FloatArray:
        """(n, K) square by which what is left of the transient may shift a part.

        A transient of several modes does not die like one. What it leaves is most in the first period: a part changes
        without that by more than noise makes it, on average over the neighbours.

        Args:
            periods: (M, n, K).
            part: which.
            lines: (K,) on which it counts.
        """
        if len(periods) < 3:
            return np.zeros(periods.shape[1:])
        later, (sizes, noise) = self.later(), self.parts(periods)
        change = np.abs(sizes[part] - later.parts(periods[1:])[0][part]) ** 2
        beyond = (change - noise * (later.variance(part) - self.variance(part))) * lines
        around = uniform_filter1d(np.stack([*beyond, lines.astype(float)]), 2 * REGION + 1, axis=1, mode="constant")
        mean = around[:-1] / np.maximum(around[-1], 0.5 / (2 * REGION + 1))
        return np.asarray(DOUBTED**2 * np.maximum(mean, 0.0))

    def variance(self, part: int) -> FloatArray:
        """(K,) of a part's size over that of the noise of a period; 0 where a line does not have it."""
        return np.asarray(np.sum(np.abs(self.inverse[:, part]) ** 2, axis=1))

    def mean_square(self, part: int) -> FloatArray:
        """(K,) mean over the periods of the square of a part of size 1."""
        return np.asarray(np.mean(np.abs(self.design[:, :, part]) ** 2, axis=1))


def columns_of(periods: ComplexArray, excited: BoolArray, *, trend: bool) -> Columns:
    """The parts that the periods of a record need.

    Args:
        periods: (M, n, K) of the responses.
        excited: (K,).
        trend: whether excited lines may change in proportion to time.
    """
    n_periods, n_lines = len(periods), len(excited)
    time = (np.arange(n_periods) - 0.5 * (n_periods - 1)) / (n_periods - 1)
    base = np.zeros((2, -(-n_lines // REGION), n_periods, 3), complex)
    base[..., STEADY] = 1.0
    base[1, ..., TREND] = time if trend else 0.0
    if n_periods < 3:
        return _columns(excited, base, np.ones(base.shape[1]))
    # Sensors count by their noise in a region, which is known once their transient is: so twice.
    changes = np.mean(np.abs(periods - periods.mean(axis=0)) ** 2, axis=0)
    mu, p_first = _transients(*_products(periods, excited, changes), base)
    _, noise = _columns(excited, _with(base, mu), p_first).parts(periods)
    mu, p = _transients(*_products(periods, excited, noise), base)
    return _columns(excited, _with(base, np.where(p < TAKEN, mu, 0.0)), np.maximum(p, p_first))


def _columns(excited: BoolArray, base: ComplexArray, p_transient: FloatArray) -> Columns:
    """The columns of every line from those of the regions, not excited and excited."""
    region = np.arange(len(excited)) // REGION
    design = base[excited.astype(int), region]
    inverse = np.linalg.pinv(base)[excited.astype(int), region]
    rank = np.any(design != 0.0, axis=1).sum(axis=1)
    return Columns(design, inverse, (design.shape[1] - rank).astype(float), p_transient)


def _with(base: ComplexArray, mu: ComplexArray) -> ComplexArray:
    """The base, (2, n_regions, M, 3), with each region's transient, none where its factor is 0."""
    full = base.copy()
    full[..., TRANSIENT] = mu[:, None] ** np.arange(base.shape[2]) * (mu != 0.0)[:, None]
    return full


def _transients(products: ComplexArray, counts: FloatArray, base: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """(n_regions,) factor from period to period and probability of as much of a transient by chance.

    Args:
        products: (2, n_regions, M, M) of the periods, over channels and lines not excited and excited.
        counts: (2, n_regions) terms in each.
        base: (2, n_regions, M, 3) other columns.
    """
    n_periods = base.shape[2]
    mu = _best(products, base, GRID)
    for turn in range(ROUNDS):
        about = mu[:, None] + 0.1 / 3.0**turn * np.maximum(0.15, 1.0 - np.abs(mu[:, None])) * REACH
        mu = _best(products, base, np.where(np.abs(about) < 1.0, about, mu[:, None]))
    rank = np.any(base != 0.0, axis=2).sum(axis=2)
    before, after = _left(products, base), _left(products, _with(base, mu))
    used, left = counts.sum(axis=0) + 1, np.sum(counts * (n_periods - rank - 1), axis=0) - 1
    spread = np.maximum(after, 1e-12 * before + np.finfo(float).tiny) / np.maximum(left, 1.0)
    ratio = (before - after) / used / spread
    chance = f_distribution.sf(ratio, 2.0 * used, 2.0 * np.maximum(left, 1.0))
    # The best of many mu was taken: M sizes and M angles of it can be told apart in M periods.
    return mu, np.where(left >= 1.0, np.minimum(chance * n_periods**2, 1.0), 1.0)


def _complement(base: ComplexArray) -> ComplexArray:
    """(2, n_regions, M, M) projections onto what the columns do not reach."""
    return np.asarray(np.eye(base.shape[2]) - base @ np.linalg.pinv(base))


def _left(products: ComplexArray, base: ComplexArray) -> FloatArray:
    """(n_regions,) squares that the columns leave."""
    return np.asarray(np.einsum("krmn,krmn->r", products, _complement(base).conj()).real)


def _best(products: ComplexArray, base: ComplexArray, tried: ComplexArray) -> ComplexArray:
    """(n_regions,) the one of the tried factors, (n,) or (n_regions, n), whose transient explains most."""
    n_periods = base.shape[2]
    powers = tried[..., None] ** np.arange(n_periods)
    squares = np.sum(np.abs(powers) ** 2, axis=-1)
    told = np.abs(powers.sum(axis=-1)) ** 2 < MOST_ALIKE * n_periods * squares
    outer = (powers[..., :, None] * powers[..., None, :].conj()).reshape(*tried.shape, -1)
    explained = np.zeros((base.shape[1], tried.shape[-1]))
    for product, complement in zip(products, _complement(base), strict=True):
        square, size = (_quadratic(form, outer) for form in (complement @ product @ complement, complement))
        alone = told & (size > NEGLIGIBLE * squares)
        explained += np.where(alone, square / np.where(alone, size, 1.0), 0.0)
    best = np.argmax(explained, axis=1)
    return tried[best] if tried.ndim == 1 else np.asarray(tried[np.arange(len(best)), best])


def _quadratic(form: ComplexArray, outer: ComplexArray) -> FloatArray:
    """(n_regions, n) v* form v of each region's Hermitian form from the products v v*, flat."""
    flat = form.reshape(len(form), -1).conj()
    if outer.ndim == 2:
        return np.asarray((flat @ outer.T).real)
    return np.asarray((outer @ flat[:, :, None])[..., 0].real)


def _products(periods: ComplexArray, excited: BoolArray, noise: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """(2, n_regions, M, M) products of the periods over channels and lines, not excited and excited, and their number.

    Channels count by their noise in the region.
    """
    n_periods, n_channels, n_lines = periods.shape
    padded = -n_lines % REGION
    held = np.pad(periods, ((0, 0), (0, 0), (0, padded))).reshape(n_periods, n_channels, -1, REGION)
    sizes = np.pad(noise, ((0, 0), (0, padded))).reshape(n_channels, -1, REGION).mean(axis=2, keepdims=True)
    held = held / np.sqrt(np.maximum(sizes, ROUNDING * np.mean(np.abs(periods) ** 2)))
    kinds = np.pad(np.stack([~excited, excited]), ((0, 0), (0, padded))).reshape(2, -1, REGION)
    products = np.stack([np.einsum("mnrg,lnrg,rg->rml", held, held.conj(), kind, optimize=True) for kind in kinds])
    return products, n_channels * kinds.sum(axis=2)
