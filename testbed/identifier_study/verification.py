"""The article's verification: an oscillator whose damping steps or drifts, by the ridge and by the smoother."""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from identification.decay.breaks import follow_past_jumps
from identification.decay.course import UNTOLD, Told
from identification.decay.cramer_rao import Floor, Form, decay_floor, stepped, straight
from identification.decay.poles import fit_poles
from identification.decay.ridge import follow_mode
from identification.decay.smoother import SmoothedMode, smooth_decay
from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE, noisy, verification_decay
from models.arrays import FloatArray

SNRS = (40.0, 60.0)
CASES = ("step", "line")

BARS = {
    ("step", 40.0): 0.0018,
    ("step", 60.0): 0.0006,
    ("line", 40.0): 0.0003,
    ("line", 60.0): 0.00005,
}
"""Rms errors of c that the smoother is to undercut without being told the form, N s/m."""

RIDGE_BARS = {"step": 0.0017, "line": 0.0037}
"""The article's, of the ridge at its optimised scale."""

ERRORS = ("multiscale", "ridge", "past_jumps", "smoother", "told", "covered")
"""What is averaged over records, in the order of ``_errors``."""

FORMS: dict[str, Form] = {"step": stepped(0.006, 0.001, 50.0), "line": straight(0.006, -0.00002)}
TOLD = {"step": Told(("constant",), 1), "line": Told(("line",), 0)}


@dataclass(frozen=True)
class Row:
    """Rms errors of c(t) over the whole record, mean over seeds, N s/m.

    Attributes:
        case: ``step`` or ``line``.
        snr_db: dB.
        multiscale: the plain ridge at the article's earlier scale, 2^6.8 samples.
        ridge: the plain ridge at the optimised scale.
        past_jumps: the ridge with windows that end at the jumps it found, at its own optimised scale.
        smoother: the form not told.
        told: the form told.
        floor: root mean square error of the best unbiased estimator that knows the form.
        mean_floor: mean over records of its rms error along a record.
        covered: share of the time at which the smoother's 95 % interval holds the truth.
        bar: for the smoother.
    """

    case: str
    snr_db: float
    multiscale: float
    ridge: float
    past_jumps: float
    smoother: float
    told: float
    floor: float
    mean_floor: float
    covered: float
    bar: float


@dataclass(frozen=True, eq=False)
class Trace:
    """One record of a case: (n,) truth and estimates of c, N s/m, with the smoother's interval."""

    case: str
    snr_db: float
    time: FloatArray
    truth: FloatArray
    multiscale: FloatArray
    ridge: FloatArray
    past_jumps: FloatArray
    smoother: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class Scales:
    """Scales of the ridges, samples.

    Attributes:
        multiscale: the article's earlier one.
        plain: the optimised one.
        past_jumps: optimised for windows that end at jumps.
    """

    multiscale: float
    plain: float
    past_jumps: float


def verification_rows(scales: dict[tuple[str, float], Scales], seeds: int, pool: Executor) -> Iterator[Row]:
    """All cases at all noise levels.

    Args:
        scales: of each case and level.
        seeds: records of each.
        pool: that the records are shared among.
    """
    for (case, snr_db), own in scales.items():
        jobs = [(case, snr_db, own, seed) for seed in range(seeds)]
        means = np.mean(list(pool.map(_errors, *zip(*jobs, strict=True))), axis=0)
        errors = dict(zip(ERRORS, means.tolist(), strict=True))
        floor = floor_of(case, snr_db)
        floors = {"floor": 2.0 * MASS * floor.rms, "mean_floor": 2.0 * MASS * floor.mean_rms}
        yield Row(case=case, snr_db=snr_db, **errors, **floors, bar=BARS[case, snr_db])


def floor_of(case: str, snr_db: float) -> Floor:
    """The Cramer-Rao bound of a case whose form is known.

    Args:
        case: ``step`` or ``line``.
        snr_db: dB.
    """
    n_samples = verification_decay(case).signal.size
    return decay_floor(FORMS[case], omega=OMEGA, phase=0.0, snr_db=snr_db, fs=SAMPLING_RATE, n_samples=n_samples)


def trace_of(case: str, snr_db: float, scales: Scales, seed: int) -> Trace:
    """One record with all that was identified in it.

    Args:
        case: ``step`` or ``line``.
        snr_db: dB.
        scales: of the ridges.
        seed: of the noise.
    """
    time, truth, measured = record_of(case, snr_db, seed)
    mode = _smoothed(measured, UNTOLD)
    low, high = (-2.0 * MASS * np.interp(time, mode.decay.times, bound) for bound in (mode.decay.high, mode.decay.low))
    ridges = _ridges(measured, scales)
    return Trace(case, snr_db, time, truth, *ridges, -2.0 * MASS * mode.decay.at(time), low, high)


def _errors(case: str, snr_db: float, scales: Scales, seed: int) -> tuple[float, ...]:
    """Rms errors of the three ridges and the smoother untold and told, and the share that its interval covers."""
    time, truth, measured = record_of(case, snr_db, seed)
    free, told = _smoothed(measured, UNTOLD), _smoothed(measured, TOLD[case])
    low, high = (-2.0 * MASS * np.interp(time, free.decay.times, bound) for bound in (free.decay.high, free.decay.low))
    covered = float(np.mean((low <= truth) & (truth <= high)))
    smoothed = (-2.0 * MASS * mode.decay.at(time) for mode in (free, told))
    return (*(rms(found - truth) for found in (*_ridges(measured, scales), *smoothed)), covered)


def record_of(case: str, snr_db: float, seed: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(N,) time, c and the measured displacement.

    Args:
        case: ``step`` or ``line``.
        snr_db: dB.
        seed: of the noise.
    """
    decay = verification_decay(case)
    return decay.time, decay.damping, noisy(decay.signal, snr_db, seed)


def _smoothed(measured: FloatArray, told: Told) -> SmoothedMode:
    poles = fit_poles(measured[None], SAMPLING_RATE, [-0.004 + 1j * OMEGA])
    return smooth_decay(measured[None], SAMPLING_RATE, poles, np.ones(1), told)[0]


def _ridges(measured: FloatArray, scales: Scales) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(N,) c of the plain ridge at both scales, and of the one past jumps."""
    frequency = OMEGA / (2.0 * np.pi)
    skeletons = (
        follow_mode(measured, SAMPLING_RATE, frequency, scales.multiscale),
        follow_mode(measured, SAMPLING_RATE, frequency, scales.plain),
        follow_past_jumps(measured, SAMPLING_RATE, frequency, scales.past_jumps),
    )
    first, second, third = (2.0 * MASS * skeleton.decay_rate for skeleton in skeletons)
    return first, second, third


def rms(error: FloatArray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(error**2)))
