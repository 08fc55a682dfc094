"""The scale of the ridge by four searches, the article's ten runs, its window and its ends."""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from itertools import product

import numpy as np

from identification.decay.morlet_wave import morlet_wave_damping
from identification.decay.ridge import EDGES, follow_mode
from identification.decay.scale_search import ScaleSearch, Training, search_scale, try_scale
from identification.decay.verification import MASS, OMEGA, SAMPLING_RATE
from identification.decay.windows import WINDOWS
from models.arrays import FloatArray
from testbed.identifier_study.verification import CASES, SNRS, Scales, record_of, rms

MULTISCALE = 2.0**6.8
"""The article's scale before it searched finely, samples."""

ARTICLE_RUNS = (
    (6.680, 0.061, 0.012),
    (6.679, 0.058, 0.010),
    (6.678, 0.062, 0.009),
    (6.680, 0.061, 0.011),
    (6.680, 0.057, 0.010),
    (6.681, 0.059, 0.008),
    (6.678, 0.058, 0.009),
    (6.680, 0.061, 0.008),
    (6.681, 0.060, 0.010),
    (6.679, 0.061, 0.010),
)
"""The article's table 1: log2 of the scale in samples, and the two identified levels, N s/m."""

TRAINING_SEED = 1000
"""Of the noise of the record on which a scale is searched; no scored record has it."""

TWO_WAVES, WAVE_PERIODS = "two Morlet waves", 60
"""Closed-form damping from two waves of finite length, and how long they are; shorter ones drown at this damping."""

SETTLED = 0.1
"""Share of a jump that is left when the new level counts as reached."""


@dataclass(frozen=True)
class SearchRow:
    """One search on one training record.

    Attributes:
        case: ``step`` or ``line``.
        snr_db: dB.
        past_jumps: whether windows ended at the jumps found.
        method: of the search.
        log2_scale: log2 of the scale in samples.
        centre_frequency: omega_0, rad.
        value: of the objective.
        error: rms error of c at that scale, N s/m.
        evaluations: of the objective.
        lowest: whether no other method found a lower value.
    """

    case: str
    snr_db: float
    past_jumps: bool
    method: str
    log2_scale: float
    centre_frequency: float
    value: float
    error: float
    evaluations: int
    lowest: bool


@dataclass(frozen=True)
class RunRow:
    """One of ten runs of the quantum search on the step at 60 dB, each with noise and seed of its own.

    Attributes:
        run: from 1.
        log2_scale: log2 of the scale in samples.
        before: median of c before the jump, N s/m.
        after: after it.
        evaluations: of the objective.
    """

    run: int
    log2_scale: float
    before: float
    after: float
    evaluations: int


@dataclass(frozen=True)
class AblationRow:
    """Mean rms error of c, N s/m, with one window and one treatment of the ends."""

    case: str
    snr_db: float
    window: str
    edges: str
    error: float


def search_of(case: str, snr_db: float, past_jumps: bool, seed: int) -> ScaleSearch:  # noqa: FBT001 - mapped over a pool
    """All searches on one training record.

    Args:
        case: ``step`` or ``line``.
        snr_db: dB.
        past_jumps: whether windows end at the jumps found.
        seed: of the searches; of the noise with ``TRAINING_SEED`` added.
    """
    _, truth, measured = record_of(case, snr_db, TRAINING_SEED + seed)
    training = Training(measured, truth, SAMPLING_RATE, OMEGA / (2.0 * np.pi), MASS)
    return search_scale(training, seed, past_jumps=past_jumps)


def grid_shares(search: ScaleSearch, case: str, snr_db: float) -> list[tuple[float, float, float]]:
    """(log2 scale, normalised error, normalised cost) at every point of the grid.

    Args:
        search: of the plain ridge on the training record of that case and level with seed 0.
        case: ``step`` or ``line``.
        snr_db: dB.
    """
    _, truth, measured = record_of(case, snr_db, TRAINING_SEED)
    training = Training(measured, truth, SAMPLING_RATE, OMEGA / (2.0 * np.pi), MASS)
    places = np.sort(search.searches["grid"].points[:, 0])
    trials = np.array([try_scale(training, 2.0**place, search.cost, past_jumps=False) for place in places])
    shares = (trials - trials.min(axis=0)) / np.ptp(trials, axis=0)
    return [(float(place), float(error), float(cost)) for place, (error, cost) in zip(places, shares, strict=True)]


