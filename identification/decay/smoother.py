"""Frequency and damping of each mode along a decay, with intervals: blocks, then the course of log-amplitude and phase.

The estimator begins with poles that stay, and fits the blocks anew along the path that it found, so that what changes
within a block is not averaged away. docs/theory.md, section 10.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from identification.decay.blocks import LEAST_BLOCKS, MOST_BLOCKS, Deviations, block_edges, deviations
from identification.decay.colour import left_over, noise_colour
from identification.decay.course import NORMAL_95, UNTOLD, Course, Told, Weighed, integral_of, weigh
from identification.decay.poles import Poles
from identification.decay.walk import Points
from models.arrays import ComplexArray, FloatArray, IntArray
from models.errors import InputError

MOST_PASSES = 6
LEAST_EDGES = 3
"""Of two blocks: one level has no slope."""

FARTHEST = 20.0
"""Np below its first amplitude, 174 dB, or beside its path, at which what a block shows is not the mode."""

MOST_GROWTH = 2.0
"""Np that a mode may grow by along its course: more than a beat or a jump makes, and no decay."""

SAME_PATH, SAME_END = 0.3, 0.9
"""The blocks are fitted anew until the path changes by less than this share of their errors, and the end little."""

MOSTLY = 0.75
"""Share of few blocks in which a mode stands out that is as good as all: longer ones would only be fewer."""

FREQUENCY_SCALE = 1e-3
"""How much a natural frequency may well change, as a share of it, where the damping is lighter than that."""


@dataclass(frozen=True, eq=False)
class Interval:
    """A quantity along the record with its 95 % interval.

    Attributes:
        times: (n,) s.
        value, low, high: (n,) in the quantity's unit.
    """

    times: FloatArray
    value: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def steady(cls, times: FloatArray, value: float, std: float) -> "Interval":
        """Of a quantity that stays, known to a standard deviation, at (n,) times, s."""
        low, middle, high = (np.full(len(times), value + side * NORMAL_95 * std) for side in (-1.0, 0.0, 1.0))
        return cls(times, middle, low, high)

    def at(self, times: FloatArray) -> FloatArray:
        """The value at (m,) times, s."""
        return np.interp(times, self.times, self.value)


@dataclass(frozen=True, eq=False)
class SmoothedMode:
    """One mode of a decay as the smoother sees it.

    Attributes:
        decay: of the log-amplitude's rate, 1/s; negative while the mode decays.
        turning: of the phase's rate, rad/s.
        sigma: decay rate of the pole that stays, 1/s.
        decay_points, turning_points: levels that both run through, beside those of a mode that stays.
        blocks: what the levels were read from.
    """

    decay: Course
    turning: Course
    sigma: float
    decay_points: Points
    turning_points: Points
    blocks: Deviations

    @property
    def loudest(self) -> float:
        """Largest log-amplitude on its course beside that of the first sample, Np."""
        return float(integral_of(self.decay.times, self.decay.rate, self.decay.times).max())

    @property
    def natural_freq(self) -> Interval:
        """sqrt(omega_d^2 + sigma^2) / 2 pi, Hz, with the mean sigma: friction's rate does not lower a frequency."""
        times = self.turning.times
        bounds = (self.turning.rate, self.turning.low, self.turning.high)
        value, low, high = (np.hypot(rate, self.sigma) / (2.0 * np.pi) for rate in bounds)
        return Interval(times, value, low, high)

    @property
    def damping_ratio(self) -> Interval:
        """sigma / sqrt(omega_d^2 + sigma^2)."""
        times = self.decay.times
        omega = self.turning.at(times)
        value, low, high = (
            -rate / np.hypot(rate, omega) for rate in (self.decay.rate, self.decay.high, self.decay.low)
        )
        return Interval(times, value, low, high)

    def mean_of(self, course: Interval) -> tuple[float, float]:
        """Mean of a course, each block weighted by what it tells, and an upper bound on its standard deviation.

        The bound takes the course's errors to be the same everywhere.

        Args:
            course: of this mode.
        """
        times, trust = self.blocks.times, 1.0 / self.blocks.variances
        half = np.interp(times, course.times, 0.5 * (course.high - course.low))
        mean, spread = np.average(course.at(times), weights=trust), np.average(half, weights=trust)
        return float(mean), float(spread) / NORMAL_95


