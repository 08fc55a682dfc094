"""From the damping of modes to that of a sleeve: which c, N s/m, gives the rig at rest the identified damping ratios?

Each mode's pole is a function of c alone (``sleeve_poles``). It is tabulated once, exactly, with its derivative; a
series of ratios is then read off the table. Every mode speaks with the precision of its ratio.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import linear_sum_assignment
from scipy.stats import chi2

from identification.decay.course import NORMAL_95
from identification.decay.sleeve_poles import Dashpots, nearest_modes, ratio_slopes, ratios_of
from models.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from models.errors import InputError
from models.linear import Linearised

POINTS = 160
"""Of the table, in equal ratios; with their derivatives they leave 1e-5 of a damping ratio."""

RANGE = 1e-4
"""Smallest damping of the table above 0, as a share of the largest."""

BEYOND_SPRING = 3.0
"""Largest damping of the table, in units at which the dashpot is as stiff as the spring at the lowest mode."""

LOST = 0.1
"""A mode ends where the next eigenvalue is this share of it away from where its derivative points."""

CONTRADICTION = 0.0027
"""Chance, that of three standard deviations, below which ratios contradict every damping of the table."""

AS_GOOD = 4.0
"""Two dampings whose sums of squares differ by less, two standard deviations, explain the ratios alike."""

REFINEMENTS = 8
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False)
class DampingTable:
    """Each mode of the rig at rest over the contact damping of one sleeve.

    Attributes:
        sleeve: its name.
        own: damping that the rig gives it at rest, N s/m; modes are numbered by frequency there, from 0.
        dampings: (n,) N s/m, from 0 on, growing.
        poles: (n, n_modes) 1/s, nan where a mode has ceased to oscillate.
        slopes: (n, n_modes) their derivatives by the damping.
    """

    sleeve: str
    own: float
    dampings: FloatArray
    poles: ComplexArray
    slopes: ComplexArray

    @classmethod
    def of(cls, linear: Linearised, sleeve: str, highest: float, *, most: float | None = None) -> Self:
        """Tabulate.

        Args:
            linear: the rig at rest.
            sleeve: one that touches at rest.
            highest: frequency up to which modes are wanted, Hz.
            most: largest damping, N s/m; None goes on to where the dashpot has stiffened the sleeve.

        Raises:
            InputError: an unknown sleeve, an open one, or no mode up to that frequency.
        """
        dashpots = Dashpots.of(linear, (sleeve,))
        own = float(dashpots.own[0])
        poles, slopes = dashpots.poles(dashpots.own)
        n_modes = int(np.count_nonzero(np.abs(poles) <= 2.0 * np.pi * highest))
        if n_modes == 0:
            raise InputError(
                f"modes up to {highest:g} Hz",
                f"the lowest that oscillates at rest has {np.abs(poles).min(initial=np.inf) / (2.0 * np.pi):.4g} Hz",
                "raise the frequency",
            )
        top = most or BEYOND_SPRING * max(float(dashpots.springs[0] / np.abs(poles[0])), 2.0 * own)
        grid = np.unique(np.concatenate(([0.0, own], np.geomspace(RANGE * top, top, POINTS))))
        first = (poles[:n_modes], slopes[:n_modes, 0])
        at = int(np.searchsorted(grid, own))
        down = _followed(dashpots, grid[at::-1], first)
        up = _followed(dashpots, grid[at:], first)
        both = [np.concatenate([low[:0:-1], high]) for low, high in zip(down, up, strict=True)]
        return cls(sleeve, own, grid, both[0], both[1])

    @property
    def ratios(self) -> CubicHermiteSpline:
        """Damping ratios of all modes over the damping."""
        slopes = ratio_slopes(self.poles, self.slopes)
        return CubicHermiteSpline(self.dampings, np.nan_to_num(ratios_of(self.poles)), np.nan_to_num(slopes))

    def matched(self, natural_freqs: FloatArray) -> IntArray:
        """(m,) numbers of the modes that have (m,) identified frequencies, Hz, at the rig's own damping.

        Raises:
            InputError: a frequency that none of them has.
        """
        own = np.abs(self.poles[np.searchsorted(self.dampings, self.own)]) / (2.0 * np.pi)
        return nearest_modes(own, natural_freqs)


def _followed(
    dashpots: Dashpots, grid: FloatArray, first: tuple[ComplexArray, ComplexArray]
) -> tuple[ComplexArray, ComplexArray]:
    """(n, n_modes) poles and derivatives along a grid of dampings, each followed from its first value."""
    poles, slopes = np.full((2, len(grid), len(first[0])), np.nan + 0j)
    poles[0], slopes[0] = first
    for k in range(1, len(grid)):
        alive = np.flatnonzero(~np.isnan(poles[k - 1]))
        found, found_slopes = dashpots.poles(grid[k : k + 1])
        expected = poles[k - 1, alive] + (grid[k] - grid[k - 1]) * slopes[k - 1, alive]
        apart = np.minimum(np.abs(expected[:, None] - found) / np.abs(expected[:, None]), LOST)
        mode, number = linear_sum_assignment(apart)
        same = apart[mode, number] < LOST
        poles[k, alive[mode[same]]] = found[number[same]]
        slopes[k, alive[mode[same]]] = found_slopes[number[same], 0]
    return poles, slopes


@dataclass(frozen=True, eq=False)
class ContactDamping:
    """The damping of one sleeve, as modes tell it, at n times.

    Attributes:
        value: (n,) N s/m, nan where no mode was known.
        std: (n,) N s/m; wider where modes contradict one another.
        low, high: (n,) the 95 % interval, within what the table holds.
        shares: (n, n_modes) of the precision that each mode brings.
        contradicted: (n,) whether no damping of the table gives these ratios within three standard deviations; the
            value then is that which comes closest.
    """

    value: FloatArray
    std: FloatArray
    low: FloatArray
    high: FloatArray
    shares: FloatArray
    contradicted: BoolArray

    @property
    def most_telling(self) -> int:
        """Place, among the modes that were given, of the one with the largest derivative for its standard deviation."""
        return int(np.argmax(np.nan_to_num(self.shares).sum(axis=0)))


def contact_damping(
    table: DampingTable, modes: IntArray, ratios: FloatArray, stds: FloatArray, *, near: float | None = None
) -> ContactDamping:
    """The damping at which the rig has the identified ratios, by least squares over its modes.

    Args:
        table: of the sleeve.
        modes: (n_modes,) their numbers in the table: see ``DampingTable.matched``.
        ratios: (n, n_modes) identified damping ratios at n times, nan where one is not known.
        stds: (n, n_modes) of the ratios.
        near: damping that is preferred where the modes alone admit two, N s/m; by default the rig's own.

    Raises:
        InputError: a mode that the table has not, or a standard deviation that is not positive.
    """
    ratios, stds = np.atleast_2d(ratios), np.atleast_2d(stds)
    known = np.isfinite(ratios)
    _check(table, modes, ratios, stds[known])
    weights = np.where(known, 1.0 / np.where(known, stds, 1.0), 0.0)
    spline = table.ratios
    aimed = np.where(known, ratios, 0.0)

    def fault(damping: FloatArray) -> FloatArray:
        return np.asarray(weights * (aimed - spline(damping)[:, modes]))

    grid = table.dampings
    misfit, reachable = _on_grid(table, modes, weights, aimed)
    at = _best(grid, misfit, table.own if near is None else near)
    row, after = np.arange(len(at)), np.minimum(at + 1, len(grid) - 1)
    low, high = grid[np.maximum(at - 1, 0)], grid[np.where(reachable[row, after], after, at)]
    value = grid[at]
    for _ in range(REFINEMENTS):
        slope = weights * spline(value, 1)[:, modes]
        step = np.sum(slope * fault(value), axis=1) / np.maximum(np.sum(slope**2, axis=1), TINY)
        value = np.clip(value + step, low, high)
    return _read(table, value, weights * spline(value, 1)[:, modes], fault(value), known)


def _on_grid(
    table: DampingTable, modes: IntArray, weights: FloatArray, aimed: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """(n, n_grid) least sums of squares within half a step of the grid, and where all known modes oscillate."""
    grid, spline = table.dampings, table.ratios
    value, slope = spline(grid)[:, modes], spline(grid, 1)[:, modes]
    squares, moments, powers = np.zeros((3, len(aimed), len(grid)))
    reachable = np.ones(squares.shape, bool)
    for i, mode in enumerate(modes):
        fault = weights[:, i, None] * (aimed[:, i, None] - value[:, i])
        towards = weights[:, i, None] * slope[:, i]
        squares += fault**2
        moments += fault * towards
        powers += towards**2
        reachable &= ~(np.isnan(table.poles[:, mode]) & (weights[:, i, None] > 0.0))
    before, after = (-0.5 * np.diff(grid, prepend=grid[0]), 0.5 * np.diff(grid, append=grid[-1]))
    step = np.clip(moments / np.maximum(powers, TINY), before, after)
    return np.where(reachable, squares - 2.0 * step * moments + step**2 * powers, np.inf), reachable


def _check(table: DampingTable, modes: IntArray, ratios: FloatArray, stds: FloatArray) -> None:
    n = table.poles.shape[1]
    if ratios.shape[1] != len(modes) or not all(0 <= mode < n for mode in modes):
        raise InputError(
            f"ratios of {ratios.shape[1]} modes with the numbers {', '.join(map(str, modes))}",
            f"one column a mode, numbered from 0 to {n - 1}",
            "number them with DampingTable.matched",
        )
    if not (np.isfinite(stds) & (stds > 0.0)).all():
        raise InputError(
            "a damping ratio whose standard deviation is not a positive number",
            "modes are weighed by their precision",
            "give a ratio that is not known as nan",
        )


def _best(grid: FloatArray, misfit: FloatArray, near: float) -> IntArray:
    """(n,) places on the grid: of the minima that are as good as the lowest, the one nearest to a damping."""
    padded = np.pad(misfit, ((0, 0), (1, 1)), constant_values=np.inf)
    lowest = misfit.min(axis=1, keepdims=True)
    minimum = (misfit <= padded[:, :-2]) & (misfit <= padded[:, 2:]) & np.isfinite(misfit)
    apart = np.abs(np.arcsinh(grid / grid[1]) - np.arcsinh(near / grid[1]))
    return np.asarray(np.where(minimum & (misfit <= lowest + AS_GOOD), apart, np.inf).argmin(axis=1))


def _read(
    table: DampingTable, value: FloatArray, slopes: FloatArray, faults: FloatArray, known: BoolArray
) -> ContactDamping:
    precision, count = np.sum(slopes**2, axis=1), np.count_nonzero(known, axis=1)
    misfit = np.sum(faults**2, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        widening = np.sqrt(np.maximum(1.0, misfit / np.maximum(count - 1, 1)))
        std = np.where(count > 0, widening / np.sqrt(precision), np.nan)
        shares = slopes**2 / precision[:, None]
    value = np.where(count > 0, value, np.nan)
    return ContactDamping(
        value=value,
        std=std,
        low=np.maximum(value - NORMAL_95 * std, 0.0),
        high=np.minimum(value + NORMAL_95 * std, table.dampings[-1]),
        shares=shares,
        contradicted=misfit > chi2.isf(CONTRADICTION, np.maximum(count, 1)),
    )
