"""Residuals of hypotheses against records of any kind, in units of the noise, on all cores.

Each process that works at them has met the records once.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import ceil
from typing import Any, Protocol, Self

import numpy as np
from scipy import fft
from scipy.ndimage import uniform_filter1d

from identification.hypothesis import Hypothesis
from identification.metrics import pooled_nrmse
from identification.noise import Noise
from identification.parallel import in_parallel
from identification.rest_target import FrfTarget, ModesTarget
from identification.wire import sent_once
from models.arrays import BoolArray, ComplexArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.errors import DivergenceError
from models.plant import Plant
from models.record import AnyRecord, Record
from models.simulate import Response, Settings


class Target(Protocol):
    """One record as a fit sees it."""

    @property
    def record(self) -> AnyRecord:
        """Measured."""

    @property
    def n_data(self) -> int:
        """Real numbers in a residual."""

    @property
    def nrmse_of_noise(self) -> float:
        """NRMSE that the noise alone leaves."""

    def nrmse_left(self, residual: FloatArray) -> float:
        """NRMSE of a residual, (n_data,) in units of the noise."""

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise.

        Raises:
            DivergenceError: the motion left the finite numbers.
        """


@sent_once
@dataclass(frozen=True, eq=False)
class TimeTarget:
    """A time record as a fit sees it.

    Attributes:
        record: measured, as far as it is judged.
        noise: of its channels.
        measured: (n, lines) spectrum below 0.35 fs.
        density: (n, lines) noise density per line, sensors' and carried by the model from the excitation, SI^2.
        driven: what is simulated: the record, and a little of what came after it where the test went on.
        whole: duration of the test of which this may be a beginning, s.
        carried: (n_realisations, n, N) what noise of the excitation did to the channels; a part of a record has its own
            density, since noise may grow through a record. Empty where none was carried.
        unjudged: samples at the start of a record, or of a later part of one, that was in motion before: the recorder
            saw that and the model does not.
        quantities: of the sensors; all "" where it is one that counts from rest.
        ran: s of its test before the first sample, through which clocks of laws have run.
    """

    record: Record
    noise: Noise
    measured: ComplexArray
    density: FloatArray
    driven: Record
    whole: float
    carried: FloatArray = field(default_factory=lambda: np.empty((0, 0, 0)), repr=False)
    unjudged: int = 0
    quantities: tuple[str, ...] = ()
    ran: float = 0.0

    @classmethod
    def of(cls, record: Record, noise: Noise, unjudged: int = 0, quantities: tuple[str, ...] | None = None) -> Self:
        """With the sensors' noise alone."""
        kinds = ("",) * len(record.sensors) if quantities is None else quantities
        measured = _judged_spectrum(record.responses, unjudged, zero_is_lost(kinds))
        bare = cls(record, noise, measured, np.empty(0), record, record.duration, unjudged=unjudged, quantities=kinds)
        return bare.with_noise(noise)

    @property
    def begins_later(self) -> bool:
        """It is no beginning of a record, but a part of one that is there besides."""
        return False

    @cached_property
    def without_zero(self) -> BoolArray:
        """(n,) whether the mean of a channel tells nothing."""
        return zero_is_lost(self.quantities)

    def with_noise(self, noise: Noise) -> Self:
        """With another noise of the sensors, and none carried from the excitation."""
        sensors = np.maximum(noise.sensors, LEAST_NOISE * self.record.responses.std(axis=1))
        density = np.repeat(sensors[:, None] ** 2, self.measured.shape[1], axis=1)
        return replace(self, noise=noise, density=density, carried=np.empty((0, 0, 0)))

    def with_carried(self, carried: FloatArray) -> Self:
        """With (n_realisations, n, N) of the excitation's noise, as the channels feel it, beside the sensors' own."""
        base = self.with_noise(self.noise)
        return replace(base, density=base.density + _density_of(carried), carried=carried)

    def cut(self, n_samples: int, unjudged: int | None = None) -> Self:
        """The first samples only, some of them judged, and never the last ``AHEAD`` of a test.

        Args:
            n_samples: that are kept.
            unjudged: of them, if not as many as of the whole.
        """
        n, unjudged = min(n_samples, self.driven.n_samples - AHEAD), self.unjudged if unjudged is None else unjudged
        if n >= self.record.n_samples or n < max(AHEAD, unjudged + 1):
            return self
        part = samples_of(self.record, 0, n), samples_of(self.driven, 0, n + AHEAD), self.carried[:, :, :n]
        return self._part(*part, unjudged)

    def cut_quickly(self, n_samples: int, *, at_least: bool = False) -> Self:
        """The first samples, a per cent fewer (or more) where those have a quick transform; ``cut`` where all are kept.

        A search transforms them ten thousand times, and the transform of 10923 samples (3 x 11 x 331) takes ten times
        as long as that of 10890.

        Args:
            n_samples: that are kept.
            at_least: rather more than fewer, and as many as asked for where there are no more.
        """
        most = min(self.driven.n_samples - AHEAD, self.record.n_samples)
        if n_samples >= most:
            return self.cut(n_samples)
        more = fft.next_fast_len(n_samples)
        if at_least:
            return self.cut(more if more <= most else n_samples)
        return self.cut(fft.prev_fast_len(n_samples))

    def later(self, first: int, name: str, looked_back: float = 0.0) -> Self:
        """The record from a sample on, under another name, since it starts from another state.

        Args:
            first: sample.
            name: of what is left.
            looked_back: s before a sample that its channels depend on: so much of the start is not judged either.
        """
        record, driven = (
            replace(samples_of(each, first, each.n_samples), name=name, moving_start=False)
            for each in (self.record, self.driven)
        )
        return self._part(record, driven, self.carried[:, :, first:], AHEAD + ceil(looked_back * self.record.fs))

    def _part(self, record: Record, driven: Record, carried: FloatArray, unjudged: int) -> Self:
        """A part of the record, with the noise that was carried into it."""
        measured = _judged_spectrum(record.responses, unjudged, self.without_zero)
        line = np.linspace(0, self.density.shape[1] - 1, measured.shape[1]).astype(int)
        density = self.density[:, line]
        if len(carried):
            own = self.with_noise(self.noise).density[:, line]
            density = density * (own + _density_of(carried)) / (own + self._carried_density[:, line])
        return replace(
            self,
            record=record,
            measured=measured,
            density=density,
            driven=driven,
            carried=carried,
            unjudged=unjudged,
        )

    @cached_property
    def _carried_density(self) -> FloatArray:
        """(n, lines) SI^2 of what noise of the excitation does to the channels."""
        return _density_of(self.carried)

    def without(self, name: str) -> Self:
        """Without the channel of a sensor, if it has that."""
        return self.only([sensor for sensor in self.record.sensors if sensor != name])

    def only(self, names: Sequence[str]) -> Self:
        """The channels of these sensors, which it has, in this order."""
        if tuple(names) == self.record.sensors:
            return self
        kept = [self.record.sensors.index(name) for name in names]
        record, driven = (_of_channels(record, kept) for record in (self.record, self.driven))
        noise = replace(self.noise, sensors=self.noise.sensors[kept])
        carried = self.carried[:, kept] if len(self.carried) else self.carried
        return replace(
            self,
            record=record,
            noise=noise,
            measured=self.measured[kept],
            density=self.density[kept],
            driven=driven,
            carried=carried,
            quantities=tuple(self.quantities[k] for k in kept),
        )

    def exchanged(self, name: str, other: str) -> Self:
        """With what the channels of two sensors hold exchanged, and their own noise with it, if it has both.

        What the model carries from the excitation stays: it belongs to the place, not to the cable.
        """
        if not {name, other} <= set(self.record.sensors):
            return self
        here, there = self.record.sensors.index(name), self.record.sensors.index(other)
        order = np.arange(len(self.record.sensors))
        order[[here, there]] = there, here
        record, driven = (replace(each, responses=each.responses[order]) for each in (self.record, self.driven))
        noise, own = replace(self.noise, sensors=self.noise.sensors[order]), self.with_noise(self.noise).density
        density = np.maximum(self.density - own, 0.0) + own[order]
        return replace(
            self,
            record=record,
            noise=noise,
            measured=self.measured[order],
            density=density,
            driven=driven,
            quantities=tuple(self.quantities[k] for k in order),
        )

    def spectrum(self, channels: FloatArray) -> ComplexArray:
        """(n, lines) spectrum of what was simulated, as far as it is judged."""
        return _judged_spectrum(channels[:, : self.record.n_samples], self.unjudged, self.without_zero)

    def at_its_zero(self, channels: FloatArray) -> FloatArray:
        """(n, N) what was simulated, each channel with the mean of the measured one where that tells nothing."""
        n = self.record.n_samples
        own = _means(self.record.responses, self.unjudged) - _means(channels[:, :n], self.unjudged)
        return channels + np.where(self.without_zero, own, 0.0)[:, None]

    @property
    def n_data(self) -> int:
        """Real and imaginary parts of the spectrum."""
        return 2 * self.measured.size

    @property
    def waits(self) -> int:
        """Samples at the start that are not judged beyond those that every later part gives up."""
        return max(0, self.unjudged - AHEAD)

    @property
    def judged_share(self) -> float:
        """Of the noise's power, what is left of it with the samples at the start that are not judged in full."""
        return float(np.mean(_weights(self.record.n_samples, self.unjudged) ** 2))

    @property
    def n_judged(self) -> int:
        """Chi-square that noise alone leaves in the mean."""
        return round(self.judged_share * self.n_data) - 2 * int(self.without_zero.sum())

    @property
    def repeats(self) -> float:
        """How many times a sum over channels counts noise at most: what a force's noise does, it does to all at once.

        The largest eigenvalue of the correlation between the channels, with the sensors' own noise on its diagonal, in
        the mean over the lines by how much they tell.
        """
        own = np.minimum(self.with_noise(self.noise).density / self.density, 1.0)
        tells = np.abs(self.measured) ** 2 / self.density
        return float(1.0 + (1.0 - np.average(own, weights=tells)) * (len(self.measured) - 1))

    @cached_property
    def strays(self) -> float:
        """Standard deviation of residual over noise in one record, by what impacts make of the excitation's noise."""
        if not len(self.carried):
            return 0.0
        own = self.with_noise(self.noise).density
        powers = [np.abs(scored_spectrum(each)) ** 2 / each.shape[1] for each in self.carried]
        return float(np.std([np.sqrt(np.mean((own + power) / self.density)) for power in powers]))

    @property
    def nrmse_of_noise(self) -> float:
        """NRMSE that the noise alone leaves."""
        return pooled_nrmse(self.noise_power, np.sum(np.abs(self.measured) ** 2, axis=1), self.quantities)

    @property
    def noise_power(self) -> FloatArray:
        """(n,) power of the spectrum that the noise alone leaves in each channel."""
        return np.asarray(self.judged_share * self.record.n_samples * self.density.sum(axis=1))

    def nrmse_left(self, residual: FloatArray) -> float:
        """NRMSE of a residual, (n_data,) in units of the noise."""
        return nrmse(unwhitened(residual, self) * np.sqrt(float(self.record.n_samples)), self.measured, self.quantities)

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise."""
        channels = self.response(hypothesis, settings).channels
        return whitened(self.spectrum(channels) - self.measured, self)

    def disturbed(self, share: float) -> Self:
        """With what drives it larger by this share."""
        if self.driven.excitation is None:
            return self
        return self.driven_by(replace(self.driven, excitation=self.driven.excitation * (1.0 + share)))

    def driven_by(self, driven: Record) -> Self:
        """The same under another excitation, to be simulated: noise carried into it, most of what is sent, is left out.

        Args:
            driven: of the same sensors and samples.
        """
        return replace(self, driven=driven, carried=np.empty((0, 0, 0)))

    def response(self, hypothesis: Hypothesis, settings: Settings, plant: Plant | None = None) -> Response:
        """What the model says of the record, and of what came after it where the test went on."""
        return hypothesis.simulated(self.driven, settings, self.met_by(plant or hypothesis.plant()))

    def met_by(self, plant: Plant) -> Plant:
        """A plant as it is at the first sample."""
        return plant.later(self.ran) if self.ran else plant


WITHOUT_ZERO = frozenset({"acceleration", "angular_velocity"})
"""Quantities whose mean over a test tells nothing of the rig: motion that stays finite has none, and what the sensor
reads is its own zero, and gravity's share. Displacements count from rest, and a velocity may drift with its base."""


