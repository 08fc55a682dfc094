"""How a record whose excitation repeats splits, per sensor and line: best linear response, distortion, noise and time.

What does not repeat is noise, what dies away is transient, what grows or falls from period to period is time variation.
Lines that were not excited hold what a linear rig cannot answer with: even distortion on even lines, odd distortion on
odd ones, once the response to what the excitation itself carries there has been taken off.

Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach (2012), sections 4.3 and 6.3.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.ndimage import uniform_filter1d

from identification.budget.interpolate import between
from identification.budget.periods import Periods, periods_of
from identification.budget.pooled import FALSE_ALARM, Share, band_edges, members, share
from identification.budget.regression import REGION, STEADY, TRANSIENT, TREND, Columns, columns_of
from models.arrays import BoolArray, ComplexArray, FloatArray
from models.record import Record

Cause = Literal["odd", "even", "odd_or_even", "time_variation", "transient"]


@dataclass(frozen=True, eq=False)
class LinePowers:
    """Mean squares of each sensor on each line, (n, K), in the sensor's unit squared.

    Attributes:
        response: of what repeats.
        noise: of what does not, with what the excitation's own noise makes a model miss: a perfect model leaves it.
        transient: of what dies away, as a mean over the periods; 0 where none is seen.
        time_variation: of what grows or falls with time on excited lines, likewise.
        distortion: of what repeats on lines that were not excited and is no linear response; 0 on other lines.
        chance: what noise alone leaves of ``distortion`` on average.
    """

    response: FloatArray
    noise: FloatArray
    transient: FloatArray
    time_variation: FloatArray
    distortion: FloatArray
    chance: FloatArray


@dataclass(frozen=True, eq=False)
class Drift:
    """How a sensor's gain changes from the first to the last period.

    Attributes:
        gain: (n,) as a share, in phase with the response on all excited lines together.
        phase: (n,) rad.
        std: (n,) of either.
    """

    gain: FloatArray
    phase: FloatArray
    std: FloatArray


@dataclass(frozen=True, eq=False)
class Split:
    """One record whose excitation repeats.

    Attributes:
        record: as measured.
        periods: its spectra; all lines lie below 0.35 fs.
        told: (K,) lines where distortion shows: not excited, and what the excitation carries there accounted for.
        excitation: (K,) spectrum of what repeats in the excitation.
        lines: mean squares line by line.
        bla: (n, L) best linear approximation on the excited lines, response unit per excitation unit.
        bla_variance: (n, L) of it, by noise.
        drift: None where time variation cannot be told.
        bands: (n_bands + 1,) Hz, their edges.
        response: (n, n_bands) mean square of what repeats on excited lines.
        noise: (n, n_bands) mean square.
        shares: of each cause.
        linear: (n, K) linear response per unit excitation, between the excited lines too; 0 beyond their range.
    """

    record: Record
    periods: Periods
    told: BoolArray
    excitation: ComplexArray
    lines: LinePowers
    bla: ComplexArray
    bla_variance: FloatArray
    drift: Drift | None
    bands: FloatArray
    response: FloatArray
    noise: FloatArray
    shares: Mapping[Cause, Share]
    linear: ComplexArray

    @property
    def level(self) -> float:
        """Rms of what repeats in the excitation, in its unit."""
        return float(np.sqrt(np.sum(np.abs(self.excitation) ** 2)))

    @property
    def n_periods(self) -> int:
        """Periods used."""
        return self.periods.n_blocks * self.periods.block

    @property
    def mean_square(self) -> FloatArray:
        """(n,) of each sensor, all that was told apart together."""
        parts = self.lines
        return np.asarray(np.sum(parts.response + parts.noise + parts.transient + parts.time_variation, axis=1))

    @property
    def noise_per_line(self) -> FloatArray:
        """(n, n_bands) mean of a band's lines."""
        counts = [int(band.sum()) for band in members(self.periods.frequency, self.bands)]
        return np.asarray(self.noise / np.maximum(np.array(counts, float), 1.0))

    def lines_of(self, cause: Cause) -> BoolArray:
        """(K,) lines on which a distortion shows."""
        return self.told & _acting(self.periods, cause)


def split_record(record: Record) -> Split | None:
    """Split a record; None where its excitation does not repeat.

    Args:
        record: any.
    """
    periods = periods_of(record)
    if periods is None:
        return None
    split = _split(record, periods, columns_of(periods.responses, periods.excited, trend=False))
    if periods.n_blocks < PERIODS_FOR_TREND:
        return split
    changing = _split(record, periods, columns_of(periods.responses, periods.excited, trend=True))
    seen = changing.shares["time_variation"]
    if seen.found.any():
        return changing
    return replace(split, drift=changing.drift, shares={**split.shares, "time_variation": seen})


PERIODS_FOR_TREND = 4
"""Of which one is left to noise beside a steady part, a transient and a trend."""


