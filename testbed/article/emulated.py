"""A Gaussian-process emulator of the struck response, checked against simulation, and the shares of its variance.

The tip's rms under the table's multisine has no formula: contacts open and close. It is simulated at some hundred
points of a space-filling design, emulated, and checked at points that the emulator has not seen; what takes ten
thousand samples, a distribution and the shares of its variance, is then asked of the emulator.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.stats import norm, qmc

from identification.parallel import in_parallel
from models.arrays import FloatArray
from models.plant import build_plant
from models.record import Record
from models.rig import Rig
from models.simulate import simulate
from testbed.article.small_motion import SmallMotion
from testbed.article.uncertain import CONDITIONS, SAMPLES, SEED, draws_at

TRAINED_ON, CHECKED_ON = 256, 64
"""Points of two space-filling designs: to learn from, and to hold the emulator against the simulation."""

BASE = 1024
"""Of Sobol's design: D + 2 times as many are evaluated."""

RESTARTS = 3
"""Of the search for the kernel's lengths."""

NAMES = ("stiffness 1", "stiffness 2", "damping 1", "damping 2", "clearance 1", "clearance 2")


@dataclass(frozen=True, eq=False)
class Emulated:
    """What the emulator is worth, and what it says.

    Attributes:
        simulated, predicted, stds: (n_checked,) tip's rms, m/s^2, at points not seen, and the emulator's own doubt.
        error: rms of their difference over the standard deviation of the simulated ones.
        covered: share of the simulated within the emulator's 95 % interval.
        samples: (N,) of the response with everything random, the emulator's doubt included.
        alone: response at the means, m/s^2: what a model without uncertainty says.
        shares, totals: (6,) first-order and total shares of the emulator's variance, with half their 95 %
            intervals.
    """

    simulated: FloatArray
    predicted: FloatArray
    stds: FloatArray
    error: float
    covered: float
    samples: FloatArray
    alone: float
    shares: FloatArray
    shares_within: FloatArray
    totals: FloatArray
    totals_within: FloatArray


@dataclass(frozen=True, eq=False)
class Shares:
    """Of the variance of four natural frequencies.

    Attributes:
        first, first_within, total, total_within: (4, 6).
    """

    first: FloatArray
    first_within: FloatArray
    total: FloatArray
    total_within: FloatArray


def frequency_shares(motion: SmallMotion, rig: Rig) -> Shares:
    """Shares of the variance of the natural frequencies, by Sobol's method on the model itself.

    Args:
        motion: of the rod.
        rig: with the means.
    """
    freqs = motion.natural_freqs(draws_at(rig, _sobol_points()))
    found = [_analysed(freqs[:, order]) for order in range(freqs.shape[1])]
    return Shares(*(np.stack([one[key] for one in found]) for key in ("S1", "S1_conf", "ST", "ST_conf")))


def emulated(rig: Rig, record: Record, tip: str, jobs: int) -> Emulated:
    """Emulate the tip's rms under a record's excitation.

    Args:
        rig: with the means and the record's excitation.
        record: whose excitation drives it.
        tip: the sensor.
        jobs: cores.

    Raises:
        DivergenceError: a rig's motion left the finite numbers.
    """
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    train, check = (
        norm.ppf(qmc.Sobol(6, rng=np.random.default_rng([SEED, 3, part])).random(count))
        for part, count in enumerate((TRAINED_ON, CHECKED_ON))
    )
    answers = partial(_answers, rig, record, tip, jobs)
    known, simulated = answers(train), answers(check)
    scale, middle = known.std(), known.mean()
    kernel = ConstantKernel(1.0) * RBF(np.full(6, 3.0), (0.3, 1e3)) + WhiteKernel(1e-3, (1e-10, 1.0))
    process = GaussianProcessRegressor(kernel, n_restarts_optimizer=RESTARTS, random_state=SEED)
    process.fit(train, (known - middle) / scale)
    predicted, stds = process.predict(check, return_std=True)
    predicted, stds = middle + scale * predicted, scale * stds
    rng = np.random.default_rng([SEED, 4])
    answered, doubts = process.predict(rng.standard_normal((SAMPLES, 6)), return_std=True)
    samples = middle + scale * (answered + doubts * rng.standard_normal(SAMPLES))
    found = _analysed(middle + scale * process.predict(_sobol_points()))
    return Emulated(
        simulated,
        predicted,
        stds,
        float(np.sqrt(np.mean((predicted - simulated) ** 2)) / simulated.std()),
        float(np.mean(np.abs(predicted - simulated) < norm.ppf(0.975) * stds)),
        np.asarray(samples),
        float(answers(np.zeros((1, 6)))[0]),
        *(found[key] for key in ("S1", "S1_conf", "ST", "ST_conf")),
    )


def _answers(rig: Rig, record: Record, tip: str, jobs: int, points: FloatArray) -> FloatArray:
    """(N,) rms of the tip."""
    draws = draws_at(rig, points)
    rigs = [
        rig.with_values(
            {f"sleeves[{k}].{key}": float(getattr(draws, key)[number, k]) for key in CONDITIONS for k in range(2)}
        )
        for number in range(len(points))
    ]
    return np.array(in_parallel(jobs, partial(_rms, record, record.sensors.index(tip)), rigs))


def _rms(record: Record, row: int, rig: Rig) -> float:
    return float(np.std(simulate(build_plant(rig), record).channels[row]))


def _problem() -> dict[str, object]:
    return {"num_vars": len(NAMES), "names": list(NAMES), "bounds": [[0.0, 1.0]] * len(NAMES), "dists": ["norm"] * 6}


def _sobol_points() -> FloatArray:
    from SALib.sample import sobol

    return np.asarray(sobol.sample(_problem(), BASE, calc_second_order=False, seed=SEED))


def _analysed(answers: FloatArray) -> dict[str, FloatArray]:
    from SALib.analyze import sobol

    found = sobol.analyze(_problem(), answers, calc_second_order=False, seed=SEED)
    return {key: np.asarray(found[key], float) for key in ("S1", "S1_conf", "ST", "ST_conf")}