def zero_is_lost(quantities: Sequence[str]) -> BoolArray:
    """(n,) whether the mean of a channel of each quantity tells nothing."""
    return np.array([quantity in WITHOUT_ZERO for quantity in quantities], bool)


AHEAD = 16
"""Samples that must follow one, and come before it in a later part of a record, for it to be judged: the recorder's
filter and the force between samples see them."""


def _of_channels(record: Record, kept: Sequence[int]) -> Record:
    """The record with some of its channels only."""
    return replace(record, sensors=tuple(record.sensors[i] for i in kept), responses=record.responses[list(kept)])


def samples_of(record: Record, first: int, end: int) -> Record:
    """The samples of a record from one up to another."""
    force = record.excitation
    return replace(
        record,
        responses=record.responses[:, first:end],
        excitation=None if force is None else force[first:end],
    )


LEAST_NOISE = 1e-5
"""Noise assumed at least, as a share of a channel's rms: no fit can be judged closer than the model is computed."""


def scored_spectrum(channels: FloatArray) -> ComplexArray:
    """(n, lines) spectrum of the band below 0.35 fs in which errors are judged."""
    n = channels.shape[1]
    return np.asarray(fft.rfft(channels, axis=1)[:, : int(SCORE_EDGE * n) + 1])


def _judged_spectrum(channels: FloatArray, unjudged: int, without_zero: BoolArray) -> ComplexArray:
    """The same without the samples at the start that are not judged, and without means that tell nothing.

    What follows the start counts ever more: a misfit that begins with a jump is spread over all lines, and counts most
    where the noise is least: the friction of a frame came out 0.03 N apart with and without one of 1250 samples.
    """
    if without_zero.any():
        channels = channels - np.where(without_zero, _means(channels, unjudged), 0.0)[:, None]
    if unjudged:
        channels = channels * _weights(channels.shape[1], unjudged)
    return scored_spectrum(channels)