def smooth_decay(
    signals: FloatArray,
    fs: float,
    poles: Poles,
    kick_signs: FloatArray,
    told: Told = UNTOLD,
) -> tuple[SmoothedMode, ...]:
    """Follow each mode's frequency and damping along a free decay.

    Args:
        signals: (n_channels, N).
        fs: sampling rate, Hz.
        poles: of modes that stay, to begin with.
        kick_signs: (n_channels,) 1 for displacements and accelerations, -1 for velocities: ``kick_of``.
        told: what is known of the form of damping and frequency.

    Returns:
        one for each mode, in order of frequency.

    Raises:
        InputError: a mode that cannot be followed; ``follow_modes`` tells which.
    """
    followed = follow_modes(signals, fs, poles, kick_signs, told)
    lost = [f"{freq:.4g}" for freq, mode in zip(poles.natural_freqs, followed, strict=True) if mode is None]
    if lost:
        raise InputError(
            f"a mode at {', '.join(lost)} Hz that does not stand out for two blocks",
            "a mode is followed while it decays steadily above what the others leave",
            "leave it out, or take a decay in which it is stronger",
        )
    return tuple(mode for mode in followed if mode is not None)


def follow_modes(
    signals: FloatArray,
    fs: float,
    poles: Poles,
    kick_signs: FloatArray,
    told: Told = UNTOLD,
) -> tuple[SmoothedMode | None, ...]:
    """The same as ``smooth_decay`` for modes of which some may not be followed at all.

    A mode is lost where less than two blocks show it, or where its course comes to grow without end or to turn
    backwards; its pole stays beside the others.

    Returns:
        one for each mode, in order of frequency; None for one that is lost.
    """
    time = np.arange(signals.shape[1]) / fs
    paths = poles.values[:, None] * time
    drowned = np.ceil(FARTHEST * fs / np.maximum(-poles.values.real, np.finfo(float).tiny))
    seen = np.minimum(drowned, signals.shape[1]).astype(int)
    left = list(range(len(seen)))
    for _ in range(MOST_PASSES):
        colours = noise_colour(left_over(signals, np.exp(paths)), fs, poles.natural_freqs)
        sights = {m: _see(signals, fs, poles, paths, m, int(seen[m]), colours[m]) for m in left}
        looked = {m: sight for m, sight in sights.items() if sight is not None}
        weighed = {m: _weigh(sight, time, kick_signs, told) for m, sight in looked.items()}
        found = {m: _path(looked[m], *weighed[m], time) for m in looked}
        ends = {m: int(np.ceil(looked[m].blocks.last_clear * fs)) for m in looked}
        sound = {m for m in looked if _sound(found[m], ends[m])}
        shorter = {m for m in looked if ends[m] < SAME_END * seen[m]}
        still = all(m in sound and m not in shorter and _still(looked[m], found[m]) for m in left)
        if still:
            break
        for m in left:
            paths[m] = found[m] if m in sound else poles.values[m] * time
        for m in looked:
            seen[m] = ends[m]
        left = [m for m in left if m in sound or m in shorter]
    return tuple(_smoothed(looked[m], *weighed[m]) if m in sound else None for m in range(len(seen)))


@dataclass(frozen=True, eq=False)
class _Sight:
    """One mode's blocks along a path, and the pole beside which its levels are taken."""

    pole: complex
    path: ComplexArray
    edges: IntArray
    blocks: Deviations