def search_rows(found: dict[tuple[str, float, bool], ScaleSearch]) -> Iterator[SearchRow]:
    """A row for every search.

    Args:
        found: by case, noise and whether windows ended at jumps.
    """
    for (case, snr_db, past_jumps), search in found.items():
        for method, result in search.searches.items():
            yield SearchRow(
                case,
                snr_db,
                past_jumps,
                method,
                float(result.best[0]),
                search.centre_frequency(method),
                result.value,
                search.trials[method].error,
                result.evaluations,
                method == search.lowest,
            )


def all_searches(pool: Executor) -> dict[tuple[str, float, bool], ScaleSearch]:
    """Searches for every case, noise level and kind of window.

    Args:
        pool: that they are shared among.
    """
    cases = list(product(CASES, SNRS, (False, True)))
    found = pool.map(search_of, *zip(*cases, strict=True), [0] * len(cases))
    return dict(zip(cases, found, strict=True))


def scales_of(found: dict[tuple[str, float, bool], ScaleSearch]) -> dict[tuple[str, float], Scales]:
    """The scales that the rows of the verification use: what the lowest search found.

    Args:
        found: by case, noise and whether windows ended at jumps.
    """
    plain = {(case, snr): search for (case, snr, past), search in found.items() if not past}
    past = {(case, snr): search for (case, snr, past), search in found.items() if past}
    return {
        key: Scales(MULTISCALE, search.scale(search.lowest), past[key].scale(past[key].lowest))
        for key, search in plain.items()
    }


def ten_runs(pool: Executor) -> Iterator[RunRow]:
    """The article's table 1: ten runs on the step.

    Args:
        pool: that they are shared among.
    """
    yield from pool.map(_run, range(1, 11))


def _run(number: int) -> RunRow:
    search = search_of("step", 60.0, False, number)  # noqa: FBT003
    time, _, measured = record_of("step", 60.0, TRAINING_SEED + number)
    skeleton = follow_mode(measured, SAMPLING_RATE, OMEGA / (2.0 * np.pi), search.scale("quantum"))
    c = 2.0 * MASS * skeleton.decay_rate
    levels = [float(np.median(c[part])) for part in (time < 50.0, time > 50.0)]
    result = search.searches["quantum"]
    return RunRow(number, float(result.best[0]), levels[0], levels[1], result.evaluations)


def ablation_rows(scales: dict[tuple[str, float], Scales], seeds: int, pool: Executor) -> Iterator[AblationRow]:
    """Every window with fitted ends, and the Gaussian with every treatment of the ends, at the optimised scale.

    Args:
        scales: of each case and level.
        seeds: records of each.
        pool: that they are shared among.
    """
    pairs = [(window, "fitted") for window in WINDOWS] + [("gaussian", edges) for edges in EDGES if edges != "fitted"]
    pairs += [(TWO_WAVES, "held")]
    jobs = [(case, snr, scales[case, snr].plain, *pair, seeds) for case, snr, pair in product(CASES, SNRS, pairs)]
    yield from pool.map(_ablated, *zip(*jobs, strict=True))


def _ablated(case: str, snr_db: float, scale: float, window: str, edges: str, seeds: int) -> AblationRow:
    errors = []
    for seed in range(seeds):
        _, truth, measured = record_of(case, snr_db, seed)
        frequency = OMEGA / (2.0 * np.pi)
        if window == TWO_WAVES:
            rate = OMEGA * morlet_wave_damping(measured, SAMPLING_RATE, frequency, WAVE_PERIODS)
        else:
            rate = follow_mode(measured, SAMPLING_RATE, frequency, scale, window, edges).decay_rate
        errors.append(rms(2.0 * MASS * rate - truth))
    return AblationRow(case, snr_db, window, edges, float(np.mean(errors)))


def tracking_time(time: FloatArray, c: FloatArray, before: float, after: float, jump: float) -> float:
    """Seconds between leaving the old level and reaching the new one for good, by a tenth of the jump.

    Args:
        time: (N,) s.
        c: (N,) identified, smoothed by its own window.
        before: N s/m.
        after: N s/m.
        jump: s.
    """
    share = (c - after) / (before - after)
    around = np.abs(time - jump) < 0.05 * time[-1]
    high, low = time[around & (share > 1.0 - SETTLED)], time[around & (share > SETTLED)]
    return float(low.max() - high.max()) if len(high) and len(low) else float("nan")