def _split(record: Record, periods: Periods, columns: Columns) -> Split:
    excited = periods.excited
    drive, drive_noise = columns.parts(periods.excitation[:, None])
    excitation = drive[STEADY, 0]
    steady = columns.parts(periods.responses)[0][STEADY]
    bla = steady[:, excited] / excitation[excited]
    linear, error = between(excited, bla)
    answered = periods.responses - linear * periods.excitation[:, None]
    cleaned, noise = columns.parts(answered)
    averaged = columns.variance(STEADY)
    told = _told(excited, excitation, drive_noise[0] * averaged) & (columns.freedom >= 1)
    transient = (np.abs(cleaned[TRANSIENT]) ** 2 - noise * columns.variance(TRANSIENT)) * columns.mean_square(TRANSIENT)
    leftover = columns.leftover(answered, STEADY, ~excited)
    powers = LinePowers(
        response=np.abs(steady) ** 2,
        noise=noise * periods.block,
        transient=np.maximum(transient, 0.0),
        time_variation=np.abs(cleaned[TREND]) ** 2 * columns.mean_square(TREND),
        distortion=np.where(told, np.abs(cleaned[STEADY]) ** 2, 0.0),
        chance=np.where(told, noise * averaged + error * np.abs(excitation) ** 2 + leftover, 0.0),
    )
    edges = band_edges(periods.frequency, excited)
    bands = list(members(periods.frequency, edges))
    trend = columns.variance(TREND) > 0
    variance = noise * columns.variance(TREND)
    return Split(
        record=record,
        periods=periods,
        told=told,
        excitation=excitation,
        lines=powers,
        bla=bla,
        bla_variance=noise[:, excited] * averaged[excited] / np.abs(excitation[excited]) ** 2,
        drift=_drift(steady[:, trend], cleaned[TREND][:, trend], variance[:, trend]) if trend.any() else None,
        bands=edges,
        response=np.stack([powers.response[:, band & excited].sum(axis=1) for band in bands], axis=1),
        noise=np.stack([powers.noise[:, band].sum(axis=1) for band in bands], axis=1),
        shares={
            **_distortions(periods, powers, columns, told, bands),
            "time_variation": _trend_share(answered, powers, columns, excited, bands),
            "transient": _transient_share(transient, noise, columns, bands),
        },
        linear=linear,
    )


ROUNDING = 1e-20
"""Power of a line, as a share of the strongest, that a computed excitation without noise holds by rounding."""


def _told(excited: BoolArray, excitation: ComplexArray, chance: FloatArray) -> BoolArray:
    """(K,) lines where distortion shows.

    Beyond the excited range no linear response is known: what the excitation repeats there would pass for distortion.
    """
    inside = (np.cumsum(excited) > 0) & (np.cumsum(excited[::-1])[::-1] > 0)
    # Noise of one line scatters by as much as itself; that of its neighbours is the same.
    repeats = np.abs(excitation) ** 2 > -np.log(FALSE_ALARM) * uniform_filter1d(chance, 2 * REGION + 1, mode="nearest")
    repeats &= np.abs(excitation) ** 2 > ROUNDING * np.max(np.abs(excitation) ** 2)
    return np.asarray(~excited & (inside | ~repeats))


def _acting(periods: Periods, cause: Cause) -> BoolArray:
    """(K,) lines on which a distortion acts, excited or not."""
    numbers = np.arange(1, len(periods.frequency) + 1)
    if cause == "odd_or_even":
        return np.full(len(numbers), periods.plan == "mixed")
    return np.asarray((periods.plan != "mixed") & (numbers % 2 == (1 if cause == "odd" else 0)))


def _distortions(
    periods: Periods, powers: LinePowers, columns: Columns, told: BoolArray, bands: list[BoolArray]
) -> dict[Cause, Share]:
    found: dict[Cause, Share] = {}
    distortions: tuple[Cause, ...] = ("odd", "even", "odd_or_even")
    for cause in distortions:
        acting = _acting(periods, cause) & (told | (periods.excited & (cause != "odd_or_even")))
        lines = [(told & acting & band, acting & band) for band in bands]
        found[cause] = share(powers.distortion, powers.chance, columns.freedom, lines)
    return found


def _trend_share(
    answered: ComplexArray, powers: LinePowers, columns: Columns, excited: BoolArray, bands: list[BoolArray]
) -> Share:
    """Time variation band by band, from the periods without their linear response."""
    seen = (columns.variance(TREND) > 0) & (columns.freedom >= 1)
    variance = columns.parts(answered)[1] * columns.variance(TREND) + columns.leftover(answered, TREND, excited)
    lines = [(seen & band, seen & band) for band in bands]
    return share(powers.time_variation, variance * columns.mean_square(TREND), columns.freedom, lines)


def _transient_share(transient: FloatArray, noise: FloatArray, columns: Columns, bands: list[BoolArray]) -> Share:
    """The transient band by band; all sensors together told each region's decay, so they share its probability."""
    region = np.arange(len(columns.freedom)) // REGION
    reached = [columns.p_transient[np.unique(region[band])] for band in bands]
    p = np.tile([min(1.0, float(p.min()) * len(p)) for p in reached], (len(transient), 1))
    power, floor = (np.stack([part[:, band].sum(axis=1) for band in bands], axis=1) for part in (transient, noise))
    return Share(np.maximum(power, 0.0), 1.0 + power / np.maximum(floor, np.finfo(float).tiny), p)


def _drift(steady: ComplexArray, changes: ComplexArray, variance: FloatArray) -> Drift:
    """The trend in proportion to the steady response, by weighted least squares over lines.

    Args:
        steady: (n, L).
        changes: (n, L) from the first to the last period.
        variance: (n, L) of these, by noise.
    """
    weight = 1.0 / np.maximum(variance, np.finfo(float).tiny)
    base = np.sum(weight * np.abs(steady) ** 2, axis=1)
    rate = np.sum(weight * steady.conj() * changes, axis=1) / base
    return Drift(rate.real, rate.imag, np.sqrt(0.5 / base))
