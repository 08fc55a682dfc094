"""The plant, the identifier that watches it and the twin that is told, in lockstep: parameters pass every hop.

Nothing is kept of the channels but sums over each hop, so a run of any length takes little memory.
"""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from identification.decay.sleeve_damping import contact_damping
from identification.decay.stream import DecayStream, StreamEstimate, StreamSettings
from identification.progress import Progress
from models.arrays import BoolArray, FloatArray
from models.errors import InputError
from models.live import LiveModel
from testbed.cosim.plan import Plan

TOLD_EVERY = 2.0
"""Seconds of motion between two words of progress."""


@dataclass(frozen=True, eq=False)
class Exchanges:
    """What was identified and passed on, one row an estimate.

    Attributes:
        times: (n,) s, for which the damping speaks, its modes weighted by their precision.
        acts: (n,) s, from when on the twin moves with it.
        values: (n,) N s/m.
        stds: (n,) N s/m.
        bounds: (n, 2) the 95 % interval, N s/m.
        shares: (n, n_modes) of the precision that each mode brings.
        contradicted: (n,) whether the modes contradict every damping.
        taps: (n,) number of the last tap before.
    """

    times: FloatArray
    acts: FloatArray
    values: FloatArray
    stds: FloatArray
    bounds: FloatArray
    shares: FloatArray
    contradicted: BoolArray
    taps: FloatArray


@dataclass(frozen=True, eq=False)
class Run:
    """A co-simulation that has been run.

    Attributes:
        exchanges: what was identified.
        power: (n_hops, n_sensors) mean square of the plant's channels without noise, SI.
        told: (n_hops, n_sensors) the same of the twin's channels minus the plant's.
        alone: (n_hops, n_sensors) the same of a twin that is told nothing.
        latency: s, by which all channels are late.
        seconds: (n_hops, 3) that plant, identifier and twin took.
    """

    exchanges: Exchanges
    power: FloatArray
    told: FloatArray
    alone: FloatArray
    latency: float
    seconds: FloatArray


def run_in_lockstep(plan: Plan, progress: Progress) -> Run:
    """Run plant, identifier and twin, and beside them a twin that is told nothing.

    Args:
        plan: what to run.
        progress: told how far it is.

    Raises:
        InputError: no estimate came out of the run.
    """
    fs, hop, taps = plan.fs, plan.hop, plan.taps
    plant = LiveModel.of(plan.truth, fs, peak=taps.peak)
    twin, alone = (LiveModel.of(plan.twin, fs, peak=taps.peak) for _ in range(2))
    settings = StreamSettings(fs, plan.window, hop / fs, -plant.latency / fs)
    stream = DecayStream(settings, plan.poles, len(plan.watched))
    rng = np.random.default_rng(plan.wish.seed)
    watched, n_hops = list(plan.watched), plan.n_samples // hop
    rows: list[_Row] = []
    squares, seconds = np.empty((3, n_hops, len(plan.noise))), np.empty((n_hops, 3))
    for number in range(n_hops):
        first = number * hop
        force = taps.force(fs, first, hop)
        start = perf_counter()
        true = plant.advance(force)
        moved = perf_counter()
        read = true + plan.noise[:, None] * rng.standard_normal(true.shape)
        for estimate in stream.push(read[watched], taps.force(fs, first - plant.latency, hop)):
            rows += _identified(plan, estimate, twin.time, rows[-1].value if rows else None)
        known = perf_counter()
        if rows:
            twin = twin.with_damping({plan.sleeve: rows[-1].value})
        faults = twin.advance(force) - true
        seconds[number] = moved - start, known - moved, perf_counter() - known
        for sums, signal in zip(squares, (true, faults, alone.advance(force) - true), strict=True):
            sums[number] = np.mean(signal**2, axis=1)
        if first % round(TOLD_EVERY * fs) < hop:
            now = f", {plan.sleeve} damps with {rows[-1].value:.4g} N s/m" if rows else ""
            progress(f"{first / fs:.1f} of {plan.n_samples / fs:.1f} s{now}")
    if not rows:
        raise InputError(
            f"a run of {plan.n_samples / fs:.3g} s at {plan.wish.snr:g} dB, in which no mode stood out of the noise",
            f"a window of {plan.window:.3g} s after a tap shows a mode",
            "run longer (--seconds) or with less noise (--snr)",
        )
    return Run(_joined(rows), squares[0], squares[1], squares[2], plant.latency / fs, seconds)


@dataclass(frozen=True, eq=False)
class _Row:
    """One estimate: see ``Exchanges``."""

    time: float
    acts: float
    value: float
    std: float
    bounds: tuple[float, float]
    shares: FloatArray
    contradicted: bool
    tap: float


def _identified(plan: Plan, estimate: StreamEstimate, acts: float, near: float | None) -> list[_Row]:
    """The damping that an estimate tells, if its modes tell one at all."""
    ratios, stds, times = np.full((3, len(plan.poles)), np.nan)
    ratios[estimate.modes], stds[estimate.modes] = estimate.damping_ratios, estimate.damping_ratio_stds
    times[estimate.modes] = estimate.times
    found = contact_damping(plan.table, np.arange(len(ratios)), ratios, stds, near=near)
    if not np.isfinite(found.std[0]):
        return []
    shares = np.nan_to_num(found.shares[0])
    time = float(np.nansum(shares * times) / np.sum(shares))
    tap = float(np.floor(estimate.start / plan.taps.period - 0.5))
    bounds = float(found.low[0]), float(found.high[0])
    told = bool(found.contradicted[0])
    return [_Row(time, acts, float(found.value[0]), float(found.std[0]), bounds, shares, told, tap)]


def _joined(rows: list[_Row]) -> Exchanges:
    return Exchanges(
        times=np.array([row.time for row in rows]),
        acts=np.array([row.acts for row in rows]),
        values=np.array([row.value for row in rows]),
        stds=np.array([row.std for row in rows]),
        bounds=np.array([row.bounds for row in rows]),
        shares=np.stack([row.shares for row in rows]),
        contradicted=np.array([row.contradicted for row in rows]),
        taps=np.array([row.tap for row in rows]),
    )
