"""How far a co-simulation lags, how far it errs, and how fast it runs."""

from dataclasses import dataclass

import numpy as np

from identification.decay.course import NORMAL_95
from identification.decay.damping_table import damping_effect
from models.arrays import FloatArray, IntArray
from models.effects.protocol import Place
from models.effects.time_varying_damping import TimeVaryingDamping
from testbed.cosim.lockstep import Exchanges, Run
from testbed.cosim.plan import Plan

TELLS_LAG = 4.0
"""A truth that varies by less than so many standard deviations of an estimate shows no lag."""

TRUTH_POINTS = 1001
"""At which the truth is told and drawn."""

TINY = float(np.finfo(float).tiny)

PER_HOP = 8
"""Times in a hop at which what was fed back is held against the truth."""


@dataclass(frozen=True, eq=False)
class Measures:
    """What a co-simulation comes to.

    Attributes:
        lag: how old, in the mean from the first exchange on, what the twin moves with is: time minus that for which it
            speaks, s.
        aligned_lag: delay of the truth that comes closest to what was fed back, s; None where the truth hardly varies.
        identified: rms error of the estimates, each at its own time and all weighing alike, over the truth's rms.
        start: damping that the twin moves with until the first exchange, N s/m.
        first_exchange: s.
        fed_back: rms error over time of what the twin moved with, from the first exchange on, over the truth's rms.
        moved_with: the same over the whole run, its start included.
        identified_error: (n_exchanges,) N s/m.
        moved_times: (m,) s, over the whole run.
        moved_error: (m,) N s/m then, of what the twin moved with.
        typical_error: that 95 % of the errors of what was identified and fed back, and of the intervals' half widths,
            do not exceed, N s/m.
        coverage: share of the 95 % intervals that hold the truth.
        told, alone: NRMSE of the twin's channels with feedback and without.
        times: (n,) s, centres of the taps' periods.
        told_over_time, alone_over_time: (n,) NRMSE in each of them.
        real_time_factor: seconds of motion for a second of plant, identifier and twin together.
        shares: (3,) of that time, of plant, identifier and twin.
        slowest: largest share of a hop's duration that one exchange took, those of the first second left out.
        truth_times, truth: (k,) s and N s/m, the sleeve's damping over the run.
    """

    lag: float
    aligned_lag: float | None
    identified: float
    start: float
    first_exchange: float
    fed_back: float
    moved_with: float
    identified_error: FloatArray
    moved_times: FloatArray
    moved_error: FloatArray
    typical_error: float
    coverage: float
    told: float
    alone: float
    times: FloatArray
    told_over_time: FloatArray
    alone_over_time: FloatArray
    real_time_factor: float
    shares: FloatArray
    slowest: float
    truth_times: FloatArray
    truth: FloatArray


def measures_of(plan: Plan, run: Run) -> Measures:
    """Hold a run against the truth.

    Args:
        plan: what was run.
        run: finished.
    """
    got, hop = run.exchanges, plan.hop / plan.fs
    truth = plan.true_damping(got.times)
    first, end = float(got.acts[0]), plan.n_samples / plan.fs
    times = np.arange(first, end, hop / PER_HOP)
    in_use = np.searchsorted(got.acts, times, side="right") - 1
    told, true = got.values[in_use], plan.true_damping(times)
    before = np.arange(0.0, first, hop / PER_HOP)
    missed = plan.table.own - plan.true_damping(before)
    moved = np.concatenate([missed, told - true])
    whole = np.linspace(0.0, end, TRUTH_POINTS)
    scale = max(_rms(plan.true_damping(whole)), TINY)
    bins = (np.arange(len(run.power)) * hop // plan.taps.period).astype(np.int64)
    filled = bins < max(len(run.power) * hop // plan.taps.period, 1)
    bins, power, with_it, without = bins[filled], run.power[filled], run.told[filled], run.alone[filled]
    per_hop = run.seconds.sum(axis=1) / hop
    return Measures(
        lag=float(np.mean(times - got.times[in_use])),
        aligned_lag=_aligned(plan, times, told, float(np.median(got.stds))),
        identified=_rms(got.values - truth) / scale,
        start=plan.table.own,
        first_exchange=first,
        fed_back=_rms(told - true) / scale,
        moved_with=_rms(moved) / scale,
        identified_error=got.values - truth,
        moved_times=np.concatenate([before, times]),
        moved_error=moved,
        typical_error=max(
            float(np.percentile(np.abs(e), 95.0)) for e in (got.values - truth, told - true, 2.0 * got.stds)
        ),
        coverage=float(np.mean((got.bounds[:, 0] <= truth) & (truth <= got.bounds[:, 1]))),
        told=_nrmse(run.told, run.power),
        alone=_nrmse(run.alone, run.power),
        times=np.asarray((np.unique(bins) + 0.5) * plan.taps.period - run.latency, np.float64),
        told_over_time=_over(bins, with_it, power),
        alone_over_time=_over(bins, without, power),
        real_time_factor=1.0 / float(per_hop.mean()),
        shares=run.seconds.sum(axis=0) / run.seconds.sum(),
        slowest=float(per_hop[min(round(1.0 / hop), len(per_hop) - 1) :].max()),
        truth_times=whole,
        truth=plan.true_damping(whole),
    )


def _aligned(plan: Plan, times: FloatArray, told: FloatArray, std: float) -> float | None:
    """The delay of the truth at which it comes closest to what was fed back, to a millisecond or so."""
    longest = 2.0 * (plan.taps.period + plan.window)
    step = times[1] - times[0] if len(times) > 1 else longest
    grid = np.arange(times[0] - longest, times[-1] + step, step)
    truth = plan.true_damping(np.maximum(grid, 0.0))
    if np.ptp(truth) < TELLS_LAG * std:
        return None
    delays = np.arange(0.0, longest, step)
    faults = [_rms(np.interp(times - delay, grid, truth) - told) for delay in delays]
    return float(delays[np.argmin(faults)])


def effect_of(plan: Plan, got: Exchanges) -> TimeVaryingDamping:
    """The damping over the run as an effect, from the most precise estimate after each tap.

    Args:
        plan: what was run.
        got: what was identified.
    """
    best = np.array([min(np.flatnonzero(got.taps == tap), key=lambda i: got.stds[i]) for tap in np.unique(got.taps)])
    best = best[np.unique(got.times[best], return_index=True)[1]]
    position = next(contact.position for contact in plan.twin.contacts if contact.sleeve == plan.sleeve)
    place = Place(sleeve=plan.sleeve, position=position)
    half = np.maximum(NORMAL_95 * got.stds[best], 1e-9)
    return damping_effect(place, got.times[best], got.values[best], got.values[best] - half, got.values[best] + half)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _nrmse(faults: FloatArray, power: FloatArray) -> float:
    """Over (n_hops, n_sensors) mean squares, all sensors weighing alike."""
    return float(np.sqrt(np.mean(faults.sum(axis=0) / power.sum(axis=0))))


def _over(bins: IntArray, faults: FloatArray, power: FloatArray) -> FloatArray:
    return np.array([_nrmse(faults[bins == number], power[bins == number]) for number in np.unique(bins)])