def _means(channels: FloatArray, unjudged: int) -> FloatArray:
    """(n,) the constant by which each channel is nearest to 0 in what is judged of it."""
    weights = _weights(channels.shape[1], unjudged) ** 2
    return np.asarray(channels @ weights / weights.sum())


def _weights(n: int, unjudged: int) -> FloatArray:
    """(n,) how much each sample counts."""
    rise = min(RISE, (n - unjudged) // 4) if unjudged else 0
    rising = np.sin(0.5 * np.pi * (np.arange(rise) + 0.5) / max(rise, 1)) ** 2
    return np.concatenate([np.zeros(unjudged), rising, np.ones(n - unjudged - rise)])


RISE = 32
"""Samples over which they come to count in full, at most."""


def nrmse(residual: ComplexArray, measured: ComplexArray, quantities: Sequence[str]) -> float:
    """rms(residual) / rms(measured) over all channels and samples, from spectra; by the quantity of each channel."""
    error, power = (np.sum(np.abs(each) ** 2, axis=1) for each in (residual, measured))
    return pooled_nrmse(error, power, quantities)


FEW = 8
"""Hypotheses a core below which each record of each is a job by itself, the longest first: less of a core is idle."""


class Evaluator:
    """Simulates hypotheses against targets in parallel.

    Args:
        targets: the records.
        jobs: cores.
        settings: resolution of the model.
    """

    def __init__(self, targets: Sequence[Target], jobs: int, settings: Settings = Settings()) -> None:  # noqa: B008
        self.targets = tuple(targets)
        self.jobs = jobs
        self.settings = settings
        self.n_runs = 0

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """What it was made of, without what was derived since."""
        return Evaluator, (self.targets, self.jobs, self.settings)

    def with_targets(self, targets: Sequence[Target]) -> "Evaluator":
        """The same for other records."""
        return Evaluator(targets, self.jobs, self.settings)

    def with_settings(self, settings: Settings) -> "Evaluator":
        """The same at another resolution."""
        return Evaluator(self.targets, self.jobs, settings)

    def with_jobs(self, jobs: int) -> "Evaluator":
        """The same on so many cores."""
        return Evaluator(self.targets, jobs, self.settings)

    @cached_property
    def timed(self) -> tuple[TimeTarget, ...]:
        """Those of time records: they can be cut, and their motion can part from its neighbours."""
        return tuple(target for target in self.targets if isinstance(target, TimeTarget))

    @cached_property
    def at_rest(self) -> tuple[FrfTarget | ModesTarget, ...]:
        """Those of small motion about rest, which a fit sees whole or not at all."""
        return tuple(target for target in self.targets if isinstance(target, FrfTarget | ModesTarget))

    @property
    def n_data(self) -> int:
        """Real numbers in a residual."""
        return sum(target.n_data for target in self.targets)

    @property
    def n_judged(self) -> int:
        """Chi-square that noise alone leaves in the mean."""
        return self.n_data - sum(target.n_data - target.n_judged for target in self.timed)

    @cached_property
    def repeats(self) -> float:
        """How many times a sum over channels counts noise at most, over all records."""
        counts = [target.repeats if isinstance(target, TimeTarget) else 1.0 for target in self.targets]
        return float(np.average(counts, weights=[target.n_data for target in self.targets]))

    @cached_property
    def strays(self) -> float:
        """Standard deviation of residual over noise, by what impacts make of the excitation's noise in each record."""
        return float(np.linalg.norm([target.strays * target.n_data for target in self.timed])) / self.n_data

    @property
    def extent(self) -> str:
        """What it holds, in words: ``8.0 s of records and frfs.uff``."""
        parts = [f"{sum(target.record.duration for target in self.timed):.1f} s of records"] if self.timed else []
        return " and ".join([*parts, *(target.record.name for target in self.at_rest)])

    def parts_of(self, residual: FloatArray) -> list[tuple[Target, FloatArray]]:
        """Each target with its part of a residual.

        Args:
            residual: (n_data,) over all targets.
        """
        ends = np.cumsum([target.n_data for target in self.targets])
        return list(zip(self.targets, np.split(residual, ends[:-1]), strict=True))

    def nrmse_of(self, residual: FloatArray) -> float:
        """NRMSE of a residual over all targets, the squares of the records averaged.

        Args:
            residual: (n_data,) in units of the noise.
        """
        errors = [target.nrmse_left(part) for target, part in self.parts_of(residual)]
        return float(np.sqrt(np.mean(np.square(errors))))

    @property
    def nrmse_of_noise(self) -> float:
        """What ``nrmse_of`` gives of noise alone."""
        return float(np.sqrt(np.mean([target.nrmse_of_noise**2 for target in self.targets])))

    def responses(self, hypothesis: Hypothesis, settings: Settings | None = None) -> list[Response]:
        """The model's response to every time record, and to what came after it where the test went on.

        Raises:
            DivergenceError: the motion left the finite numbers.
        """
        self.n_runs += len(self.timed)
        return in_parallel(self.jobs, partial(_response, hypothesis, settings or self.settings), self.timed)

    def residuals(self, hypotheses: Iterable[tuple[Hypothesis, str | None]]) -> list[FloatArray | None]:
        """Residuals in units of the noise, one row of ``n_data`` numbers a hypothesis, None where it diverges.

        Args:
            hypotheses: each with the name of the only record that differs from the last full one, or None; the other
                records' parts are then left at 0.
        """
        asked = list(hypotheses)
        wanted = [
            [k for k, target in enumerate(self.targets) if only is None or target.record.name == only]
            for _, only in asked
        ]
        self.n_runs += sum(len(each) for each in wanted)
        jobs = self._shared_out(wanted)
        found = in_parallel(
            self.jobs,
            partial(_residuals, self.targets, self.settings),
            [(asked[k][0], each) for k, each in jobs],
            alike=len(jobs) == len(asked),
        )
        rows: list[FloatArray | None] = [np.zeros(self.n_data) for _ in asked]
        ends = np.cumsum([target.n_data for target in self.targets])
        for (number, each), parts in zip(jobs, found, strict=True):
            row = rows[number]
            if parts is None or row is None:
                rows[number] = None
                continue
            for k, part in zip(each, parts, strict=True):
                row[ends[k] - len(part) : ends[k]] = part
        return rows

    def _shared_out(self, wanted: Sequence[list[int]]) -> list[tuple[int, list[int]]]:
        """Numbers of hypotheses, each with the records that are simulated one after the other."""
        if self.jobs == 1 or len(wanted) >= FEW * self.jobs:
            return list(enumerate(wanted))
        jobs = [(number, [k]) for number, each in enumerate(wanted) for k in each]
        return sorted(jobs, key=lambda job: -self.targets[job[1][0]].n_data)


def _residuals(
    targets: Sequence[Target], settings: Settings, asked: tuple[Hypothesis, Sequence[int]]
) -> list[FloatArray] | None:
    """Residuals of a hypothesis against some of the targets, None where it diverges."""
    hypothesis, wanted = asked
    try:
        return [targets[k].residual(hypothesis, settings) for k in wanted]
    except DivergenceError:
        return None


def _response(hypothesis: Hypothesis, settings: Settings, target: TimeTarget) -> Response:
    return target.response(hypothesis, settings)


def whitened(residual: ComplexArray, target: TimeTarget) -> FloatArray:
    """Residual in standard deviations of the noise, as real numbers whose squares sum to chi-square."""
    weight = np.sqrt(2.0 / (target.record.n_samples * target.density))
    return np.ascontiguousarray(residual * weight).view(float).ravel()


def unwhitened(residual: FloatArray, target: TimeTarget) -> ComplexArray:
    """(n, lines) spectrum of what ``whitened`` made, scaled so that white noise reads its variance."""
    return np.asarray(residual.view(complex).reshape(target.measured.shape) * np.sqrt(0.5 * target.density))


def carry_noise(
    evaluator: Evaluator, hypothesis: Hypothesis, rng: np.random.Generator, realisations: int = 4
) -> list[Target]:
    """The targets with the noise of the measured excitation, carried through the model, added to their densities.

    Args:
        evaluator: with the targets.
        hypothesis: the model that carries it.
        rng: of the realisations.
        realisations: simulations averaged.
    """
    noisy = [t for t in evaluator.timed if t.noise.excitation > 0 and t.record.excitation is not None]
    if not noisy:
        return list(evaluator.targets)
    clean = evaluator.with_targets(noisy).responses(hypothesis)
    changes: dict[str, list[FloatArray]] = {target.record.name: [] for target in noisy}
    for _ in range(realisations):
        disturbed = [t.driven_by(shaken(t.driven, t.noise.excitation, rng)) for t in noisy]
        moved = evaluator.with_targets(disturbed).responses(hypothesis)
        for target, one, other in zip(noisy, clean, moved, strict=True):
            changes[target.record.name].append((other.channels - one.channels)[:, : target.record.n_samples])
    targets: list[Target] = []
    for each in evaluator.targets:
        if not isinstance(each, TimeTarget):
            targets.append(each)
        elif each.record.name in changes:
            targets.append(each.with_carried(np.stack(changes[each.record.name])))
        else:
            targets.append(each.with_noise(each.noise))
    return targets


SMOOTHED_LINES = 9


def _density_of(carried: FloatArray) -> FloatArray:
    """(n, lines) noise density per line, SI^2, of (n_realisations, n, N) realisations."""
    power = np.mean([np.abs(scored_spectrum(each)) ** 2 for each in carried], axis=0)
    return np.asarray(uniform_filter1d(power / carried.shape[2], SMOOTHED_LINES, axis=1))


def shaken(record: Record, sigma: float, rng: np.random.Generator) -> Record:
    """The record with white noise of a standard deviation, SI, added to its measured excitation."""
    if record.excitation is None:
        return record
    return replace(record, excitation=record.excitation + sigma * rng.standard_normal(record.n_samples))