def _see(
    signals: FloatArray, fs: float, poles: Poles, paths: ComplexArray, mode: int, seen: int, colour: float
) -> _Sight | None:
    """A mode's blocks; longer ones where it stands out in few, None where there are less than two or show another."""
    most = MOST_BLOCKS
    while True:
        edges = block_edges(seen, fs, poles.values.imag / (2.0 * np.pi), mode, most)
        if len(edges) < LEAST_EDGES:
            return None
        blocks = deviations(signals, fs, paths, mode, edges, colour)
        if not np.isfinite(blocks.variances + blocks.log_amplitude + blocks.phase).all():
            return None
        if np.abs(blocks.log_amplitude[blocks.clear]).max(initial=0.0) > FARTHEST:
            return None
        enough = min(LEAST_BLOCKS, MOSTLY * len(blocks.clear))
        if np.count_nonzero(blocks.clear) >= enough or most <= LEAST_BLOCKS:
            return _Sight(complex(poles.values[mode]), paths[mode], edges, blocks)
        most = max(min(most, len(edges) - 1) // 2, LEAST_BLOCKS)


def _weigh(sight: _Sight, time: FloatArray, kick_signs: FloatArray, told: Told) -> tuple[Weighed, Weighed]:
    """The courses of log-amplitude and phase through the blocks, beside the pole's."""
    pole, edges, blocks = sight.pole, sight.edges, sight.blocks
    span = (float(time[0]), float(time[edges[-1] - 1]))
    beside = np.add.reduceat((sight.path - pole * time)[: edges[-1]], edges[:-1]) / np.diff(edges)

    def kick(times: FloatArray) -> FloatArray:
        return kick_of(np.interp(times, time, sight.path.imag), blocks, kick_signs, pole.imag)

    losing = max(abs(pole.real), 1.0 / (span[1] - span[0]))
    decay = weigh(blocks.points(beside.real + blocks.log_amplitude), span, losing, kick, told)
    scale = max(losing, FREQUENCY_SCALE * pole.imag)
    turning = weigh(blocks.points(beside.imag + blocks.phase), span, scale, np.zeros_like, told)
    return decay, turning


def _path(sight: _Sight, decay: Weighed, turning: Weighed, time: FloatArray) -> ComplexArray:
    """(N,) the integral of both most likely rates, which stay after the mode has drowned unless it grows too much."""
    losing, phasing = (integral_of(*weighed.most_likely(), time) for weighed in (decay, turning))
    path = np.asarray(sight.pole * time + losing + 1j * phasing)
    end = int(np.searchsorted(time, sight.blocks.last_clear))
    return np.asarray(np.minimum(path.real, path.real[:end].max() + MOST_GROWTH) + 1j * path.imag)


def _sound(path: ComplexArray, end: int) -> bool:
    """Whether a mode, up to the end of where it is clear, turns forwards and never grows as no decay does."""
    growth = path.real[:end] - np.minimum.accumulate(path.real[:end])
    return bool(np.diff(path.imag[:end]).min() > 0.0 and growth.max() < MOST_GROWTH)


def _smoothed(sight: _Sight, decay: Weighed, turning: Weighed) -> SmoothedMode:
    return SmoothedMode(
        decay.average().beside(sight.pole.real),
        turning.average().beside(sight.pole.imag),
        -sight.pole.real,
        decay.points,
        turning.points,
        sight.blocks,
    )


def _still(sight: _Sight, path: ComplexArray) -> bool:
    """Whether a new path runs through all blocks as the old one did, up to a share of their errors."""
    change = (path - sight.path)[: sight.edges[-1]]
    within = [change[end - 1] - change[start] for start, end in pairwise(sight.edges)]
    return bool((np.abs(within) < SAME_PATH * np.sqrt(sight.blocks.variances)).all())


def kick_of(phase: FloatArray, blocks: Deviations, signs: FloatArray, omega: float) -> FloatArray:
    """(m,) s, the jump of a mode's log-amplitude for a unit jump of its rate at (m,) phases of its path, rad.

    Displacement and velocity do not jump when damping does, so the amplitude that they define must:
    sin(2 phase) / (2 omega) for displacements and accelerations, the opposite for velocities.
    """
    weights = signs * np.abs(blocks.shape / blocks.noise) ** 2
    turns = np.sin(2.0 * (phase[:, None] + np.angle(blocks.shape)))
    return np.asarray(turns @ weights / np.sum(np.abs(weights)) / (2.0 * omega))
